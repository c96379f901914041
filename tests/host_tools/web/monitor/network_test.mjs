// What the page shows of data that come late or not at all, with a synthetic robot: synthetic_monitor.

import assert from 'node:assert/strict';
import net from 'node:net';
import { test } from 'node:test';
import { openPage, shownSpeed, until } from './browser.mjs';
import { browser, monitor, page, press, state, text } from './synthetic.mjs';

const kPeriod_s = 0.02;

/** Passes connections on to `target`; what comes back is at most as fast as its `rate_B_s`. */
async function slowNetwork(target) {
  const network = { rate_B_s: Infinity, sockets: new Set() };
  const server = net.createServer((page) => {
    const behind = net.connect(Number(new URL(target).port), '127.0.0.1');
    for (const socket of [page, behind]) {
      network.sockets.add(socket);
      socket.on('error', () => {});
    }
    page.pipe(behind);
    const timer = setInterval(() => {
      const room = Math.min(behind.readableLength, Math.ceil(network.rate_B_s * kPeriod_s));
      const bytes = room > 0 ? behind.read(room) : behind.read(0);
      if (bytes) page.write(bytes);
    }, 1000 * kPeriod_s);
    behind.on('end', () => page.end());
    behind.on('close', () => {
      clearInterval(timer);
      page.end();
    });
    page.on('close', () => behind.destroy());
  });
  await new Promise((resolve) => { server.listen(0, '127.0.0.1', resolve); });
  network.url = `http://127.0.0.1:${server.address().port}/`;
  network.close = () => {
    for (const socket of network.sockets) socket.destroy();
    server.close();
  };
  return network;
}

test('a page whose network is too slow is stale, stays a few seconds behind at most, and is live again after that', async () => {
  const network = await slowNetwork(monitor.url);
  const far = await openPage(browser, network.url);
  const live = () => until('live data', async () => /^live/.test(await far.textContent('#link-status')));
  try {
    await live();
    await far.waitForTimeout(2500);  // while a page opens it gets all tables
    network.rate_B_s = 60_000;
    const behind_s = async () => Number((await far.textContent('#alarm')).match(/([\d.]+) s behind the monitor/)?.[1] ?? 0);
    await until('the alarm', async () => (await behind_s()) > 0.5 && far.isVisible('#alarm'));
    let most_s = 0;
    for (let k = 0; k < 120; ++k) {
      most_s = Math.max(most_s, await behind_s());
      await far.waitForTimeout(100);
    }
    console.log(`at most ${most_s} s behind`);
    assert.ok(most_s < 4, `${most_s} s behind`);
    network.rate_B_s = Infinity;
    await live();
    assert.match(await far.textContent('#link-status'), /lost/);
  } finally {
    await far.close();
    network.close();
  }
});

test('what was before a silence is not shown as of now', async () => {
  const before = page.locator('.before');
  await press('w');
  await state('walk');
  await until('a speed', async () => (await shownSpeed(page)) > 0.3);
  const emergencyStop = (pattern) => until(`an emergency stop like ${pattern}`, async () => pattern.test(await text('#emergency-stop')));
  await emergencyStop(/^emergency stop not configured$/);
  assert.ok(await before.first().isHidden());
  monitor.write('silent');
  await until('the cover', async () => (await text('#stage-cover')) === 'STALE DATA');
  await emergencyStop(/^emergency stop not known$/);
  await until('no speed', async () => (await text('#speed-now')) === '–' && (await shownSpeed(page)) === null);
  assert.deepEqual(await before.allTextContents(), ['before the silence', 'before the silence']);
  for (const one of await before.all()) assert.ok(await one.isVisible());
  const filterOf = (selector) => page.$eval(selector, (shown) => getComputedStyle(shown).filter);
  for (const selector of ['#state', '#faults']) assert.equal(await filterOf(selector), 'grayscale(1)', selector);
  assert.equal(await text('#state'), 'walk');
  monitor.write('talk');
  await emergencyStop(/^emergency stop not configured$/);
  await until('a speed', async () => (await shownSpeed(page)) !== null);
  assert.ok(await before.first().isHidden());
});
