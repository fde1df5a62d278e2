// What is said while somebody turns round for a scan. Values, no state.

import { isWhole, nextSide, share } from './bearings.js';

/** @typedef {import('./bearings.js').Bearings} Bearings */

/**
 * @typedef {object} Guide
 * @property {number} ticks twelfths of the turn that were told by sound
 * @property {number} quarters that were told in words
 * @property {number} moved_s when the turn last went on
 * @property {number} said_s when something was said last
 */

/**
 * @typedef {object} Cue
 * @property {string | null} say key of a text
 * @property {{ percent: number }} values its placeholders
 * @property {boolean} tick whether a tick is heard
 * @property {boolean} done whether the scan is complete
 */

const TICKS = 12;
const REMIND_S = 8; // after standing still, or doing it wrong, for so long
const QUARTERS = ['', 'scan.quarter', 'scan.half', 'scan.threeQuarters'];

/** @param {number} time_s */
export function newGuide(time_s) {
  return /** @type {Guide} */ (
    Object.freeze({ ticks: 0, quarters: 0, moved_s: time_s, said_s: time_s })
  );
}

/**
 * Return what to say and sound now, and the guide after it.
 *
 * @param {Guide} guide
 * @param {Bearings} bearings
 * @param {number} nWalls
 * @param {number} time_s
 * @returns {[Guide, Cue]}
 */
export function guided(guide, bearings, nWalls, time_s) {
  const covered = share(bearings);
  const ticks = Math.floor(covered * TICKS + 1e-9);
  const tick = ticks > guide.ticks;
  const after = { ...guide, ticks, moved_s: tick ? time_s : guide.moved_s };
  const [say, quarters] = wordsFor(after, bearings, nWalls, time_s);
  const values = { percent: Math.round(100 * covered) };
  return [
    Object.freeze({ ...after, quarters, said_s: say ? time_s : after.said_s }),
    { say, values, tick, done: isWhole(bearings) && nWalls > 0 },
  ];
}

/**
 * @param {Guide} guide
 * @param {Bearings} bearings
 * @param {number} nWalls
 * @param {number} time_s
 * @returns {[string | null, number]} key of a text, and the quarters told
 */
function wordsFor(guide, bearings, nWalls, time_s) {
  const quarters = Math.min(3, Math.floor(4 * share(bearings) + 1e-9));
  if (quarters > guide.quarters) return [QUARTERS[quarters], quarters];
  if (time_s - guide.said_s < REMIND_S) return [null, guide.quarters];
  if (bearings.pace === 'steep') return ['scan.upright', guide.quarters];
  if (bearings.pace === 'quick') return ['scan.slower', guide.quarters];
  if (isWhole(bearings) && nWalls === 0) return ['scan.noWalls', guide.quarters];
  if (time_s - guide.moved_s >= REMIND_S) {
    return [`scan.goOn.${nextSide(bearings) ?? 'right'}`, guide.quarters];
  }
  return [null, guide.quarters];
}
