// One walk: the turn for a scan, then the way, with pauses, gaps of the network and new turns.
//
// Eyes see, the socket carries, and what happens is told as events; nothing here touches the page.

import { NOTHING_SEEN, looked, share } from './bearings.js';
import { guided, newGuide } from './guide.js';
import { wallOf, wallPlanes } from './planes.js';
import { groundOf, isDue, lookOf, poseMessage } from './poses.js';

/**
 * @typedef {import('./xr.js').Sight} Sight
 * @typedef {import('../shared/socket.js').LiveSocket} LiveSocket
 * @typedef {'scan' | 'walk' | 'paused'} Phase
 * @typedef {'byUser' | 'leaving' | 'hidden' | 'camera' | 'reload'} PauseReason
 */

const SAMPLES_IN_ONE = 100; // after a gap; the server takes 500
const MOST_KEPT = 6000; // samples of three quarters of an hour without a network

/**
 * Says `phase` (a Phase); `turn` ({bearings, nWalls, percent}) with each look while scanning;
 * `cue` ({key, values, passing}) for what the page shall say; `tick` and `tune` for its sounds.
 */
export class Walk extends EventTarget {
  /** @type {Phase} */ phase = 'paused';
  /** @type {PauseReason} */ reason = 'reload';
  #eyes;
  #socket;
  /** @type {Sight | null} */ #sight = null;
  #bearings = NOTHING_SEEN;
  #guide = newGuide(0);
  /** @type {{ time_s: number, pose: import('./poses.js').Pose } | null} */ #last = null;
  /** @type {object[]} */ #samples = [];
  #hasFrame = false; // whether the server knows this frame of reference, by a scan
  #isAgain = false; // whether it knows an earlier one, which is to be left
  #isFirst = true; // whether the latest scan was the first of its frame
  /** @type {import('../shared/socket.js').Message | null} */ #scan = null;

  /**
   * @param {import('./xr.js').Eyes} eyes
   * @param {LiveSocket} socket
   * @param {{ isAgain?: boolean }} [options] whether the session has been walked in before
   */
  constructor(eyes, socket, { isAgain = false } = {}) {
    super();
    this.#eyes = eyes;
    this.#socket = socket;
    this.#isAgain = isAgain;
    eyes.addEventListener('sight', (event) => this.#see(/** @type {CustomEvent} */ (event).detail));
    eyes.addEventListener('blind', () => this.#cue('scan.blind'));
    eyes.addEventListener('reset', () => this.#reset());
    eyes.addEventListener('hidden', () => this.pause('hidden'));
    eyes.addEventListener('visible', () => this.reason === 'hidden' && this.resume());
    eyes.addEventListener('end', () => this.#cameraOff());
    socket.addEventListener('welcome', () => this.#sendSamples());
    socket.addEventListener('error', (event) =>
      this.#refused(/** @type {CustomEvent} */ (event).detail));
  }

  /**
   * Begin to turn; the camera is on.
   *
   * @param {string} key of the text to say
   */
  beginScan(key) {
    if (!this.#hasFrame && this.#isAgain) this.#send({ type: 'resume', same_frame: false });
    this.#isAgain = false;
    this.#bearings = NOTHING_SEEN;
    this.#guide = newGuide(this.#sight?.time_s ?? 0);
    this.#become('scan');
    this.#cue(key, {}, { asked: true });
  }

  /** Send what was seen, whether or not the turn was whole; says why where that is too little. */
  finishScan() {
    const sight = this.#sight;
    if (!sight) return this.#cue('scan.waiting', {}, { asked: true });
    const planes = wallPlanes(sight.planes, groundOf(sight.pose));
    if (planes.length === 0) return this.#cue('scan.noWalls', {}, { asked: true });
    this.#isFirst = !this.#hasFrame;
    this.#scan = this.#send({
      type: 'scan', t_s: sight.time_s, form: 'webxr', planes, pose: poseMessage(sight.pose),
    });
    [this.#hasFrame, this.#last] = [true, sight];
    this.#become('walk');
    const percent = Math.round(100 * share(this.#bearings));
    this.#cue(percent < 97 ? 'scan.partial' : 'scan.done', { percent }, { asked: true });
    this.#tell('tune', 'done');
  }

  /**
   * Stop sending.
   *
   * @param {PauseReason} reason
   */
  pause(reason) {
    if (this.phase === 'paused') return;
    if (this.#hasFrame) this.#send({ type: 'pause' });
    this.reason = reason;
    this.#become('paused');
  }

  /** Go on where the camera has stayed on; else a new turn is needed. */
  resume() {
    if (this.phase !== 'paused') return;
    if (!this.#hasFrame) return this.beginScan(this.#isAgain ? 'scan.resumed' : 'scan.start');
    this.#send({ type: 'resume', same_frame: true });
    this.#become('walk');
  }

  /** @param {string} text what its user says about where they are */
  tell(text) {
    this.#send({ type: 'tell', text });
  }

  #cameraOff() {
    this.pause('camera');
    this.reason = 'camera';
    this.#leaveFrame();
    this.#sight = null;
    this.#become('paused');
  }

  /** The tracking began anew: what was walked in the old frame stays, the new one needs a scan. */
  #reset() {
    if (this.phase === 'scan' && !this.#hasFrame) return this.beginScan('scan.reset');
    this.#sendSamples();
    this.#leaveFrame();
    if (this.phase !== 'paused') this.beginScan('scan.reset');
  }

  #leaveFrame() {
    this.#isAgain ||= this.#hasFrame;
    this.#hasFrame = false;
  }

  /** @param {Sight} sight */
  #see(sight) {
    if (!this.#sight) this.#guide = newGuide(sight.time_s);
    this.#sight = sight;
    if (this.phase === 'paused') return;
    if (this.#hasFrame) this.#step(sight);
    if (this.phase === 'scan') this.#turn(sight);
  }

  /** @param {Sight} sight */
  #turn({ time_s, pose, planes }) {
    this.#bearings = looked(this.#bearings, { ...lookOf(pose.orientation), time_s });
    const nWalls = planes.filter(wallOf).length;
    const [guide, cue] = guided(this.#guide, this.#bearings, nWalls, time_s);
    this.#guide = guide;
    this.#tell('turn', { bearings: this.#bearings, nWalls, percent: cue.values.percent });
    if (cue.tick) this.#tell('tick', share(this.#bearings));
    if (cue.done) this.finishScan();
    else if (cue.say) this.#cue(cue.say, cue.values, { passing: true });
  }

  /** @param {Sight} sight */
  #step(sight) {
    if (!isDue(this.#last, sight)) return;
    this.#last = sight;
    this.#samples.push({ t_s: sight.time_s, pose: poseMessage(sight.pose) });
    if (this.#samples.length > MOST_KEPT) this.#samples.shift();
    if (this.#socket.state === 'open') this.#sendSamples();
  }

  /** Send the samples that have gathered; after a gap they are few messages. */
  #sendSamples() {
    while (this.#samples.length > 0) {
      this.#socket.send({ type: 'odometry', samples: this.#samples.splice(0, SAMPLES_IN_ONE) });
    }
  }

  /** Send an input after all that was walked before it. */
  #send(/** @type {import('../shared/socket.js').Message} */ input) {
    this.#sendSamples();
    return this.#socket.send(input);
  }

  /**
   * A scan that the server could not use: where it was the first, the frame is as new as before.
   *
   * @param {{ code: string, seq?: number }} error
   */
  #refused({ code, seq }) {
    if (code !== 'input' || !this.#scan || seq !== this.#scan.seq) return;
    if (this.#isFirst) this.#hasFrame = false;
    this.beginScan('scan.refused');
  }

  /** @param {Phase} phase */
  #become(phase) {
    this.phase = phase;
    this.#tell('phase', phase);
  }

  /**
   * @param {string} key
   * @param {Record<string, string | number>} [values]
   * @param {{ asked?: boolean, passing?: boolean }} [how]
   */
  #cue(key, values = {}, how = {}) {
    this.#tell('cue', { key, values, ...how });
  }

  /**
   * @param {string} kind
   * @param {unknown} detail
   */
  #tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }
}
