// The screens of the page, one at a time, and small things that they share.

/** @typedef {'choose' | 'scan' | 'walk' | 'paused' | 'over' | 'other'} Screen */

/**
 * Return an element of the page.
 *
 * @param {string} id
 * @returns {any}
 */
export function element(id) {
  const found = document.getElementById(id);
  if (!found) throw new Error(`no element ${id}`);
  return found;
}

/**
 * Show one screen; its heading gets the focus, so that a screen reader says where one is.
 *
 * @param {Screen} name
 * @param {{ focus?: boolean }} [options]
 */
export function show(name, { focus = true } = {}) {
  if (document.body.dataset.screen === name) return;
  document.body.dataset.screen = name;
  for (const screen of document.querySelectorAll('.screen')) {
    /** @type {HTMLElement} */ (screen).hidden = screen.id !== name;
  }
  if (focus) element(`${name}-title`).focus();
}

/**
 * Show a problem where it arose; nothing when there is none.
 *
 * @param {string} id
 * @param {string} [text]
 */
export function showProblem(id, text = '') {
  const place = element(id);
  place.textContent = text;
  place.hidden = !text;
}

/**
 * Fill a list of choices.
 *
 * @param {HTMLSelectElement} list
 * @param {{ value: string, text: string }[]} choices
 */
export function fillChoices(list, choices) {
  list.replaceChildren(...choices.map(({ value, text }) => new Option(text, value)));
}
