// The settings' form: shows the preferences, and keeps what is changed.

import { preferencesOf, savePreferences } from './preferences.js';
import { element } from './screens.js';

/**
 * @param {import('./preferences.js').Preferences} preferences changed in place
 * @param {() => void} changed
 */
export function bindSettings(preferences, changed) {
  const forms = [element('settings-form'), element('start-form')];
  const all = forms.flatMap((form) => [...form.elements]);
  const fields = all.filter(({ name }) => name in preferences);
  for (const field of fields) {
    showValue(field, preferences);
    field.addEventListener('change', () => {
      Object.assign(preferences, preferencesOf({ ...preferences, [field.name]: valueOf(field) }));
      for (const each of fields) showValue(each, preferences);
      savePreferences(preferences);
      changed();
    });
  }
  element('settings-form').addEventListener('submit', (/** @type {Event} */ event) =>
    event.preventDefault());
  element('vibration-field').hidden = !('vibrate' in navigator);
}

/**
 * @param {any} field
 * @param {Record<string, any>} preferences
 */
function showValue(field, preferences) {
  if (field.type === 'checkbox') field.checked = preferences[field.name];
  else if (field.type === 'radio') field.checked = preferences[field.name] === field.value;
  else field.value = preferences[field.name];
}

/** @param {any} field */
function valueOf(field) {
  return field.type === 'checkbox' ? field.checked : field.value;
}
