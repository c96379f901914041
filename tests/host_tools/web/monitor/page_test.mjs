// The page in a browser, with a synthetic robot that does what the tests ask for: synthetic_monitor.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { firstMotion_ms, hipX, openPage, picture, pixels, shownSpeed, until } from './browser.mjs';
import { answer, browser, monitor, order, page, press, state, text } from './synthetic.mjs';

test('a page that is opened while the robot walks shows it moving', async () => {
  await press('w');
  await state('walk');
  const another = await openPage(browser, monitor.url);
  console.log(`first moving frame ${await firstMotion_ms(another)} ms after opening`);
  await another.close();
});

test('a page that is opened during a walk draws the speed commanded before, and no height that it does not know', async () => {
  await press('w');
  await until('two metres', async () => (await hipX(page)) > 2);
  const another = await openPage(browser, monitor.url);
  const caption = (title) => another.textContent(`figure[data-title="${title}"] .legend.dashed b`);
  await until('the commanded height of now', async () => /0.780 m/.test(await caption('Height of the hip')));
  await another.keyboard.press('p');
  await another.fill('#back', '-3');
  await until('three seconds back', async () => (await another.textContent('#back-value')) === '−3.00 s');
  await until('the commanded speed', async () => (await caption('Forward speed')) === '0.50 m/s');
  assert.match(await caption('Height of the hip'), /^(–|0.780 m)$/);
  await another.close();
});

test('walk from the keyboard moves the robot, its picture and the plots', async () => {
  const from = await hipX(page);
  const before = await pixels(page, '#stage-canvas');
  const plot = 'figure[data-title="Forward speed"]';
  const plotBefore = await pixels(page, `${plot} canvas`);
  await press('w');
  await answer(/walk at 0.50 m\/s: accepted/);
  await state('walk');
  await until('a metre', async () => (await hipX(page)) > from + 1);
  assert.notEqual(await pixels(page, '#stage-canvas'), before);
  assert.notEqual(await pixels(page, `${plot} canvas`), plotBefore);
  await until('the speed asked for', async () => Math.abs((await shownSpeed(page)) - 0.5) < 0.05);
  await picture(page, 'walking');
  const rate = await until('a frame rate', () => page.getAttribute('#frame-rate', 'data-value'));
  console.log(`${Number(rate).toFixed(1)} frames per second with all plots`);
});

test('the speed slider changes the speed while walking', async () => {
  await order(() => page.click('[data-command=walk]'));
  await until('0.5 m/s', async () => Math.abs((await shownSpeed(page)) - 0.5) < 0.05);
  await page.fill('#speed', '0.3');
  await until('0.3 m/s', async () => Math.abs((await shownSpeed(page)) - 0.3) < 0.05);
});

/** Height of the hip as written in the picture, m. */
async function shownHeight() {
  return Number((await text('#stage-detail')).match(/hip ([\d.]+) m/)?.[1]);
}

test('slider and keys change the height of the hip', async () => {
  await until('the active height', async () => (await text('#height-value')) === '0.780 m');
  await page.fill('#height', '0.74');
  await answer(/hip height 0.740 m: accepted/);
  await until('a lower hip', async () => Math.abs((await shownHeight()) - 0.74) < 0.02);
  await page.keyboard.press('+');
  await answer(/hip height 0.750 m: accepted/);
  await page.keyboard.press('-');
  await page.keyboard.press('-');
  await answer(/hip height 0.730 m: accepted/);
  await until('a lower hip', async () => Math.abs((await shownHeight()) - 0.73) < 0.02);
});

for (const key of ['Space', 'Escape']) {
  test(`${key} stops, even while something else has the focus`, async () => {
    await press('w');
    await state('walk');
    await page.focus('#tunable-filter');
    await page.keyboard.press(key);
    await answer(/stop: accepted/);
    await state('stand');
    await until('rest', async () => Math.abs(await shownSpeed(page)) < 0.01);
  });
}

test('a wrong token is refused in words, and the right one is not', async () => {
  await page.click('#token-box summary');
  await page.fill('#token', 'a guess');
  await page.click('[data-command=walk]');
  await answer(/walk at 0.50 m\/s: refused. The token is not that of this run./);
  await picture(page, 'wrong_token');
  assert.equal(await text('#state'), 'stand');
  await page.fill('#token', 'open-sesame');
  await order(() => page.click('[data-command=walk]'));
  await answer(/accepted/);
});

test('a silent controller is shown at once, and the picture is marked as old', async () => {
  monitor.write('silent');
  await until('the alarm', async () => /No data for .* the data are stale/.test(await text('#alarm')));
  assert.equal(await text('#stage-cover'), 'STALE DATA');
  await picture(page, 'stale');
  await page.keyboard.press('w');
  await answer(/walk: not sent, because the data are stale .*; Stop and Motors off are sent/);
  await page.keyboard.press('Escape');
  await answer(/stop: accepted/);
  monitor.write('talk');
  await until('no alarm', async () => page.isHidden('#alarm'));
});

test('a walk that is pressed while the link stands still is refused when the link is back, and stop is not', async () => {
  const pressInSilence = async (key) => {
    monitor.process.kill('SIGSTOP');
    try {
      await page.keyboard.press(key);
      await page.waitForTimeout(700);
    } finally {
      monitor.process.kill('SIGCONT');
    }
  };
  await pressInSilence('w');
  await answer(/walk at 0.50 m\/s: refused. The sender's data were [\d.]+ s old .*: look, then order again/);
  assert.equal(await text('#state'), 'stand');
  await until('live data', async () => /^live/.test(await text('#link-status')));
  await press('w');
  await state('walk');
  await pressInSilence('Escape');
  await answer(/stop: accepted/);
});

for (const source of ['robot', 'record']) {
  test(`a monitor of a ${source} that sends nothing, although connected, is shown, and so is its return`, async () => {
    if (source === 'record') {
      monitor.write('record');
      await page.reload();
    }
    const shown = source === 'record' ? /^record$/ : /^live/;
    await until('the source', async () => shown.test(await text('#link-status')));
    monitor.process.kill('SIGSTOP');
    try {
      await until('the alarm', async () => /Nothing from the monitor for [2-9]\.\d s/.test(await text('#alarm')));
      assert.ok(await page.isVisible('#alarm'));
      assert.equal(await text('#stage-cover'), 'STALE DATA');
      assert.match(await text('#link-status'), /^silent \d+ s/);
    } finally {
      monitor.process.kill('SIGCONT');
    }
    // Signs of life that waited may call the page stale once more, and tables are left out until it has caught up.
    const back = source === 'record' ? /^record( · \d+ lost)?$/ : /^live/;
    await until('its return', async () => (await page.isHidden('#alarm')) && (await text('#stage-cover')) === '' &&
      back.test(await text('#link-status')));
  });
}

test('Shift and Escape, or a button, turn the motors off', async () => {
  await page.focus('#tunable-filter');
  await page.keyboard.press('Shift+Escape');
  await answer(/cut: accepted/);
  await state('off');
  assert.ok(await page.isDisabled('#height'));
  assert.match(await page.getAttribute('#height', 'title'), /Not now: the robot is in state off/);
  await page.evaluate(() => { document.getElementById('answer').textContent = ''; });
  await page.click('#cut');
  await answer(/cut: accepted/);
});

test('a monitor that ends is shown', async () => {
  monitor.process.stdin.end();
  await monitor.ended;
  await until('the alarm', async () => /The monitor does not answer/.test(await text('#alarm')));
});

test('a fault says its cause, what the robot does and what clears it', async () => {
  monitor.write('fault joint_speed_limit knee_R, 31 rad/s, limit 21 rad/s');
  await state('fault');
  const card = await until('the fault', () => text('.fault'));
  assert.match(card, /joint_speed_limit 102 · happening now/);
  assert.match(card, /Cause: a joint is faster than its limit/);
  assert.match(card, /Found: knee_R, 31 rad\/s, limit 21 rad\/s\./);
  assert.match(card, /The robot: damps the joints/);
  assert.match(card, /Clears when: every joint is slower; then Reset/);
  await page.keyboard.press('w');
  await answer(/walk: the robot is in state fault; it steps and walks from stand/);
  monitor.write('over joint_speed_limit');
  await until('the cause gone', async () => /102 · waits for Reset/.test(await text('.fault')));
  await picture(page, 'fault');
  await page.keyboard.press('r');
  await until('none', async () => (await text('#fault-list')) === 'None.');
});

test('an emergency stop damps the joints for a time, then the motors are off', async () => {
  monitor.write('fault emergency_stop pressed');
  await state('fault');
  assert.match(await until('the fault', () => text('.fault')), /The robot: damps the joints for 3 s, then turns the motors off\./);
  assert.match(await text('#fault-table'), /emergency_stop.*damps the joints, then turns the motors off/);
});

test('a robot that sits down because of a fault is not asked to stand, step or walk', async () => {
  await press('w');
  await state('walk');
  monitor.write('fault stale_plan');
  await until('the fault', () => text('.fault'));
  for (const command of ['stand', 'step', 'walk']) {
    const button = page.locator(`[data-command=${command}]`);
    await until(`${command} grey`, async () => (await button.getAttribute('aria-disabled')) === 'true');
    assert.match(await button.getAttribute('title'), /Not now: the robot sits down because of stale_plan, which then takes a reset/);
  }
  await page.keyboard.press('t');
  await answer(/step: the robot sits down because of stale_plan/);
  assert.equal(await text('#state'), 'walk');
  assert.equal(await page.getAttribute('[data-command=sit]', 'aria-disabled'), 'false');
});

const pointedOut = () => page.$$eval('figure.pointed-out', (figures) => figures.map((figure) => figure.dataset.title));

test('a fault leads to its plot, which is unfolded where it was folded', async () => {
  const plot = page.locator('figure[data-title="Hip velocity"]');
  assert.ok(await plot.isHidden());
  monitor.write('fault joint_speed_limit');
  await state('fault');
  await page.click('.fault .to-plot');
  assert.deepEqual(await pointedOut(), ['Hip velocity', 'Knee velocity']);
  await until('the plot in view', async () => {
    const box = await plot.boundingBox();
    return box !== null && box.y > 0 && box.y + box.height < 900;
  });
  const still = await pixels(page, 'figure[data-title="Hip velocity"] canvas');
  await until('it drawn', async () => (await pixels(page, 'figure[data-title="Hip velocity"] canvas')) !== still);
  await until('its full width', () => plot.evaluate((figure) => Math.abs(figure.clientWidth - figure.querySelector('canvas').clientWidth) < 2));
  await page.focus('#window');
  assert.deepEqual(await pointedOut(), []);
});

test('every fault of the table leads to a plot in view, but for those that watch what no plot shows', async () => {
  const kWithout = ['driver_fault', 'driver_not_enabled', 'driver_hot', 'driver_overheated', 'low_voltage', 'high_voltage',
    'not_finite', 'heartbeat_lost', 'operator_gone', 'emergency_stop', 'bring_up_failed'];
  await page.click('text=Every fault there is');
  const rows = await page.$$eval('#fault-table tbody tr', (all) => all.map((row) => [row.cells[1].textContent, row.querySelector('.to-plot') !== null]));
  assert.ok(rows.length >= 34);
  assert.deepEqual(rows.filter(([, leads]) => !leads).map(([name]) => name).sort(), kWithout.sort());
  for (const [name] of rows.filter(([, leads]) => leads)) {
    await page.locator('#fault-table .to-plot', { hasText: new RegExp(`^${name}$`) }).click();
    const [title] = await pointedOut();
    assert.ok(title, `${name} leads to no plot`);
    const box = await page.locator('figure.pointed-out').first().boundingBox();
    assert.ok(box.y > 0 && box.y + box.height < 900, `${name}: ${title} is out of view`);
  }
});

test('a hundred events and a hundred keys per second hide neither the motion nor stop', async () => {
  await press('w');
  await state('walk');
  let sent = 0;
  const events = setInterval(() => monitor.write(`event glitch ${sent++}`), 10);
  await page.evaluate(() => {
    let pressed = 0;
    const press = () => document.body.dispatchEvent(
      new KeyboardEvent('keydown', { key: pressed++ % 2 === 0 ? 'ArrowUp' : 'ArrowDown', bubbles: true }));
    window.keys = setInterval(press, 10);
  });
  await until('500 events', () => sent > 500);
  const from = await hipX(page);
  await until('motion', async () => (await hipX(page)) > from + 0.2);
  await page.keyboard.press('Space');
  await state('stand');
  clearInterval(events);
  await page.evaluate(() => clearInterval(window.keys));
  await until('the newest event', async () => (await text('#event-list li:first-child')).endsWith(`glitch ${sent - 1}`));
  assert.ok((await page.locator('#event-list li').count()) <= 100);
});

test('dropped ticks are counted', async () => {
  monitor.write('drop 40');
  await until('the count', async () => /live · \d+ lost/.test(await text('#link-status')));
  assert.match(await page.getAttribute('#link-status', 'title'), /; 40 missing on the way/);
});

test('another run is shown, and its plots and events begin anew', async () => {
  const walked = async () => /state: walk/.test(await text('#event-list'));
  await press('w');
  await until('the event', walked);
  monitor.write('run');
  await until('the note and its name', async () => /Another run/.test(await text('#note')) && /synthetic-2/.test(await text('#run-list')));
  assert.ok(!(await walked()));
});

test('a second controller that publishes at once is shown', async () => {
  monitor.write('others');
  await until('both', async () => /2 controllers send.*synthetic-1[^0-9]/.test(await text('#runs')));
  await page.click('#runs button');
  await until('the other', async () => /Shown and commanded: AMBER3M, run synthetic-77/.test(await text('#runs')));
  assert.match(await text('#run-list'), /synthetic-77/);
  await picture(page, 'two_robots');
});

test('a button that the robot would refuse is grey, says why, and sends nothing', async () => {
  monitor.write('idle');
  await state('idle');
  const walk = page.locator('[data-command=walk]');
  assert.equal(await walk.getAttribute('aria-disabled'), 'true');
  assert.match(await walk.getAttribute('title'), /it steps and walks from stand/);
  assert.equal(await page.getAttribute('[data-command=stand]', 'aria-disabled'), 'false');
  await page.keyboard.press('w');
  await answer(/walk: the robot is in state idle; it steps and walks from stand. Press Stand first/);
  assert.equal(await text('#state'), 'idle');
  await page.keyboard.press('s');
  await state('stand');
  assert.equal(await walk.getAttribute('aria-disabled'), 'false');
});

test('a robot off its feet is drawn pale on the ground, and one that does not answer not at all', async () => {
  monitor.write('fault bus_off');
  await state('fault');
  await until('the words', async () => /the place of the hip is not known/.test(await text('#stage-detail')));
  await picture(page, 'off_its_feet');
  const pale = await pixels(page, '#stage-canvas');
  monitor.write('dead');
  await until('the words', async () => /The joints do not answer/.test(await text('#stage-detail')));
  assert.notEqual(await pixels(page, '#stage-canvas'), pale);
  await picture(page, 'silent_joints');
});

test('a tunable outside its range is not sent, and one inside takes effect', async () => {
  const row = '[data-name="gait.swing_height_m"]';
  await page.fill(`${row} input`, '0.9');
  await page.press(`${row} input`, 'Enter');
  assert.match(await text(`${row} small`), /must be 0.005 to 0.3/);
  assert.equal(await text('#answer'), '');
  await page.fill(`${row} input`, '0.08');
  await page.press(`${row} input`, 'Enter');
  await answer(/gait.swing_height_m = 0.08: accepted/);
  await until('the active value', async () => (await page.inputValue(`${row} input`)) === '0.08');
});

test('timing histograms show their deadline', async () => {
  await until('a histogram', async () => /deadline 500 µs/.test((await text('#histograms')) ?? ''));
});

test('pause holds the picture and looks back, and pause again lets it go', async () => {
  await press('w');
  await until('motion', async () => (await hipX(page)) > 0.2);
  await page.click('#pause');
  const still = await until('a still picture', async () => {
    const first = await pixels(page, '#stage-canvas');
    await page.evaluate(() => new Promise((resolve) => { setTimeout(resolve, 300); }));
    return (await pixels(page, '#stage-canvas')) === first ? first : null;
  });
  const there = await hipX(page);
  await page.fill('#back', '-1');
  await until('where it was a second ago', async () => (await hipX(page)) < there - 0.05);
  assert.equal(await text('#back-value'), '−1.00 s');
  await page.fill('#back', '0');
  await until('where it was', async () => (await hipX(page)) === there);
  await page.click('#pause');
  await until('motion', async () => (await pixels(page, '#stage-canvas')) !== still);
  assert.equal(await text('#back-value'), 'live');
  assert.equal(await page.inputValue('#back'), '0');
});

test('the bar of a live robot goes back as far as the page remembers, and who moves it pauses', async () => {
  await press('w');
  await until('motion', async () => (await hipX(page)) > 1);
  assert.equal(await text('#back-value'), 'live');
  await until('some seconds', async () => Number(await page.getAttribute('#back', 'min')) <= -2);
  const [, megabytes] = (await page.getAttribute('#back', 'title')).match(/The last \d+ s are remembered, 300 s at most, in (\d+) MB/);
  assert.ok(Number(megabytes) > 50 && Number(megabytes) < 115, `${megabytes} MB`);
  await page.fill('#back', '-2');
  await until('two seconds back', async () => (await text('#back-value')) === '−2.00 s');
  assert.equal(await page.getAttribute('#pause', 'aria-pressed'), 'true');
  await page.keyboard.press('p');
  await until('now', async () => (await text('#back-value')) === 'live');
});

test('dragging over a plot zooms only while paused, and a click there shows that moment', async () => {
  await press('w');
  await until('motion', async () => (await hipX(page)) > 0.5);
  const box = await page.locator('figure[data-title="Forward speed"] .u-over').boundingBox();
  const plot = 'figure[data-title="Height of the hip"] canvas';
  const drag = async () => {
    await page.mouse.move(box.x + 0.85 * box.width, box.y + 50);
    await page.mouse.down();
    await page.mouse.move(box.x + 0.95 * box.width, box.y + 50, { steps: 5 });
    await page.mouse.up();
    await page.mouse.move(0, 0);
  };
  await drag();
  await page.click('#pause');
  await until('the newest moment at the right edge', async () => (await text('#back-value')) === '0.00 s');
  const still = () => pixels(page, plot);
  const all = await still();
  await drag();
  await until('zoomed plots', async () => (await still()) !== all);
  await until('the start of the window', async () => Math.abs(parseFloat((await text('#back-value')).replace('−', '-')) + 1.5) < 0.1);
  await page.mouse.click(box.x + 0.5 * box.width, box.y + 50);
  await until('its middle', async () => Math.abs(parseFloat((await text('#back-value')).replace('−', '-')) + 1) < 0.1);
});

test('a record is shown as one and takes no commands', async () => {
  monitor.write('record');
  await page.reload();
  await until('the words', async () => /A record: it takes no commands/.test(await text('#answer')));
  assert.ok(await page.isHidden('#stop'));
  assert.ok(await page.isHidden('#gaits'));
});
