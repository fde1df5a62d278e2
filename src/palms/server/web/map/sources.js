// Sources: where a story comes from. A live session, a drawn walk, a recording.

import { splitFrames } from '../shared/frames.js';
import { ask, askJson, ticketFor } from '../shared/rest.js';
import { LiveSocket } from '../shared/socket.js';
import { lengthOf } from './pen.js';
import { Story } from './story.js';

/** @typedef {import('../shared/socket.js').Message} Message */
/** @typedef {import('../shared/view.js').Point} Point */

const RECEIVE = ['estimates', 'events', 'particles', 'heatmaps'];
const MOST_PARTICLES = 2000;
const SAMPLE_MS = 500; // a simulated phone says twice a second where it is
const MOST_UNSTORED = 20;

/**
 * @param {string} building
 * @param {string} level
 * @param {string} [bearer] a link's key instead of the token
 */
export function loadPlan(building, level, bearer) {
  const path = `/api/v1/buildings/${encodeURIComponent(building)}/plan`;
  return askJson('GET', `${path}?level=${encodeURIComponent(level)}`, bearer ? { bearer } : {});
}

/**
 * A source tells `change` (the story grew), `event` (a message of that type), `problem` (one line),
 * `finished` (nothing more will come), `state` (of the connection).
 */
class Source extends EventTarget {
  /** @type {Story} */ story;

  /** @param {Story} story */
  constructor(story) {
    super();
    this.story = story;
  }

  /**
   * @param {string} kind
   * @param {any} [detail]
   */
  tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }

  /** @param {LiveSocket} socket */
  listen(socket) {
    const on = (/** @type {string} */ kind, /** @type {(detail: any) => void} */ does) =>
      socket.addEventListener(kind, (event) => does(/** @type {CustomEvent} */ (event).detail));
    on('estimate', (estimate) => this.#grow(() => this.story.addStep(estimate)));
    on('path', (path) => this.#grow(() => this.story.addPath(path)));
    on('frame', (frame) => this.#grow(() => this.story.addFrame(frame)));
    on('event', (happening) => {
      this.story.events.push(happening);
      this.tell('event', happening);
    });
    on('error', (error) => this.tell('problem', error.text));
    on('state', (state) => this.tell('state', state));
  }

  /** @param {() => void} by */
  #grow(by) {
    by();
    this.tell('change');
  }

  close() {}
}

/** Looks on at a live session. */
export class Watched extends Source {
  #socket;
  #bearer;
  #building = '';
  #asked = new Set();

  /**
   * @param {object} which
   * @param {string} [which.session] for the operator
   * @param {string} [which.view] a link's key, for anybody else
   */
  constructor({ session, view }) {
    super(new Story({ title: 'Live', level: '' }));
    this.#bearer = view;
    const hello = {
      role: 'viewer', receive: RECEIVE, max_particles: MOST_PARTICLES, name: 'Map page',
    };
    this.#socket = new LiveSocket(view ? { ...hello, view } : { ...hello, session }, {
      ticket: async () => (view ? null : ticketFor({ role: 'viewer', session })),
    });
    this.listen(this.#socket);
    this.#socket.addEventListener('welcome', (event) => {
      this.#welcome(/** @type {CustomEvent} */ (event).detail);
    });
    this.#socket.addEventListener('ended', (event) => {
      this.tell('finished', /** @type {CustomEvent} */ (event).detail);
    });
    this.#socket.addEventListener('estimate', (event) => {
      this.#load(/** @type {CustomEvent} */ (event).detail.level);
    });
    this.#socket.connect();
  }

  /** @param {Message} welcome */
  #welcome({ building, level }) {
    this.#building = building.id;
    this.story.title = building.name;
    this.story.level = level;
    return this.#load(level);
  }

  /**
   * Get the plan of a level that somebody has come to.
   *
   * @param {string | null} level
   */
  async #load(level) {
    if (!level || this.#asked.has(level)) return;
    this.#asked.add(level);
    try {
      this.story.plans.set(level, await loadPlan(this.#building, level, this.#bearer));
      this.tell('plan');
      this.tell('change');
    } catch (problem) {
      this.tell('problem', /** @type {Error} */ (problem).message);
    }
  }

  close() {
    this.#socket.close();
  }
}

/**
 * Walks a path that the server simulates, as a phone would: a session of its own. It is recorded,
 * and the recording goes when the page lets go of it, unless somebody keeps it. Says `recorded`.
 */
export class Walked extends Source {
  #socket;
  #samples;
  #next = 0;
  #timer = 0;
  length_m;
  speed;
  isOver = false;
  isKept = false;
  /** @type {string | null} */ recording = null;

  /**
   * @param {{ id: string, name: string }} building
   * @param {import('../shared/plan.js').Plan} plan
   * @param {Message} simulation as the server made it
   * @param {{ level: string, speed: number, seed: number }} options
   */
  constructor(building, plan, simulation, { level, speed, seed }) {
    super(new Story({ title: building.name, level, plan, truth_m: simulation.truth_m }));
    this.speed = speed;
    this.length_m = lengthOf(simulation.truth_m);
    this.#samples = simulation.samples;
    const hello = {
      building: building.id, level, seed, receive: RECEIVE, max_particles: MOST_PARTICLES,
      record: true,
    };
    this.#socket = new LiveSocket(hello, {
      ticket: () => ticketFor({ role: 'walker', building: building.id }),
    });
    this.listen(this.#socket);
    this.#socket.addEventListener('ended', (event) => {
      this.recording = /** @type {CustomEvent} */ (event).detail.recording;
      this.tell('recorded');
    });
    const { type, t_s, planes, position_m, coverage_m } = simulation.scan;
    this.#socket.send({ type, t_s, planes, position_m, coverage_m });
    this.#socket.connect();
    this.#tick();
  }

  /** Send the next sample, if the server keeps up; end after the last. */
  #tick() {
    const last = this.story.steps.at(-1)?.seq ?? 0; // the scan, which is the first, takes its time
    if (last === this.#samples.length + 1) {
      this.isOver = true;
      this.#socket.say({ type: 'end' });
      this.tell('finished', {});
      return;
    }
    this.#timer = setTimeout(() => this.#tick(), SAMPLE_MS / this.speed);
    const isReady = this.#socket.state === 'open' && this.#socket.nUnstored < MOST_UNSTORED;
    if (last > 0 && isReady && this.#next < this.#samples.length) {
      this.#socket.send({ type: 'odometry', samples: [this.#samples[this.#next++]] });
    }
  }

  close() {
    clearTimeout(this.#timer);
    if (this.recording && !this.isKept) {
      ask('DELETE', `/api/v1/recordings/${this.recording}`).catch(() => null); // it expires, too
    } else if (this.#socket.state === 'open') {
      this.#socket.say({ type: 'end', keep_recording: false });
    } else this.#socket.close();
  }
}

/**
 * Load a recording as a story.
 *
 * @param {string} recording
 * @param {string} [bearer] a link's key instead of the token
 */
export async function loadReplay(recording, bearer) {
  const path = `/api/v1/recordings/${encodeURIComponent(recording)}`;
  const options = bearer ? { bearer } : {};
  const track = await askJson('GET', `${path}/track`, options);
  const { plan, level, estimates, events } = track;
  const story = new Story({ title: plan.name, level, plan, truth_m: truthOf(recording) });
  story.events = events;
  for (const estimate of estimates) story.addStep(estimate);
  const frames = await (await ask('GET', `${path}/frames`, options)).arrayBuffer();
  for (const frame of splitFrames(frames)) story.addFrame(frame);
  return story;
}

/**
 * Remember where a recorded walk truly led; only this tab knows it.
 *
 * @param {string} recording
 * @param {Point[] | null} truth_m
 */
export function rememberTruth(recording, truth_m) {
  sessionStorage.setItem(`palms-truth-${recording}`, JSON.stringify(truth_m));
}

/** @param {string} recording */
function truthOf(recording) {
  return JSON.parse(sessionStorage.getItem(`palms-truth-${recording}`) ?? 'null');
}
