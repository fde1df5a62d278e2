// Which room a place is in, where the server was asked for a track alone.

/** @typedef {import('../shared/plan.js').Plan} Plan */
/** @typedef {import('../shared/view.js').Point} Point */

const NEAR_M = 5;

/**
 * Whether a place lies in a polygon.
 *
 * @param {Point[]} polygon not closed
 * @param {Point} place
 */
export function contains(polygon, [x, y]) {
  let isIn = false;
  polygon.forEach(([x0, y0], i) => {
    const [x1, y1] = polygon[(i + 1) % polygon.length];
    if (y0 > y !== y1 > y && x < x0 + ((y - y0) / (y1 - y0)) * (x1 - x0)) isIn = !isIn;
  });
  return isIn;
}

/**
 * Return how to say where a place is: in a room, near one, or on the map alone.
 *
 * @param {Plan} plan
 * @param {Point} place
 */
export function placeIn(plan, place) {
  const named = plan.rooms.filter(({ name }) => name);
  const within = named.find(({ polygon_m }) => contains(polygon_m, place));
  if (within) return { key: 'other.foundRoom', room: within.name };
  const nearest = named
    .map(({ name, polygon_m }) => ({ name, range_m: rangeTo(polygon_m, place) }))
    .sort((a, b) => a.range_m - b.range_m)[0];
  if (nearest && nearest.range_m <= NEAR_M) return { key: 'other.foundNear', room: nearest.name };
  return { key: 'other.found', room: '' };
}

/**
 * @param {Point[]} polygon
 * @param {Point} place
 */
function rangeTo(polygon, place) {
  return Math.min(...polygon.map((corner, i) =>
    toEdge(corner, polygon[(i + 1) % polygon.length], place)));
}

/**
 * @param {Point} a
 * @param {Point} b
 * @param {Point} place
 */
function toEdge([ax, ay], [bx, by], [x, y]) {
  const [ex, ey] = [bx - ax, by - ay];
  const squared = ex * ex + ey * ey;
  const along = squared > 0 ? ((x - ax) * ex + (y - ay) * ey) / squared : 0;
  const t = Math.min(1, Math.max(0, along));
  return Math.hypot(ax + t * ex - x, ay + t * ey - y);
}
