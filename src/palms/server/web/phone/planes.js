// Planes of a WebXR session: which are walls, which of them can be seen from a place, and how they
// are sent.

import { rounded } from './poses.js';

/** @typedef {import('./poses.js').Pose} Pose */
/** @typedef {import('./poses.js').Point3} Point3 */
/** @typedef {[number, number]} Place on the ground, odom frame, metres */

/**
 * @typedef {object} Plane
 * @property {Pose} pose y is its normal
 * @property {Point3[]} polygon in the plane's own space, y = 0
 * @property {string} [orientation]
 * @property {string} [semanticLabel]
 */

const UPRIGHT = 0.3; // sine of 17 degrees: a normal that rises more than that is no wall's
const NO_WALLS = new Set(['floor', 'ceiling', 'table', 'desk', 'couch', 'bed', 'lamp', 'plant']);
const SHORTEST_M = 0.2;
const RAYS = 360;
const BEFORE_M = 0.4; // a cupboard or a picture this near before a wall does not hide it
const MOST = 300; // the server takes 400 walls

/**
 * Turn a vector by a quaternion.
 *
 * @param {import('./poses.js').Quaternion} q
 * @param {Point3} v
 * @returns {Point3}
 */
function turned(q, v) {
  const tx = 2 * (q.y * v.z - q.z * v.y);
  const ty = 2 * (q.z * v.x - q.x * v.z);
  const tz = 2 * (q.x * v.y - q.y * v.x);
  return {
    x: v.x + q.w * tx + q.y * tz - q.z * ty,
    y: v.y + q.w * ty + q.z * tx - q.x * tz,
    z: v.z + q.w * tz + q.x * ty - q.y * tx,
  };
}

/**
 * Return a plane's trace on the ground; null when it is no wall: it lies, or is called otherwise,
 * or is too small.
 *
 * @param {Plane} plane
 * @returns {[Place, Place] | null}
 */
export function wallOf({ pose, polygon, semanticLabel }) {
  if (NO_WALLS.has(semanticLabel ?? '') || polygon.length < 3) return null;
  const normal = turned(pose.orientation, { x: 0, y: 1, z: 0 });
  if (Math.abs(normal.y) > UPRIGHT) return null;
  const flat = Math.hypot(normal.x, normal.z);
  const along = [-normal.z / flat, normal.x / flat]; // of (x, z): level, in the plane
  const reach = polygon.map((corner) => {
    const { x, z } = turned(pose.orientation, corner);
    return x * along[0] + z * along[1];
  });
  const [from, to] = [Math.min(...reach), Math.max(...reach)];
  if (to - from < SHORTEST_M) return null;
  const end = (/** @type {number} */ t) => /** @type {Place} */ ([
    pose.position.x + t * along[0],
    0 - (pose.position.z + t * along[1]),
  ]);
  return [end(from), end(to)];
}

/**
 * Return which walls can be seen from a place: a scan tells what is seen from one point, and a
 * session remembers walls of rooms that somebody left long ago.
 *
 * @param {[Place, Place][]} walls
 * @param {Place} place
 * @returns {boolean[]}
 */
export function seenFrom(walls, place) {
  const isSeen = walls.map(() => false);
  for (let ray = 0; ray < RAYS; ray++) {
    const bearing = (2 * Math.PI * ray) / RAYS;
    const ranges = walls.map((wall) => rangeTo(wall, place, bearing));
    const first = Math.min(...ranges);
    ranges.forEach((range, i) => {
      if (range <= first + BEFORE_M && range < Infinity) isSeen[i] = true;
    });
  }
  return isSeen;
}

/**
 * Return how far it is to a wall along a bearing; Infinity when it is not hit.
 *
 * @param {[Place, Place]} wall
 * @param {Place} place
 * @param {number} bearing_rad
 */
function rangeTo([[ax, ay], [bx, by]], [x, y], bearing_rad) {
  const [dx, dy] = [Math.cos(bearing_rad), Math.sin(bearing_rad)];
  const [ex, ey] = [bx - ax, by - ay];
  const cross = dx * ey - dy * ex;
  if (Math.abs(cross) < 1e-12) return Infinity;
  const range = ((ax - x) * ey - (ay - y) * ex) / cross;
  const t = ((ax - x) * dy - (ay - y) * dx) / cross;
  return range >= 0 && t >= 0 && t <= 1 ? range : Infinity;
}

/**
 * Return the planes that are walls in sight of a place, as the server's messages have them
 * (form `webxr`); the largest, when there are too many.
 *
 * @param {Plane[]} planes
 * @param {Place} place
 */
export function wallPlanes(planes, place) {
  const upright = planes.flatMap((plane) => {
    const wall = wallOf(plane);
    return wall ? [{ plane, wall }] : [];
  });
  const isSeen = seenFrom(upright.map(({ wall }) => wall), place);
  return upright
    .filter((_, i) => isSeen[i])
    .sort((a, b) => lengthOf(b.wall) - lengthOf(a.wall))
    .slice(0, MOST)
    .map(({ plane }) => planeMessage(plane));
}

/** @param {[Place, Place]} wall */
function lengthOf([[ax, ay], [bx, by]]) {
  return Math.hypot(bx - ax, by - ay);
}

/** @param {Plane} plane */
function planeMessage({ pose, polygon, semanticLabel }) {
  const { position: p, orientation: q } = pose;
  return {
    orientation: 'vertical',
    ...(semanticLabel ? { semanticLabel } : {}),
    polygon: polygon.map(({ x, y, z }) => ({ x: rounded(x), y: rounded(y), z: rounded(z) })),
    pose: {
      position: { x: rounded(p.x), y: rounded(p.y), z: rounded(p.z) },
      orientation: { x: q.x, y: q.y, z: q.z, w: q.w },
    },
  };
}
