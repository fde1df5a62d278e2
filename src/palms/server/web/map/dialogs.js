// Dialogs: a token, a plan to upload, a phone's address, a link to a replay.

import { Refusal, ask, askJson, ticketFor, token } from '../shared/rest.js';
import { phoneAdvice } from './advice.js';

const SHARE_S = 7 * 86_400;

/** @param {string} id @returns {any} */
const $ = (id) => document.getElementById(id);

for (const button of document.querySelectorAll('dialog [data-close]')) {
  button.addEventListener('click', () => button.closest('dialog')?.close());
}

/**
 * @param {string} id
 * @param {string} text empty: there is none
 */
function showProblem(id, text) {
  $(id).textContent = text;
  $(id).hidden = !text;
}

/** Ask for the token until the server takes it. @returns {Promise<void>} */
export function askForToken() {
  const [dialog, form] = [$('token-dialog'), $('token-form')];
  showProblem('token-problem', token.get() ? 'The server does not know this token.' : '');
  token.forget();
  dialog.oncancel = (/** @type {Event} */ event) => event.preventDefault();
  if (!dialog.open) dialog.showModal();
  return new Promise((resolve) => {
    form.onsubmit = async (/** @type {Event} */ event) => {
      event.preventDefault();
      token.set(form.elements.token.value);
      try {
        await ask('GET', '/api/v1/buildings');
      } catch (problem) {
        token.forget();
        const isWrong = /** @type {Refusal} */ (problem).status === 401;
        const text = isWrong ? 'The server does not know this token.' : String(problem);
        showProblem('token-problem', text);
        return;
      }
      form.reset();
      dialog.close();
      resolve();
    };
  });
}

/**
 * Let the operator add a building, or a level, or delete what is shown.
 *
 * @param {{ id: string, name: string, is_sample: boolean }} shown
 * @param {(building: any) => void} onDone is told the building, null when it was deleted
 */
export function askForPlan(shown, onDone) {
  const [dialog, form] = [$('upload-dialog'), $('upload-form')];
  form.reset();
  showProblem('upload-problem', '');
  $('delete-building').disabled = shown.is_sample;
  form.onsubmit = async (/** @type {Event} */ event) => {
    event.preventDefault();
    showProblem('upload-problem', '');
    const button = form.querySelector('.primary');
    button.disabled = true;
    try {
      onDone(await upload(form, shown.id));
      dialog.close();
    } catch (problem) {
      showProblem('upload-problem', /** @type {Error} */ (problem).message);
    } finally {
      button.disabled = false;
    }
  };
  $('delete-building').onclick = async () => {
    if (!confirm(`Delete ${shown.name} for good?`)) return;
    try {
      await ask('DELETE', `/api/v1/buildings/${encodeURIComponent(shown.id)}`);
      onDone(null);
      dialog.close();
    } catch (problem) {
      showProblem('upload-problem', /** @type {Error} */ (problem).message);
    }
  };
  dialog.showModal();
}

/**
 * @param {HTMLFormElement} filled
 * @param {string} building that gets the level, if that is wanted
 */
function upload(filled, building) {
  const given = new FormData(filled);
  const form = new FormData();
  for (const name of ['file', 'name', 'level']) form.set(name, given.get(name) ?? '');
  for (const option of String(given.get('option')).split(/\s+/).filter(Boolean)) {
    form.append('option', option);
  }
  if (!given.has('more')) return askJson('POST', '/api/v1/buildings', { form });
  form.delete('name');
  return askJson('POST', `/api/v1/buildings/${encodeURIComponent(building)}/levels`, { form });
}

/** Show the address of the phone's page as a QR code. @param {string} building */
export async function showPhone(building) {
  const ticket = await ticketFor({ role: 'walker', building });
  const about = new URLSearchParams(ticket ? { building, ticket } : { building });
  const address = `${location.origin}/phone/#${about}`;
  const answer = await ask('POST', '/api/v1/codes', { json: { text: address } });
  URL.revokeObjectURL($('code').src);
  $('code').src = URL.createObjectURL(await answer.blob());
  Object.assign($('phone-address'), { href: address, textContent: address });
  $('phone-means').textContent = phoneAdvice(location, ticket !== null);
  $('phone-dialog').showModal();
}

/** Make a link to a recording, and show it. @param {string} recording */
export async function shareRecording(recording) {
  const path = `/api/v1/recordings/${encodeURIComponent(recording)}/links`;
  const { view, expires_in_s } = await askJson('POST', path, { json: { ttl_s: SHARE_S } });
  const address = `${location.origin}/#${new URLSearchParams({ replay: recording, key: view })}`;
  $('share-link').value = address;
  const days = Math.round(expires_in_s / 86_400);
  $('share-means').textContent = `Whoever has this link sees the walk for ${days} days, or `
    + 'until the server stops.';
  $('copy').textContent = 'Copy';
  $('copy').onclick = async () => {
    $('share-link').select();
    try {
      await navigator.clipboard.writeText(address);
      $('copy').textContent = 'Copied';
    } catch {
      $('copy').textContent = 'Press Ctrl-C';
    }
  };
  $('share-dialog').showModal();
}
