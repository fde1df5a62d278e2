// What this phone keeps of a walk, so that a reload goes on with it: its name and key, no place.

const KEY = 'palms-walk';

/**
 * @typedef {object} Kept
 * @property {string} session
 * @property {string} key
 * @property {string} building its id
 * @property {string} level
 * @property {string} place what to call building and level
 * @property {boolean} [isPushed] whether an app pushes readings
 */

/** @returns {Kept | null} */
export function loadWalk() {
  try {
    const found = JSON.parse(localStorage.getItem(KEY) ?? 'null');
    return found?.session && found?.key ? found : null;
  } catch {
    return null;
  }
}

/** @param {Kept} kept */
export function keepWalk(kept) {
  try {
    localStorage.setItem(KEY, JSON.stringify(kept));
  } catch {
    // a browser that keeps nothing begins anew after a reload
  }
}

export function forgetWalk() {
  try {
    localStorage.removeItem(KEY);
  } catch {
    // nothing was kept
  }
}
