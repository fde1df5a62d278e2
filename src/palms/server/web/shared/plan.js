// Floor plans on a canvas: rooms, walls, doors, glass, names.

import { toScreen, useMetres, usePixels } from './view.js';

/** @typedef {import('./view.js').View} View */
/** @typedef {import('./view.js').Point} Point */

/**
 * A level as the server gives it, `palms-plan/1`.
 *
 * @typedef {object} Plan
 * @property {string} name
 * @property {string | null} level
 * @property {[Point, Point][]} segments_m
 * @property {('wall' | 'door' | 'opening' | 'glass')[]} classes
 * @property {{ name: string, polygon_m: Point[] }[]} rooms
 * @property {Point[] | null} outline_m
 */

/**
 * What is drawn of a plan, made once.
 *
 * @typedef {object} Drawing
 * @property {Path2D} floor
 * @property {Record<string, Path2D>} lines by class
 * @property {{ name: string, at: Point, width_m: number }[]} names
 * @property {[Point, Point]} bounds_m
 */

/** Widths of lines in metres, and at least in pixels. */
const STROKES = {
  opening: { width_m: 0.04, least_px: 0.8, dash: [0.25, 0.25] },
  door: { width_m: 0.07, least_px: 1, dash: [] },
  glass: { width_m: 0.1, least_px: 1.2, dash: [] },
  wall: { width_m: 0.14, least_px: 1.4, dash: [] },
};
const NAME_PX = 12;

/**
 * Return the corners of the box around a plan.
 *
 * @param {Plan} plan
 * @returns {[Point, Point]}
 */
export function boundsOf({ segments_m }) {
  const low = [Infinity, Infinity];
  const high = [-Infinity, -Infinity];
  for (const [x, y] of segments_m.flat()) {
    [low[0], low[1]] = [Math.min(low[0], x), Math.min(low[1], y)];
    [high[0], high[1]] = [Math.max(high[0], x), Math.max(high[1], y)];
  }
  return [/** @type {Point} */ (low), /** @type {Point} */ (high)];
}

/**
 * Return the middle of a polygon, weighted by area; of its corners when it has no area.
 *
 * @param {Point[]} polygon not closed
 * @returns {Point}
 */
export function middleOf(polygon) {
  let [area, x, y] = [0, 0, 0];
  polygon.forEach(([x0, y0], i) => {
    const [x1, y1] = polygon[(i + 1) % polygon.length];
    const cross = x0 * y1 - x1 * y0;
    area += cross;
    x += (x0 + x1) * cross;
    y += (y0 + y1) * cross;
  });
  if (Math.abs(area) > 1e-9) return [x / (3 * area), y / (3 * area)];
  const sum = polygon.reduce(([a, b], [c, d]) => [a + c, b + d], [0, 0]);
  return [sum[0] / polygon.length, sum[1] / polygon.length];
}

/**
 * @param {Plan} plan
 * @returns {Drawing}
 */
export function drawingOf(plan) {
  /** @type {Record<string, Path2D>} */
  const lines = {};
  for (const kind of Object.keys(STROKES)) lines[kind] = new Path2D();
  plan.segments_m.forEach(([[x0, y0], [x1, y1]], i) => {
    const path = lines[plan.classes[i]] ?? lines.wall;
    path.moveTo(x0, y0);
    path.lineTo(x1, y1);
  });
  const floor = new Path2D();
  for (const ring of plan.outline_m ? [plan.outline_m] : plan.rooms.map((room) => room.polygon_m)) {
    addRing(floor, ring);
  }
  const names = plan.rooms.filter((room) => room.name).map((room) => ({
    name: room.name,
    at: middleOf(room.polygon_m),
    width_m: extentOf(room.polygon_m),
  }));
  return { floor, lines, names, bounds_m: boundsOf(plan) };
}

/**
 * @param {Path2D} path
 * @param {Point[]} ring
 */
function addRing(path, ring) {
  ring.forEach(([x, y], i) => (i ? path.lineTo(x, y) : path.moveTo(x, y)));
  path.closePath();
}

/** @param {Point[]} polygon */
function extentOf(polygon) {
  const xs = polygon.map(([x]) => x);
  return Math.max(...xs) - Math.min(...xs);
}

/**
 * Colours of a page, as its style sheet has them in custom properties (`--wall`, `--floor`, ...).
 *
 * @param {Element} element
 * @returns {(name: string) => string}
 */
export function coloursOf(element) {
  const style = getComputedStyle(element);
  /** @type {Map<string, string>} */
  const known = new Map();
  return (name) => {
    let colour = known.get(name);
    if (colour === undefined) {
      colour = style.getPropertyValue(`--${name}`).trim();
      known.set(name, colour);
    }
    return colour;
  };
}

/**
 * Draw the floor of a plan; what lies on it comes next, then `drawWalls`.
 *
 * @param {CanvasRenderingContext2D} canvas
 * @param {Drawing} drawing
 * @param {View} view
 * @param {{ density: number, colour: (name: string) => string }} style
 */
export function drawFloor(canvas, drawing, view, { density, colour }) {
  useMetres(canvas, view, density);
  canvas.fillStyle = colour('floor');
  canvas.fill(drawing.floor);
}

/**
 * Draw the walls, doors, openings and glass of a plan.
 *
 * @type {typeof drawFloor}
 */
export function drawWalls(canvas, drawing, view, { density, colour }) {
  useMetres(canvas, view, density);
  canvas.lineCap = 'round';
  for (const [kind, { width_m, least_px, dash }] of Object.entries(STROKES)) {
    canvas.lineWidth = Math.max(width_m, least_px / view.scale);
    canvas.setLineDash(dash);
    canvas.strokeStyle = colour(kind);
    canvas.stroke(drawing.lines[kind]);
  }
  canvas.setLineDash([]);
}

/**
 * Write the names of those rooms that are wide enough on the screen for them.
 *
 * @type {typeof drawFloor}
 */
export function drawNames(canvas, drawing, view, { density, colour }) {
  usePixels(canvas, density);
  canvas.font = `${NAME_PX}px ${colour('font') || 'sans-serif'}`;
  canvas.textAlign = 'center';
  canvas.textBaseline = 'middle';
  canvas.fillStyle = colour('room-name');
  for (const { name, at, width_m } of drawing.names) {
    const room_px = width_m * view.scale - 6;
    const shown = [name, name.replace(/^Room\s+/i, '')].find(
      (text) => canvas.measureText(text).width <= room_px,
    );
    if (shown) canvas.fillText(shown, ...toScreen(view, at));
  }
}
