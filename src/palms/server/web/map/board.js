// Board: the canvas of the map. Turns pointers, wheel and keys into a view or into strokes.

import { fitted, panned, toMap, usePixels, zoomed } from '../shared/view.js';

/** @typedef {import('../shared/view.js').View} View */
/** @typedef {import('../shared/view.js').Point} Point */

const ARROWS = /** @type {Record<string, Point>} */ ({
  ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1],
});
const PAN_PX = 60;
const ZOOM = 1.3;
const WHEEL = 0.0015;

/**
 * Says `press`, `drag`, `release` and `cancel` of a stroke, with the place on the map; `step` of
 * an arrow key, `start`, `enter`, `back` and `escape` of other keys. In the mode `move` a stroke
 * moves the map instead, and so do arrow keys.
 */
export class Board extends EventTarget {
  /** @type {'draw' | 'move'} */ mode = 'move';
  /** @type {View} */ view = { x_m: 0, y_m: 0, scale: 10, width: 300, height: 300 };
  density = 1;
  /** @type {[Point, Point] | null} */ #bounds_m = null;
  /** @type {Map<number, Point>} */ #fingers = new Map();
  #isMoved = false;
  #isStroke = false;
  #frame = 0;
  #element;
  #paint;

  /**
   * @param {HTMLCanvasElement} element
   * @param {(canvas: CanvasRenderingContext2D, view: View, density: number) => void} paint
   */
  constructor(element, paint) {
    super();
    this.#element = element;
    this.#paint = paint;
    new ResizeObserver(() => this.#resize()).observe(element);
    element.addEventListener('pointerdown', (event) => this.#down(event));
    element.addEventListener('pointermove', (event) => this.#move(event));
    for (const kind of /** @type {const} */ (['pointerup', 'pointercancel'])) {
      element.addEventListener(kind, (event) => this.#up(event, kind === 'pointercancel'));
    }
    element.addEventListener('wheel', (event) => this.#wheel(event), { passive: false });
    element.addEventListener('keydown', (event) => this.#key(event));
    element.addEventListener('contextmenu', (event) => event.preventDefault());
  }

  /** Show a box whole, now and after changes of size, until the user moves the map. */
  show(/** @type {[Point, Point]} */ bounds_m) {
    this.#bounds_m = bounds_m;
    this.#isMoved = false;
    this.#look(fitted(bounds_m, this.view, Math.min(24, this.view.width / 20)));
  }

  /** Show the same box again. */
  showAll() {
    if (this.#bounds_m) this.show(this.#bounds_m);
  }

  /** @param {number} factor */
  zoom(factor) {
    this.#turnTo(zoomed(this.view, factor));
  }

  /** Paint soon; often asked for, done once a frame. */
  refresh() {
    this.#frame ||= requestAnimationFrame(() => {
      this.#frame = 0;
      const canvas = /** @type {CanvasRenderingContext2D} */ (this.#element.getContext('2d'));
      usePixels(canvas, this.density);
      canvas.clearRect(0, 0, this.view.width, this.view.height);
      this.#paint(canvas, this.view, this.density);
    });
  }

  /** @param {View} view */
  #look(view) {
    this.view = view;
    this.refresh();
  }

  /** @param {View} view that the user chose */
  #turnTo(view) {
    this.#isMoved = true;
    this.#look(view);
  }

  #resize() {
    const { clientWidth: width, clientHeight: height } = this.#element;
    if (!width || !height) return;
    this.density = Math.min(window.devicePixelRatio || 1, 3);
    this.#element.width = Math.round(width * this.density);
    this.#element.height = Math.round(height * this.density);
    this.view = { ...this.view, width, height };
    if (this.#bounds_m && !this.#isMoved) this.show(this.#bounds_m);
    this.refresh();
  }

  /**
   * @param {MouseEvent} event
   * @returns {Point} pixels
   */
  #at(event) {
    const { left, top } = this.#element.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  }

  /**
   * @param {string} kind
   * @param {any} [detail]
   */
  #tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }

  /** @param {PointerEvent} event */
  #down(event) {
    this.#element.setPointerCapture(event.pointerId);
    this.#fingers.set(event.pointerId, this.#at(event));
    if (this.#fingers.size > 1) {
      if (this.#isStroke) this.#tell('cancel');
      this.#isStroke = false;
    } else if (this.mode === 'draw' && event.button === 0) {
      this.#isStroke = true;
      this.#tell('press', toMap(this.view, this.#at(event)));
    }
  }

  /** @param {PointerEvent} event */
  #move(event) {
    const before = this.#fingers.get(event.pointerId);
    if (!before) return;
    const at = this.#at(event);
    const others = [...this.#fingers].filter(([id]) => id !== event.pointerId);
    this.#fingers.set(event.pointerId, at);
    if (this.#isStroke) {
      for (const each of event.getCoalescedEvents?.() ?? [event]) {
        this.#tell('drag', toMap(this.view, this.#at(each)));
      }
    } else if (others.length === 1) {
      this.#pinch(others[0][1], before, at);
    } else if (others.length === 0) {
      this.#turnTo(panned(this.view, [at[0] - before[0], at[1] - before[1]]));
    }
  }

  /**
   * @param {Point} still the finger that stays
   * @param {Point} before
   * @param {Point} at
   */
  #pinch(still, before, at) {
    const apart = (/** @type {Point} */ p) => Math.hypot(p[0] - still[0], p[1] - still[1]);
    const middle = /** @type {Point} */ ([(at[0] + still[0]) / 2, (at[1] + still[1]) / 2]);
    const half = /** @type {Point} */ ([(at[0] - before[0]) / 2, (at[1] - before[1]) / 2]);
    const factor = apart(at) / Math.max(apart(before), 1);
    this.#turnTo(zoomed(panned(this.view, half), factor, middle));
  }

  /**
   * @param {PointerEvent} event
   * @param {boolean} isCancelled
   */
  #up(event, isCancelled) {
    this.#fingers.delete(event.pointerId);
    if (!this.#isStroke) return;
    this.#isStroke = false;
    this.#tell(isCancelled ? 'cancel' : 'release');
  }

  /** @param {WheelEvent} event */
  #wheel(event) {
    event.preventDefault();
    const factor = Math.exp(-event.deltaY * WHEEL * (event.deltaMode === 1 ? 20 : 1));
    this.#turnTo(zoomed(this.view, factor, this.#at(event)));
  }

  /** @param {KeyboardEvent} event */
  #key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrow = ARROWS[event.key];
    /** @type {Record<string, () => void>} */
    const keys = {
      '+': () => this.zoom(ZOOM), '=': () => this.zoom(ZOOM), '-': () => this.zoom(1 / ZOOM),
      0: () => this.showAll(), ' ': () => this.#tell('start'), Enter: () => this.#tell('enter'),
      Backspace: () => this.#tell('back'), Escape: () => this.#tell('escape'),
    };
    if (arrow && this.mode === 'draw') this.#tell('step', { arrow, isLong: event.shiftKey });
    else if (arrow) this.#turnTo(panned(this.view, [-arrow[0] * PAN_PX, arrow[1] * PAN_PX]));
    else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  }
}
