// Where the server has a token, the page asks for it, and it is in no address.
import assert from 'node:assert/strict';
import test from 'node:test';
import { assertAccessible, openPage } from '../helpers.mjs';

test('the token opens the page; a wrong one is refused', async (t) => {
  const page = await openPage(t, '/', { init: 'Math.random = () => 0.25;', expected: /401/ });
  const asked = [];
  page.on('request', (request) => asked.push(request.url()));
  page.on('websocket', (socket) => asked.push(socket.url()));
  const dialog = page.getByRole('dialog', { name: 'This server needs its token' });
  await dialog.getByLabel('Token').fill('a guess of some length');
  await dialog.getByRole('button', { name: 'Go on' }).click();
  await dialog.getByText('The server does not know this token.').waitFor();
  await assertAccessible(page, 'a wrong token');
  await dialog.getByLabel('Token').fill(process.env.PALMS_TOKEN);
  await dialog.getByRole('button', { name: 'Go on' }).click();
  await page.waitForSelector('[data-ready]');
  await page.getByRole('button', { name: 'Walk for me' }).click();
  await page.locator('[data-stage=searching]').waitFor();
  await page.getByRole('button', { name: 'Use a phone' }).click();
  await page.getByText(/#building=sample&ticket=/).waitFor();
  assert.ok(!asked.some((each) => each.includes(process.env.PALMS_TOKEN)));
  assert.ok(!page.url().includes(process.env.PALMS_TOKEN));
  await page.reload();
  await page.waitForSelector('[data-ready]');
});
