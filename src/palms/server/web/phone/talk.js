// Who may speak now: at most one unasked sentence in five seconds. Values, no state.

/**
 * @typedef {object} Sentence
 * @property {string} text
 * @property {string | null} [details]
 * @property {string} [language]
 * @property {boolean} [asked] an answer: it is said at once
 * @property {boolean} [urgent] it is said at once, too
 * @property {boolean} [passing] soon out of date: rather left out than late
 */

/**
 * @typedef {object} Talk
 * @property {number} free_s when the next unasked sentence may be said
 * @property {Sentence | null} waiting the one that is said then
 */

export const GAP_S = 5;

/** @type {Talk} */
export const SILENCE = Object.freeze({ free_s: -Infinity, waiting: null });

/**
 * Offer a sentence; it is said now, or waits, or is left out. One that waits gives way to a later
 * one, unless that is merely passing.
 *
 * @param {Talk} talk
 * @param {Sentence} sentence
 * @param {number} time_s
 * @returns {[Talk, Sentence | null]} what to say now
 */
export function offered(talk, sentence, time_s) {
  const { asked = false, urgent = false, passing = false } = sentence;
  if (asked || urgent || time_s >= talk.free_s) {
    const waiting = asked ? talk.waiting : null;
    return [Object.freeze({ free_s: time_s + GAP_S, waiting }), sentence];
  }
  if (passing) return [talk, null];
  return [Object.freeze({ ...talk, waiting: sentence }), null];
}

/**
 * Return what has waited long enough, if anything.
 *
 * @param {Talk} talk
 * @param {number} time_s
 * @returns {[Talk, Sentence | null]}
 */
export function dueNow(talk, time_s) {
  if (!talk.waiting || time_s < talk.free_s) return [talk, null];
  return [Object.freeze({ free_s: time_s + GAP_S, waiting: null }), talk.waiting];
}
