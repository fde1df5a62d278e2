// Timeline: how probable the answer was over time, the stages, what happened; a slider to scrub.

import { usePixels } from '../shared/view.js';
import { STAGES, clock, stepSentence } from './words.js';

/** @typedef {import('./story.js').Story} Story */
/** @typedef {import('./story.js').Step} Step */

const STRIP_PX = 16;
const GAP_PX = 4;
export const THUMB_PX = 16; // of the slider: the curve begins and ends at the middle of its thumb

/**
 * Return the last step that is not after a time.
 *
 * @param {Step[]} steps
 * @param {number} t_s
 */
export function indexAt(steps, t_s) {
  let [low, high] = [0, steps.length - 1];
  while (low < high) {
    const middle = Math.ceil((low + high) / 2);
    if (steps[middle].t_s <= t_s) low = middle;
    else high = middle - 1;
  }
  return Math.max(low, 0);
}

/**
 * Return the stretches of one stage each, as indices of their first and last step.
 *
 * @param {Step[]} steps
 * @returns {{ stage: Step['stage'], from: number, to: number }[]}
 */
export function stretches(steps) {
  /** @type {{ stage: Step['stage'], from: number, to: number }[]} */
  const found = [];
  steps.forEach(({ stage }, i) => {
    const last = found.at(-1);
    if (last?.stage === stage) last.to = i;
    else found.push({ stage, from: i, to: i });
  });
  return found;
}

export class Timeline {
  #element;
  #slider;
  #time;

  /**
   * @param {HTMLCanvasElement} element
   * @param {HTMLInputElement} slider whose value is the index of a step
   * @param {HTMLElement} time
   */
  constructor(element, slider, time) {
    this.#element = element;
    this.#slider = slider;
    this.#time = time;
  }

  /**
   * Show a story up to a step; the whole curve is drawn, the rest of it faint.
   *
   * @param {Story} story
   * @param {number} index
   * @param {(name: string) => string} colour
   */
  show(story, index, colour) {
    const { steps } = story;
    const step = steps[index];
    this.#slider.max = String(Math.max(steps.length - 1, 0));
    this.#slider.value = String(index);
    this.#slider.setAttribute('aria-valuetext', stepSentence(step, story.since(step)));
    const whole = clock(story.since(steps[steps.length - 1]));
    this.#time.textContent = `${clock(story.since(step))} / ${whole}`;
    this.#paint(story, index, colour);
  }

  /**
   * @param {Story} story
   * @param {number} index
   * @param {(name: string) => string} colour
   */
  #paint({ steps }, index, colour) {
    const { clientWidth: width, clientHeight: height } = this.#element;
    if (!width) return;
    const density = Math.min(window.devicePixelRatio || 1, 3);
    this.#element.width = Math.round(width * density);
    this.#element.height = Math.round(height * density);
    const canvas = /** @type {CanvasRenderingContext2D} */ (this.#element.getContext('2d'));
    usePixels(canvas, density);
    const x = scaleOf(steps.length, width);
    const curve = height - STRIP_PX - GAP_PX;
    drawCurve(canvas, steps, x, curve, colour);
    drawStages(canvas, steps, x, { top: curve + GAP_PX, colour });
    canvas.fillStyle = colour('card');
    canvas.globalAlpha = 0.6;
    canvas.fillRect(x(index), 0, width, height);
    canvas.globalAlpha = 1;
    canvas.fillStyle = colour('ink');
    canvas.fillRect(x(index) - 1, 0, 2, height);
  }
}

/**
 * Steps lie evenly, as the slider has them.
 *
 * @param {number} n
 * @param {number} width
 */
function scaleOf(n, width) {
  const span = width - THUMB_PX;
  return (/** @type {number} */ i) => THUMB_PX / 2 + (n > 1 ? (span * i) / (n - 1) : 0);
}

/**
 * @param {CanvasRenderingContext2D} canvas
 * @param {Step[]} steps
 * @param {(i: number) => number} x
 * @param {number} height
 * @param {(name: string) => string} colour
 */
function drawCurve(canvas, steps, x, height, colour) {
  const y = (/** @type {number} */ p) => 2 + (height - 2) * (1 - p);
  const end = x(steps.length - 1);
  canvas.fillStyle = colour('line');
  for (const p of [0, 0.5, 1]) canvas.fillRect(x(0), Math.round(y(p)) - 0.5, end - x(0), 1);
  canvas.beginPath();
  canvas.moveTo(x(0), y(0));
  steps.forEach((step, i) => canvas.lineTo(x(i), y(step.p_within_1m ?? 0)));
  canvas.lineTo(end, y(0));
  canvas.fillStyle = colour('accent');
  canvas.globalAlpha = 0.18;
  canvas.fill();
  canvas.globalAlpha = 1;
  canvas.beginPath();
  steps.forEach((step, i) => canvas.lineTo(x(i), y(step.p_within_1m ?? 0)));
  canvas.strokeStyle = colour('accent');
  canvas.lineWidth = 2;
  canvas.lineJoin = 'round';
  canvas.stroke();
  canvas.fillStyle = colour('muted');
  canvas.font = `11px ${colour('font')}`;
  canvas.textAlign = 'left';
  canvas.textBaseline = 'bottom';
  canvas.fillText('probability within 1 m', x(0) + 4, y(0) - 2);
}

/**
 * @param {CanvasRenderingContext2D} canvas
 * @param {Step[]} steps
 * @param {(i: number) => number} x
 * @param {{ top: number, colour: (name: string) => string }} style
 */
function drawStages(canvas, steps, x, { top, colour }) {
  canvas.font = `600 11px ${colour('font')}`;
  canvas.textAlign = 'left';
  canvas.textBaseline = 'middle';
  for (const { stage, from, to } of stretches(steps)) {
    const [left, right] = [x(from), x(Math.min(to + 1, steps.length - 1))];
    canvas.fillStyle = colour(stage);
    canvas.fillRect(left, top, Math.max(right - left - 1, 1), STRIP_PX);
    const { word, sign } = STAGES[stage];
    canvas.fillStyle = colour('card');
    const text = [`${sign} ${word}`, sign].find(
      (each) => canvas.measureText(each).width < right - left - 8,
    );
    if (text) canvas.fillText(text, left + 4, top + STRIP_PX / 2 + 0.5);
  }
}
