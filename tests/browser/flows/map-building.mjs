// A building is chosen, added, refused, deleted.
import assert from 'node:assert/strict';
import test from 'node:test';
import { assertAccessible, openPage } from '../helpers.mjs';

const HALL = '0,0,12,0\n12,0,12,8\n12,8,0,8\n0,8,0,0\n0,4,5,4\n';
const shows = (page, name) =>
  page.getByRole('application', { name, exact: true }).waitFor();
const file = (name, text) => ({ name, mimeType: 'text/plain', buffer: Buffer.from(text) });

test('the sample is there at once, with a hint', async (t) => {
  const page = await openPage(t);
  await page.waitForSelector('[data-ready]');
  assert.match(await page.title(), /PALMS/);
  assert.equal(await page.locator('#building option').first().textContent(), 'Sample building');
  assert.ok(await page.getByText(/^Draw a walk: press/).isVisible());
  await assertAccessible(page, 'as it opens');
});

test('a plan is uploaded; what is wrong with one is said in one line', async (t) => {
  const page = await openPage(t, '/', { expected: /422/ });
  await page.getByRole('button', { name: 'Add…' }).click();
  const dialog = page.getByRole('dialog', { name: 'Add a building' });
  await dialog.getByLabel('Floor plan').setInputFiles(file('hall.csv', 'no,numbers,at,all\n'));
  await dialog.getByLabel('Name').fill('Town hall');
  await dialog.getByRole('button', { name: 'Add', exact: true }).click();
  const problem = dialog.getByRole('alert');
  await problem.waitFor();
  assert.doesNotMatch(await problem.textContent(), /\n|Traceback/);
  await assertAccessible(page, 'a refused upload');
  await dialog.getByLabel('Floor plan').setInputFiles(file('hall.csv', HALL));
  await dialog.getByRole('button', { name: 'Add', exact: true }).click();
  await dialog.waitFor({ state: 'hidden' });
  await shows(page, 'Map of Town hall, level 1');

  await page.getByRole('button', { name: 'Add…' }).click();
  await dialog.getByLabel('Floor plan').setInputFiles(file('up.csv', HALL));
  await dialog.getByLabel('Level', { exact: true }).fill('2');
  await dialog.getByLabel('One more level').check();
  await dialog.getByRole('button', { name: 'Add', exact: true }).click();
  await dialog.waitFor({ state: 'hidden' });
  await page.locator('#level').selectOption('2');
  await shows(page, 'Map of Town hall, level 2');

  page.once('dialog', (question) => question.accept());
  await page.getByRole('button', { name: 'Add…' }).click();
  await dialog.getByRole('button', { name: 'Delete the one' }).click();
  await dialog.waitFor({ state: 'hidden' });
  await shows(page, 'Map of Sample building, level 2');
});

test('the address for a phone is a QR code that the page can show', async (t) => {
  const page = await openPage(t);
  await page.waitForSelector('[data-ready]');
  await page.getByRole('button', { name: 'Use a phone' }).click();
  await page.waitForFunction(() => document.querySelector('#code').naturalWidth > 0);
  const address = await page.locator('#phone-address').textContent();
  assert.match(address, /\/phone\/#building=sample$/);
  assert.match(await page.locator('#phone-means').textContent(), /--tls/);
  await assertAccessible(page, 'the code for a phone');
});
