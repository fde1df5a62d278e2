// Where a browser cannot scan: follow a recording, or let an app push its readings.

import { askJson, ticketFor } from '../shared/rest.js';
import { LiveSocket } from '../shared/socket.js';
import { placeIn } from './rooms.js';
import { element, showProblem } from './screens.js';
import { Sketch } from './sketch.js';

/** @typedef {import('./live.js').Company} Company */

/** @param {Company} company */
export function bindOther(company) {
  element('upload-form').addEventListener('submit', (/** @type {Event} */ event) => {
    event.preventDefault();
    followRecording(company);
  });
  element('push').addEventListener('click', () => openPush(company));
}

/** @param {Company} company */
async function followRecording({ texts, speaker }) {
  const form = new FormData(element('upload-form'));
  const say = (/** @type {string} */ key, values = {}) =>
    speaker.say({ text: texts.of(key, values), asked: true });
  element('speech').hidden = false;
  showProblem('upload-problem');
  say('other.working');
  try {
    const track = await askJson('POST', '/api/v1/tracks', { form });
    const plan = await askJson('GET', `/api/v1/buildings/${form.get('building')}/plan`);
    const found = lastPlace(track);
    if (!found) return say('other.notFound');
    showPlace(plan, found);
    const place = placeIn(plan, [found.x_m, found.y_m]);
    say(place.key, { room: place.room, radius: Math.ceil(found.radius_m) });
  } catch (problem) {
    element('speech').hidden = true;
    showProblem('upload-problem', /** @type {Error} */ (problem).message);
    element('upload-problem').focus();
  }
}

/**
 * Return where a recorded walk ended, and the way to there; null when it was not localized then.
 *
 * @param {any} track `palms-track/1`
 */
export function lastPlace(track) {
  const { stage, x_m, y_m, radius_95_m } = track.trials[0].steps;
  const last = stage.length - 1;
  if (stage[last] !== 'localized') return null;
  const way = stage.flatMap((/** @type {string} */ each, /** @type {number} */ i) =>
    (each === 'localized' ? [[x_m[i], y_m[i]]] : []));
  return { x_m: x_m[last], y_m: y_m[last], radius_m: radius_95_m[last], way };
}

/**
 * @param {import('../shared/plan.js').Plan} plan
 * @param {NonNullable<ReturnType<typeof lastPlace>>} found
 */
function showPlace(plan, found) {
  element('upload-map').hidden = false;
  const sketch = new Sketch(element('upload-map'));
  sketch.setPlan(plan);
  sketch.setSpot(found, found.way);
}

const INERTIAL = { source: 'inertial', frame: 'own', method: 'no-scan' };

/** @type {LiveSocket | null} the session that an app pushes to; it lasts as long as this page */
let pushed = null;

/** @param {Company} company */
function openPush({ texts, speaker }) {
  if (pushed) return;
  const building = element('upload-building').value;
  pushed = new LiveSocket(
    { building, ...INERTIAL, receive: ['events', 'speech'] },
    { ticket: () => ticketFor({ role: 'walker', building }) },
  );
  element('speech').hidden = false;
  pushed.addEventListener('welcome', (event) => {
    const { session } = /** @type {CustomEvent} */ (event).detail;
    element('push-url').textContent = `${location.origin}/api/v1/push/${session}`;
    element('push-header').textContent = `Bearer ${pushed?.key}`;
    element('push-address').hidden = false;
  });
  pushed.addEventListener('say', (event) => speaker.say(/** @type {CustomEvent} */ (event).detail));
  pushed.addEventListener('error', (event) => {
    const { text, fatal } = /** @type {CustomEvent} */ (event).detail;
    speaker.say({ text, asked: true });
    if (fatal) pushed = null;
  });
  pushed.connect();
}
