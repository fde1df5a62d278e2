// A first look: the page is there, and nothing on it is in anybody's way.
import assert from 'node:assert/strict';
import test from 'node:test';
import { assertAccessible, openPage } from '../helpers.mjs';

test('the page opens', async (t) => {
  const page = await openPage(t, '/');
  assert.match(await page.title(), /PALMS/);
  await assertAccessible(page, 'as it opens');
});
