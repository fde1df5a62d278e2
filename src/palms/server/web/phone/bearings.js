// The bearings that a phone has looked at while its user turns round. Values, no state.
//
// Angles are on the ground, counter-clockwise seen from above: who turns left turns to larger ones.

const SECTORS = 72;
const HALF_VIEW_RAD = (25 * Math.PI) / 180; // a camera held upright sees about 50 degrees across
const QUICK_RAD_S = (100 * Math.PI) / 180; // quicker than this the picture blurs
const STEEP_RAD = (40 * Math.PI) / 180; // who looks further up or down sees floor or ceiling
const LATELY_S = 2; // so long a turn is remembered
const FULL = 0.97; // a turn by hand that ends this near to its beginning is a whole one

/**
 * @typedef {object} View
 * @property {number} yaw_rad where the phone looks
 * @property {number} pitch_rad up, from the horizon
 * @property {number} time_s
 */

/**
 * @typedef {object} Bearings
 * @property {readonly boolean[]} seen by sector of the bearing, from 0 to 2 pi
 * @property {View | null} last
 * @property {'good' | 'quick' | 'steep'} pace how the last look was
 * @property {number} turned_rad the way turned lately, to the left positive
 */

/** @type {Bearings} */
export const NOTHING_SEEN = Object.freeze({
  seen: Object.freeze(new Array(SECTORS).fill(false)),
  last: null,
  pace: 'good',
  turned_rad: 0,
});

/**
 * Return an angle in (-pi, pi].
 *
 * @param {number} angle_rad
 */
export function wrapAngle(angle_rad) {
  const turned = angle_rad % (2 * Math.PI);
  if (turned > Math.PI) return turned - 2 * Math.PI;
  return turned <= -Math.PI ? turned + 2 * Math.PI : turned;
}

/**
 * Look once more. A look counts unless the phone turns too quickly or is tilted too far.
 *
 * @param {Bearings} bearings
 * @param {View} view
 * @returns {Bearings}
 */
export function looked(bearings, view) {
  const { last } = bearings;
  const turn_rad = last ? wrapAngle(view.yaw_rad - last.yaw_rad) : 0;
  const took_s = last ? view.time_s - last.time_s : 0;
  const pace = paceOf(view, turn_rad, took_s);
  return Object.freeze({
    seen: pace === 'good' ? withSector(bearings.seen, view.yaw_rad) : bearings.seen,
    last: view,
    pace,
    turned_rad: bearings.turned_rad * Math.exp(-took_s / LATELY_S) + turn_rad,
  });
}

/**
 * @param {View} view
 * @param {number} turn_rad since the look before
 * @param {number} took_s
 * @returns {Bearings['pace']}
 */
function paceOf(view, turn_rad, took_s) {
  if (Math.abs(view.pitch_rad) > STEEP_RAD) return 'steep';
  return took_s > 0 && Math.abs(turn_rad) / took_s > QUICK_RAD_S ? 'quick' : 'good';
}

/**
 * @param {readonly boolean[]} seen
 * @param {number} yaw_rad
 */
function withSector(seen, yaw_rad) {
  if (seen.every((was, sector) => was || !isInView(sector, yaw_rad))) return seen;
  return Object.freeze(seen.map((was, sector) => was || isInView(sector, yaw_rad)));
}

/** @param {number} sector */
export function bearingOf(sector) {
  return ((sector + 0.5) * 2 * Math.PI) / SECTORS;
}

/**
 * @param {number} sector
 * @param {number} yaw_rad
 */
function isInView(sector, yaw_rad) {
  return Math.abs(wrapAngle(bearingOf(sector) - yaw_rad)) <= HALF_VIEW_RAD;
}

/**
 * Return the share of all bearings that were looked at, 0 to 1.
 *
 * @param {Bearings} bearings
 */
export function share({ seen }) {
  return seen.filter(Boolean).length / seen.length;
}

/**
 * Whether the phone was turned all the way round.
 *
 * @param {Bearings} bearings
 */
export function isWhole(bearings) {
  return share(bearings) >= FULL;
}

/**
 * Return the side to turn to: on, the way that somebody turns already, else where the nearest
 * bearing is that was not looked at; null when there is none.
 *
 * @param {Bearings} bearings
 * @returns {'left' | 'right' | null}
 */
export function nextSide({ seen, last, turned_rad }) {
  if (!last || seen.every(Boolean)) return null;
  const left = gapTo(seen, last.yaw_rad, 1);
  const right = gapTo(seen, last.yaw_rad, -1);
  const isTurning = Math.abs(turned_rad) > HALF_VIEW_RAD / 5;
  if (isTurning && Math.min(left, right) > 0.6 * Math.max(left, right)) {
    return turned_rad > 0 ? 'left' : 'right';
  }
  return left < right ? 'left' : 'right';
}

/**
 * Return how many sectors there are to the first that was not looked at.
 *
 * @param {readonly boolean[]} seen
 * @param {number} yaw_rad
 * @param {1 | -1} way to the left or to the right
 */
function gapTo(seen, yaw_rad, way) {
  const here = Math.floor((yaw_rad / (2 * Math.PI)) * SECTORS);
  for (let n = 1; n <= SECTORS; n++) {
    if (!seen[(((here + way * n) % SECTORS) + SECTORS) % SECTORS]) return n;
  }
  return SECTORS;
}
