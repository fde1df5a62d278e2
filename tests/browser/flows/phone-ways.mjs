// Other ways through the phone's page: by keyboard alone, without AR, in German.
import assert from 'node:assert/strict';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { assertAccessible, openPage } from '../helpers.mjs';
import { PORTRAIT, Phone, simulated } from '../emulator.mjs';

const TARGET_PX = 48;
const MOST_TABS = 40;
const WALK = '../../../src/palms/sample/data/trajectories/sample/walk-1/';
const recorded = (name) => fileURLToPath(new URL(WALK + name, import.meta.url));

/** Go to a control with the tab key alone; it must say where it is, and show it. */
async function tabTo(page, role, name) {
  const wanted = page.getByRole(role, { name, exact: true });
  for (let i = 0; i < MOST_TABS; i++) {
    await page.keyboard.press('Tab');
    if (!(await wanted.evaluate((element) => element === document.activeElement))) continue;
    const outline = await wanted.evaluate((element) => getComputedStyle(element).outlineWidth);
    assert.equal(outline, '3px', `focus on ${name} is seen`);
    return;
  }
  assert.fail(`no way to ${role} ${name} by the tab key`);
}

async function press(page, name, key = 'Enter') {
  await tabTo(page, 'button', name);
  await page.keyboard.press(key);
}

/** All that can be pressed is at least 48 pixels high and wide. */
async function assertLarge(page) {
  const small = await page.evaluate((least) => [
    ...document.querySelectorAll('button, select, summary, label:has(input), input[type=text], a'),
  ].filter((element) => element.checkVisibility())
    .map((element) => ({ element, box: element.getBoundingClientRect() }))
    .filter(({ box }) => Math.min(box.width, box.height) < least)
    .map(({ element }) => element.outerHTML), TARGET_PX);
  assert.deepEqual(small, []);
  const [wide, has] = await page.evaluate(() => [document.body.scrollWidth, innerWidth]);
  assert.ok(wide <= has, `${wide} of ${has} pixels`);
}

async function assertHeading(page, name) {
  const heading = page.getByRole('heading', { name, level: 2, exact: true });
  await heading.waitFor();
  assert.ok(await heading.evaluate((element) => element === document.activeElement), name);
}

test('by keyboard and accessibility tree alone', async (t) => {
  const { scan, samples } = await simulated();
  const narrow = { width: 320, height: 640 };
  const phone = await Phone.open(t, { walls: scan.planes, viewport: narrow });
  const { page } = phone;
  await phone.screen('choose');
  await assertLarge(page);
  await phone.pose([0, 0], samples[0].facing_rad);
  await tabTo(page, 'radio', 'My screen reader, or nobody');
  await press(page, 'Start');
  await phone.screen('scan');
  await assertHeading(page, 'Turn all the way round');
  const status = page.getByRole('status');
  assert.equal(await status.getAttribute('aria-live'), 'polite');
  assert.match(await status.textContent(), /^Hold the phone upright/);
  await phone.turn(3);
  await assertLarge(page);
  await press(page, 'Enough. Go on with what I saw', 'Space');
  await phone.screen('walk');
  await assertHeading(page, 'Walk');
  await phone.hears(/^\d+ percent seen\. Now walk\.$/);
  await phone.walk(samples.slice(0, 4));
  await assertLarge(page);
  await tabTo(page, 'textbox', 'I know where I am: a room, or its number');
  await page.keyboard.type('cross corridor');
  await page.keyboard.press('Enter');
  await press(page, 'Let somebody look on');
  await page.getByRole('link', { name: /\/#view=\S{20,}$/ }).waitFor();
  await press(page, 'Pause');
  await assertHeading(page, 'Paused');
  await press(page, 'Go on');
  await phone.screen('walk');
  await page.evaluate(() => globalThis.phone.device.activeSession.end());
  await phone.screen('paused');
  await page.getByText('The camera was switched off').waitFor();
  await assertAccessible(page, 'while paused');
  await press(page, 'End');
  await phone.screen('over');
  await assertHeading(page, 'The walk is over');
  assert.deepEqual(await page.evaluate(() => globalThis.phone.spoken), []);
  assert.equal(await page.evaluate(() => localStorage.getItem('palms-walk')), null);
});

test('a browser that finds no planes says so', async (t) => {
  const phone = await Phone.open(t, { hasPlanes: false });
  await phone.screen('choose');
  await phone.page.getByRole('button', { name: 'Start' }).click();
  await phone.page.getByText('This browser finds no walls').waitFor();
});

test('without AR the page says what to do, and follows a recording', async (t) => {
  const page = await openPage(t, '/phone/', { viewport: PORTRAIT });
  await page.getByRole('heading', { name: 'This browser cannot scan' }).waitFor();
  await page.getByRole('combobox', { name: 'Building' }).waitFor();
  await assertAccessible(page, 'without AR');
  await page.locator('#upload-form').getByLabel('File of the scan')
    .setInputFiles(recorded('Session_1001/detectedPlanes.json'));
  await page.getByLabel('File of the walk').setInputFiles(recorded('walk-1.json'));
  await page.getByRole('button', { name: 'Find where I was' }).click();
  const said = page.getByRole('status').filter({ hasText: /At the end you were/ });
  await said.waitFor();
  assert.match(await said.textContent(), /accurate to about \d+ metres\.$/);
  await page.getByRole('img', { name: 'Map of the floor with the place that was found' }).waitFor();
  await assertLarge(page);
  await assertAccessible(page, 'with its answer');
});

test('without AR an app pushes, and the page tells; also after a reload', async (t) => {
  const page = await openPage(t, '/phone/', { viewport: PORTRAIT });
  const card = page.locator('#push-form');
  await card.getByLabel('File of the scan')
    .setInputFiles(recorded('Session_1001/detectedPlanes.json'));
  await card.getByRole('button', { name: 'Use this scan' }).click();
  await assertHeading(page, 'Walk');
  const url = await page.getByText(/\/api\/v1\/push\/\w+$/).textContent();
  const authorization = await page.getByText(/^Bearer \S{20,}$/).textContent();
  await assertAccessible(page, 'while an app pushes');
  const answer = await fetch(url, {
    method: 'POST', headers: { authorization, 'content-type': 'application/json' },
    body: JSON.stringify({ messageId: 1, payload: [] }),
  });
  assert.equal(answer.status, 200, await answer.text());
  await page.reload();
  await page.getByText(url).waitFor();
  await page.getByRole('button', { name: 'End' }).click();
  await page.getByRole('heading', { name: 'The walk is over' }).waitFor();
});

test('a recording that cannot be read is a problem in one line', async (t) => {
  const page = await openPage(t, '/phone/', { viewport: PORTRAIT, expected: /422/ });
  await page.getByRole('combobox', { name: 'Building' }).waitFor();
  for (const label of ['File of the scan', 'File of the walk']) {
    await page.locator('#upload-form').getByLabel(label)
      .setInputFiles({ name: 'x.json', mimeType: 'application/json', buffer: Buffer.from('{') });
  }
  await page.getByRole('button', { name: 'Find where I was' }).click();
  await page.locator('#upload-problem').filter({ hasText: 'scan.json line 1' }).waitFor();
});

test('the page speaks German where that is wanted', async (t) => {
  const phone = await Phone.open(t, { locale: 'de-AT' });
  await phone.screen('choose');
  await phone.page.getByRole('heading', { name: 'Wo bin ich?' }).waitFor();
  assert.equal(await phone.page.locator('html').getAttribute('lang'), 'de');
  await assertAccessible(phone.page, 'in German');
});
