// What somebody prefers, kept on this phone alone.

const KEY = 'palms-preferences';

/**
 * What may be chosen, the default first.
 *
 * @type {Record<string, readonly (string | boolean | number)[]>}
 */
const CHOICES = {
  voice: ['reader', 'page'],
  units: ['metres', 'feet', 'steps'],
  directions: ['clock', 'degrees', 'words'],
  details: [false, true],
  quiet: [false, true],
  sounds: [true, false],
  vibration: [true, false],
  record: [false, true],
};
const SHORTEST_STEP_CM = 20;
const LONGEST_STEP_CM = 150;

/**
 * @typedef {object} Preferences
 * @property {'reader' | 'page'} voice who speaks
 * @property {'metres' | 'feet' | 'steps'} units
 * @property {'clock' | 'degrees' | 'words'} directions
 * @property {number} step_cm length of a step
 * @property {boolean} details whether details are said unasked
 * @property {boolean} quiet whether only what is urgent is said unasked
 * @property {boolean} sounds
 * @property {boolean} vibration
 * @property {boolean} record whether the server shall keep the walk
 */

/**
 * Return preferences; what is missing or makes no sense is the default.
 *
 * @param {unknown} found what was kept, or read from a form
 * @returns {Preferences}
 */
export function preferencesOf(found) {
  const isObject = typeof found === 'object' && found !== null;
  const given = /** @type {Record<string, any>} */ (isObject ? found : {});
  const chosen = Object.fromEntries(Object.entries(CHOICES).map(([name, all]) =>
    [name, all.includes(given[name]) ? given[name] : all[0]]));
  const step_cm = Number(given.step_cm);
  const isStep = step_cm >= SHORTEST_STEP_CM && step_cm <= LONGEST_STEP_CM;
  return /** @type {any} */ ({ ...chosen, step_cm: isStep ? Math.round(step_cm) : 70 });
}

/** @returns {Preferences} */
export function loadPreferences() {
  try {
    return preferencesOf(JSON.parse(localStorage.getItem(KEY) ?? 'null'));
  } catch {
    return preferencesOf(null);
  }
}

/** @param {Preferences} preferences */
export function savePreferences(preferences) {
  try {
    localStorage.setItem(KEY, JSON.stringify(preferences));
  } catch {
    // a browser that keeps nothing asks again next time
  }
}

/**
 * Return the message that tells the server.
 *
 * @param {Preferences} preferences
 * @param {string} language
 */
export function preferencesMessage(preferences, language) {
  const { units, step_cm, directions, details, quiet } = preferences;
  const step_m = step_cm / 100;
  return { type: 'preferences', units, step_m, language, directions, details, quiet };
}
