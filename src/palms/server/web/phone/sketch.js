// A small map for sighted helpers: the plan, and the place that was told. Nothing depends on it.

import { coloursOf, drawFloor, drawNames, drawWalls, drawingOf } from '../shared/plan.js';
import { fitted, toScreen } from '../shared/view.js';

/**
 * @typedef {import('../shared/plan.js').Plan} Plan
 * @typedef {import('../shared/view.js').Point} Point
 *
 * @typedef {object} Spot
 * @property {number} x_m map frame
 * @property {number} y_m
 * @property {number} radius_m so near to it, with a probability of 95 %
 * @property {number | null} [facing_rad]
 */

const AROUND_M = 14; // so far around a place the map shows
const DOT_PX = 7;

export class Sketch {
  /** @type {import('../shared/plan.js').Drawing | null} */ #drawing = null;
  /** @type {Spot | null} */ #spot = null;
  /** @type {Point[]} */ #way = [];

  /** @param {HTMLCanvasElement} canvas */
  constructor(canvas) {
    this.canvas = canvas;
    new ResizeObserver(() => this.draw()).observe(canvas);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
  }

  /** @param {Plan} plan */
  setPlan(plan) {
    this.#drawing = drawingOf(plan);
    this.draw();
  }

  /**
   * @param {Spot | null} spot null while no place may be told
   * @param {Point[]} [way] that led there
   */
  setSpot(spot, way = []) {
    [this.#spot, this.#way] = [spot, way];
    this.draw();
  }

  draw() {
    const context = this.canvas.getContext('2d');
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!context || !this.#drawing || width === 0) return;
    const density = devicePixelRatio;
    [this.canvas.width, this.canvas.height] = [width * density, height * density];
    const view = fitted(this.#bounds(), { width, height }, 8);
    const style = { density, colour: coloursOf(this.canvas) };
    context.fillStyle = style.colour('outside');
    context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    for (const part of [drawFloor, drawWalls, drawNames]) part(context, this.#drawing, view, style);
    if (this.#spot) drawSpot(context, this.#spot, this.#way, view, style.colour);
  }

  /** @returns {[Point, Point]} */
  #bounds() {
    const spot = this.#spot;
    if (!spot) return /** @type {import('../shared/plan.js').Drawing} */ (this.#drawing).bounds_m;
    const reach = Math.max(AROUND_M, 1.5 * spot.radius_m);
    return [[spot.x_m - reach, spot.y_m - reach], [spot.x_m + reach, spot.y_m + reach]];
  }
}

/**
 * Draw a place, in pixels: its disc, a dot, where it faces, and the way that led there.
 *
 * @param {CanvasRenderingContext2D} context
 * @param {Spot} spot
 * @param {Point[]} way
 * @param {import('../shared/view.js').View} view
 * @param {(name: string) => string} colour
 */
function drawSpot(context, { x_m, y_m, radius_m, facing_rad }, way, view, colour) {
  const [x, y] = toScreen(view, [x_m, y_m]);
  context.strokeStyle = colour('drawn');
  context.lineWidth = 2;
  context.beginPath();
  for (const place of way) context.lineTo(...toScreen(view, place));
  context.stroke();
  context.fillStyle = context.strokeStyle = colour('answer');
  context.globalAlpha = 0.18;
  disc(context, x, y, radius_m * view.scale);
  context.globalAlpha = 1;
  disc(context, x, y, DOT_PX);
  if (typeof facing_rad !== 'number') return;
  context.lineWidth = 4;
  context.beginPath();
  context.moveTo(x, y);
  context.lineTo(x + 3 * DOT_PX * Math.cos(facing_rad), y - 3 * DOT_PX * Math.sin(facing_rad));
  context.stroke();
}

/**
 * @param {CanvasRenderingContext2D} context
 * @param {number} x pixels
 * @param {number} y
 * @param {number} radius
 */
function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
