// Panel: what the map shows, in words and numbers; for everybody, and for who cannot see the map.

import { drawCross, mark } from './layers.js';
import { N_GROUPS, SHAPES, driftsOf, grouped, labelsIn } from './groups.js';
import { STAGES, atMost, clock, degrees, percent, placeSentence } from './words.js';

/** @typedef {import('./story.js').Story} Story */
/** @typedef {import('./story.js').Step} Step */

const MOST_PLACES = 4;

/** @param {string} id @returns {any} */
const $ = (id) => document.getElementById(id);

/**
 * Show a step of a story, or that there is none.
 *
 * @param {Story | null} story
 * @param {Step | undefined} step
 */
export function showKnowledge(story, step) {
  $('figures').hidden = !step;
  const stage = step?.stage;
  $('stage').dataset.stage = stage ?? 'none';
  $('stage').textContent = stage ? `${STAGES[stage].sign} ${STAGES[stage].word}` : 'Nothing yet';
  $('place').textContent = step ? placeSentence(step) : 'Nobody is followed.';
  $('means').textContent = stage ? STAGES[stage].means : 'Draw a walk, or watch one.';
  if (!story || !step) return;
  for (const [id, p] of [['p1', step.p_within_1m], ['p2', step.p_within_2m]]) {
    $(`${id}`).value = p ?? 0;
    $(`${id}-text`).textContent = p == null ? 'not known' : percent(/** @type {number} */ (p));
  }
  showFacts(story, step);
  showPlaces(step);
}

/**
 * @param {Story} story
 * @param {Step} step
 */
function showFacts(story, step) {
  const truth = story.truthAt(step.seq);
  /** @type {[string, string][]} */
  const facts = [['Walked', `${(step.walked_m ?? 0).toFixed(0)} m in ${clock(story.since(step))}`]];
  if (step.radius_68_m && step.radius_95_m) {
    facts.push(['68 % disc', atMost(step.radius_68_m)], ['95 % disc', atMost(step.radius_95_m)]);
  }
  if (step.heading_rad != null) facts.push(['Heading', degrees(step.heading_rad)]);
  if (truth && step.x_m !== null && step.y_m !== null) {
    const error_m = Math.hypot(step.x_m - truth[0], step.y_m - truth[1]);
    facts.push(['Truly off by', `${error_m.toFixed(1)} m`]);
  }
  const pairs = facts.map(([name, value]) => [made('dt', name), made('dd', value)]);
  $('facts').replaceChildren(...pairs.flat());
}

/** @param {Step} step */
function showPlaces(step) {
  const places = (step.hypotheses ?? []).slice(0, MOST_PLACES);
  $('others-title').hidden = $('others').hidden = places.length === 0;
  $('others').replaceChildren(...places.map(({ room, p }) => {
    const item = made('li', room ?? 'outside of rooms');
    item.append(made('span', percent(p)));
    return item;
  }));
}

/**
 * @param {string} kind
 * @param {string} text
 */
export function made(kind, text) {
  return Object.assign(document.createElement(kind), { textContent: text });
}

/**
 * What can be on the map: a switch for each, with its mark.
 *
 * @type {{ id: string, name: string, draw: (canvas: CanvasRenderingContext2D,
 *   colour: (name: string) => string) => void }[]}
 */
const LAYERS = [
  { id: 'particles', name: 'Particles', draw: drawGroups },
  { id: 'discs', name: 'Answer, 68 % and 95 % discs', draw: drawDisc },
  { id: 'path', name: 'Path of the answers', draw: drawStroke },
  { id: 'truth', name: 'Truth, where known', draw: drawTruth },
  { id: 'names', name: 'Names of rooms', draw: drawLetter },
];

/**
 * Make the switches; all are on.
 *
 * @param {() => void} onChange
 * @returns {(id: string) => boolean} whether a layer is on
 */
export function makeLayers(onChange) {
  $('layers').replaceChildren(...LAYERS.map(({ id, name }) => {
    const label = document.createElement('label');
    const box = Object.assign(document.createElement('input'), {
      type: 'checkbox', id: `layer-${id}`, checked: true, onchange: onChange,
    });
    const swatch = Object.assign(document.createElement('canvas'), { className: 'swatch' });
    swatch.setAttribute('aria-hidden', 'true');
    label.append(box, swatch, name);
    const item = document.createElement('li');
    item.append(label);
    if (id === 'particles') item.append(Object.assign(made('ul', ''), { id: 'groups' }));
    return item;
  }));
  return (id) => $(`layer-${id}`).checked;
}

/** Draw the marks of the switches. @param {(name: string) => string} colour */
export function paintSwatches(colour) {
  document.querySelectorAll('#layers > li > label > .swatch').forEach((element, i) => {
    LAYERS[i].draw(swatchOf(/** @type {HTMLCanvasElement} */ (element)), colour);
  });
}

/** @param {HTMLCanvasElement} element */
function swatchOf(element) {
  const density = Math.min(window.devicePixelRatio || 1, 3);
  Object.assign(element, { width: 28 * density, height: 18 * density });
  const canvas = /** @type {CanvasRenderingContext2D} */ (element.getContext('2d'));
  canvas.setTransform(density, 0, 0, density, 0, 0);
  return canvas;
}

/**
 * Say which groups of particles there are, and their shares.
 *
 * @param {Story | null} story
 * @param {Step | undefined} step
 * @param {(name: string) => string} colour
 */
export function showGroups(story, step, colour) {
  const maps = story && step ? story.heatmapsAt(step.seq) : [];
  const cloud = story && step ? story.cloudAt(step.seq) : null;
  const drifts = driftsOf(maps);
  const groups = cloud ? grouped(cloud, labelsIn(maps, cloud)) : [];
  const total = cloud?.label.length ?? 1;
  $('groups').replaceChildren(...groups.flatMap((members, k) => {
    if (members.length === 0) return [];
    const turned = drifts.length ? `turned by about ${degrees(drifts[k])}` : `turn ${k + 1}`;
    const item = made('li', `${turned}: ${percent(members.length / total)}`);
    const swatch = Object.assign(document.createElement('canvas'), { className: 'swatch' });
    swatch.setAttribute('aria-hidden', 'true');
    item.prepend(swatch);
    drawMark(swatchOf(swatch), k, 14, 4.5, colour);
    return [item];
  }));
}

/**
 * @param {CanvasRenderingContext2D} canvas
 * @param {number} k
 * @param {number} x
 * @param {number} r
 * @param {(name: string) => string} colour
 */
function drawMark(canvas, k, x, r, colour) {
  canvas.beginPath();
  mark(canvas, SHAPES[k], x, 9, r);
  canvas.fillStyle = colour(`group-${k}`);
  canvas.fill();
}

/** @type {typeof LAYERS[number]['draw']} */
function drawGroups(canvas, colour) {
  for (let k = 0; k < N_GROUPS; k++) drawMark(canvas, k, 4 + 6.8 * k, 2.8, colour);
}

/** @type {typeof LAYERS[number]['draw']} */
function drawDisc(canvas, colour) {
  canvas.strokeStyle = canvas.fillStyle = colour('answer');
  for (const [r, alpha] of [[8, 0.15], [5, 0.2], [2.6, 1]]) {
    canvas.beginPath();
    canvas.arc(14, 9, r, 0, 2 * Math.PI);
    canvas.globalAlpha = alpha;
    canvas.fill();
    canvas.globalAlpha = 1;
    canvas.stroke();
  }
}

/** @type {typeof LAYERS[number]['draw']} */
function drawStroke(canvas, colour) {
  canvas.beginPath();
  canvas.moveTo(3, 12);
  canvas.lineTo(11, 6);
  canvas.lineTo(25, 10);
  canvas.strokeStyle = colour('answer');
  canvas.lineWidth = 2;
  canvas.stroke();
}

/** @type {typeof LAYERS[number]['draw']} */
function drawTruth(canvas, colour) {
  const view = { x_m: 0, y_m: 0, scale: 1, width: 28, height: 18 };
  const density = canvas.getTransform().a;
  drawCross(canvas, view, [0, 0], { density, stroke: colour('truth'), halo: colour('halo') });
}

/** @type {typeof LAYERS[number]['draw']} */
function drawLetter(canvas, colour) {
  canvas.font = `12px ${colour('font')}`;
  canvas.textAlign = 'center';
  canvas.textBaseline = 'middle';
  canvas.fillStyle = colour('room-name');
  canvas.fillText('215', 14, 9);
}
