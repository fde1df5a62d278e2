// What the map page computes before it draws: words, groups, strokes, stories, time.
import assert from 'node:assert/strict';
import test from 'node:test';
import { phoneAdvice } from '../../../src/palms/server/web/map/advice.js';
import { driftsOf, groupOf, grouped, labelsIn } from '../../../src/palms/server/web/map/groups.js';
import {
  extended, isOpen, lengthOf, meet, undone, wallsOf,
} from '../../../src/palms/server/web/map/pen.js';
import { Sketch } from '../../../src/palms/server/web/map/sketch.js';
import { Story } from '../../../src/palms/server/web/map/story.js';
import { indexAt, stretches } from '../../../src/palms/server/web/map/timeline.js';
import {
  atMost, clock, degrees, eventSentence, percent, placeSentence, stepSentence,
} from '../../../src/palms/server/web/map/words.js';
import { isIn, turnOf } from '../../../src/palms/server/web/shared/plan.js';

const STEP = {
  seq: 2, t_s: 75, stage: 'localized', x_m: 1, y_m: 2, room: 'Lobby', radius_95_m: 1.21,
  p_within_1m: 0.8765,
};

test('shares are never certain when they are not', () => {
  assert.deepEqual([0, 0.001, 0.5, 0.999, 1].map(percent),
    ['0 %', 'below 1 %', '50 %', 'above 99 %', '100 %']);
});

test('distances are rounded up', () => {
  assert.deepEqual([0.91, 1.2, 2.95, 3.2, 12].map(atMost), ['1.0 m', '1.2 m', '3.0 m', '4 m', '12 m']);
});

test('times and angles are written for people', () => {
  assert.deepEqual([0, 59.6, 3600].map(clock), ['0:00', '1:00', '60:00']);
  assert.equal(degrees(-Math.PI / 2), '−90°');
});

test('a place is told only once it is localized, with how sure it is', () => {
  assert.equal(placeSentence(STEP), 'Lobby, within 1.3 m');
  const places = [{ p: 0.4 }, { p: 0.3 }, { p: 0.01 }];
  const searching = { ...STEP, stage: 'searching', hypotheses: places };
  assert.equal(placeSentence(searching), '2 places likely');
  assert.equal(placeSentence({ ...searching, hypotheses: [], x_m: null }), 'Waiting for a scan');
  assert.equal(stepSentence(STEP, 75), '1:15: Localized, Lobby, within 1.3 m, 88 % within 1 metre');
  assert.equal(eventSentence({ kind: 'localized' }, STEP), 'Localized: Lobby, within 1.3 m.');
  assert.match(eventSentence({ kind: 'lost' }, STEP), /^Lost\. /);
  assert.equal(eventSentence({ kind: 'danced' }), 'danced.');
});

test('labels go round the circle: a quarter is a group', () => {
  assert.deepEqual([0, 3, 4, 15].map((label) => groupOf(label, 16)), [0, 0, 1, 3]);
  assert.deepEqual([0, 1, 2, 3].map((label) => groupOf(label, 4)), [0, 1, 2, 3]);
  assert.deepEqual([0, 71].map((label) => groupOf(label, 72)), [0, 3]);
  const cloud = { label: Uint8Array.of(0, 5, 15, 4) };
  assert.deepEqual(grouped(cloud, 16), [[0], [1, 3], [], [2]]);
  assert.equal(labelsIn([], cloud), 16);
  assert.equal(labelsIn([{ n_labels: 72 }], cloud), 72);
});

test('one map tells the drifts of all groups', () => {
  const drifts = driftsOf([{ label: 5, n_labels: 16, drift_rad: 2 }]);
  assert.deepEqual(drifts.map((each) => each.toFixed(2)), ['0.43', '2.00', '-2.71', '-1.14']);
  assert.deepEqual(driftsOf([]), []);
});

const WALLS = [[[2, -1], [2, 1]]];

test('a stroke goes on up to a wall, and round it', () => {
  assert.equal(isOpen([0, 0], [1, 0], WALLS), true);
  assert.equal(isOpen([0, 0], [3, 0], WALLS), false);
  assert.equal(isOpen([0, 0], [2, 0], WALLS), false, 'touching is meeting');
  assert.equal(meet([[0, 0], [1, 1]], [[5, 5], [6, 6]]), false);
  const start = extended([], [0, 0], WALLS);
  assert.equal(extended(start, [0.1, 0], WALLS), start, 'too near to matter');
  assert.equal(extended(start, [3, 0], WALLS), null);
  assert.equal(lengthOf(extended(extended(start, [0, 2], WALLS), [3, 2], WALLS)), 5);
  assert.deepEqual(undone([[0, 0], [1, 0], [2, 0]], [0, 1]), [[0, 0]]);
});

test('doors and openings let a walker through', () => {
  const segments_m = [1, 2, 3, 4].map((x) => [[x, 0], [x, 1]]);
  const classes = ['wall', 'door', 'opening', 'glass'];
  assert.deepEqual(wallsOf({ segments_m, classes }), [segments_m[0], segments_m[3]]);
});

test('a sketch by keys: the cross, the start, steps, a wall, and back', () => {
  const sketch = new Sketch();
  sketch.begin({ segments_m: WALLS, classes: ['wall'] });
  let n = 0;
  sketch.addEventListener('blocked', () => { n++; });
  sketch.step([-1, 0], false, [1, 0]);
  assert.deepEqual(sketch.cursor, [0, 0]);
  sketch.start();
  sketch.step([1, 0], true, [9, 9]);
  assert.equal(n, 1);
  sketch.step([0, 1], false, [9, 9]);
  assert.deepEqual(sketch.path, [[0, 0], [0, 0.65]]);
  sketch.undo();
  sketch.undo();
  assert.deepEqual(sketch.path, []);
});

function cloudFrame(seq) {
  const data = new DataView(new ArrayBuffer(49));
  [80, 70, 1].forEach((byte, i) => data.setUint8(i, byte));
  data.setUint32(4, 1, true);
  data.setFloat64(8, seq, true);
  return data.buffer;
}

test('a story keeps steps in order, and what came before its viewer', () => {
  const story = new Story({ title: 'x', level: '1', truth_m: [[0, 0], [1, 0]] });
  story.addStep({ ...STEP, seq: 3, t_s: 12 });
  story.addStep({ ...STEP, seq: 3, t_s: 12, room: 'again' });
  story.addStep({ ...STEP, seq: 2, t_s: 11 });
  story.addPath({ t_s: [10, 11, 12], x_m: [null, 1, 2], y_m: [null, 1, 2], stage: ['searching', 'oriented', 'lost'] });
  assert.deepEqual(story.steps.map(({ seq, stage }) => [seq, stage]),
    [[1, 'searching'], [2, 'oriented'], [3, 'localized']]);
  assert.equal(story.steps[2].room, 'again');
  assert.equal(story.since(story.steps[2]), 2);
  assert.deepEqual(story.truthAt(2), [1, 0]);
  assert.equal(story.truthAt(3), null);
});

test('a moment has the particles and maps of its time', () => {
  const story = new Story({ title: 'x', level: '1' });
  for (const seq of [1, 4]) story.addFrame(cloudFrame(seq));
  assert.deepEqual([0, 1, 3, 9].map((seq) => story.cloudAt(seq)?.seq), [undefined, 1, 1, 4]);
  for (const [seq, number] of [[1, 1], [1, 0], [6, 0], [6, 0]]) story.addHeatmap({ seq, number });
  assert.deepEqual(story.heatmapsAt(5).map(({ number }) => number), [0, 1]);
  assert.equal(story.heatmapsAt(6).length, 1);
  assert.equal(story.heatmapsAt(0).length, 0);
});

test('time leads to the last step that is not after it; stages lie in stretches', () => {
  const steps = [1, 2, 4].map((t_s, i) => ({ t_s, stage: i < 2 ? 'searching' : 'localized' }));
  assert.deepEqual([0, 1, 2.5, 4, 9].map((t_s) => indexAt(steps, t_s)), [0, 0, 1, 2, 2]);
  assert.equal(indexAt([], 3), 0);
  assert.deepEqual(stretches(steps),
    [{ stage: 'searching', from: 0, to: 1 }, { stage: 'localized', from: 2, to: 2 }]);
});

test('names lie along narrow rooms, never upside down', () => {
  const corridor = [[0, 0], [-10, 10], [-11, 9], [-1, -1]];
  assert.equal(turnOf(corridor).toFixed(3), (-Math.PI / 4).toFixed(3));
  assert.equal(turnOf([[0, 0], [4, 0], [4, 3], [0, 3]]), 0);
  assert.ok(isIn(corridor, [-5, 4.9]));
  assert.ok(!isIn(corridor, [5, 5]));
});

test('what a phone needs to open the page is said', () => {
  const advice = (hostname, protocol) => phoneAdvice({ hostname, protocol }, false);
  assert.match(advice('127.0.0.1', 'https:'), /this machine alone/);
  assert.match(advice('localhost', 'http:'), /this machine alone/);
  assert.match(advice('10.0.0.2', 'http:'), /--tls/);
  assert.match(advice('10.0.0.2', 'https:'), /^Scan the code/);
  assert.match(phoneAdvice({ hostname: 'a.local', protocol: 'https:' }, true), /one session/);
});
