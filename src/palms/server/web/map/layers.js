// Layers: what lies on the floor plan. Each draws one thing in pixels, and knows nothing of pages.

import { toScreen, usePixels } from '../shared/view.js';
import { SHAPES, grouped } from './groups.js';

/** @typedef {import('../shared/view.js').View} View */
/** @typedef {import('../shared/view.js').Point} Point */
/** @typedef {import('./story.js').Step} Step */
/** @typedef {CanvasRenderingContext2D} Canvas */
/** @typedef {{ density: number, colour: (name: string) => string }} Style */

const CROSS_PX = 8; // so that its arms stand out behind an answer
const PARTICLE_PX = 2.1;
const LONGEST_MOVE_M = 3; // of an answer; it jumped if it is farther
const TAU = 2 * Math.PI;
/** How strokes of the path tell the stage; as in the figures. */
const STAGE_DASHES = { searching: [1, 5], oriented: [7, 5], localized: [], lost: [9, 4, 2, 4] };

/**
 * Draw a heatmap that was tinted before.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {{ image: CanvasImageSource, width: number, height: number, origin_m: Point,
 *   cell_size_m: number }} tinted
 * @param {Style} style
 */
export function drawHeatmap(canvas, view, tinted, { density }) {
  usePixels(canvas, density);
  const { image, width, height, origin_m, cell_size_m } = tinted;
  const [left, top] = toScreen(view, [origin_m[0], origin_m[1] + height * cell_size_m]);
  const pixel = cell_size_m * view.scale;
  canvas.imageSmoothingEnabled = pixel < 3;
  canvas.drawImage(image, left, top, width * pixel, height * pixel);
}

/**
 * Draw particles in the colours and shapes of their groups, the rarest on top.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {import('../shared/frames.js').Particles} cloud
 * @param {number} n_labels
 * @param {Style} style
 */
export function drawParticles(canvas, view, cloud, n_labels, { density, colour }) {
  usePixels(canvas, density);
  const groups = grouped(cloud, n_labels).map((members, k) => ({ members, k }));
  const size = PARTICLE_PX * Math.min(1.6, Math.max(0.8, view.scale / 12));
  canvas.globalAlpha = 0.8;
  for (const { members, k } of groups.sort((a, b) => b.members.length - a.members.length)) {
    canvas.beginPath();
    for (const i of members) {
      const [x, y] = toScreen(view, [cloud.x_m[i], cloud.y_m[i]]);
      mark(canvas, SHAPES[k], x, y, size);
    }
    canvas.fillStyle = colour(`group-${k}`);
    canvas.fill();
  }
  canvas.globalAlpha = 1;
}

/**
 * Add a small shape to the path of a canvas.
 *
 * @param {Canvas} canvas
 * @param {string} shape
 * @param {number} x
 * @param {number} y
 * @param {number} r half its size
 */
export function mark(canvas, shape, x, y, r) {
  if (shape === 'circle') {
    canvas.moveTo(x + r, y);
    canvas.arc(x, y, r, 0, TAU);
  } else if (shape === 'square') {
    canvas.rect(x - 0.9 * r, y - 0.9 * r, 1.8 * r, 1.8 * r);
  } else {
    const corners = shape === 'triangle'
      ? [[0, -1.25], [1.1, 0.8], [-1.1, 0.8]]
      : [[0, -1.3], [1.3, 0], [0, 1.3], [-1.3, 0]];
    corners.forEach(([dx, dy], i) => canvas[i ? 'lineTo' : 'moveTo'](x + r * dx, y + r * dy));
    canvas.closePath();
  }
}

/**
 * @param {Step | undefined} step
 * @returns {Point | null}
 */
function placeOf(step) {
  return step == null || step.x_m === null || step.y_m === null ? null : [step.x_m, step.y_m];
}

/**
 * Draw the way of the answers so far: each stage in its own stroke, gaps where it jumped.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {Step[]} steps
 * @param {Style} style
 */
export function drawPath(canvas, view, steps, { density, colour }) {
  usePixels(canvas, density);
  canvas.strokeStyle = colour('answer');
  canvas.lineJoin = 'round';
  canvas.lineCap = 'round';
  canvas.lineWidth = 2;
  for (const stage of /** @type {Step['stage'][]} */ (Object.keys(STAGE_DASHES))) {
    canvas.beginPath();
    steps.forEach((step, i) => {
      const [from, to] = [placeOf(steps[i - 1]), placeOf(step)];
      if (!from || !to || step.stage !== stage) return;
      if (Math.hypot(to[0] - from[0], to[1] - from[1]) > LONGEST_MOVE_M) return;
      canvas.moveTo(...toScreen(view, from));
      canvas.lineTo(...toScreen(view, to));
    });
    canvas.globalAlpha = stage === 'localized' ? 0.9 : 0.45;
    canvas.setLineDash(STAGE_DASHES[stage]);
    canvas.stroke();
  }
  canvas.setLineDash([]);
  canvas.globalAlpha = 1;
}

/**
 * Draw a line of points, such as the true way or one that is being drawn.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {Point[]} points
 * @param {{ density: number, stroke: string, width: number, alpha?: number }} style
 */
export function drawLine(canvas, view, points, { density, stroke, width, alpha = 1 }) {
  usePixels(canvas, density);
  canvas.beginPath();
  points.forEach((point, i) => canvas[i ? 'lineTo' : 'moveTo'](...toScreen(view, point)));
  canvas.globalAlpha = alpha;
  canvas.strokeStyle = stroke;
  canvas.lineWidth = width;
  canvas.lineJoin = 'round';
  canvas.lineCap = 'round';
  canvas.stroke();
  canvas.globalAlpha = 1;
}

/**
 * Draw the discs that hold 68 % and 95 % of the belief; filled once it is localized.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {Step} step
 * @param {Style} style
 */
export function drawDiscs(canvas, view, step, { density, colour }) {
  if (step.x_m === null || step.y_m === null) return;
  usePixels(canvas, density);
  const [x, y] = toScreen(view, [step.x_m, step.y_m]);
  canvas.fillStyle = colour('answer');
  canvas.strokeStyle = colour('answer');
  canvas.lineWidth = 1.5;
  for (const [radius_m, dash] of [[step.radius_95_m, [5, 4]], [step.radius_68_m, []]]) {
    if (!radius_m) continue;
    canvas.beginPath();
    canvas.arc(x, y, /** @type {number} */ (radius_m) * view.scale, 0, TAU);
    canvas.globalAlpha = 0.12;
    if (step.stage === 'localized') canvas.fill();
    canvas.globalAlpha = step.stage === 'localized' ? 0.9 : 0.5;
    canvas.setLineDash(/** @type {number[]} */ (dash));
    canvas.stroke();
  }
  canvas.setLineDash([]);
  canvas.globalAlpha = 1;
}

/**
 * Draw the answer: a dot with a halo, hollow until it is localized, and where it is heading.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {Step} step
 * @param {Style} style
 */
export function drawAnswer(canvas, view, step, { density, colour }) {
  if (step.x_m === null || step.y_m === null) return;
  usePixels(canvas, density);
  const [x, y] = toScreen(view, [step.x_m, step.y_m]);
  if (step.heading_rad != null && step.stage === 'localized') {
    drawArrow(canvas, x, y, step.heading_rad, colour);
  }
  canvas.beginPath();
  canvas.arc(x, y, 6.5, 0, TAU);
  canvas.fillStyle = step.stage === 'localized' ? colour('answer') : colour('halo');
  canvas.fill();
  canvas.lineWidth = 2.5;
  canvas.strokeStyle = step.stage === 'localized' ? colour('halo') : colour('answer');
  canvas.stroke();
}

/**
 * @param {Canvas} canvas
 * @param {number} x
 * @param {number} y
 * @param {number} heading_rad of the map
 * @param {(name: string) => string} colour
 */
function drawArrow(canvas, x, y, heading_rad, colour) {
  canvas.save();
  canvas.translate(x, y);
  canvas.rotate(-heading_rad);
  canvas.beginPath();
  for (const [px, py] of [[23, 0], [8, 8], [11, 0], [8, -8]]) canvas.lineTo(px, py);
  canvas.closePath();
  canvas.fillStyle = colour('answer');
  canvas.strokeStyle = colour('halo');
  canvas.lineWidth = 2;
  canvas.stroke();
  canvas.fill();
  canvas.restore();
}

/**
 * Mark a place with a cross that has a halo.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {Point} place_m
 * @param {{ density: number, stroke: string, halo: string }} style
 */
export function drawCross(canvas, view, place_m, { density, stroke, halo }) {
  usePixels(canvas, density);
  const [x, y] = toScreen(view, place_m);
  for (const [width, ink] of /** @type {[number, string][]} */ ([[6, halo], [2.8, stroke]])) {
    canvas.beginPath();
    canvas.moveTo(x - CROSS_PX, y - CROSS_PX);
    canvas.lineTo(x + CROSS_PX, y + CROSS_PX);
    canvas.moveTo(x - CROSS_PX, y + CROSS_PX);
    canvas.lineTo(x + CROSS_PX, y - CROSS_PX);
    canvas.lineWidth = width;
    canvas.strokeStyle = ink;
    canvas.stroke();
  }
}

/**
 * Draw a bar of a round length into the lower left corner.
 *
 * @param {Canvas} canvas
 * @param {View} view
 * @param {Style} style
 */
export function drawScaleBar(canvas, view, { density, colour }) {
  usePixels(canvas, density);
  const metres = [0.5, 1, 2, 5, 10, 20, 50, 100, 200].findLast(
    (each) => each * view.scale <= Math.min(140, view.width / 3),
  ) ?? 0.5;
  const [x, y] = [14, view.height - 14];
  canvas.strokeStyle = colour('muted');
  canvas.fillStyle = colour('muted');
  canvas.lineWidth = 1.5;
  canvas.beginPath();
  canvas.moveTo(x, y - 5);
  canvas.lineTo(x, y);
  canvas.lineTo(x + metres * view.scale, y);
  canvas.lineTo(x + metres * view.scale, y - 5);
  canvas.stroke();
  canvas.font = `12px ${colour('font')}`;
  canvas.textAlign = 'left';
  canvas.textBaseline = 'alphabetic';
  canvas.fillText(`${metres} m`, x + 4, y - 8);
}
