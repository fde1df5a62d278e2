// Sounds and vibration for those who want them: progress, found, lost.

const TICK_S = 0.06;
const LOW_HZ = 440;
const VOLUME = 0.2;

/** Notes as (frequency in hertz, start in seconds, length in seconds). */
const TUNES = {
  done: [[660, 0, 0.12], [880, 0.12, 0.2]],
  localized: [[523, 0, 0.14], [659, 0.14, 0.14], [784, 0.28, 0.3]],
  lost: [[392, 0, 0.2], [294, 0.22, 0.4]],
};
const PULSES_MS = { tick: [15], done: [60, 60, 60], localized: [60, 60, 60, 60, 180], lost: [400] };

/** @typedef {keyof typeof TUNES} Tune */

export class Sounds {
  /** @type {AudioContext | null} */ #audio = null;

  /** @param {{ sounds: boolean, vibration: boolean }} wanted read whenever something sounds */
  constructor(wanted) {
    this.wanted = wanted;
  }

  /** Begin; browsers allow it only while a button is being pressed. */
  unlock() {
    if (!this.#audio && 'AudioContext' in globalThis) this.#audio = new AudioContext();
    this.#audio?.resume().catch(() => {});
  }

  /**
   * A tick, the higher the more is done.
   *
   * @param {number} share 0 to 1
   */
  tick(share) {
    this.#pulse(PULSES_MS.tick);
    if (this.wanted.sounds) this.#note(LOW_HZ * 2 ** share, 0, TICK_S);
  }

  /** @param {Tune} tune */
  play(tune) {
    this.#pulse(PULSES_MS[tune]);
    if (!this.wanted.sounds) return;
    for (const [hertz, start_s, length_s] of TUNES[tune]) this.#note(hertz, start_s, length_s);
  }

  /** @param {number[]} pulses_ms */
  #pulse(pulses_ms) {
    if (this.wanted.vibration) navigator.vibrate?.(pulses_ms);
  }

  /**
   * @param {number} hertz
   * @param {number} start_s from now
   * @param {number} length_s
   */
  #note(hertz, start_s, length_s) {
    const audio = this.#audio;
    if (!audio) return;
    const [tone, volume] = [audio.createOscillator(), audio.createGain()];
    const [from, to] = [audio.currentTime + start_s, audio.currentTime + start_s + length_s];
    tone.frequency.value = hertz;
    volume.gain.setValueAtTime(VOLUME, from);
    volume.gain.exponentialRampToValueAtTime(0.001, to);
    tone.connect(volume).connect(audio.destination);
    tone.start(from);
    tone.stop(to);
  }
}
