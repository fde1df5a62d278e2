// Sketch: a walk that is being drawn, by strokes or by keys.

import { extended, isOpen, lengthOf, undone, wallsOf } from './pen.js';

/** @typedef {import('../shared/view.js').Point} Point */

const CURSOR_M = 1; // the cross moves by so much before a walk begins
const STEP_M = 0.65; // as people step
const LONG = 5;

/** Says `change`, and `blocked` when a wall is in the way. */
export class Sketch extends EventTarget {
  /** @type {Point[]} */ path = [];
  /** @type {Point | null} */ cursor = null;
  /** @type {number[]} */ #strokes = [];
  /** @type {[Point, Point][]} */ #walls = [];
  #isBlocked = false;

  /** @param {import('../shared/plan.js').Plan} plan */
  begin(plan) {
    this.#walls = wallsOf(plan);
    this.clear();
  }

  get length_m() {
    return lengthOf(this.path);
  }

  clear() {
    this.path = [];
    this.cursor = null;
    this.#strokes = [];
    this.#change();
  }

  /** Take the last stroke back. */
  undo() {
    this.path = undone(this.path, this.#strokes);
    this.#strokes.pop();
    this.#change();
  }

  /** A stroke begins: where the walk starts, or straight on from its end. @param {Point} at */
  press(at) {
    this.cursor = null;
    this.#strokes.push(this.path.length);
    this.#isBlocked = false;
    this.drag(at);
  }

  /** @param {Point} at */
  drag(at) {
    const longer = extended(this.path, at, this.#walls);
    if (!longer && !this.#isBlocked) this.dispatchEvent(new Event('blocked'));
    this.#isBlocked = !longer;
    if (!longer || longer === this.path) return;
    this.path = longer;
    this.#change();
  }

  /** A stroke turned out to be none. */
  cancel() {
    this.undo();
  }

  /**
   * An arrow key: the cross moves, or the walk goes on.
   *
   * @param {Point} arrow
   * @param {boolean} isLong
   * @param {Point} middle of the screen, where the cross appears first
   */
  step([dx, dy], isLong, middle) {
    const last = this.path.at(-1);
    const by = (last ? STEP_M : CURSOR_M) * (isLong ? LONG : 1);
    const from = last ?? this.cursor ?? middle;
    const to = /** @type {Point} */ ([from[0] + dx * by, from[1] + dy * by]);
    if (!last) this.cursor = to;
    else if (isOpen(last, to, this.#walls)) {
      this.#strokes.push(this.path.length);
      this.path = [...this.path, to];
    } else this.dispatchEvent(new Event('blocked'));
    this.#change();
  }

  /** The walk starts at the cross. */
  start() {
    if (this.path.length > 0 || !this.cursor) return;
    this.#strokes.push(0);
    this.path = [this.cursor];
    this.cursor = null;
    this.#change();
  }

  #change() {
    this.dispatchEvent(new Event('change'));
  }
}
