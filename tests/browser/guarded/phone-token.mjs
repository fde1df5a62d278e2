// Where the server has a token, a phone comes in with a ticket, which is good once.
import assert from 'node:assert/strict';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { PORTRAIT, Phone } from '../emulator.mjs';
import { SERVER, assertAccessible, openPage } from '../helpers.mjs';

const { PALMS_TOKEN: TOKEN } = process.env;
const WALLS = [[[-3, 3], [3, 3]], [[3, 3], [3, -3]], [[3, -3], [-3, -3]]];
const WALK = '../../../src/palms/sample/data/trajectories/sample/walk-1/';
const recorded = (name) => fileURLToPath(new URL(WALK + name, import.meta.url));

async function newTicket() {
  const answer = await fetch(`${SERVER}/api/v1/tickets`, {
    method: 'POST', body: JSON.stringify({ role: 'walker', building: 'sample' }),
    headers: { authorization: `Bearer ${TOKEN}`, 'content-type': 'application/json' },
  });
  return (await answer.json()).ticket;
}

test('a ticket lets a phone in, once; it does not stay in the address', async (t) => {
  const path = `/phone/#building=sample&ticket=${await newTicket()}`;
  const phone = await Phone.open(t, { walls: WALLS, path, expected: /401/ });
  const { page } = phone;
  await phone.screen('choose');
  assert.equal(new URL(page.url()).hash, '');
  await page.getByRole('button', { name: 'Start' }).click();
  await phone.screen('scan');
  await phone.turn(2 * Math.PI);
  await phone.screen('walk');
  await page.getByRole('banner').getByText('Sample building').waitFor();
  await phone.end();
  await page.getByRole('button', { name: 'Start again' }).click();
  const problem = page.locator('#choose-problem');
  await problem.filter({ hasText: 'This server lets nobody in without a ticket.' }).waitFor();
  await page.goto(`${SERVER}${path}`);
  await page.waitForURL((url) => !url.hash); // it takes the new code, and out of the address
  await page.getByRole('button', { name: 'Start', exact: true }).click();
  await problem.filter({ hasText: 'The ticket has been used or has expired.' }).waitFor();
  await assertAccessible(page, 'a used ticket');
});

test('without a ticket the token is asked for', async (t) => {
  const phone = await Phone.open(t, { expected: /401/ });
  const { page } = phone;
  await page.locator('#choose-problem').filter({ hasText: 'without a ticket' }).waitFor();
  await page.getByText("I have the server's token").click();
  await page.getByLabel('Token').fill(TOKEN);
  await page.getByRole('button', { name: 'Use it' }).click();
  await page.getByRole('combobox', { name: 'Building' }).waitFor();
  assert.ok(!page.url().includes(TOKEN));
});

test('without AR a ticket lets a recording be followed', async (t) => {
  const path = `/phone/#building=sample&ticket=${await newTicket()}`;
  const page = await openPage(t, path, { viewport: PORTRAIT });
  await page.locator('#upload-form').getByLabel('File of the scan')
    .setInputFiles(recorded('Session_1001/detectedPlanes.json'));
  await page.getByLabel('File of the walk').setInputFiles(recorded('walk-1.json'));
  await page.getByRole('button', { name: 'Find where I was' }).click();
  await page.getByRole('status').filter({ hasText: /At the end you were/ }).waitFor();
});
