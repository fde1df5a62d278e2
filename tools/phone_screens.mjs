// Pictures of the phone's page; tools/make_phone_screens.py runs this and puts them together.
import test from 'node:test';
import { Phone, simulated } from '../tests/browser/emulator.mjs';

const { PALMS_PICTURES: FOLDER } = process.env;
const SHARP = { deviceScaleFactor: 2 };

/** Go through a walk, with a picture of each screen. */
async function pictured(t, colorScheme) {
  const { scan, samples } = await simulated();
  const phone = await Phone.open(t, {
    walls: scan.planes, isShown: true, colorScheme, ...SHARP,
  });
  const { page } = phone;
  const picture = (name) => page.screenshot({ path: `${FOLDER}/${name}-${colorScheme}.png` });
  await phone.screen('choose');
  await picture('start');
  await phone.pose([0, 0], samples[0].facing_rad);
  await page.getByRole('radio', { name: 'This page speaks' }).check();
  await page.getByRole('button', { name: 'Start' }).click();
  await phone.screen('scan');
  await phone.turn(3.1);
  await picture('turn');
  await phone.turn(3.3);
  await phone.screen('walk');
  await phone.walk(samples);
  await phone.hears(/^Found: /);
  await page.getByRole('button', { name: 'Where am I?' }).click();
  await phone.hears(/^(Probably )?East corridor/);
  await page.evaluate(() => document.activeElement.blur());
  await picture('walk');
  await page.getByText('Map, for who can see it').click();
  await page.locator('#map').scrollIntoViewIfNeeded();
  await page.getByText('Map, for who can see it').evaluate((element) => {
    element.blur();
    element.scrollIntoView();
  });
  await picture('map');
}

test('light', (t) => pictured(t, 'light'));
test('dark', (t) => pictured(t, 'dark'));
