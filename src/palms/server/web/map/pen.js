// Pen: the path of a walk while it is drawn. Paths are values: points of the map, in metres.

/** @typedef {import('../shared/view.js').Point} Point */
/** @typedef {[Point, Point]} Segment */

const SPACING_M = 0.25; // points of a path are at least so far apart
const BLOCKING = new Set(['wall', 'glass']);

/**
 * Return the segments of a plan that stop a walker.
 *
 * @param {import('../shared/plan.js').Plan} plan
 * @returns {Segment[]}
 */
export function wallsOf(plan) {
  return plan.segments_m.filter((_, i) => BLOCKING.has(plan.classes[i]));
}

/**
 * @param {Point} o
 * @param {Point} a
 * @param {Point} b
 */
const turn = (o, a, b) => (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);

/**
 * Whether two segments meet; those that only touch do, too.
 *
 * @param {Segment} one
 * @param {Segment} other
 */
export function meet([a, b], [c, d]) {
  if (Math.max(a[0], b[0]) < Math.min(c[0], d[0]) || Math.max(c[0], d[0]) < Math.min(a[0], b[0])) {
    return false;
  }
  if (Math.max(a[1], b[1]) < Math.min(c[1], d[1]) || Math.max(c[1], d[1]) < Math.min(a[1], b[1])) {
    return false;
  }
  return turn(a, b, c) * turn(a, b, d) <= 0 && turn(c, d, a) * turn(c, d, b) <= 0;
}

/**
 * Whether a walker can go straight from one point to another.
 *
 * @param {Point} from
 * @param {Point} to
 * @param {Segment[]} walls
 */
export function isOpen(from, to, walls) {
  return !walls.some((wall) => meet([from, to], wall));
}

/**
 * Return a path that goes on to a point; null when a wall is in the way. A point that is too near
 * to the last one changes nothing.
 *
 * @param {Point[]} path
 * @param {Point} point
 * @param {Segment[]} walls
 * @returns {Point[] | null}
 */
export function extended(path, point, walls) {
  const last = path.at(-1);
  if (!last) return [point];
  if (Math.hypot(point[0] - last[0], point[1] - last[1]) < SPACING_M) return path;
  return isOpen(last, point, walls) ? [...path, point] : null;
}

/** Length of a path in metres. @param {Point[]} path */
export function lengthOf(path) {
  return path.slice(1).reduce(
    (sum, [x, y], i) => sum + Math.hypot(x - path[i][0], y - path[i][1]),
    0,
  );
}

/**
 * Return a path without its last metres: where a stroke began, or one point.
 *
 * @param {Point[]} path
 * @param {number[]} strokes number of points at the beginning of each stroke
 */
export function undone(path, strokes) {
  return path.slice(0, strokes.at(-1) ?? 0);
}
