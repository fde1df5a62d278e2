// The map page: puts its parts together.

import { askJson } from '../shared/rest.js';
import { coloursOf } from '../shared/plan.js';
import { Board } from './board.js';
import { askForPlan, askForToken, shareRecording, showPhone } from './dialogs.js';
import { showRecordings, showSessions } from './lists.js';
import { makeLayers, paintSwatches, showGroups, showKnowledge } from './panel.js';
import { Player } from './player.js';
import { drawn, paintScene } from './scene.js';
import { Sketch } from './sketch.js';
import { Walked, Watched, loadPlan, loadReplay, rememberTruth } from './sources.js';
import { makeTabs } from './tabs.js';
import { makeTheme } from './theme.js';
import { Timeline } from './timeline.js';
import { degrees, eventSentence } from './words.js';

/** @typedef {import('../shared/plan.js').Plan} Plan */
/**
 * @typedef {{ id: string, name: string, is_sample: boolean, levels: { name: string }[] }} Building
 */

const LIST_MS = 3000;
const ZOOM = 1.5;
const BROKEN = 'The connection broke. Trying again…';

/** @param {string} id @returns {any} */
const $ = (id) => document.getElementById(id);

/** @type {Building[]} */ let buildings = [];
/** @type {Plan | null} */ let plan = null;
/** @type {Watched | Walked | null} */ let source = null;
/** @type {string} */ let panel = 'try';

const sketch = new Sketch();
const player = new Player();
const timeline = new Timeline($('curve'), $('scrub'), $('time'));
const board = new Board($('map'), (canvas, view, density) => {
  paintScene(canvas, view, density, moment(), () => board.refresh());
});
const isOn = makeLayers(() => board.refresh());
const showTab = makeTabs($('try').parentElement.querySelector('[role=tablist]'), (id) => {
  panel = id;
  refreshLists();
});
makeTheme($('theme'), refresh);

/** What is to be seen now. @returns {import('./scene.js').Moment} */
function moment() {
  const { story, index, step } = player;
  const maps = story && step ? story.heatmapsAt(step.seq) : [];
  const heatmap = maps.find((map) => String(map.number) === $('heatmap').value);
  return { plan: story?.planAt(step) ?? plan, story, index, heatmap, sketch, isOn };
}

/** Show the moment everywhere. */
function refresh() {
  const { story, step } = player;
  const colour = coloursOf(document.documentElement);
  board.refresh();
  paintSwatches(colour);
  showKnowledge(story, step);
  showGroups(story, step, colour);
  showHeatmapChoice();
  if (story && step) timeline.show(story, player.index, colour);
}

function showHeatmapChoice() {
  const { story, step } = player;
  const drifts = (story && step ? story.heatmapsAt(step.seq) : []).map((map) => map.drift_rad);
  const named = drifts.map((drift, i) => `turned by ${degrees(drift)}${i ? '' : ', best'}`);
  const texts = ['none', ...named];
  const select = $('heatmap');
  select.disabled = drifts.length === 0;
  const shown = [...select.options].map((option) => option.textContent);
  if (shown.join() === texts.join()) return;
  const chosen = select.value;
  select.replaceChildren(...texts.map((text, i) => new Option(text, i ? String(i - 1) : '')));
  select.value = Number(chosen) < drifts.length ? chosen : '';
}

// What is followed

/**
 * Let go of what was followed, and follow something else.
 *
 * @param {Watched | Walked | null} next
 */
function follow(next) {
  source?.close();
  source = next;
  sketch.clear();
  player.attach(next?.story ?? null, next !== null);
  setMode(next ? 'move' : 'draw');
  if (next) listen(next);
  refresh();
}

/** @param {Watched | Walked} from */
function listen(from) {
  const on = (/** @type {string} */ kind, /** @type {(detail: any) => void} */ does) =>
    from.addEventListener(kind, (event) => {
      if (from === source) does(/** @type {CustomEvent} */ (event).detail);
    });
  on('change', () => {
    player.grew();
    showSketch();
  });
  on('problem', note);
  on('plan', () => showWhole(from.story.planAt(undefined)));
  on('recorded', showSketch);
  on('state', (state) => {
    if (state === 'waiting') note(BROKEN);
    else if ($('note').textContent === BROKEN) note('');
  });
  on('finished', () => {
    player.finished();
    showSketch();
    note(from instanceof Walked ? '' : 'The walk has ended.');
  });
}

/** @param {Plan | null} shown */
function showWhole(shown) {
  if (shown) board.show(drawn(shown).bounds_m);
}

player.addEventListener('move', (event) => {
  const { before, isByItself } = /** @type {CustomEvent} */ (event).detail;
  if (isByItself) announce(before);
  refresh();
});

player.addEventListener('state', () => {
  const runs = player.isPlaying || player.isFollowing;
  $('play').textContent = runs ? '❚❚' : '▶';
  $('play').setAttribute('aria-label', runs ? 'Pause' : 'Play');
  $('now').hidden = !player.isGrowing || player.isFollowing;
});

/** Say what happened since a step. @param {number} before index */
function announce(before) {
  const { story, step } = player;
  if (!story || !step) return;
  const from = story.steps[before]?.seq ?? 0;
  const happened = story.events.findLast(({ seq }) => seq > from && seq <= step.seq);
  if (happened) say(eventSentence(happened, step));
}

/** @param {string} text for the live region */
function say(text) {
  $('events').textContent = text;
}

/** @param {string} text one line on the map; empty: none */
function note(text) {
  $('note').textContent = text;
  $('note').hidden = !text;
  if (text) say(text);
}

// Buildings

/** @returns {Building} */
const building = () => buildings.find(({ id }) => id === $('building').value) ?? buildings[0];

/** Ask for the buildings, and show one. @param {string} [wanted] its id */
async function loadBuildings(wanted) {
  buildings = (await askJson('GET', '/api/v1/buildings')).buildings;
  const chosen = wanted ?? $('building').value;
  $('building').replaceChildren(...buildings.map(({ id, name }) => new Option(name, id)));
  $('building').value = (buildings.find(({ id }) => id === chosen) ?? buildings[0])?.id ?? '';
  await showBuilding();
}

async function showBuilding() {
  const { levels } = building();
  $('level').replaceChildren(...levels.map(({ name }) => new Option(`Level ${name}`, name)));
  $('level').hidden = levels.length < 2;
  await showLevel();
}

async function showLevel() {
  const [id, level] = [building().id, $('level').value];
  plan = await loadPlan(id, level);
  follow(null);
  sketch.begin(/** @type {Plan} */ (plan));
  showWhole(plan);
  $('map').setAttribute('aria-label', `Map of ${building().name}, level ${level}`);
}

// A drawn walk

/** What the panel says of the walk. */
function aboutWalk() {
  if (source instanceof Walked) {
    const walked_m = (source.story.steps.at(-1)?.walked_m ?? 0).toFixed(0);
    return source.isOver
      ? `The walk of ${walked_m} m is over. Look at any moment of it below the map.`
      : `A simulated phone walks: ${walked_m} of ${source.length_m.toFixed(0)} m.`;
  }
  return player.story
    ? 'A walk is shown.'
    : 'PALMS gets what a phone would send: one simulated scan, and how the phone moved. '
      + 'It has to find where that was.';
}

/** What the bar below the map says while a walk is drawn. */
function aboutSketch() {
  if (sketch.path.length > 1) return `${sketch.length_m.toFixed(0)} m are drawn.`;
  if (sketch.path.length) return 'The start is set. Draw on.';
  return 'Draw a walk: press in a corridor and drag. Doors let you through.';
}

function showSketch() {
  const { path } = sketch;
  $('try-text').textContent = aboutWalk();
  $('pen-text').textContent = aboutSketch();
  $('pen').hidden = player.story !== null;
  $('timeline').hidden = player.story === null;
  $('another').hidden = player.story === null;
  $('keep').hidden = !(source instanceof Walked && source.recording);
  $('walk').disabled = path.length < 2;
  $('undo').disabled = $('clear').disabled = path.length === 0;
  board.refresh();
}
sketch.addEventListener('change', showSketch);
sketch.addEventListener('blocked', () => say('A wall is in the way.'));

/**
 * Walk a path; without one the server chooses.
 *
 * @param {import('../shared/view.js').Point[]} [path_m]
 */
async function walk(path_m) {
  const [where, level] = [building(), $('level').value];
  note(path_m ? '' : 'Choosing a walk…');
  $('walk').disabled = $('choose').disabled = true;
  try {
    const seed = Math.floor(Math.random() * 2 ** 31);
    const wanted = { building: where.id, level, seed, ...(path_m && { path_m }) };
    const simulation = await askJson('POST', '/api/v1/simulations', { json: wanted });
    const speed = Number($('speed').value);
    const options = { level, speed, seed };
    follow(new Walked(where, /** @type {Plan} */ (plan), simulation, options));
    note(simulation.is_cut ? 'The walk ends where it met a wall.' : '');
    if (document.activeElement === document.body) $('play').focus();
  } finally {
    $('choose').disabled = false;
    $('walk').disabled = sketch.path.length < 2;
  }
}

/** Let go of what is followed, if anything is, and draw. */
async function drawAnew() {
  if (player.story) await showLevel();
  setMode('draw');
  $('map').focus();
}

/** @param {'draw' | 'move'} mode */
function setMode(mode) {
  board.mode = mode;
  for (const each of ['draw', 'move']) {
    $(`mode-${each}`).setAttribute('aria-pressed', String(each === mode));
  }
  $('map').dataset.mode = mode;
  showSketch();
}

board.addEventListener('press', (event) => sketch.press(/** @type {CustomEvent} */ (event).detail));
board.addEventListener('drag', (event) => sketch.drag(/** @type {CustomEvent} */ (event).detail));
board.addEventListener('cancel', () => sketch.cancel());
board.addEventListener('start', () => (player.story ? player.toggle() : sketch.start()));
board.addEventListener('back', () => sketch.undo());
board.addEventListener('escape', () => sketch.clear());
board.addEventListener('enter', () => attempt(() => sketch.path.length > 1 && walk(sketch.path)));
board.addEventListener('step', (event) => {
  const { arrow, isLong } = /** @type {CustomEvent} */ (event).detail;
  sketch.step(arrow, isLong, [board.view.x_m, board.view.y_m]);
});

// Lists and links

async function refreshLists() {
  const nameOf = (/** @type {string} */ id) => buildings.find((each) => each.id === id)?.name ?? id;
  if (panel === 'live') await showSessions(nameOf, (session) => follow(new Watched({ session })));
  if (panel === 'replay') {
    const play = (/** @type {string} */ recording) => attempt(() => replay(recording));
    await showRecordings(nameOf, play, (recording) => attempt(() => shareRecording(recording)));
  }
}

/**
 * @param {string} recording
 * @param {string} [key] of a link
 */
async function replay(recording, key) {
  note('Loading the replay…');
  const story = await loadReplay(recording, key);
  follow(null);
  player.attach(story, false);
  setMode('move');
  showWhole(story.planAt(undefined));
  note('');
  player.toggle();
}

/** Keep the recording of the drawn walk, and make a link to it. */
async function keepWalk() {
  if (!(source instanceof Walked) || !source.recording) return;
  source.isKept = true;
  rememberTruth(source.recording, source.story.truth_m);
  await shareRecording(source.recording);
}

/** Do something that may be refused; what was wrong is said in one line. */
async function attempt(/** @type {() => unknown} */ work) {
  try {
    await work();
  } catch (problem) {
    const refused = /** @type {import('../shared/rest.js').Refusal} */ (problem);
    if (refused.status !== 401 || document.body.dataset.guest !== undefined) {
      return note(refused.message);
    }
    await askForToken();
    await attempt(work);
  }
}

/** @type {Record<string, () => unknown>} */
const CLICKS = {
  walk: () => walk(sketch.path),
  choose: () => walk(),
  undo: () => sketch.undo(),
  clear: () => sketch.clear(),
  keep: keepWalk,
  play: () => player.toggle(),
  now: () => player.toNow(),
  phone: () => showPhone(building().id),
  upload: () => askForPlan(building(), (added) => attempt(() => loadBuildings(added?.id))),
  'mode-move': () => setMode('move'),
  'mode-draw': drawAnew,
  another: drawAnew,
  'zoom-in': () => board.zoom(ZOOM),
  'zoom-out': () => board.zoom(1 / ZOOM),
  'zoom-all': () => board.showAll(),
};
for (const [id, does] of Object.entries(CLICKS)) {
  $(id).addEventListener('click', () => attempt(does));
}
$('building').addEventListener('change', () => attempt(showBuilding));
$('level').addEventListener('change', () => attempt(showLevel));
$('heatmap').addEventListener('change', () => board.refresh());
$('scrub').addEventListener('input', () => player.scrub(Number($('scrub').value)));
$('speed').addEventListener('change', () => {
  player.speed = Number($('speed').value);
  if (source instanceof Walked) source.speed = player.speed;
});
new ResizeObserver(refresh).observe($('curve'));
setInterval(() => panel === 'live' && !document.hidden && attempt(refreshLists), LIST_MS);

/** What the address asks for: a link to a replay or to a live session, or the page whole. */
async function begin() {
  const about = new URLSearchParams(location.hash.slice(1));
  const [recording, key, view] = ['replay', 'key', 'view'].map((name) => about.get(name));
  if (recording || view) document.body.dataset.guest = '';
  if (recording && key) await replay(recording, key);
  else if (view) follow(new Watched({ view }));
  else await loadBuildings();
  document.body.dataset.ready = '';
}
addEventListener('hashchange', () => location.reload());
addEventListener('pagehide', () => source?.close());
showTab('try');
attempt(begin);
