// A phone that is not there: walks a path that the server simulates, over a socket of its own.
import { rest } from './helpers.mjs';

/**
 * Open a session from a page of the server, and scan. `walk(n)` sends so many samples more; `share`
 * returns the key of a link; `end` ends the session.
 *
 * @param {import('playwright-core').Page} page any page of the server
 * @param {{ seed: number, length_m?: number }} wanted
 */
export async function livePhone(page, { seed, length_m = 60 }) {
  const building = 'sample';
  const simulation = await rest('POST', '/api/v1/simulations', { building, seed, length_m });
  await page.evaluate(async ({ building, seed, simulation }) => {
    const { LiveSocket } = await import('/shared/socket.js');
    const phone = new LiveSocket({ building, seed });
    window.phone = phone;
    window.sayAndWait = (message, kind) => new Promise((resolve) => {
      phone.addEventListener(kind, ({ detail }) => resolve(detail), { once: true });
      phone.say(message);
    });
    const scanned = new Promise((resolve) => phone.addEventListener('estimate', resolve));
    phone.send({ ...simulation.scan, seq: undefined });
    await phone.connect();
    await scanned;
  }, { building, seed, simulation });
  let sent = 0;
  return {
    truth_m: simulation.truth_m,
    async walk(n = Infinity) {
      const samples = simulation.samples.slice(sent, sent + n);
      sent += samples.length;
      await page.evaluate((each) => {
        for (const sample of each) window.phone.send({ type: 'odometry', samples: [sample] });
      }, samples);
    },
    share: () => page.evaluate(async () =>
      (await window.sayAndWait({ type: 'share' }, 'link')).view),
    end: () => page.evaluate(() => window.sayAndWait({ type: 'end' }, 'ended')),
  };
}
