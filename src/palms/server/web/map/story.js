// Story: all that the page knows of one walk, from its beginning to now; the same for a live
// session, a drawn walk and a replay.

import { onLevel, unpackFrame } from '../shared/frames.js';

/** @typedef {import('../shared/plan.js').Plan} Plan */
/** @typedef {import('../shared/view.js').Point} Point */
/** @typedef {import('../shared/frames.js').Particles} Particles */
/** @typedef {import('../shared/frames.js').Heatmap} Heatmap */

/**
 * An estimate as the server sends it; of what was before a viewer came only time, place and stage.
 *
 * @typedef {object} Step
 * @property {number} seq
 * @property {number} t_s
 * @property {'searching' | 'oriented' | 'localized' | 'lost'} stage
 * @property {number | null} x_m
 * @property {number | null} y_m
 * @property {number | null} [heading_rad]
 * @property {number | null} [p_within_1m]
 * @property {number | null} [p_within_2m]
 * @property {number | null} [radius_68_m]
 * @property {number | null} [radius_95_m]
 * @property {string | null} [level]
 * @property {string | null} [room]
 * @property {number} [walked_m]
 * @property {{ x_m: number, y_m: number, p: number, room: string | null }[]} [hypotheses]
 */

/** @typedef {{ kind: string, seq: number, t_s: number | null }} Happening */

const MOST_CLOUDS = 1500; // of 10 kB each

/** Changes as messages come; says nothing by itself. */
export class Story {
  /** @type {Step[]} */ steps = [];
  /** @type {Happening[]} */ events = [];
  /** @type {Heatmap[]} */ heatmaps = [];
  /** @type {Map<string, Plan>} */ plans = new Map();
  /** @type {string[]} */ levels = []; // of the building, from the lowest up
  /** @type {Point[] | null} */ truth_m;
  /** @type {Map<number, ArrayBuffer>} */ #clouds = new Map();

  /**
   * @param {object} about
   * @param {string} about.title such as the building's name
   * @param {string} about.level
   * @param {Plan} [about.plan]
   * @param {Point[] | null} [about.truth_m] the start, then the place after each sample
   */
  constructor({ title, level, plan, truth_m = null }) {
    this.title = title;
    this.level = level;
    this.truth_m = truth_m;
    if (plan) this.plans.set(level, plan);
  }

  /** @param {Step} estimate */
  addStep(estimate) {
    const last = this.steps.at(-1);
    if (last && last.seq === estimate.seq) this.steps.pop();
    if (last && last.seq > estimate.seq) return;
    this.steps.push(estimate);
  }

  /**
   * Take up what was before: columns of equal length.
   *
   * @param {{ t_s: number[], x_m: (number | null)[], y_m: (number | null)[],
   *   stage: Step['stage'][] }} path
   */
  addPath({ t_s, x_m, y_m, stage }) {
    const known = new Map(this.steps.map((step) => [step.seq, step]));
    this.steps = t_s.map((time, i) => known.get(i + 1)
      ?? { seq: i + 1, t_s: time, x_m: x_m[i], y_m: y_m[i], stage: stage[i] });
  }

  /** @param {ArrayBuffer} buffer a binary frame */
  addFrame(buffer) {
    const frame = unpackFrame(buffer);
    if (frame?.kind === 'heatmap') this.addHeatmap(frame);
    if (frame?.kind !== 'particles') return;
    this.#clouds.set(frame.seq, buffer);
    if (this.#clouds.size > MOST_CLOUDS) this.#clouds.delete(this.#clouds.keys().next().value ?? 0);
  }

  /** @param {Heatmap} map */
  addHeatmap(map) {
    const isOther = (/** @type {Heatmap} */ each) =>
      each.seq !== map.seq || each.number !== map.number || each.level !== map.level;
    this.heatmaps = [...this.heatmaps.filter(isOther), map];
  }

  /**
   * The particles after a step, or the latest before it, on the level that is shown.
   *
   * @param {number} seq
   * @returns {Particles | null}
   */
  cloudAt(seq) {
    let found = -1;
    for (const each of this.#clouds.keys()) if (each <= seq && each > found) found = each;
    const buffer = this.#clouds.get(found);
    const cloud = buffer && /** @type {Particles} */ (unpackFrame(buffer));
    return cloud ? onLevel(cloud, this.#levelAt(seq)) : null;
  }

  /**
   * The maps of the latest scan up to a step, on the level that is shown, the best first.
   *
   * @param {number} seq
   */
  heatmapsAt(seq) {
    const scans = this.heatmaps.map((map) => map.seq).filter((each) => each <= seq);
    const scan = Math.max(...scans);
    const level = this.#levelAt(seq);
    const shown = this.heatmaps.filter(
      (map) => map.seq === scan && (!map.n_levels || map.level === level),
    );
    return shown.sort((a, b) => a.number - b.number);
  }

  /** The number of the level that is shown at a step. @param {number} seq */
  #levelAt(seq) {
    const step = this.steps.findLast((each) => each.seq <= seq);
    return Math.max(0, this.levels.indexOf(step?.level ?? this.level));
  }

  /**
   * Where the phone truly was at a step; null where nobody knows.
   *
   * @param {number} seq
   */
  truthAt(seq) {
    return this.truth_m?.[seq - 1] ?? null;
  }

  /** @param {Step | undefined} step */
  planAt(step) {
    return this.plans.get(step?.level ?? this.level) ?? this.plans.get(this.level) ?? null;
  }

  /** Seconds from the first step to another. @param {Step} step */
  since(step) {
    return step.t_s - this.steps[0].t_s;
  }
}
