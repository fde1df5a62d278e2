// Before the walk: which building, and who lets the phone in.

import { askJson, ticketFor, token } from '../shared/rest.js';
import { element, fillChoices, showProblem } from './screens.js';

/**
 * @typedef {object} Level
 * @property {string} name
 *
 * @typedef {object} Building
 * @property {string} id
 * @property {string} name
 * @property {Level[]} levels
 */

/**
 * @typedef {object} Invitation what the page's address carries behind its #
 * @property {string | null} ticket good once; it names the building itself
 * @property {string | null} building to be offered first
 */

/**
 * Return what an address carries, and take it out of there.
 *
 * @param {{ hash: string, pathname: string }} place such as `location`
 * @param {{ replaceState: Function }} past such as `history`
 * @returns {Invitation}
 */
export function takeInvitation(place, past) {
  const found = new URLSearchParams(place.hash.slice(1));
  if (place.hash) past.replaceState(null, '', place.pathname);
  return { ticket: found.get('ticket'), building: found.get('building') };
}

export class Entrance {
  /** @type {Building[]} */ buildings = [];

  /**
   * @param {import('./texts.js').Texts} texts
   * @param {Invitation} invitation
   */
  constructor(texts, { ticket, building }) {
    this.texts = texts;
    this.ticket = ticket;
    this.offered = building;
    const [list, other] = [element('building'), element('other-building')];
    list.addEventListener('change', () => this.#showLevels());
    other.addEventListener('change', () => {
      list.value = other.value;
      this.#showLevels();
    });
    element('token-form').addEventListener('submit', (/** @type {Event} */ event) => {
      event.preventDefault();
      token.set(element('token').value);
      this.ticket = null;
      this.open();
    });
  }

  /** Find out which buildings may be chosen. A ticket says it itself. */
  async open() {
    for (const id of ['choose-problem', 'other-problem']) showProblem(id);
    if (this.ticket) return;
    try {
      this.buildings = (await askJson('GET', '/api/v1/buildings')).buildings;
    } catch (problem) {
      const { status } = /** @type {{ status: number }} */ (/** @type {unknown} */ (problem));
      this.refuse(status === 401 ? 'choose.needTicket' : 'choose.noServer');
      return;
    }
    if (this.buildings.length === 0) this.refuse('choose.noBuilding');
    this.#showBuildings();
  }

  /** @param {string} key of the text that says why not */
  refuse(key) {
    for (const id of ['choose-problem', 'other-problem']) showProblem(id, this.texts.of(key));
    element('token-details').hidden = !key.endsWith('Ticket');
  }

  #showBuildings() {
    const choices = this.buildings.map(({ id, name }) => ({ value: id, text: name }));
    for (const id of ['building', 'other-building']) {
      fillChoices(element(id), choices);
      if (choices.some(({ value }) => value === this.offered)) element(id).value = this.offered;
      element(`${id}-field`).hidden = choices.length === 0;
    }
    this.#showLevels();
  }

  #showLevels() {
    const levels = this.#chosen()?.levels ?? [];
    fillChoices(element('level'), levels.map(({ name }) => ({ value: name, text: name })));
    element('level-field').hidden = levels.length < 2;
  }

  #chosen() {
    return this.buildings.find(({ id }) => id === element('building').value);
  }

  /** Whether somebody could start now. */
  get isReady() {
    return Boolean(this.ticket ?? this.#chosen());
  }

  /** What hello says of the place. */
  get terms() {
    if (this.ticket) return {};
    return { building: element('building').value, level: element('level').value || null };
  }

  /** The ticket has let somebody in; it does so once. */
  spend() {
    this.ticket = null;
  }

  /** A one-time ticket for hello, where the server wants one. */
  async newTicket() {
    return this.ticket ?? ticketFor({ role: 'walker', building: element('building').value });
  }
}
