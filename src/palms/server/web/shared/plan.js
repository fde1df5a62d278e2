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
 * A room's name, and where there is space for it.
 *
 * @typedef {object} Label
 * @property {string} name
 * @property {Point} at
 * @property {Point[]} polygon_m
 * @property {number} turn_rad of the text on the map; 0 unless the room is long and narrow
 */

/**
 * What is drawn of a plan, made once.
 *
 * @typedef {object} Drawing
 * @property {Path2D} floor
 * @property {Record<string, Path2D>} lines by class
 * @property {Label[]} names
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
const NARROW = 3; // a room as many times as long as wide has its name along it

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
  const names = plan.rooms.filter(({ name }) => name).map(({ name, polygon_m }) => (
    { name, polygon_m, at: middleOf(polygon_m), turn_rad: turnOf(polygon_m) }
  ));
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

/**
 * How a name lies in a room: along it where it is long and narrow, else level.
 *
 * @param {Point[]} polygon
 * @returns {number} radians, so that the text is not upside down
 */
export function turnOf(polygon) {
  const edges = polygon.map(([x, y], i) => {
    const [x1, y1] = polygon[(i + 1) % polygon.length];
    return [x1 - x, y1 - y];
  });
  const [dx, dy] = edges.reduce((a, b) => (Math.hypot(...b) > Math.hypot(...a) ? b : a));
  const length = Math.hypot(dx, dy) || 1;
  const spans = [[dx, dy], [-dy, dx]].map(([ux, uy]) => {
    const along = polygon.map(([x, y]) => (x * ux + y * uy) / length);
    return Math.max(...along) - Math.min(...along);
  });
  if (spans[0] < NARROW * spans[1]) return 0;
  const turn = Math.atan(dy / dx);
  return Number.isNaN(turn) ? 0 : turn;
}

/**
 * Whether a point lies in a polygon.
 *
 * @param {Point[]} polygon
 * @param {Point} point
 */
export function isIn(polygon, [x, y]) {
  return polygon.reduce((isInside, [x0, y0], i) => {
    const [x1, y1] = polygon[(i + 1) % polygon.length];
    const crosses = y0 > y !== y1 > y && x < x0 + ((y - y0) * (x1 - x0)) / (y1 - y0);
    return crosses ? !isInside : isInside;
  }, false);
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
 * Write the names of those rooms that are large enough on the screen for them.
 *
 * @type {typeof drawFloor}
 */
export function drawNames(canvas, drawing, view, { density, colour }) {
  usePixels(canvas, density);
  canvas.font = `${NAME_PX}px ${colour('font') || 'sans-serif'}`;
  canvas.textAlign = 'center';
  canvas.textBaseline = 'middle';
  canvas.fillStyle = colour('room-name');
  for (const label of drawing.names) {
    const shown = [label.name, label.name.replace(/^Room\s+/i, '')].find(
      (text) => hasSpace(label, canvas.measureText(text).width, view.scale),
    );
    if (!shown) continue;
    canvas.save();
    canvas.translate(...toScreen(view, label.at));
    canvas.rotate(-label.turn_rad);
    canvas.fillText(shown, 0, 0);
    canvas.restore();
  }
}

/**
 * Whether a text fits into its room.
 *
 * @param {Label} label
 * @param {number} width_px
 * @param {number} scale pixels per metre
 */
function hasSpace({ at, polygon_m, turn_rad }, width_px, scale) {
  const [c, s] = [Math.cos(turn_rad), Math.sin(turn_rad)];
  const [along, across] = [width_px / 2 / scale, NAME_PX / 2 / scale];
  return [[1, 1], [1, -1], [-1, 1], [-1, -1], [0, 0]].every(([i, j]) => {
    const [dx, dy] = [i * along, j * across];
    return isIn(polygon_m, [at[0] + c * dx - s * dy, at[1] + s * dx + c * dy]);
  });
}
