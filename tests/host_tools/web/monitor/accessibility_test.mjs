// The monitor's page by the rules of accessibility, with a synthetic robot: synthetic_monitor. Those of a record and of a
// report are in their tests.

import { test } from 'node:test';
import { assertAccessible } from './accessibility.mjs';
import { hipX, openPage, until } from './browser.mjs';
import { answer, browser, monitor, page, press, state, text } from './synthetic.mjs';

test('no serious finding while the robot walks', async () => {
  await press('w');
  await until('motion', async () => (await hipX(page)) > 0.3);
  await assertAccessible(page, 'accessible_walking');
});

test('no serious finding with a fault, a refused command, a second robot, or a picture that stands still', async () => {
  monitor.write('fault joint_speed_limit');
  monitor.write('others');
  await state('fault');
  await until('both', () => page.isVisible('#runs'));
  await page.keyboard.press('w');
  await answer(/walk: the robot is in state fault/);
  await page.click('#pause');
  await assertAccessible(page, 'accessible_fault');
});

test('no serious finding in a state that refuses commands, or when the data are stale', async () => {
  monitor.write('idle');
  await state('idle');
  monitor.write('silent');
  await until('the alarm', () => page.isVisible('#alarm'));
  await assertAccessible(page, 'accessible_stale');
});

test('no serious finding on a phone that only looks', async () => {
  await until('the key of the first page stored', async () => /This page commands/.test(await text('#access')));
  await page.evaluate(() => localStorage.clear());
  const phone = await openPage(browser, new URL('/', monitor.url).href);
  await phone.setViewportSize({ width: 390, height: 844 });
  await until('the words', async () => /This page only looks/.test(await phone.textContent('#access')));
  await assertAccessible(phone, 'accessible_phone');
  await phone.close();
});
