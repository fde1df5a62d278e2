// Poses and planes: where they look, which are walls, which are in sight, what is sent.
import assert from 'node:assert/strict';
import test from 'node:test';
import { seenFrom, wallOf, wallPlanes } from '../../../src/palms/server/web/phone/planes.js';
import {
  groundOf, isDue, lookOf, poseMessage,
} from '../../../src/palms/server/web/phone/poses.js';

const HALF = Math.SQRT1_2;
const LYING = { x: 0, y: 0, z: 0, w: 1 };
const square = (half) => [[-half, -1], [half, -1], [half, 1], [-half, 1]]
  .map(([x, z]) => ({ x, y: 0, z }));

/** A wall seen from the south: 2 m wide, its middle at (x, z). */
const wall = (x, z, fields) => ({
  pose: { position: { x, y: 1, z }, orientation: { x: HALF, y: 0, z: 0, w: HALF } },
  polygon: square(1), ...fields,
});

/** Upright, looking along a bearing. */
const about = (yaw_rad) => {
  const half = (yaw_rad - Math.PI / 2) / 2;
  return { x: 0, y: Math.sin(half), z: 0, w: Math.cos(half) };
};

test('a pose looks along -z; on the ground that is (x, -z)', () => {
  const { yaw_rad, pitch_rad } = lookOf(LYING);
  assert.ok(yaw_rad === Math.PI / 2 && Math.abs(pitch_rad) === 0);
  for (const yaw of [-3, -1, 0, 0.5, 2]) {
    assert.ok(Math.abs(lookOf(about(yaw)).yaw_rad - yaw) < 1e-12);
  }
  const up = { x: Math.sin(0.2), y: 0, z: 0, w: Math.cos(0.2) };
  assert.ok(Math.abs(lookOf(up).pitch_rad - 0.4) < 1e-12);
  assert.deepEqual(groundOf({ position: { x: 1, y: 2, z: 3 }, orientation: LYING }), [1, -3]);
});

test('a pose is sent to a tenth of a millimetre, and never as -0', () => {
  const sent = poseMessage({
    position: { x: 1.23456789, y: -0.00000001, z: 0 }, orientation: LYING,
  });
  assert.equal(JSON.stringify(sent), '{"position":[1.2346,0,0],"orientation":[0,0,0,1]}');
});

test('samples are due often while one moves or turns, seldom while one stands', () => {
  const at = (time_s, x, yaw = 0) =>
    ({ time_s, pose: { position: { x, y: 0, z: 0 }, orientation: about(yaw) } });
  assert.equal(isDue(null, at(0, 0)), true);
  const due = (later) => isDue(at(0, 0, 3.1), later);
  assert.deepEqual([due(at(0.3, 5)), due(at(0.4, 0.5, 3.1)), due(at(0.4, 0.05, 3.1))],
    [false, true, false]);
  assert.deepEqual([due(at(0.5, 0, -3.1)), due(at(0.5, 0, -2.9)), due(at(2, 0, 3.1))],
    [false, true, true]);
});

test('an upright plane is a wall from end to end', () => {
  const [a, b] = wallOf(wall(2, -3)).sort(([x], [y]) => x - y);
  assert.ok(Math.hypot(a[0] - 1, a[1] - 3) < 1e-9 && Math.hypot(b[0] - 3, b[1] - 3) < 1e-9);
});

test('what lies, or is called a table, or is tiny, is none', () => {
  const lying = { ...wall(0, 0), pose: { position: { x: 0, y: 0, z: 0 }, orientation: LYING } };
  assert.equal(wallOf(lying), null);
  assert.equal(wallOf(wall(0, 0, { semanticLabel: 'table' })), null);
  assert.equal(wallOf(wall(0, 0, { polygon: square(0.05) })), null);
  assert.ok(wallOf(wall(0, 0, { semanticLabel: 'door' })));
  assert.equal(wallOf(wall(0, 0, { polygon: [] })), null);
});

test('a wall turned about the vertical keeps its length', () => {
  const [c, s] = [HALF * Math.cos(0.35), HALF * Math.sin(0.35)];
  const pose = { position: { x: 0, y: 1, z: -2 }, orientation: { x: c, y: s, z: -s, w: c } };
  const [[ax, ay], [bx, by]] = wallOf({ ...wall(0, -2), pose });
  assert.ok(Math.abs(Math.atan2(by - ay, bx - ax) % Math.PI) > 0.6);
  assert.ok(Math.abs(Math.hypot(bx - ax, by - ay) - 2) < 1e-6);
});

test('a wall behind another is not in sight; a picture before one hides nothing', () => {
  const near = [[-2, 2], [2, 2]];
  const behind = [[-1, 5], [1, 5]];
  const picture = [[-2, 1.8], [2, 1.8]];
  const beside = [[4, -1], [4, 1]];
  assert.deepEqual(seenFrom([near, behind, beside], [0, 0]), [true, false, true]);
  assert.deepEqual(seenFrom([near, behind, picture], [0, 0]), [true, false, true]);
  assert.deepEqual(seenFrom([], [0, 0]), []);
});

test('what is sent are the walls in sight, the largest first, as the server reads them', () => {
  const planes = [
    wall(0, -6), wall(0, -2, { polygon: square(3), semanticLabel: 'wall' }), wall(4, 0),
    { ...wall(0, 0), pose: { position: { x: 0, y: 0, z: 0 }, orientation: LYING } },
  ];
  const sent = wallPlanes(planes, [0, 0]);
  assert.deepEqual(sent.map(({ pose }) => [pose.position.x, pose.position.z]), [[0, -2]]);
  assert.deepEqual(Object.keys(sent[0]), ['orientation', 'semanticLabel', 'polygon', 'pose']);
  assert.equal(sent[0].orientation, 'vertical');
});
