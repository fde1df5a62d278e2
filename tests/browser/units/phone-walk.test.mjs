// A walk without a page: what is sent, and when, through turns, pauses, gaps and new frames.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Walk } from '../../../src/palms/server/web/phone/walk.js';

const HALF = Math.SQRT1_2;
const WALL = {
  pose: { position: { x: 0, y: 1, z: -3 }, orientation: { x: HALF, y: 0, z: 0, w: HALF } },
  polygon: [[-2, -1], [2, -1], [2, 1], [-2, 1]].map(([x, z]) => ({ x, y: 0, z })),
};

class FakeSocket extends EventTarget {
  state = 'open';
  sent = [];

  send(input) {
    const numbered = { ...input, seq: this.sent.length + 1 };
    this.sent.push(numbered);
    return numbered;
  }

  tell(type, detail) {
    this.dispatchEvent(new CustomEvent(type, { detail }));
  }

  get types() {
    return this.sent.map(({ type }) => type);
  }
}

class FakeEyes extends EventTarget {
  time_s = 100;

  see(x, degree, planes = [WALL]) {
    this.time_s += 0.5;
    const half = ((degree - 90) * Math.PI) / 360;
    const orientation = { x: 0, y: Math.sin(half), z: 0, w: Math.cos(half) };
    const pose = { position: { x, y: 1.4, z: 0 }, orientation };
    this.tell('sight', { time_s: this.time_s, pose, planes });
  }

  turn(walk) {
    for (let degree = 0; degree <= 360 && walk.phase === 'scan'; degree += 20) this.see(0, degree);
  }

  walk(from, to) {
    for (let x = from; x <= to; x += 0.5) this.see(x, 0);
  }

  tell(kind, detail) {
    this.dispatchEvent(new CustomEvent(kind, { detail }));
  }
}

function begun(options) {
  const [eyes, socket] = [new FakeEyes(), new FakeSocket()];
  const walk = new Walk(eyes, socket, options);
  const cues = [];
  walk.addEventListener('cue', ({ detail }) => cues.push(detail.key));
  walk.beginScan('scan.start');
  return { eyes, socket, walk, cues };
}

function scanned(options) {
  const all = begun(options);
  all.eyes.turn(all.walk);
  return all;
}

test('a whole turn sends the scan by itself; then steps are sent', () => {
  const { eyes, socket, walk, cues } = scanned();
  assert.deepEqual([walk.phase, socket.types, cues.at(-1)], ['walk', ['scan'], 'scan.done']);
  assert.equal(socket.sent[0].planes.length, 1);
  eyes.walk(0.5, 2);
  assert.deepEqual(socket.types.slice(1), Array(4).fill('odometry'));
});

test('a part of a turn is sent when somebody has enough; without walls it is not', () => {
  const { eyes, socket, walk, cues } = begun();
  walk.finishScan();
  assert.equal(cues.at(-1), 'scan.waiting');
  eyes.see(0, 0, []);
  walk.finishScan();
  assert.deepEqual([walk.phase, cues.at(-1)], ['scan', 'scan.noWalls']);
  eyes.see(0, 90);
  walk.finishScan();
  assert.deepEqual([walk.phase, socket.types, cues.at(-1)], ['walk', ['scan'], 'scan.partial']);
});

test('nothing is sent while the turn is new', () => {
  const { eyes, socket } = begun();
  eyes.walk(0, 3);
  assert.deepEqual(socket.sent, []);
});

test('in a gap samples gather, and come as few messages before anything else', () => {
  const { eyes, socket, walk } = scanned();
  socket.state = 'waiting';
  eyes.walk(0.5, 75);
  assert.deepEqual(socket.types, ['scan']);
  walk.tell('room 12');
  const [, first, second, told] = socket.sent;
  assert.deepEqual(socket.types, ['scan', 'odometry', 'odometry', 'tell']);
  assert.equal(first.samples.length + second.samples.length, 150);
  assert.equal(told.text, 'room 12');
  const times = [...first.samples, ...second.samples].map(({ t_s }) => t_s);
  assert.deepEqual(times, times.toSorted((a, b) => a - b));
});

test('what gathered is sent as soon as the server welcomes', () => {
  const { eyes, socket } = scanned();
  socket.state = 'waiting';
  eyes.walk(0.5, 3);
  socket.state = 'open';
  socket.tell('welcome', {});
  assert.deepEqual(socket.types, ['scan', 'odometry']);
});

test('a pause keeps the frame; nothing is sent meanwhile', () => {
  const { eyes, socket, walk } = scanned();
  walk.pause('byUser');
  walk.pause('byUser');
  eyes.walk(0.5, 3);
  walk.resume();
  assert.deepEqual(socket.types, ['scan', 'pause', 'resume']);
  assert.equal(socket.sent.at(-1).same_frame, true);
});

test('who hides the page pauses, and goes on by coming back; who paused stays paused', () => {
  const { eyes, socket, walk } = scanned();
  eyes.tell('hidden');
  assert.equal(walk.phase, 'paused');
  eyes.tell('visible');
  assert.deepEqual([walk.phase, socket.types], ['walk', ['scan', 'pause', 'resume']]);
  walk.pause('byUser');
  eyes.tell('visible');
  assert.equal(walk.phase, 'paused');
});

test('a camera that was switched off needs a new turn, in a new frame', () => {
  const { eyes, socket, walk } = scanned();
  eyes.tell('end');
  assert.deepEqual([walk.phase, walk.reason], ['paused', 'camera']);
  walk.resume();
  assert.equal(walk.phase, 'scan');
  eyes.turn(walk);
  assert.deepEqual(socket.types, ['scan', 'pause', 'resume', 'scan']);
  assert.equal(socket.sent[2].same_frame, false);
});

test('tracking that began anew needs a new turn, and steps of both frames are never mixed', () => {
  const { eyes, socket, walk, cues } = scanned();
  socket.state = 'waiting';
  eyes.walk(0.5, 1);
  eyes.tell('reset');
  assert.deepEqual([walk.phase, cues.at(-1)], ['scan', 'scan.reset']);
  eyes.walk(40, 42);
  eyes.turn(walk);
  eyes.walk(0.5, 1);
  socket.state = 'open';
  socket.tell('welcome', {});
  assert.deepEqual(socket.types, ['scan', 'odometry', 'resume', 'scan', 'odometry']);
  const places = socket.sent.flatMap(({ samples }) => samples ?? [])
    .map(({ pose }) => pose.position[0]);
  assert.ok(Math.max(...places) <= 1);
});

test('a new turn on the way keeps the frame, and steps go on', () => {
  const { eyes, socket, walk } = scanned();
  eyes.walk(0.5, 1);
  walk.beginScan('scan.start');
  eyes.turn(walk);
  assert.equal(socket.types.includes('resume'), false);
  assert.equal(socket.types.filter((type) => type === 'scan').length, 2);
  assert.equal(socket.types.at(-1), 'scan');
});

test('a first scan that the server refuses is taken once more, in the same frame', () => {
  const { eyes, socket, walk, cues } = scanned();
  socket.tell('error', { code: 'input', seq: 99 });
  assert.equal(walk.phase, 'walk');
  socket.tell('error', { code: 'input', seq: 1 });
  assert.deepEqual([walk.phase, cues.at(-1)], ['scan', 'scan.refused']);
  eyes.turn(walk);
  assert.deepEqual(socket.types, ['scan', 'scan']);
});

test('a session that is taken up after a reload begins a new frame', () => {
  const { socket } = scanned({ isAgain: true });
  assert.deepEqual(socket.types, ['resume', 'scan']);
  assert.equal(socket.sent[0].same_frame, false);
});
