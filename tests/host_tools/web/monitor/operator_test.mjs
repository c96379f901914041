// What an operator holds and presses: gamepads, and the list of keys; with a synthetic robot: synthetic_monitor. The
// gamepads are those that the test puts in place of navigator.getGamepads.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { shownSpeed, until } from './browser.mjs';
import { assertAccessible } from './accessibility.mjs';
import { answer, forget, monitor, page, press, state, text } from './synthetic.mjs';

const kA = 0, kB = 1, kX = 2, kY = 3, kLB = 4, kRB = 5;

/** The page has one gamepad that is held like this; none with `buttons` null. */
async function hold(buttons, { forward = 0, mapping = 'standard' } = {}) {
  await page.evaluate(([held, stick, layout]) => {
    const pad = held && {
      id: 'Test Pad (STANDARD GAMEPAD Vendor: 0000)', index: 0, connected: true, mapping: layout, axes: [0, -stick, 0, 0],
      buttons: Array.from({ length: 17 }, (_, k) => ({ pressed: held.includes(k), value: held.includes(k) ? 1 : 0 })),
    };
    navigator.getGamepads = () => [null, pad];
  }, [buttons, forward, mapping]);
  await page.waitForTimeout(100);
}

const says = (pattern) => until(`words like ${pattern}`, async () => pattern.test(await text('#gamepad')));

/** Walks by gamepad at the largest speed; LB stays held. */
async function walk() {
  await hold([]);
  await hold([kLB]);
  await hold([kLB, kA], { forward: 1 });
  await state('walk');
}

test('with the enabling button held the buttons stand, step and walk, and the stick sets the speed', async () => {
  await hold([]);
  await says(/Gamepad Test Pad: hold LB or RB to command. B stops/);
  await hold([kRB]);
  await says(/is enabled/);
  await hold([kRB, kX]);
  await state('step');
  await hold([kRB]);
  await hold([kRB, kY]);
  await state('stand');
  await hold([kRB], { forward: 0.575 });
  assert.equal(await text('#speed-value'), '0.50 m/s');
  await hold([kRB, kA], { forward: 0.575 });
  await answer(/walk at 0.50 m\/s: accepted/);
  await state('walk');
  await hold([kRB], { forward: 0.405 });
  await answer(/speed 0.30 m\/s: accepted/);
  await until('that speed', async () => Math.abs((await shownSpeed(page)) - 0.3) < 0.05);
  await hold([kRB], { forward: -1 });
  await answer(/speed −0.40 m\/s: accepted/);
  await hold([kRB], { forward: 0.1 });
  await answer(/speed 0.00 m\/s: accepted/);
});

test('without the enabling button a gamepad commands nothing', async () => {
  await hold([]);
  for (const button of [kX, kY, kA]) {
    await hold([button], { forward: 1 });
    await hold([]);
  }
  assert.equal(await text('#answer'), '');
  assert.equal(await text('#speed-value'), '0.50 m/s');
  assert.equal(await text('#state'), 'stand');
});

test('stop needs no enabling button, not even of a gamepad that was not there before', async () => {
  await press('w');
  await state('walk');
  await hold([kB]);
  await answer(/stop: accepted/);
  await state('stand');
});

test('letting go of the enabling button stops what the gamepad moves, and nothing else', async () => {
  await walk();
  await forget();
  await hold([], { forward: 1 });
  await answer(/stop: accepted/);
  await state('stand');
  await press('t');
  await state('step');
  await forget();
  await hold([kLB]);
  await hold([]);
  await page.waitForTimeout(300);
  assert.equal(await text('#state'), 'step');
  assert.equal(await text('#answer'), '');
});

test('letting go stops a robot whose speed the stick changed, whoever made it walk', async () => {
  await press('w');
  await state('walk');
  await hold([]);
  await hold([kLB], { forward: 1 });
  await answer(/speed 1.00 m\/s: accepted/);
  await hold([]);
  await state('stand');
});

test('a gamepad that is gone, or a page that is hidden, stops like letting go', async () => {
  await walk();
  await hold(null);
  await state('stand');
  assert.ok(await page.isHidden('#gamepad'));
  await walk();
  await page.evaluate(() => {
    Object.defineProperty(document, 'hidden', { value: true, configurable: true });
    document.dispatchEvent(new Event('visibilitychange'));
  });
  await state('stand');
  await forget();
  await hold([]);
  await hold([kLB]);
  await hold([kLB, kA]);
  assert.equal(await text('#answer'), '', 'a hidden page takes no commands');
});

test('buttons that are held when a gamepad appears command nothing', async () => {
  await hold([kLB, kA], { forward: 1 });
  await says(/hold LB or RB/);
  await hold([kLB], { forward: 1 });
  await hold([kLB, kA], { forward: 1 });
  assert.equal(await text('#state'), 'stand');
  assert.equal(await text('#answer'), '');
});

test('each button of a gamepad without a known layout stops, and no more', async () => {
  await press('w');
  await state('walk');
  await hold([], { mapping: '' });
  await says(/has no layout for Test Pad, so each of its buttons stops/);
  await hold([kLB, kA], { forward: 1, mapping: '' });
  await answer(/stop: accepted/);
  await state('stand');
});

test('each key sends its command', async () => {
  for (const [key, command, after] of [['t', 'step', 'step'], ['w', 'walk at 0.50 m/s', 'walk'],
    ['ArrowUp', 'speed 0.55 m/s', 'walk'], ['ArrowDown', 'speed 0.50 m/s', 'walk'], ['W', 'walk at 0.50 m/s', 'walk'],
    ['+', 'hip height 0.790 m', 'walk'], ['-', 'hip height 0.780 m', 'walk'], ['s', 'stand', 'stand'], ['d', 'sit', 'stand']]) {
    assert.equal(await press(key), `${command}: accepted`, key);
    await state(after);
  }
  monitor.write('fault joint_speed_limit');
  await state('fault');
  assert.equal(await press('r'), 'reset: accepted');
});

test('the keys are listed by a button and by ?, without covering stop', async () => {
  assert.ok(await page.isHidden('#keys'));
  await page.click('#keys-button');
  assert.equal(await page.getAttribute('#keys-button', 'aria-expanded'), 'true');
  assert.deepEqual(await page.locator('#keys kbd').allTextContents(), ['space', 'Esc', 'Shift', 'space', 'Esc', 'S', 'T', 'W',
    'D', 'R', '↑', '↓', '+', '−', 'P', '←', '→', 'Home', 'L', '?', 'Tab', 'Enter']);
  assert.deepEqual(await page.locator('#keys dd b').allTextContents(), ['LB', 'RB', 'A', 'X', 'Y', 'B']);
  await assertAccessible(page, 'keys');
  await page.click('#stop');
  await answer(/stop: accepted/);
  await page.click('#keys-close');
  assert.ok(await page.isHidden('#keys'));
  await page.keyboard.press('?');
  assert.ok(await page.isVisible('#keys'));
  await press('w');
  await state('walk');
  await page.keyboard.press('Escape');
  await state('stand');
  assert.ok(await page.isHidden('#keys'));
});
