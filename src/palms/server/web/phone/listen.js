// Words by voice, where the browser can understand them.

const browser = /** @type {any} */ (globalThis);
const Recognition = browser.SpeechRecognition ?? browser.webkitSpeechRecognition;

/** Whether this browser understands speech. */
export const canListen = Boolean(Recognition);

/**
 * Listen once; null when nothing was understood, or the microphone was refused.
 *
 * @param {string} language
 * @returns {Promise<string | null>}
 */
export function listen(language) {
  return new Promise((resolve) => {
    const hearing = new Recognition();
    hearing.lang = language;
    hearing.maxAlternatives = 1;
    hearing.onresult = (/** @type {any} */ { results }) =>
      resolve(results[0][0].transcript.trim() || null);
    hearing.onerror = () => resolve(null);
    hearing.onend = () => resolve(null);
    hearing.start();
  });
}
