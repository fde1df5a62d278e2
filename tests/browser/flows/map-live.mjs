// A phone walks; the operator and somebody with a link look on.
import assert from 'node:assert/strict';
import test from 'node:test';
import { assertAccessible, openPage } from '../helpers.mjs';
import { livePhone } from '../phone.mjs';

test('a live session is watched from the list and by a link', async (t) => {
  const elsewhere = await openPage(t);
  const phone = await livePhone(elsewhere, { seed: 8, length_m: 50 });
  const operator = await openPage(t);
  await operator.waitForSelector('[data-ready]');
  await operator.getByRole('tab', { name: 'Live' }).click();
  await operator.getByRole('button', { name: /^Watch: Sample building/ }).last().click();
  await operator.locator('[data-stage=searching]').waitFor();
  await assertAccessible(operator, 'live');

  await phone.walk(10);
  await operator.locator('#facts').getByText(/^[67] m in/).waitFor();
  const view = await phone.share();
  const guest = await openPage(t, `/#view=${encodeURIComponent(view)}`);
  await guest.locator('[data-stage=searching]').waitFor();
  await phone.walk();
  for (const page of [operator, guest]) {
    await page.locator('[data-stage=localized]').waitFor();
    assert.match(await page.getByRole('status').textContent(), /^(Localized|Found again): /);
  }
  await guest.getByRole('button', { name: 'Pause' }).click();
  await guest.getByLabel('Moment of the walk').press('Home');
  await guest.locator('[data-stage=searching]').waitFor();
  await guest.getByRole('button', { name: 'To now' }).click();
  await guest.locator('[data-stage=localized]').waitFor();
  await phone.end();
  await guest.getByText('The walk has ended.').first().waitFor();
});

test('a link that is not known says so in one line', async (t) => {
  const page = await openPage(t, '/#view=guess');
  await page.getByText('looking on needs a link').first().waitFor();
});
