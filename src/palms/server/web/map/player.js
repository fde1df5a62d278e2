// Player: which moment of a story is shown. Follows what grows, plays, or stands where it was put.

import { indexAt } from './timeline.js';

/** @typedef {import('./story.js').Story} Story */

/** Says `move`, with the index before and whether time went on by itself; and `state`. */
export class Player extends EventTarget {
  /** @type {Story | null} */ story = null;
  index = -1;
  speed = 4;
  isPlaying = false;
  isFollowing = false;
  isGrowing = false;
  #t_s = 0;
  #before_ms = 0;

  /**
   * @param {Story | null} story
   * @param {boolean} isGrowing whether it is live: then its end is followed
   */
  attach(story, isGrowing) {
    Object.assign(this, { story, isGrowing, isFollowing: isGrowing, isPlaying: false, index: -1 });
    if (story?.steps.length) this.#go(isGrowing ? story.steps.length - 1 : 0, true);
    this.#tellState();
  }

  get step() {
    return this.story?.steps[this.index];
  }

  /** The story has more steps than before. */
  grew() {
    if (!this.story?.steps.length) return;
    if (this.isFollowing) this.#go(this.story.steps.length - 1, true);
    else this.#go(Math.max(this.index, 0), false);
  }

  /** The story will not grow any more. */
  finished() {
    this.isGrowing = this.isFollowing = false;
    this.#tellState();
  }

  /** @param {number} index */
  scrub(index) {
    this.isPlaying = this.isFollowing = false;
    this.#go(index, false);
    this.#tellState();
  }

  toNow() {
    this.isFollowing = this.isGrowing;
    this.#go((this.story?.steps.length ?? 0) - 1, false);
    this.#tellState();
  }

  toggle() {
    if (!this.story?.steps.length) return;
    this.isPlaying = !(this.isPlaying || this.isFollowing);
    this.isFollowing = false;
    const isAtEnd = this.index >= this.story.steps.length - 1;
    if (this.isPlaying && isAtEnd) this.#go(0, false);
    this.#t_s = this.step?.t_s ?? 0;
    this.#before_ms = performance.now();
    if (this.isPlaying) requestAnimationFrame((now_ms) => this.#tick(now_ms));
    this.#tellState();
  }

  /** @param {number} now_ms */
  #tick(now_ms) {
    if (!this.isPlaying || !this.story) return;
    this.#t_s += (Math.max(now_ms - this.#before_ms, 0) / 1000) * this.speed;
    this.#before_ms = now_ms;
    const index = indexAt(this.story.steps, this.#t_s);
    if (index !== this.index) this.#go(index, true);
    if (index >= this.story.steps.length - 1) {
      this.isPlaying = false;
      this.isFollowing = this.isGrowing;
      this.#tellState();
    } else requestAnimationFrame((next_ms) => this.#tick(next_ms));
  }

  /**
   * @param {number} index
   * @param {boolean} isByItself
   */
  #go(index, isByItself) {
    const before = this.index;
    this.index = index;
    this.dispatchEvent(new CustomEvent('move', { detail: { before, isByItself } }));
  }

  #tellState() {
    this.dispatchEvent(new Event('state'));
  }
}
