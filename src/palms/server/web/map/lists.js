// Lists: who walks now, and what was recorded; for the operator.

import { ask, askJson } from '../shared/rest.js';
import { made } from './panel.js';
import { STAGES } from './words.js';

/** @param {string} id @returns {any} */
const $ = (id) => document.getElementById(id);

/** When something was, for a person. @param {number} seconds since 1970 */
export function when(seconds) {
  return new Date(seconds * 1000).toLocaleString([], { dateStyle: 'medium', timeStyle: 'short' });
}

/**
 * @param {any} each a session or a recording
 * @param {(id: string) => string} nameOf its building
 */
function titleOf(each, nameOf) {
  return nameOf(each.building) + (each.level ? `, level ${each.level}` : '');
}

/**
 * @param {string} title
 * @param {string} more
 * @param {[string, () => void][]} actions
 */
function entry(title, more, actions) {
  const item = document.createElement('li');
  const words = made('p', title);
  words.append(Object.assign(made('span', more), { className: 'muted' }));
  const row = Object.assign(document.createElement('div'), { className: 'row' });
  row.append(...actions.map(([name, does]) => {
    const button = Object.assign(made('button', name), { type: 'button', onclick: does });
    button.setAttribute('aria-label', `${name}: ${title}, ${more}`);
    return button;
  }));
  item.append(words, row);
  return item;
}

/**
 * Replace a list's entries, unless they are the same or one of them has the focus.
 *
 * @param {HTMLElement} list
 * @param {HTMLElement[]} entries
 */
function refill(list, entries) {
  const isSame = list.textContent === entries.map((each) => each.textContent).join('');
  if (isSame && list.childElementCount === entries.length) return;
  list.replaceChildren(...entries);
}

/** @param {any} session as in the list of sessions */
function stageOf({ stage, is_connected }) {
  if (!is_connected) return 'its phone is away';
  const known = STAGES[/** @type {keyof typeof STAGES} */ (stage)];
  return known ? known.word.toLowerCase() : 'waiting';
}

/**
 * Show who walks now: those whose phone is there first, and the newest of them.
 *
 * @param {(id: string) => string} nameOf a building
 * @param {(session: string) => void} watch
 */
export async function showSessions(nameOf, watch) {
  const { sessions } = await askJson('GET', '/api/v1/sessions');
  const inOrder = sessions.toSorted((/** @type {any} */ a, /** @type {any} */ b) =>
    b.is_connected - a.is_connected || b.created_s - a.created_s);
  refill($('sessions'), inOrder.map((/** @type {any} */ each) => {
    const looking = each.n_viewers ? `, ${each.n_viewers} looking on` : '';
    const more = `${stageOf(each)}, since ${when(each.created_s)}${looking}`;
    const title = titleOf(each, nameOf);
    return entry(title, more, [['Watch', () => watch(each.session)]]);
  }));
  $('no-sessions').hidden = sessions.length > 0;
}

/**
 * Show what was recorded.
 *
 * @param {(id: string) => string} nameOf a building
 * @param {(recording: string) => void} replay
 * @param {(recording: string) => void} share
 */
export async function showRecordings(nameOf, replay, share) {
  const { recordings } = await askJson('GET', '/api/v1/recordings');
  const again = () => showRecordings(nameOf, replay, share);
  refill($('recordings'), recordings.toReversed().map((/** @type {any} */ each) => {
    const title = titleOf(each, nameOf);
    const more = `${when(each.created_s)}, ${each.n_inputs} messages`;
    return entry(title, more, [
      ['Replay', () => replay(each.recording)],
      ['Share', () => share(each.recording)],
      ['Delete', async () => {
        if (!confirm(`Delete this recording for good? ${title}, ${more}`)) return;
        await ask('DELETE', `/api/v1/recordings/${each.recording}`);
        again();
      }],
    ]);
  }));
  $('no-recordings').hidden = recordings.length > 0;
}
