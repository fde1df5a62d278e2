// A walk is drawn, localizes, is kept, shared, and looked at again.
import assert from 'node:assert/strict';
import test from 'node:test';
import { fitted, toScreen } from '../../../src/palms/server/web/shared/view.js';
import { assertAccessible, openPage, rest } from '../helpers.mjs';

const FIXED = 'Math.random = () => 0.25;'; // the seed of the simulated phone
const knows = (page) => page.locator('.knows').textContent();

/** Where points of the sample building's map are on the page as it opens. */
async function onScreen(page, points_m) {
  const { left, top, width, height } = await page.evaluate(() => {
    const { left, top, width, height } = document.querySelector('#map').getBoundingClientRect();
    return { left, top, width, height };
  });
  const { levels: [{ bounds_m }] } = await rest('GET', '/api/v1/buildings/sample');
  const view = fitted(bounds_m, { width, height }, Math.min(24, width / 20));
  return points_m.map((point) => toScreen(view, point)).map(([x, y]) => [x + left, y + top]);
}

async function drawWithMouse(page, points_m) {
  const [first, ...others] = await onScreen(page, points_m);
  await page.mouse.move(...first);
  await page.mouse.down();
  for (const point of others) await page.mouse.move(...point);
  await page.mouse.up();
}

test('a walk that is drawn with the mouse localizes, is shared and replayed', async (t) => {
  const page = await openPage(t, '/', { init: FIXED });
  await page.waitForSelector('[data-ready]');
  const wanted = { building: 'sample', seed: 8, length_m: 50 };
  const { truth_m } = await rest('POST', '/api/v1/simulations', wanted);
  await drawWithMouse(page, truth_m);
  await page.getByText(/^(49|50) m are drawn/).waitFor();
  await page.getByLabel('Speed').evaluate((select) => { select.value = '10'; });
  await page.getByRole('button', { name: 'Walk', exact: true }).click();
  await page.locator('[data-stage=localized]').waitFor();
  assert.match(await page.getByRole('status').textContent(), /^(Localized|Found again): .+, within/);
  await page.getByText(/^The walk of \d+ m is over/).waitFor();
  const off = await page.locator('dt:text("Truly off by") + dd').textContent();
  assert.ok(parseFloat(off) < 2, off);
  await page.getByLabel('Heatmap').selectOption({ index: 1 });
  await assertAccessible(page, 'localized');

  await page.getByRole('button', { name: 'Keep and share' }).click();
  await page.getByRole('dialog', { name: 'Share this replay' }).waitFor();
  const link = await page.getByLabel('Link').inputValue();
  await assertAccessible(page, 'the link');
  const guest = await openPage(t, new URL(link).pathname + new URL(link).hash);
  await guest.locator('[data-stage=searching]').waitFor();
  await guest.getByRole('button', { name: 'Pause' }).click();
  const slider = guest.getByLabel('Moment of the walk');
  await slider.press('End');
  await guest.locator('[data-stage=localized]').waitFor();
  assert.match(await slider.getAttribute('aria-valuetext'), /Localized, .+ within 1 metre/);
  const end = await knows(guest);
  await slider.press('Home');
  await guest.locator('[data-stage=searching]').waitFor();
  assert.notEqual(await knows(guest), end);
  assert.equal(await guest.getByRole('tab').count(), 0, 'a guest sees the walk alone');
  await assertAccessible(guest, 'a replay by a link');
});

test('a walk is drawn by keys alone, and a wall stops it', async (t) => {
  const page = await openPage(t, '/', { init: FIXED });
  await page.waitForSelector('[data-ready]');
  const { recordings } = await rest('GET', '/api/v1/recordings');
  await page.locator('#map').focus();
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Space');
  await page.getByText('The start is set. Draw on.').waitFor();
  for (let i = 0; i < 20; i++) await page.keyboard.press('Shift+ArrowRight');
  assert.equal(await page.getByRole('status').textContent(), 'A wall is in the way.');
  await page.keyboard.press('ArrowLeft');
  assert.match(await page.locator('#pen-text').textContent(), /m are drawn/);
  await page.keyboard.press('Backspace');
  await page.keyboard.press('Shift+ArrowLeft');
  await page.keyboard.press('Enter');
  await page.getByText(/A simulated phone walks|is over/).waitFor();
  await page.getByText(/^The walk of \d+ m is over/).waitFor();
  await page.getByRole('button', { name: 'New walk' }).click();
  await page.getByText(/^Draw a walk: press/).waitFor();
  await page.waitForFunction(async (n) => { // what nobody keeps is deleted
    const { recordings } = await (await fetch('/api/v1/recordings')).json();
    return recordings.length === n;
  }, recordings.length);
});

test('on a narrow phone in the dark a walk is chosen; nothing sticks out', async (t) => {
  const page = await openPage(t, '/', {
    init: FIXED, colorScheme: 'dark', hasTouch: true, isMobile: true,
    viewport: { width: 320, height: 640 },
  });
  await page.waitForSelector('[data-ready]');
  await assertAccessible(page, 'a narrow phone in the dark');
  await page.getByRole('button', { name: 'Walk for me' }).tap();
  await page.getByLabel('Moment of the walk').waitFor();
  await page.getByText(/A simulated phone walks: [1-9]/).waitFor();
  await assertAccessible(page, 'a walk on a narrow phone');
  const [inner, outer] = await page.evaluate(() =>
    [document.documentElement.scrollWidth, document.documentElement.clientWidth]);
  assert.equal(inner, outer);
  await page.getByRole('button', { name: 'Dark' }).tap();
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'light');
  await assertAccessible(page, 'a walk in the light');
});
