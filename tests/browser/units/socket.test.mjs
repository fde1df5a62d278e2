// The socket that comes back by itself, against a server of a few lines.
import assert from 'node:assert/strict';
import test, { mock } from 'node:test';
import { LiveSocket, liveAddress, waitMs } from '../../../src/palms/server/web/shared/socket.js';

class FakeSocket {
  static all = [];

  constructor() {
    this.sent = [];
    FakeSocket.all.push(this);
  }

  send(text) {
    this.sent.push(JSON.parse(text));
  }

  close() {
    queueMicrotask(() => this.onclose?.());
  }

  say(message) {
    this.onmessage({ data: JSON.stringify(message) });
  }
}

const latest = () => FakeSocket.all.at(-1);
const inputs = () => latest().sent.filter(({ seq }) => seq).map(({ seq, n }) => [seq, n]);
const welcome = (fields) => ({
  type: 'welcome', role: 'walker', session: 's1', key: 'k1', next_seq: 1, ...fields,
});

async function connected(options) {
  FakeSocket.all = [];
  const live = new LiveSocket({ building: 'sample' }, { open: () => new FakeSocket(), ...options });
  await live.connect();
  latest().onopen();
  return live;
}

test('inputs wait for the welcome, are numbered, and are kept until they are stored', async () => {
  const live = await connected();
  live.send({ type: 'scan', n: 1 });
  assert.deepEqual(latest().sent, [{ type: 'hello', building: 'sample' }]);
  latest().say(welcome());
  live.send({ type: 'odometry', n: 2 });
  assert.deepEqual(inputs(), [[1, 1], [2, 2]]);
  latest().say({ type: 'ack', seq: 2, status: 'waiting', next_seq: 1 });
  assert.equal(live.nUnstored, 2);
  latest().say({ type: 'ack', seq: 2, status: 'stored', next_seq: 3 });
  assert.equal(live.nUnstored, 0);
  live.close();
});

test('after a broken connection it comes back with its key and sends what is not stored', async () => {
  mock.timers.enable({ apis: ['setTimeout'] });
  const live = await connected();
  const states = [];
  live.addEventListener('state', ({ detail }) => states.push(detail));
  latest().say(welcome());
  for (const n of [1, 2, 3]) live.send({ type: 'odometry', n });
  latest().say({ type: 'ack', seq: 1, status: 'stored', next_seq: 2 });
  latest().onclose();
  live.send({ type: 'odometry', n: 4 });
  mock.timers.tick(waitMs(0));
  await Promise.resolve();
  await new Promise(setImmediate);
  latest().onopen();
  assert.deepEqual(latest().sent[0], { type: 'hello', building: 'sample', session: 's1', key: 'k1' });
  latest().say(welcome({ key: null, next_seq: 3, resumed: true }));
  assert.deepEqual(inputs(), [[3, 3], [4, 4]]);
  assert.deepEqual(states, ['open', 'waiting', 'connecting', 'open']);
  assert.equal(live.key, 'k1');
  live.close();
  mock.timers.reset();
});

test('a connection that does not answer is taken for dead', async () => {
  mock.timers.enable({ apis: ['setTimeout'] });
  const live = await connected();
  latest().say(welcome());
  live.send({ type: 'odometry' });
  mock.timers.tick(20_000);
  assert.equal(live.state, 'waiting');
  live.close();
  mock.timers.reset();
});

test('a gap is sent again from where the server says', async () => {
  const live = await connected();
  latest().say(welcome());
  for (const n of [1, 2, 3]) live.send({ type: 'odometry', n });
  latest().say({ type: 'error', code: 'gap', text: 'send again', fatal: false, seq: 3, next_seq: 2 });
  assert.deepEqual(inputs(), [[1, 1], [2, 2], [3, 3], [2, 2], [3, 3]]);
  live.close();
});

test('a refusal ends it; a server that is full is asked again', async () => {
  mock.timers.enable({ apis: ['setTimeout'] });
  const refused = await connected();
  latest().say({ type: 'error', code: 'forbidden', text: 'no', fatal: true });
  assert.equal(refused.state, 'closed');
  const patient = await connected();
  latest().say({ type: 'error', code: 'full', text: 'later', fatal: true });
  latest().onclose();
  assert.equal(patient.state, 'waiting');
  patient.close();
  mock.timers.reset();
});

test('a ticket is asked for where there is no key, and what refuses it is told', async () => {
  await connected({ ticket: async () => 't1' });
  assert.equal(latest().sent[0].ticket, 't1');
  const live = new LiveSocket({}, { ticket: async () => { throw new Error('no token'); } });
  let told;
  live.addEventListener('error', ({ detail }) => { told = detail; });
  await live.connect();
  assert.equal(told.text, 'no token');
  assert.equal(live.state, 'closed');
});

test('waits grow up to ten seconds; the address follows the page', () => {
  assert.deepEqual([0, 1, 2, 9].map(waitMs), [500, 1000, 2000, 10_000]);
  assert.equal(liveAddress({ protocol: 'https:', host: 'a:1' }), 'wss://a:1/api/v1/live');
  assert.equal(liveAddress({ protocol: 'http:', host: 'b' }), 'ws://b/api/v1/live');
});
