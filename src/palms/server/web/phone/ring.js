// The ring that fills while somebody turns: a picture of what the voice says, ahead being up.

import { bearingOf } from './bearings.js';

const SVG = 'http://www.w3.org/2000/svg';
const RADIUS = 84;
const INNER = 62;
const GAP = 0.12; // of a sector, between two
const DEGREES = 180 / Math.PI;

/** @typedef {import('./bearings.js').Bearings} Bearings */

export class Ring {
  /** @type {SVGElement[]} */ #sectors = [];
  #wheel;
  #percent;

  /** @param {HTMLElement} host an empty element with the role progressbar */
  constructor(host) {
    this.host = host;
    const svg = shape('svg', { viewBox: '-100 -100 200 200', 'aria-hidden': 'true' });
    this.#wheel = shape('g', { class: 'wheel' });
    svg.append(this.#wheel, shape('path', { class: 'ahead', d: 'M0-98 8-88H-8Z' }));
    this.#percent = shape('text', { class: 'percent', y: '14', 'text-anchor': 'middle' });
    svg.append(this.#percent);
    host.append(svg);
  }

  /**
   * @param {Bearings} bearings
   * @param {number} percent
   */
  show({ seen, last }, percent) {
    if (this.#sectors.length === 0) {
      this.#sectors = seen.map((_, sector) => sectorShape(sector, seen.length));
      this.#wheel.append(...this.#sectors);
    }
    seen.forEach((is, sector) => this.#sectors[sector].classList.toggle('seen', is));
    const yaw = last?.yaw_rad ?? 0;
    this.#wheel.setAttribute('transform', `rotate(${(yaw * DEGREES - 90).toFixed(1)})`);
    this.#percent.textContent = `${percent} %`;
    this.host.setAttribute('aria-valuenow', String(percent));
  }
}

/**
 * @param {number} sector
 * @param {number} of
 */
function sectorShape(sector, of) {
  const half = ((1 - GAP) * Math.PI) / of;
  const [from, to] = [bearingOf(sector) - half, bearingOf(sector) + half];
  const at = (/** @type {number} */ r, /** @type {number} */ bearing) =>
    `${(r * Math.cos(bearing)).toFixed(2)} ${(-r * Math.sin(bearing)).toFixed(2)}`;
  return shape('path', {
    class: 'sector',
    d: `M${at(INNER, from)}L${at(RADIUS, from)}A${RADIUS} ${RADIUS} 0 0 0 ${at(RADIUS, to)}` +
      `L${at(INNER, to)}A${INNER} ${INNER} 0 0 1 ${at(INNER, from)}Z`,
  });
}

/**
 * @param {string} name
 * @param {Record<string, string>} attributes
 */
function shape(name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  return /** @type {SVGElement} */ (element);
}
