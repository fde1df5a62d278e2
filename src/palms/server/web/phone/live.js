// One live session on the page: what it says, sounds and shows, and what its buttons do.

import { askJson } from '../shared/rest.js';
import { LiveSocket } from '../shared/socket.js';
import { forgetWalk, keepWalk } from './kept.js';
import { canListen, listen } from './listen.js';
import { preferencesMessage } from './preferences.js';
import { element, show, showProblem } from './screens.js';
import { Walk } from './walk.js';
import { Eyes } from './xr.js';

/**
 * @typedef {object} Company what a session needs of the page
 * @property {import('./texts.js').Texts} texts
 * @property {import('./preferences.js').Preferences} preferences
 * @property {import('./speaker.js').Speaker} speaker
 * @property {import('./sounds.js').Sounds} sounds
 * @property {import('./ring.js').Ring} ring
 * @property {import('./sketch.js').Sketch} sketch
 */

const GAP_MS = 1500; // a shorter break is not worth a word
const ANSWERS = new Set(['answer', 'hint', 'pause', 'settings']);
/** @type {Record<string, import('./sounds.js').Tune>} */
const TUNES = { localized: 'localized', found: 'localized', lost: 'lost' };
const OVER = { // what the server's codes and reasons mean to somebody who walks
  unknown: 'over.unknown', replaced: 'over.replaced', idle: 'over.idle', deleted: 'over.deleted',
};
const LONGEST_WAY = 2000;
const SHARED_S = 3600; // so long a link is good

/** Says `over` ({text}) when it is over, `refused` ({code, text}) when it did not begin. */
export class Live extends EventTarget {
  eyes = new Eyes();
  #gapTimer = 0;
  #isGap = false;
  #isFull = false;
  #isOver = false;
  #hasPlan = false;
  #viewers = 0;
  /** @type {import('../shared/view.js').Point[]} */ #way = [];

  /**
   * @param {Company} company
   * @param {object} hello what hello says besides the usual
   * @param {object} [options]
   * @param {() => Promise<string | null>} [options.ticket] as in `LiveSocket`
   * @param {import('./kept.js').Kept} [options.kept] what is gone on with
   * @param {boolean} [options.isPushed] whether an app pushes readings, and this page only listens
   */
  constructor(company, hello, { ticket, kept, isPushed = false } = {}) {
    super();
    this.company = company;
    this.kept = kept ?? null;
    this.isPushed = isPushed;
    const receive = ['estimates', 'events', 'speech'];
    this.socket = new LiveSocket({ ...hello, receive }, { ticket });
    this.walk = new Walk(this.eyes, this.socket, { isAgain: Boolean(kept) });
    this.#hear();
    this.#follow();
  }

  /** Connect; what is walked before the server answers is kept. */
  connect() {
    this.socket.connect();
  }

  /** Tell the server what somebody prefers. */
  sendPreferences() {
    const { preferences, texts } = this.company;
    this.socket.say(preferencesMessage(preferences, texts.language));
  }

  #hear() {
    /** @type {Record<string, (message: any) => void>} */
    const hearers = {
      state: (state) => this.#connection(state),
      welcome: (message) => this.#welcomed(message),
      say: (message) => this.#said(message),
      estimate: (message) => this.#estimated(message),
      viewers: (message) => this.#watched(message.viewers),
      link: (message) => this.#linked(message.view),
      error: (message) => this.#failed(message),
      ended: (message) => this.#ended(OVER[/** @type {'idle'} */ (message.reason)] ??
        (message.recording ? 'over.recorded' : 'over.ended')),
    };
    for (const [type, hearer] of Object.entries(hearers)) {
      this.socket.addEventListener(type, (event) =>
        this.#isOver || hearer(/** @type {CustomEvent} */ (event).detail));
    }
  }

  #follow() {
    const { sounds, ring } = this.company;
    /** @type {Record<string, (detail: any) => void>} */
    const followers = {
      phase: (phase) => this.#showPhase(phase),
      cue: ({ key, values, ...how }) => this.cue(key, values, how),
      tick: (share) => sounds.tick(share),
      tune: (tune) => sounds.play(tune),
      turn: ({ bearings, nWalls, percent }) => {
        ring.show(bearings, percent);
        this.#showWalls(nWalls);
      },
    };
    for (const [kind, follower] of Object.entries(followers)) {
      this.walk.addEventListener(kind, (event) =>
        this.#isOver || follower(/** @type {CustomEvent} */ (event).detail));
    }
  }

  /**
   * Say something of the page's own.
   *
   * @param {string} key
   * @param {Record<string, string | number>} [values]
   * @param {{ asked?: boolean, urgent?: boolean, passing?: boolean }} [how]
   */
  cue(key, values = {}, how = {}) {
    this.company.speaker.say({ text: this.company.texts.of(key, values), ...how });
  }

  /**
   * Ask the server for words.
   *
   * @param {'where' | 'details' | 'near' | 'options'} what
   */
  ask(what) {
    if (this.socket.state !== 'open') return this.cue('gap.ask', {}, { asked: true });
    this.socket.say({ type: 'ask', what });
  }

  /** @param {string} text where somebody says they are */
  tell(text) {
    if (!text) return;
    this.walk.tell(text);
    if (this.socket.state !== 'open') this.cue('tell.kept', {}, { asked: true });
  }

  /** Let somebody speak instead of type. */
  async listen() {
    if (!canListen) return;
    this.cue('tell.hearing', {}, { asked: true });
    const words = await listen(this.company.texts.language);
    if (words) this.tell(words);
    else this.cue('tell.nothing', {}, { asked: true });
  }

  /** Make a link with which others look on. */
  share() {
    if (this.socket.state !== 'open') return this.cue('gap.ask', {}, { asked: true });
    this.socket.say({ type: 'share', ttl_s: SHARED_S });
  }

  /** @param {string} view key of the link */
  async #linked(view) {
    const url = `${location.origin}/#view=${view}`;
    Object.assign(element('share-link'), { href: url, textContent: url });
    element('share-place').hidden = false;
    this.cue('share.text', {}, { asked: true });
    try {
      await navigator.share?.({ url });
    } catch {
      // who does not want to send it on finds it on the page
    }
  }

  /** Send away who looks on. */
  dismissViewers() {
    element('share-place').hidden = true;
    this.socket.say({ type: 'dismiss' });
  }

  /** Pause, and ask whether it shall end; a finger may have slipped. */
  leaveOrStay() {
    if (this.isPushed) this.end();
    else this.walk.pause('leaving');
  }

  /** End the walk; the server deletes it. */
  end() {
    if (this.socket.state === 'open') this.socket.say({ type: 'end' });
    else this.#ended('over.offline');
  }

  /** @param {string} state */
  #connection(state) {
    clearTimeout(this.#gapTimer);
    if (state === 'waiting' && !this.#isGap) {
      this.#gapTimer = setTimeout(() => {
        this.#isGap = true;
        this.cue('gap.lost');
      }, GAP_MS);
    }
    if (state === 'open' && this.#isGap) {
      this.#isGap = false;
      this.cue('gap.back');
    }
  }

  /** @param {any} welcome */
  #welcomed({ session, building, level }) {
    const { key } = this.socket;
    const place = building.levels.length > 1 ? `${building.name}, ${level}` : building.name;
    this.kept = {
      session, key: key ?? '', building: building.id, level, place, isPushed: this.isPushed,
    };
    keepWalk(this.kept);
    if (this.isPushed) this.#showAddress(this.kept);
    element('place').textContent = place;
    this.sendPreferences();
    if (!this.#hasPlan) this.#loadPlan();
  }

  /** @param {import('./kept.js').Kept} kept */
  #showAddress({ session, key }) {
    element('push-url').textContent = `${location.origin}/api/v1/push/${session}`;
    element('push-header').textContent = `Bearer ${key}`;
  }

  async #loadPlan() {
    const { building, level, key } = /** @type {import('./kept.js').Kept} */ (this.kept);
    const path = `/api/v1/buildings/${building}/plan?level=${encodeURIComponent(level)}`;
    try {
      this.company.sketch.setPlan(await askJson('GET', path, { bearer: key }));
      this.#hasPlan = true;
    } catch {
      // the walk goes on without a map
    }
  }

  /** @param {string | null} level the one that the walk is on now */
  #onLevel(level) {
    if (!this.kept || !level || level === this.kept.level) return;
    this.kept = { ...this.kept, level };
    this.#way = [];
    this.#loadPlan();
  }

  /** @param {any} sentence */
  #said({ kind, text, details, urgent, language }) {
    const asked = ANSWERS.has(kind);
    const passing = kind === 'resume'; // the page has said so itself
    this.company.speaker.say({ text, details, urgent, language, asked, passing });
    if (kind in TUNES) this.company.sounds.play(TUNES[kind]);
  }

  /** @param {any} estimate */
  #estimated({ stage, level, x_m, y_m, radius_95_m, facing_rad }) {
    this.#onLevel(level);
    document.body.dataset.stage = stage;
    const isTold = stage === 'localized';
    if (isTold) this.#way.push([x_m, y_m]);
    if (this.#way.length > LONGEST_WAY) this.#way.shift();
    const spot = isTold ? { x_m, y_m, radius_m: radius_95_m, facing_rad } : null;
    this.company.sketch.setSpot(spot, this.#way);
  }

  /** @param {{ name: string }[]} viewers */
  #watched(viewers) {
    if (viewers.length === 0 && this.#viewers === 0) return;
    this.#viewers = viewers.length;
    const names = viewers.map(({ name }) => name).join(', ');
    const key = viewers.length > 0 ? 'viewers.some' : 'viewers.none';
    this.cue(key, { names });
    element('viewers').hidden = viewers.length === 0;
    element('viewers-text').textContent = this.company.texts.of(key, { names });
  }

  /** @param {any} error */
  #failed({ code, fatal, text }) {
    if (!fatal && this.isPushed && code === 'input') this.company.speaker.say({ text });
    if (!fatal) return;
    if (code === 'full' && this.socket.state !== 'closed') return this.#sayFull();
    if (code === 'unknown' && this.kept) return this.#ended('over.unknown');
    if (this.socket.state === 'closed') this.#refuse(code, text);
  }

  #sayFull() {
    if (!this.#isFull) this.cue('gap.full');
    this.#isFull = true;
  }

  /**
   * @param {string} code
   * @param {string} text
   */
  #refuse(code, text) {
    this.leave();
    this.dispatchEvent(new CustomEvent('refused', { detail: { code, text } }));
  }

  /** @param {string} key */
  #ended(key) {
    forgetWalk();
    this.leave();
    this.dispatchEvent(new CustomEvent('over', { detail: { key } }));
  }

  /** Let go of camera and connection; the server's session stays. */
  leave() {
    this.#isOver = true;
    clearTimeout(this.#gapTimer);
    this.socket.close();
    this.eyes.close();
    delete document.body.dataset.stage;
  }

  /** @param {import('./walk.js').Phase} phase */
  #showPhase(phase) {
    document.body.classList.toggle('in-ar', this.eyes.isOpen);
    if (phase === 'paused') this.showPause();
    show(phase);
  }

  /** Say why nothing goes on. */
  showPause() {
    const { texts } = this.company;
    const reason = this.walk.reason === 'hidden' ? 'byUser' : this.walk.reason;
    showProblem('paused-problem');
    element('paused-text').textContent =
      texts.of(`paused.${reason}`, { building: this.kept?.place ?? '' });
  }

  /** @param {number} n */
  #showWalls(n) {
    const key = n === 1 ? 'scan.walls.one' : 'scan.walls.other';
    element('walls').textContent = this.company.texts.of(key, { n });
  }
}
