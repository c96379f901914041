// The page in the dark, on narrow screens and by keys alone, with a synthetic robot: synthetic_monitor.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { hipX, picture, pixels, until } from './browser.mjs';
import { answer, monitor, page, press, state, text } from './synthetic.mjs';

test('on a phone in the dark the stop button is in reach and nothing is wider than the screen', async () => {
  await page.evaluate(() => localStorage.setItem('theme', 'dark'));
  await page.setViewportSize({ width: 390, height: 844 });
  await page.reload();
  await until('the robot again', () => page.getAttribute('#stage-canvas', 'data-hip-x'));
  await press('w');
  await until('motion', async () => (await hipX(page)) > 0.3);
  const stop = await page.locator('#stop').boundingBox();
  assert.ok(stop.y > 700 && stop.y + stop.height <= 844 && stop.width > 300, JSON.stringify(stop));
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
  await assertDark();
  await picture(page, 'phone');
  await page.evaluate(() => localStorage.clear());
});

/** Page, cards, picture and plots are dark, and what is written on them is light. */
async function assertDark() {
  assert.equal(await page.getAttribute('html', 'data-theme'), 'dark');
  const light = (colour) => colour.match(/[\d.]+/g).slice(0, 3).reduce((sum, channel) => sum + Number(channel), 0) / (3 * 255);
  for (const selector of ['body', '.card', '#commands', 'figure', '#bar']) {
    const { ground, words } = await page.$eval(selector, (node) => {
      let under = node;
      while (getComputedStyle(under).backgroundColor === 'rgba(0, 0, 0, 0)') under = under.parentElement;
      return { ground: getComputedStyle(under).backgroundColor, words: getComputedStyle(node).color };
    });
    assert.ok(light(ground) < 0.2 && light(words) > 0.55, `${selector}: ${words} on ${ground}`);
  }
  const corner = await page.$eval('#stage-canvas', (canvas) => [...canvas.getContext('2d').getImageData(2, 2, 1, 1).data]);
  assert.deepEqual(corner, [0x14, 0x1a, 0x20, 255]);
}

test('the button and the key L make the page dark and light, drawings included, and the browser remembers it', async () => {
  const light = await pixels(page, '#stage-canvas');
  await page.click('#theme');
  await until('a dark picture', async () => (await pixels(page, '#stage-canvas')) !== light);
  await assertDark();
  await page.reload();
  await until('the robot again', () => page.getAttribute('#stage-canvas', 'data-hip-x'));
  await assertDark();
  await page.keyboard.press('l');
  assert.equal(await page.getAttribute('html', 'data-theme'), 'light');
  await page.evaluate(() => localStorage.clear());
});

test('on the narrowest phone everything fits, and each command and stop can be pressed wherever the page is scrolled', async () => {
  monitor.write('fault driver_hot');
  monitor.write('others');
  await page.setViewportSize({ width: 320, height: 568 });
  await until('the fault', async () => (await page.locator('.fault').count()) === 1);
  await page.evaluate(() => { for (const box of document.querySelectorAll('details')) box.open = true; });
  await page.click('#keys-button');
  const wide = await page.evaluate(() => [...document.querySelectorAll('body *')].filter((node) => {
    const { width, right } = node.getBoundingClientRect();
    return width > 0 && right > window.innerWidth + 1 && !node.closest('#fault-table, pre, .u-wrap');
  }).map((node) => `${node.tagName} ${node.id} ${node.className}`));
  assert.deepEqual(wide, []);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= window.innerWidth));
  await page.click('#keys-close');
  for (const [command, name] of [['step', 'step'], ['walk', 'walk'], ['stand', 'stand'], ['walk', 'walk']]) {
    await page.click(`[data-command=${command}]`);
    await state(name);
  }
  await page.locator('#configuration').scrollIntoViewIfNeeded();
  await page.click('#stop');
  await state('stand');
  await picture(page, 'narrow');
});

test('with a fault on the page the newest events stay in view', async () => {
  await press('w');
  await state('walk');
  monitor.write('fault driver_hot knee_L, 81 C');
  await until('the fault', async () => (await page.locator('.fault').count()) === 1);
  await until('its event', async () => (await page.locator('#event-list li').count()) === 3);
  for (let k = 0; k < 3; ++k) {
    const box = await page.locator('#event-list li').nth(k).boundingBox();
    assert.ok(box.y > 0 && box.y + box.height <= 900, `event ${k}: ${JSON.stringify(box)}`);
  }
  await picture(page, 'fault_and_events');
});

test('a session by keys alone: stand, walk, another speed, a tunable, a look back, the list of keys, stop', async () => {
  monitor.write('idle');
  await state('idle');
  const tabTo = async (selector) => {
    for (let k = 0; k < 200; ++k) {
      if (await page.evaluate((wanted) => document.activeElement.matches(wanted), selector)) return;
      await page.keyboard.press('Tab');
    }
    throw new Error(`${selector} is not reached with Tab`);
  };
  await tabTo('[data-command=stand]');
  await page.keyboard.press('Enter');
  await state('stand');
  await tabTo('#speed');
  await page.keyboard.press('ArrowRight');
  await tabTo('[data-command=walk]');
  await page.keyboard.press('Enter');
  await answer(/walk at 0.55 m\/s: accepted/);
  await state('walk');
  await page.keyboard.press('ArrowDown');
  await answer(/speed 0.50 m\/s: accepted/);
  await tabTo('[data-name="gait.swing_height_m"] input');
  await page.keyboard.press('Control+A');
  await page.keyboard.type('0.08');
  await page.keyboard.press('Enter');
  await answer(/gait.swing_height_m = 0.08: accepted/);
  await tabTo('#pause');
  await page.keyboard.press('Enter');
  await tabTo('[data-command=walk]');
  await page.keyboard.press('ArrowLeft');
  await until('a step back', async () => (await text('#back-value')) === '−0.05 s');
  await page.keyboard.press('p');
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('#keys'));
  await page.keyboard.press('?');
  await page.keyboard.press('Space');
  await answer(/stop: accepted/);
  await state('stand');
});

test('every control can be reached with the keyboard, and Enter presses', async () => {
  await page.evaluate(() => { for (const box of document.querySelectorAll('details')) box.open = true; });
  const all = await page.evaluate(() => {
    const shown = [...document.querySelectorAll('button, input, select, summary, a[href], [tabindex="0"]')]
      .filter((node) => !node.disabled && node.getClientRects().length > 0);
    shown.forEach((node, k) => { node.dataset.control = k; });
    return shown.map((node) => `${node.tagName} ${node.id || node.dataset.command || node.title}`);
  });
  assert.ok(all.length > 60, `${all.length} controls`);
  const reached = new Set();
  for (let k = 0; k < all.length + 5; ++k) {
    await page.keyboard.press('Tab');
    reached.add(await page.evaluate(() => Number(document.activeElement.dataset.control)));
  }
  assert.deepEqual(all.filter((_, k) => !reached.has(k)), [], 'not reached with Tab');
  await page.focus('[data-command=step]');
  await page.keyboard.press('Enter');
  await state('step');
});
