// Which part of the map is on the screen; the middle of rooms; binary frames.
import assert from 'node:assert/strict';
import test from 'node:test';
import { splitFrames, unpackFrame } from '../../../src/palms/server/web/shared/frames.js';
import { boundsOf, middleOf } from '../../../src/palms/server/web/shared/plan.js';
import { fitted, panned, toMap, toScreen, zoomed } from '../../../src/palms/server/web/shared/view.js';

const near = (a, b) => a.forEach((value, i) => assert.ok(Math.abs(value - b[i]) < 1e-9, `${a} ${b}`));
const view = fitted([[0, 0], [80, 40]], { width: 848, height: 600 });

test('a box fits, y upwards, and screen and map are inverse', () => {
  near(toScreen(view, [0, 40]), [24, 100]);
  near(toScreen(view, [80, 0]), [824, 500]);
  near(toMap(view, toScreen(view, [12.3, 4.5])), [12.3, 4.5]);
});

test('what is under the finger stays there', () => {
  const at = [100, 200];
  near(toMap(zoomed(view, 3, at), at), toMap(view, at));
  near(toScreen(panned(view, [10, -20]), [5, 5]), toScreen(view, [5, 5]).map((v, i) => v + [10, -20][i]));
});

test('zoom has ends', () => {
  assert.equal(zoomed(view, 1e9).scale, zoomed(view, 1e12).scale);
  assert.ok(zoomed(view, 1e-9).scale > 0);
});

test('the middle of an L is weighted by area; a line has one, too', () => {
  near(middleOf([[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]]), [9.5 / 7, 9.5 / 7]);
  near(middleOf([[0, 0], [2, 0]]), [1, 0]);
  assert.deepEqual(boundsOf({ segments_m: [[[0, 3], [5, -1]]] }), [[0, -1], [5, 3]]);
});

function particles(n) {
  const buffer = new ArrayBuffer(44 + 5 * n);
  const data = new DataView(buffer);
  data.setUint8(0, 80);
  data.setUint8(1, 70);
  data.setUint8(2, 1);
  data.setUint32(4, n, true);
  data.setFloat64(8, 7, true);
  data.setFloat64(24, 10, true);
  data.setFloat64(32, 20, true);
  data.setFloat32(40, 0.5, true);
  for (let i = 0; i < n; i++) data.setInt16(44 + 4 * i, -2 * i, true);
  for (let i = 0; i < n; i++) data.setUint8(44 + 4 * n + i, i);
  return buffer;
}

test('particles are unpacked; what is cut off or of another version is not', () => {
  const frame = unpackFrame(particles(3));
  assert.deepEqual([...frame.x_m], [10, 9, 8]);
  assert.deepEqual([...frame.y_m], [20, 20, 20]);
  assert.deepEqual([...frame.label], [0, 1, 2]);
  assert.equal(frame.seq, 7);
  assert.equal(unpackFrame(particles(3).slice(0, 50)), null);
  assert.equal(unpackFrame(new ArrayBuffer(2)), null);
  const other = particles(1);
  new DataView(other).setUint8(2, 2);
  assert.equal(unpackFrame(other), null);
});

test('frames of a stream are taken apart, up to where it is cut off', () => {
  const one = new Uint8Array(particles(1));
  const stream = new Uint8Array(2 * (4 + one.length));
  for (const k of [0, 1]) {
    new DataView(stream.buffer).setUint32(k * (4 + one.length), one.length, true);
    stream.set(one, k * (4 + one.length) + 4);
  }
  assert.equal(splitFrames(stream.buffer).length, 2);
  assert.equal(splitFrames(stream.buffer.slice(0, -1)).length, 1);
});
