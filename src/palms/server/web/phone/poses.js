// Poses of a WebXR session: where they look, what is sent of them, and when.

import { wrapAngle } from './bearings.js';

/** @typedef {{ x: number, y: number, z: number }} Point3 */
/** @typedef {Point3 & { w: number }} Quaternion */

/**
 * @typedef {object} Pose y up, looking along -z, metres
 * @property {Point3} position
 * @property {Quaternion} orientation
 */

const DIGITS = 4; // a tenth of a millimetre
const OFTEN_S = 0.4; // two and a half samples a second while somebody walks
const SELDOM_S = 2; // and one every two seconds while they stand, so that the server knows
const MOVED_M = 0.1;
const TURNED_RAD = (10 * Math.PI) / 180;

/**
 * Return where a pose looks: the bearing on the ground, (x, -z), and the angle above the horizon.
 *
 * @param {Quaternion} q
 */
export function lookOf({ x, y, z, w }) {
  const ahead_x = -2 * (x * z + w * y);
  const ahead_y = -2 * (y * z - w * x);
  const ahead_z = -(1 - 2 * (x * x + y * y));
  const up = Math.asin(Math.max(-1, Math.min(1, ahead_y)));
  return { yaw_rad: Math.atan2(-ahead_z, ahead_x), pitch_rad: up };
}

/**
 * Return the place on the ground, odom frame.
 *
 * @param {Pose} pose
 * @returns {[number, number]}
 */
export function groundOf({ position }) {
  return [position.x, 0 - position.z];
}

/**
 * Return a pose as the server's messages have it.
 *
 * @param {Pose} pose
 */
export function poseMessage({ position: p, orientation: q }) {
  return {
    position: [p.x, p.y, p.z].map(rounded),
    orientation: [q.x, q.y, q.z, q.w].map(rounded),
  };
}

/** @param {number} value */
export function rounded(value) {
  return Number(value.toFixed(DIGITS)) + 0;
}

/**
 * Whether a sample of odometry is due: often while somebody moves, seldom while they stand.
 *
 * @param {{ time_s: number, pose: Pose } | null} last what was sent last
 * @param {{ time_s: number, pose: Pose }} now
 */
export function isDue(last, now) {
  if (!last) return true;
  const since_s = now.time_s - last.time_s;
  if (since_s < OFTEN_S) return false;
  if (since_s >= SELDOM_S) return true;
  const [x0, y0] = groundOf(last.pose);
  const [x, y] = groundOf(now.pose);
  if (Math.hypot(x - x0, y - y0) >= MOVED_M) return true;
  const turn = lookOf(now.pose.orientation).yaw_rad - lookOf(last.pose.orientation).yaw_rad;
  return Math.abs(wrapAngle(turn)) >= TURNED_RAD;
}
