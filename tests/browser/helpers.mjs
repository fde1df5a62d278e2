// What flows share: pages of the one browser, an accessibility check, the server's REST.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before } from 'node:test';
import { chromium } from 'playwright-core';

/** Address of the server, as `http://127.0.0.1:8123`. */
export const SERVER = process.env.PALMS_URL;
/** So long may something take on a busy machine. */
export const PATIENCE_MS = 120_000;

const AXE = readFileSync(new URL('node_modules/axe-core/axe.min.js', import.meta.url), 'utf8');

let browser;
before(async () => {
  browser = await chromium.connect(process.env.PALMS_BROWSER);
});
after(() => browser?.close());

/**
 * Open a page in a context of its own. When the test ends it is closed, and it fails the test if it
 * logged an error, broke the content security policy, or asked another server for anything.
 *
 * @param {import('node:test').TestContext} t
 * @param {string} path such as `/`
 * @param {object} [settings] of playwright's `newContext`; `init` is a script that runs before the
 *   page's own, or a list of them; `clock` lets the test hold the page's clock; `server` is another
 *   way to the server; `expected` is a pattern of errors that belong to the test
 */
export async function openPage(t, path = '/', settings = {}) {
  const { server = SERVER, init = [], expected, clock = false, ...options } = settings;
  const context = await browser.newContext({ ignoreHTTPSErrors: true, ...options });
  context.setDefaultTimeout(PATIENCE_MS);
  if (clock) await context.clock.install();
  for (const script of [init].flat()) await context.addInitScript(script);
  const page = await context.newPage();
  const problems = watchForProblems(page, server);
  t.after(async () => {
    await context.close();
    const unexpected = problems.filter((each) => !expected?.test(each));
    assert.deepEqual(unexpected, [], 'what the page logged');
  });
  await page.goto(server + path);
  return page;
}

function watchForProblems(page, server) {
  const problems = [];
  page.on('console', (said) => {
    if (said.type() === 'error') problems.push(`${said.text()} ${said.location().url}`);
  });
  page.on('pageerror', (error) => problems.push(String(error)));
  page.on('request', (request) => {
    const { protocol, origin } = new URL(request.url());
    const isOwn = origin === server || ['data:', 'blob:'].includes(protocol);
    if (!isOwn) problems.push(`asked elsewhere: ${request.url()}`);
  });
  return problems;
}

/** Fail with a readable list of what axe-core finds on the page as it is now. */
export async function assertAccessible(page, state) {
  await page.evaluate(`if (!window.axe) { ${AXE} }`);
  const { violations } = await page.evaluate(() => window.axe.run({ resultTypes: ['violations'] }));
  const found = violations.flatMap(({ id, help, nodes }) =>
    nodes.map((node) => `${id}: ${help}: ${node.target.join(' ')} ${node.failureSummary}`));
  assert.deepEqual(found, [], `axe-core, ${state}`);
}

/** Ask the server's REST interface; returns the answer's JSON. */
export async function rest(method, path, body) {
  const answer = await fetch(SERVER + path, {
    method,
    headers: { 'content-type': 'application/json' },
    body: body && JSON.stringify(body),
  });
  assert.ok(answer.ok, `${method} ${path}: ${answer.status}`);
  return answer.status === 204 ? null : answer.json();
}
