// What is said: in one place of the page, and by one voice, the screen reader's or the page's own.

import { SILENCE, dueNow, offered } from './talk.js';

/** @typedef {import('./talk.js').Sentence} Sentence */

export class Speaker {
  #talk = SILENCE;
  /** @type {Sentence | null} */ #last = null;
  #timer = 0;

  /**
   * @param {{ said: HTMLElement, details: HTMLElement }} places where the sentence stands, which is
   *   the page's one live region, and its details
   * @param {{ voice: 'reader' | 'page' }} wanted read whenever something is said
   * @param {string} language of the page's own sentences
   */
  constructor({ said, details }, wanted, language) {
    this.said = said;
    this.details = details;
    this.wanted = wanted;
    this.language = language;
  }

  /** Let the region speak to a screen reader, or be silent where the page speaks itself. */
  settle() {
    this.said.setAttribute('aria-live', this.wanted.voice === 'page' ? 'off' : 'polite');
    if (this.wanted.voice !== 'page') globalThis.speechSynthesis?.cancel();
  }

  /**
   * Say something, now or as soon as it is its turn.
   *
   * @param {Sentence} sentence
   */
  say(sentence) {
    const [talk, now] = offered(this.#talk, sentence, performance.now() / 1000);
    this.#talk = talk;
    if (now) this.#speak(now);
    this.#wait();
  }

  /** Say nothing more, and forget what was said. */
  clear() {
    clearTimeout(this.#timer);
    [this.#talk, this.#last] = [SILENCE, null];
    this.said.textContent = this.details.textContent = '';
    globalThis.speechSynthesis?.cancel();
  }

  /** Say the last sentence once more. */
  repeat() {
    if (this.#last) this.#speak({ ...this.#last, asked: true });
  }

  #wait() {
    clearTimeout(this.#timer);
    if (!this.#talk.waiting) return;
    const wait_ms = Math.max(0, 1000 * this.#talk.free_s - performance.now());
    this.#timer = setTimeout(() => {
      const [talk, now] = dueNow(this.#talk, performance.now() / 1000);
      this.#talk = talk;
      if (now) this.#speak(now);
      this.#wait();
    }, wait_ms + 1);
  }

  /** @param {Sentence} sentence */
  #speak(sentence) {
    this.#last = sentence;
    const text = sentence.text;
    const isSame = this.said.textContent === text;
    // a region that does not change is not read again: an invisible mark makes it another
    this.said.textContent = isSame ? `${text}\u200b` : text;
    this.said.lang = sentence.language ?? this.language;
    this.details.textContent = sentence.details ?? '';
    if (this.wanted.voice === 'page') this.#utter(text, sentence);
  }

  /**
   * @param {string} text
   * @param {Sentence} sentence
   */
  #utter(text, { asked, urgent, language }) {
    const synthesis = globalThis.speechSynthesis;
    if (!synthesis) return;
    if (asked || urgent) synthesis.cancel();
    const words = new SpeechSynthesisUtterance(text);
    words.lang = language ?? this.language;
    synthesis.speak(words);
  }
}
