// The turn for a scan: which bearings count, which side is next, what is said.
import assert from 'node:assert/strict';
import test from 'node:test';
import {
  NOTHING_SEEN, isWhole, looked, nextSide, share, wrapAngle,
} from '../../../src/palms/server/web/phone/bearings.js';
import { guided, newGuide } from '../../../src/palms/server/web/phone/guide.js';

const DEGREE = Math.PI / 180;

/** Look along bearings in degrees, some seconds apart. */
function turned(degrees, { from = NOTHING_SEEN, apart_s = 1, pitch = 0, start_s = 0 } = {}) {
  return degrees.reduce((bearings, degree, i) => looked(bearings, {
    yaw_rad: wrapAngle(degree * DEGREE), pitch_rad: pitch * DEGREE, time_s: start_s + i * apart_s,
  }), from);
}

const round = (step, to = 360) => Array.from({ length: to / step + 1 }, (_, i) => i * step);

test('a look covers what the camera sees: 50 degrees of 360', () => {
  assert.ok(Math.abs(share(turned([10])) - 50 / 360) < 0.02);
  assert.equal(isWhole(turned([10])), false);
});

for (const [how, degrees] of Object.entries({
  'to the left': round(30),
  'to the right': round(30).map((degree) => -degree),
  'forth and back': [...round(20, 180), ...round(20, 180).map((degree) => -degree)],
  'by many small steps': round(2),
})) {
  test(`a whole turn is a whole turn ${how}`, () => {
    assert.ok(isWhole(turned(degrees)));
  });
}

test('a turn goes on where it was left off, however long the pause', () => {
  const half = turned(round(30, 180));
  const rest = turned(round(30, 180).map((degree) => 180 + degree), { from: half, start_s: 900 });
  assert.ok(!isWhole(half) && isWhole(rest));
});

test('what is seen never becomes less, whatever comes', () => {
  let [bearings, before, seed] = [NOTHING_SEEN, 0, 7];
  for (let i = 0; i < 500; i++) {
    seed = (seed * 48271) % 2147483647;
    bearings = looked(bearings, {
      yaw_rad: wrapAngle(seed / 1e6), pitch_rad: Math.sin(seed), time_s: i / 10,
    });
    assert.ok(share(bearings) >= before);
    before = share(bearings);
  }
});

test('who turns too quickly, or looks at floor or ceiling, has seen nothing, and is told', () => {
  const quick = turned([0, 90, 180, 270], { apart_s: 0.3 });
  assert.equal(quick.pace, 'quick');
  assert.equal(share(quick), share(turned([0])));
  const steep = turned(round(30), { pitch: -60 });
  assert.deepEqual([steep.pace, share(steep)], ['steep', 0]);
});

test('the next side is on, the way that one turns, else where the nearest gap is', () => {
  assert.equal(nextSide(turned(round(20, 120))), 'left');
  assert.equal(nextSide(turned(round(20, 120).map((degree) => -degree))), 'right');
  const nearlyAll = turned(round(10, 300));
  const back = turned([300, 290, 280], { from: nearlyAll, start_s: 100 });
  assert.equal(nextSide(back), 'left');
  assert.equal(nextSide(turned(round(10))), null);
});

/** What is said during a turn, as [time, key]; one look a second. */
function told(degrees, { nWalls = 3, pitch = 0 } = {}) {
  let [guide, bearings, ticks, done] = [newGuide(0), NOTHING_SEEN, 0, null];
  const said = [];
  degrees.forEach((degree, second) => {
    bearings = turned([degree], { from: bearings, start_s: second, pitch });
    const [after, cue] = guided(guide, bearings, nWalls, second);
    guide = after;
    ticks += Number(cue.tick);
    if (cue.say) said.push([second, cue.say]);
    if (cue.done) done ??= second;
  });
  return { said, ticks, done };
}

test('quarters are said once each, twelve ticks sound, and then it is done', () => {
  const { said, ticks, done } = told(round(10));
  assert.deepEqual(said.map(([, key]) => key), ['scan.quarter', 'scan.half', 'scan.threeQuarters']);
  assert.equal(ticks, 12);
  assert.ok(done > 25 && done <= 36);
});

test('who stands still is reminded every eight seconds, and told the side', () => {
  const { said } = told([...round(10, 40), ...Array(30).fill(40)]);
  const reminders = said.filter(([, key]) => key === 'scan.goOn.left').map(([second]) => second);
  assert.ok(reminders.length >= 3);
  reminders.slice(1).forEach((second, i) => assert.ok(second - reminders[i] >= 8));
});

test('without a wall it is never done, and says why', () => {
  const { said, done } = told([...round(10), ...round(10)], { nWalls: 0 });
  assert.equal(done, null);
  assert.ok(said.some(([, key]) => key === 'scan.noWalls'));
});

test('who looks down is asked to hold the phone upright', () => {
  assert.deepEqual(told(round(10), { pitch: 70 }).said.slice(0, 1), [[8, 'scan.upright']]);
});
