// Takes the pictures of the documentation: node pictures.mjs URL CHROMIUM FOLDER. Prints their paths.
import { chromium } from 'playwright-core';

const [url, executablePath, folder] = process.argv.slice(2);
const FIXED = 'Math.random = () => 0.1;'; // the same phone, scan and walk each time
const LOCALIZED = '[data-stage=localized]';
const AFTER = 8; // steps since it was localized

const browser = await chromium.launch({ executablePath, args: ['--no-sandbox', '--disable-gpu'] });

/** Have a walk chosen, and wait until it is over. */
async function walked(options) {
  const context = await browser.newContext({ ...options, deviceScaleFactor: 1 });
  context.setDefaultTimeout(240_000);
  await context.addInitScript(FIXED);
  const page = await context.newPage();
  await page.goto(url);
  await page.waitForSelector('[data-ready]');
  await page.getByRole('button', { name: 'Walk for me' }).click();
  await page.getByLabel('Speed').selectOption('10');
  await page.getByText(/^The walk of \d+ m is over/).waitFor();
  return page;
}

/** Show a step by its index. */
async function show(page, index) {
  await page.getByLabel('Moment of the walk').evaluate((slider, value) => {
    slider.value = value;
    slider.dispatchEvent(new Event('input'));
  }, index);
}

/** Index of the first step that is localized. */
async function localizedAt(page) {
  const n = Number(await page.getByLabel('Moment of the walk').getAttribute('max'));
  for (let index = 0; index <= n; index++) {
    await show(page, index);
    if (await page.locator(LOCALIZED).count()) return index;
  }
  throw new Error('it was never localized');
}

async function photograph(page, name) {
  await page.evaluate(() => document.activeElement?.blur());
  await page.waitForTimeout(500); // the heatmap is tinted meanwhile
  const path = `${folder}/map-${name}.png`;
  await page.screenshot({ path });
  return path;
}

const wide = await walked({ viewport: { width: 1280, height: 800 } });
const first = await localizedAt(wide);
await show(wide, first + AFTER);
const taken = [await photograph(wide, 'light')];
await wide.emulateMedia({ colorScheme: 'dark' });
await show(wide, Math.round(first / 3));
await wide.getByLabel('Heatmap').selectOption({ index: 1 });
taken.push(await photograph(wide, 'dark'));

const narrow = await walked({ viewport: { width: 390, height: 844 }, hasTouch: true });
await show(narrow, first + AFTER);
taken.push(await photograph(narrow, 'phone'));
await browser.close();
console.log(JSON.stringify(taken));
