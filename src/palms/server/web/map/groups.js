// Groups: particles and heatmaps by how the phone's frame is turned, in four colours and shapes.

/** @typedef {import('../shared/frames.js').Particles} Particles */
/** @typedef {import('../shared/frames.js').Heatmap} Heatmap */

export const N_GROUPS = 4;
export const SHAPES = ['circle', 'square', 'triangle', 'diamond'];

/**
 * Return the group of a label: labels go round the circle in order, a quarter is a group.
 *
 * @param {number} label
 * @param {number} n_labels 0 where it is not known
 */
export function groupOf(label, n_labels) {
  const quarter = n_labels > N_GROUPS ? Math.floor((label * N_GROUPS) / n_labels) : label;
  return quarter % N_GROUPS;
}

/**
 * How many labels there are: as the heatmaps say, else as many as are seen.
 *
 * @param {Heatmap[]} heatmaps
 * @param {Particles | null} cloud
 */
export function labelsIn(heatmaps, cloud) {
  if (heatmaps.length > 0) return heatmaps[0].n_labels;
  return cloud ? cloud.label.reduce((most, each) => Math.max(most, each), 0) + 1 : 0;
}

/**
 * Return the indices of the particles of each group.
 *
 * @param {Particles} cloud
 * @param {number} n_labels
 * @returns {number[][]}
 */
export function grouped(cloud, n_labels) {
  /** @type {number[][]} */
  const groups = Array.from({ length: N_GROUPS }, () => []);
  cloud.label.forEach((label, i) => groups[groupOf(label, n_labels)].push(i));
  return groups;
}

/**
 * About which drift each group has, from any map that is known: groups are a quarter of a turn
 * apart. Empty where no map is known.
 *
 * @param {Heatmap[]} heatmaps
 * @returns {number[]} radians, in (-pi, pi]
 */
export function driftsOf(heatmaps) {
  if (heatmaps.length === 0) return [];
  const { label, n_labels, drift_rad } = heatmaps[0];
  const own = groupOf(label, n_labels);
  return Array.from({ length: N_GROUPS }, (_, k) => wrapped(drift_rad + ((k - own) * Math.PI) / 2));
}

/** @param {number} angle */
function wrapped(angle) {
  const turned = angle % (2 * Math.PI);
  if (turned > Math.PI) return turned - 2 * Math.PI;
  return turned <= -Math.PI ? turned + 2 * Math.PI : turned;
}
