// Starts one Chromium for all flows and says where it listens; it ends with its standard input.
import { chromium } from 'playwright-core';

const ARGUMENTS = [
  '--no-sandbox', // containers run as root
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

const browser = await chromium.launchServer({
  executablePath: process.argv[2],
  headless: true,
  args: ARGUMENTS,
});
console.log(browser.wsEndpoint());
process.stdin.resume();
process.stdin.on('end', () => browser.close());
