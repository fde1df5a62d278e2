// Where a browser cannot scan: follow a recording, or let an app push its readings.

import { askJson } from '../shared/rest.js';
import { LiveSocket } from '../shared/socket.js';
import { Live } from './live.js';
import { placeIn } from './rooms.js';
import { element, showProblem } from './screens.js';
import { Sketch } from './sketch.js';

/**
 * @typedef {import('./live.js').Company} Company
 * @typedef {import('./choose.js').Entrance} Entrance
 *
 * @typedef {object} Pass what lets files be read
 * @property {string} building
 * @property {string | null} level
 * @property {string} [session] that the ticket has opened
 * @property {string} [key] its key
 */

const PUSHED = { source: 'inertial', frame: 'own' };

/**
 * @param {Company} company
 * @param {Entrance} entrance
 * @param {(live: Live) => void} begun is told of the session that an app pushes to
 */
export function bindOther(company, entrance, begun) {
  const counter = new Counter(entrance);
  bindForm(company, 'upload', (form) => followRecording(company, counter, form));
  bindForm(company, 'push', async (form) => begun(await openPushed(company, counter, form)));
}

/**
 * Let a form do something; what goes wrong is said below it.
 *
 * @param {Company} company
 * @param {string} name
 * @param {(form: FormData) => Promise<void>} does
 */
function bindForm(company, name, does) {
  const form = element(`${name}-form`);
  form.addEventListener('submit', async (/** @type {Event} */ event) => {
    event.preventDefault();
    showProblem(`${name}-problem`);
    try {
      await does(new FormData(form));
    } catch (problem) {
      company.speaker.clear();
      showProblem(`${name}-problem`, /** @type {Error} */ (problem).message);
    }
  });
}

/** Where one shows a ticket, or the token, and gets a pass. */
class Counter {
  /** @type {Promise<Pass> | null} */ #pass = null;

  /** @param {Entrance} entrance */
  constructor(entrance) {
    this.entrance = entrance;
  }

  /** @returns {Promise<Pass>} */
  async pass() {
    const { ticket, terms } = this.entrance;
    if (!ticket && !this.#pass) return /** @type {Pass} */ (terms);
    this.#pass ??= redeemed(/** @type {string} */ (ticket));
    this.#pass.catch(() => {
      this.#pass = null;
    });
    return this.#pass;
  }
}

/**
 * Open a session with a ticket; its key lets files be read, and an app may push to it.
 *
 * @param {string} ticket
 * @returns {Promise<Pass>}
 */
function redeemed(ticket) {
  return new Promise((resolve, reject) => {
    const socket = new LiveSocket({ ...PUSHED, receive: [] }, { ticket: async () => ticket });
    socket.addEventListener('welcome', (event) => {
      const { session, building, level } = /** @type {CustomEvent} */ (event).detail;
      socket.close();
      resolve({ building: building.id, level, session, key: socket.key ?? undefined });
    });
    socket.addEventListener('error', (event) => {
      socket.close();
      reject(new Error(/** @type {CustomEvent} */ (event).detail.text));
    });
    socket.connect();
  });
}

/**
 * @param {Company} company
 * @param {Counter} counter
 * @param {FormData} form
 */
async function followRecording({ texts, speaker }, counter, form) {
  const say = (/** @type {string} */ key, values = {}) =>
    speaker.say({ text: texts.of(key, values), asked: true });
  say('other.working');
  const { building, level, key } = await counter.pass();
  form.set('building', building);
  if (level) form.set('level', level);
  const track = await askJson('POST', '/api/v1/tracks', { form, bearer: key });
  const which = level ? `?level=${encodeURIComponent(level)}` : '';
  const plan = await askJson('GET', `/api/v1/buildings/${building}/plan${which}`, { bearer: key });
  const found = lastPlace(track);
  if (!found) return say('other.notFound');
  element('upload-map').hidden = false;
  const sketch = new Sketch(element('upload-map'));
  sketch.setPlan(plan);
  sketch.setSpot(found, found.way);
  const place = placeIn(plan, [found.x_m, found.y_m]);
  say(place.key, { room: place.room, radius: Math.ceil(found.radius_m) });
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
 * Open a session for an app that pushes, and send it the scan of a file.
 *
 * @param {Company} company
 * @param {Counter} counter
 * @param {FormData} form
 */
async function openPushed(company, counter, form) {
  const { building, level, session, key } = await counter.pass();
  form.set('building', building);
  const scan = await askJson('POST', '/api/v1/scans', { form, bearer: key });
  const hello = session ? { session, key } : { ...PUSHED, building, level };
  const live = new Live(company, hello, {
    ticket: () => counter.entrance.newTicket(), isPushed: true,
  });
  live.socket.send({ ...scan, t_s: Date.now() / 1000 });
  return live;
}
