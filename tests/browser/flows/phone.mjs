// The phone's page, from the first look to the end of a walk.
import assert from 'node:assert/strict';
import test from 'node:test';
import { Network } from '../gap.mjs';
import { SERVER, assertAccessible, rest } from '../helpers.mjs';
import { Phone, simulated } from '../emulator.mjs';

/** How far off the page's estimates may be, once localized. */
const NEAR_M = 2;
const BROKEN = /ERR_CONNECTION|ERR_EMPTY_RESPONSE|ERR_FAILED|WebSocket/;

const walks = await simulated();

/** Open the page and turn all the way round; its user walks next. */
async function scanned(t, options = {}) {
  const phone = await Phone.open(t, { walls: walks.scan.planes, ...options });
  await phone.screen('choose');
  await phone.pose([0, 0], walks.samples[0].facing_rad);
  await phone.page.getByRole('radio', { name: 'This page speaks' }).check();
  await phone.page.getByRole('button', { name: 'Start' }).click();
  await phone.screen('scan');
  await phone.turn(2 * Math.PI);
  await phone.screen('walk');
  return phone;
}

function assertNear({ stage, x_m, y_m }, [x, y]) {
  assert.equal(stage, 'localized');
  assert.ok(Math.hypot(x_m - x, y_m - y) < NEAR_M, `${x_m}, ${y_m} is far from ${x}, ${y}`);
}

test('scan, walk, and hear where one is', async (t) => {
  const phone = await Phone.open(t, { walls: walks.scan.planes });
  const { page } = phone;
  await phone.screen('choose');
  await assertAccessible(page, 'before the start');
  await page.getByRole('radio', { name: 'This page speaks' }).check();
  await phone.pose([0, 0], walks.samples[0].facing_rad);
  await page.getByRole('button', { name: 'Start' }).click();
  await phone.screen('scan');
  await phone.hears(/turn slowly all the way round/);
  await phone.turn(2.4);
  const ring = page.getByRole('progressbar', { name: 'How much of the turn is done' });
  const percent = Number(await ring.getAttribute('aria-valuenow'));
  assert.ok(percent > 40 && percent < 65, `${percent} %`);
  await assertAccessible(page, 'while turning');
  await phone.turn(3.9);
  await phone.screen('walk');
  await phone.hears(/^All the way round\. Now walk\.$/);
  await phone.walk(walks.samples);
  assertNear(await phone.settled(), walks.truth_m.at(-1));
  await assertAccessible(page, 'while walking');
  await phone.hears(/^Found: .*East corridor/);
  await page.getByRole('button', { name: 'Where am I?' }).click();
  await phone.hears(/^(Probably )?East corridor/);
  await page.getByRole('button', { name: 'More' }).click();
  await phone.hears(/Accurate to \d+ metres\./);
  const said = await phone.spoken();
  await page.getByRole('button', { name: 'Repeat' }).click();
  assert.deepEqual(await phone.spoken(), [...said, said.at(-1)]);
  await phone.end();
  await assertAccessible(page, 'at the end');
  assert.deepEqual((await rest('GET', '/api/v1/sessions')).sessions, []);
});

test('a gap of the network in the middle loses no step, and is told', async (t) => {
  const network = await Network.to(t, SERVER);
  const phone = await scanned(t, { server: network.url, expected: BROKEN });
  const third = Math.floor(walks.samples.length / 3);
  await phone.walk(walks.samples.slice(0, third));
  const before = (await phone.settled()).seq;
  network.cut();
  await phone.walk(walks.samples.slice(third, 2 * third));
  await phone.hears(/^No connection/);
  assert.equal(await phone.page.evaluate(() => globalThis.phone.last.seq), before);
  network.mend();
  await phone.hears(/^Connected again/);
  await phone.walk(walks.samples.slice(2 * third));
  const last = await phone.settled();
  assertNear(last, walks.truth_m.at(-1));
  const length = walks.truth_m.slice(1).reduce((sum, [x, y], i) =>
    sum + Math.hypot(x - walks.truth_m[i][0], y - walks.truth_m[i][1]), 0);
  assert.ok(Math.abs(last.walked_m / length - 1) < 0.05, `${last.walked_m} m of ${length} m`);
  assert.equal(last.n_late, 0);
});

test('a reload in a gap takes the walk up again, with a new turn', async (t) => {
  const network = await Network.to(t, SERVER);
  const phone = await scanned(t, { server: network.url, expected: BROKEN });
  await phone.walk(walks.samples.slice(0, 5));
  await phone.settled();
  const { page } = phone;
  await page.evaluate(() => navigator.serviceWorker.ready.then(() => true));
  network.cut();
  await page.reload();
  await phone.screen('paused');
  await page.getByText('Your walk in Sample building goes on').waitFor();
  network.mend();
  await phone.pose([0, 0], walks.samples[0].facing_rad);
  await page.getByRole('button', { name: 'Go on' }).click();
  await phone.screen('scan');
  await phone.turn(2 * Math.PI);
  await phone.screen('walk');
  await phone.walk(walks.samples);
  assertNear(await phone.settled(), walks.truth_m.at(-1));
  await phone.end();
});
