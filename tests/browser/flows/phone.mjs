// The phone's page, from the first look to the end of a walk.
import assert from 'node:assert/strict';
import test from 'node:test';
import { assertAccessible } from '../helpers.mjs';
import { Phone, simulated } from '../phone.mjs';

test('scan, walk, and hear where one is', async (t) => {
  const { scan, samples } = await simulated();
  const phone = await Phone.open(t, { walls: scan.planes });
  const { page } = phone;
  await phone.screen('choose');
  await page.screenshot({ path: '/tmp/p1.png' });
  await assertAccessible(page, 'before the start');
  await page.getByRole('radio', { name: 'This page speaks' }).check();
  await phone.pose([0, 0], samples[0].facing_rad);
  await page.getByRole('button', { name: 'Start' }).click();
  await phone.screen('scan');
  await phone.turn(2.2);
  await page.screenshot({ path: '/tmp/p2.png' });
  await assertAccessible(page, 'while turning');
  await phone.turn(4.2);
  await phone.screen('walk');
  await phone.walk(samples);
  await page.screenshot({ path: '/tmp/p3.png' });
  await assertAccessible(page, 'while walking');
  console.log(await page.evaluate(() => phone.spoken));
});
