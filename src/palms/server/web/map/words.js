// Words: what the map shows, told. Distances and uncertainties are rounded up.

/** @typedef {import('./story.js').Step} Step */

export const STAGES = {
  searching: { word: 'Searching', sign: '○', means: 'Many places fit what the phone saw.' },
  oriented: { word: 'Oriented', sign: '◐', means: 'It knows how the phone is turned, not where.' },
  localized: { word: 'Localized', sign: '●', means: 'It knows where the phone is.' },
  lost: { word: 'Lost', sign: '✕', means: 'Walls contradict what it believed.' },
};

const HAPPENINGS = {
  scanning: 'A scan was taken.',
  oriented: 'Oriented.',
  localized: 'Localized',
  relocalized: 'Found again',
  unsure: 'Not sure any more.',
  lost: 'Lost. It looks elsewhere; another scan helps most.',
  paused: 'The phone has paused.',
  resumed: 'The phone goes on.',
  restarted: 'The phone began anew; it needs another scan.',
};

/**
 * A share as a percentage; never 100 % or 0 % when it is not quite.
 *
 * @param {number} share
 */
export function percent(share) {
  if (share > 0 && share < 0.01) return 'below 1 %';
  if (share > 0.99 && share < 1) return 'above 99 %';
  return `${Math.round(share * 100)} %`;
}

/**
 * A distance that is not more than what it says: to a decimetre below 3 m, else to a metre.
 *
 * @param {number} metres
 */
export function atMost(metres) {
  const unit = metres < 3 ? 0.1 : 1;
  const rounded = Math.ceil(metres / unit - 1e-9) * unit;
  return `${unit < 1 ? rounded.toFixed(1) : rounded} m`;
}

/** A time as minutes and seconds. @param {number} seconds */
export function clock(seconds) {
  const whole = Math.max(0, Math.round(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

/** An angle for a person. @param {number} radians */
export function degrees(radians) {
  return `${Math.round((radians * 180) / Math.PI)}°`.replace('-', '−');
}

/**
 * Where the phone is, in a sentence, as far as it may be said.
 *
 * @param {Step} step
 */
export function placeSentence(step) {
  if (step.stage === 'localized' && step.x_m !== null) {
    const place = step.room ?? 'On the map';
    return step.radius_95_m ? `${place}, within ${atMost(step.radius_95_m)}` : place;
  }
  const n = (step.hypotheses ?? []).filter(({ p }) => p >= 0.05).length;
  if (n > 1) return `${n} places likely`;
  if (n === 1) return 'One place likely, among many';
  return step.x_m === null ? 'Waiting for a scan' : 'No place stands out yet';
}

/**
 * What happened, for the live region and the timeline.
 *
 * @param {{ kind: string }} event
 * @param {Step} [step] the estimate after it
 */
export function eventSentence({ kind }, step) {
  const words = HAPPENINGS[/** @type {keyof typeof HAPPENINGS} */ (kind)] ?? `${kind}.`;
  if (kind !== 'localized' && kind !== 'relocalized') return words;
  return step ? `${words}: ${placeSentence(step)}.` : `${words}.`;
}

/**
 * A step whole, for the slider and for who does not see the map.
 *
 * @param {Step} step
 * @param {number} seconds since the beginning
 */
export function stepSentence(step, seconds) {
  const sure = step.p_within_1m == null ? '' : `, ${percent(step.p_within_1m)} within 1 metre`;
  return `${clock(seconds)}: ${STAGES[step.stage].word}, ${placeSentence(step)}${sure}`;
}
