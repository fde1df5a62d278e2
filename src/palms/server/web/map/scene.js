// Scene: the whole map, painted: a plan, what is known at a moment, and a walk that is drawn.

import { coloursOf, drawFloor, drawNames, drawWalls, drawingOf } from '../shared/plan.js';
import { groupOf, labelsIn } from './groups.js';
import {
  drawAnswer, drawCross, drawDiscs, drawHeatmap, drawLine, drawParticles, drawPath, drawScaleBar,
} from './layers.js';
import { tinted } from './tint.js';

/** @typedef {import('../shared/plan.js').Plan} Plan */
/** @typedef {import('../shared/plan.js').Drawing} Drawing */
/** @typedef {import('../shared/frames.js').Heatmap} Heatmap */
/** @typedef {import('./story.js').Story} Story */

/**
 * What is to be seen.
 *
 * @typedef {object} Moment
 * @property {Plan | null} plan
 * @property {Story | null} story
 * @property {number} index
 * @property {Heatmap | undefined} heatmap
 * @property {import('./sketch.js').Sketch} sketch
 * @property {(layer: string) => boolean} isOn
 */

/** @type {WeakMap<Plan, Drawing>} */
const drawings = new WeakMap();
/** @type {WeakMap<Heatmap, { colour: string, done: import('./tint.js').Tinted | null }>} */
const tints = new WeakMap();

/** @param {Plan} plan */
export function drawn(plan) {
  let drawing = drawings.get(plan);
  if (!drawing) {
    drawing = drawingOf(plan);
    drawings.set(plan, drawing);
  }
  return drawing;
}

/**
 * Return a heatmap in the colour of its group; null until that is made, which calls `onDone`.
 *
 * @param {Heatmap} map
 * @param {string} colour
 * @param {() => void} onDone
 */
function tintOf(map, colour, onDone) {
  const known = tints.get(map);
  if (known?.colour === colour) return known.done;
  const entry = { colour, done: /** @type {import('./tint.js').Tinted | null} */ (null) };
  tints.set(map, entry);
  tinted(map, colour).then((done) => {
    entry.done = done;
    onDone();
  });
  return null;
}

/**
 * @param {CanvasRenderingContext2D} canvas
 * @param {import('../shared/view.js').View} view
 * @param {number} density
 * @param {Moment} moment
 * @param {() => void} again paint once more, soon
 */
export function paintScene(canvas, view, density, moment, again) {
  const { plan, story, index, heatmap, sketch, isOn } = moment;
  const style = { density, colour: coloursOf(document.documentElement) };
  if (!plan) return;
  drawFloor(canvas, drawn(plan), view, style);
  if (heatmap) {
    const colour = style.colour(`group-${groupOf(heatmap.label, heatmap.n_labels)}`);
    const tint = tintOf(heatmap, colour, again);
    if (tint) drawHeatmap(canvas, view, tint, style);
  }
  drawWalls(canvas, drawn(plan), view, style);
  if (isOn('names')) drawNames(canvas, drawn(plan), view, style);
  if (story) paintStory(canvas, view, story, index, { style, isOn });
  paintSketch(canvas, view, sketch, style);
  drawScaleBar(canvas, view, style);
}

/**
 * @param {CanvasRenderingContext2D} canvas
 * @param {import('../shared/view.js').View} view
 * @param {Story} story
 * @param {number} index
 * @param {{ style: import('./layers.js').Style, isOn: (layer: string) => boolean }} how
 */
function paintStory(canvas, view, story, index, { style, isOn }) {
  const step = story.steps[index];
  const { density, colour } = style;
  const cloud = step && story.cloudAt(step.seq);
  if (cloud && isOn('particles')) {
    const n_labels = labelsIn(story.heatmapsAt(step.seq), cloud);
    drawParticles(canvas, view, cloud, n_labels, style);
  }
  if (story.truth_m && isOn('truth')) {
    const walked = story.truth_m.slice(0, step?.seq ?? 1);
    const stroke = colour('truth');
    drawLine(canvas, view, story.truth_m, { density, stroke, width: 2, alpha: 0.3 });
    drawLine(canvas, view, walked, { density, stroke, width: 4, alpha: 0.55 });
  }
  if (step && isOn('path')) {
    const plan = story.planAt(step);
    const before = story.steps.slice(0, index + 1).filter((each) => story.planAt(each) === plan);
    drawPath(canvas, view, before, style);
  }
  const truth = story.truthAt(step?.seq ?? 1);
  if (step && isOn('discs')) drawDiscs(canvas, view, step, style);
  if (truth && isOn('truth')) {
    drawCross(canvas, view, truth, { density, stroke: colour('truth'), halo: colour('halo') });
  }
  if (step && isOn('discs')) drawAnswer(canvas, view, step, style);
}

/**
 * @param {CanvasRenderingContext2D} canvas
 * @param {import('../shared/view.js').View} view
 * @param {import('./sketch.js').Sketch} sketch
 * @param {import('./layers.js').Style} style
 */
function paintSketch(canvas, view, { path, cursor }, { density, colour }) {
  const stroke = colour('drawn');
  drawLine(canvas, view, path, { density, stroke, width: 4, alpha: 0.85 });
  const [first, last] = [cursor ?? path[0], path.at(-1)];
  if (first) drawCross(canvas, view, first, { density, stroke, halo: colour('halo') });
  if (last && path.length > 1) {
    drawCross(canvas, view, last, { density, stroke, halo: colour('halo') });
  }
}
