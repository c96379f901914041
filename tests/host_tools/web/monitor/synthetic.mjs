// A browser, and for each test a synthetic robot that does what the test asks for, with its page: synthetic_monitor.

import assert from 'node:assert/strict';
import { after, afterEach, before, beforeEach } from 'node:test';
import { openBrowser, openPage, Program, until } from './browser.mjs';

export let browser;
export let monitor;
export let page;

before(async () => { browser = await openBrowser(); });
after(async () => { await browser.close(); });

beforeEach(async () => {
  monitor = new Program(process.env.STILT_SYNTHETIC_MONITOR, []);
  const [url] = await monitor.wrote(/http:\S+/);
  monitor.url = url;
  page = await openPage(browser, url);
  await until('the robot in the picture', () => page.getAttribute('#stage-canvas', 'data-hip-x'));
});

afterEach(async () => {
  const { problems } = page;
  await page.close();
  monitor.process.stdin.end();
  await monitor.ended;
  assert.deepEqual(problems, []);
});

export const text = (selector) => page.textContent(selector);
export const answer = (pattern) => until(`an answer like ${pattern}`, async () => pattern.test(await text('#answer')));
export const state = (name) => until(`state ${name}`, async () => (await text('#state')) === name);
export const forget = () => page.evaluate(() => { document.getElementById('answer').textContent = ''; });

/** The answer to what `act` orders. Orders again, as the refusal asks for, what a busy machine delivered late. */
export async function order(act) {
  for (;;) {
    await forget();
    await act();
    const said = await until('an answer', async () => (await text('#answer')).replace(/.*: no answer from the robot yet/, ''));
    if (!/look, then order again|because the data are stale/.test(said)) return said;
    await until('live data', async () => /^live/.test(await text('#link-status')));
  }
}

export const press = (key) => order(() => page.keyboard.press(key));
