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
    this.#socket.connect();
  }

  /** @param {Message} welcome */
  async #welcome({ building, level }) {
    this.story.title = building.name;
    this.story.level = level;
    if (this.story.plans.has(level)) return;
    try {
      this.story.plans.set(level, await loadPlan(building.id, level, this.#bearer));
    } catch (problem) {
      this.tell('problem', /** @type {Error} */ (problem).message);
    }
    this.tell('plan');
    this.tell('change');
  }

  close() {
    this.#socket.close();
  }
}

/** Walks a path that the server simulates, as a phone would: its own session. */
export class Walked extends Source {
  #socket;
  #samples;
  #next = 0;
  #timer = 0;
  /** @type {((recording: string | null) => void) | null} */ #ended = null;
  length_m;
  isOver = false;
  canRecord = false;
  speed;

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
      this.#ended?.(/** @type {CustomEvent} */ (event).detail.recording);
    });
    this.#socket.addEventListener('welcome', (event) => {
      this.canRecord = /** @type {CustomEvent} */ (event).detail.recording;
    });
    const { type, t_s, planes, position_m, coverage_m } = simulation.scan;
    this.#socket.send({ type, t_s, planes, position_m, coverage_m });
    this.#socket.connect();
    this.#tick();
  }

  #tick() {
    this.#timer = setTimeout(() => this.#tick(), SAMPLE_MS / this.speed);
    const isReady = this.#socket.state === 'open' && this.#socket.nUnstored < MOST_UNSTORED;
    if (this.#next === 0 && this.story.steps.length === 0) return; // the scan takes its time
    if (isReady && this.#next < this.#samples.length) {
      this.#socket.send({ type: 'odometry', samples: [this.#samples[this.#next++]] });
    }
    if (this.#next < this.#samples.length || this.#socket.nUnstored > 0) return;
    if (this.story.steps.at(-1)?.seq !== this.#samples.length + 1) return;
    clearTimeout(this.#timer);
    this.isOver = true;
    this.tell('finished', {});
  }

  /**
   * End the session.
   *
   * @param {boolean} isKept whether its recording stays
   * @returns {Promise<string | null>} name of the recording
   */
  end(isKept) {
    clearTimeout(this.#timer);
    if (this.#socket.state !== 'open') return Promise.resolve(null);
    const ended = new Promise((resolve) => { this.#ended = resolve; });
    this.#socket.say({ type: 'end', keep_recording: isKept });
    return ended;
  }

  close() {
    if (this.#socket.state === 'open') this.end(false);
    else this.#socket.close();
    clearTimeout(this.#timer);
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
