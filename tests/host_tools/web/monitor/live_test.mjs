// The whole thing: simulated robot, stiltd and monitor as programs on the loopback interface, and the page in a browser.
// Robot and controller take turns, so that a busy machine changes how fast they go and nothing else. The page has the
// processors before them. With STILT_LIVE_REALTIME=1 they follow the clock, and late ticks are only reported.

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { hipX, openBrowser, openPage, ownDomain, picture, pixels, Program, shownSpeed, until } from './browser.mjs';

const kNumber = process.pid;
const kDomain = ownDomain();
const kBuses = ['left', 'right'].flatMap((side) => ['--bus', `loopback:stilt_monitor_${kNumber}_${side}`]);
const kTurns = process.env.STILT_LIVE_REALTIME ? [] : ['--lockstep'];
const kPatientSettings = ['supervisor.torque_loop_stall_s=10', 'supervisor.missed_hold_ticks=500',
  'supervisor.missed_damp_ticks=1000', 'supervisor.stale_plan_s=5', 'supervisor.heartbeat_timeout_s=30',
  'supervisor.operator_gone_s=60', 'telemetry.release_s=60',
  `telemetry.domain=${kDomain}`].flatMap((setting) => ['--set', setting]);

let browser;
let folder;
let robot;
let controller;
let monitor;
let page;

const text = (selector) => page.textContent(selector);
/** What the page showed when it was not what the test waits for. */
const waitFor = (selector, pattern, from = page) => {
  let seen = '';
  return until(`${selector} to be like ${pattern}`, async () => {
    seen = await from.textContent(selector);
    return pattern.test(seen);
  }).catch((error) => { throw new Error(`${error.message}; it is: ${seen}`); });
};
const state = (name) => waitFor('#state', new RegExp(`^${name}$`));
const answer = (pattern) => waitFor('#answer', pattern);

/** Asks for it again while it is refused: until the torque law is blended in. */
const walk = () => until('walking', async () => {
  if ((await text('#state')) === 'walk') return true;
  await page.keyboard.press('w');
  await page.waitForTimeout(2000);
  return false;
});

/** `stilt` or `stiltd`, at the niceness of a process whose time is not the clock's. */
const start = (program, words) => (process.env.STILT_LIVE_REALTIME ? new Program(program, words)
  : new Program('nice', ['-n', '10', program, ...words]));
const startRobot = (buses = kBuses, words = []) => start(process.env.STILT_PROGRAM,
  ['robot', ...kTurns, ...buses, ...words]);
const startController = (buses = kBuses, words = [], token = 'token') => start(process.env.STILTD_PROGRAM,
  [...kTurns, ...buses, ...words, ...kPatientSettings, '--set', `telemetry.token_file=${join(folder, token)}`]);

function startMonitor(words = []) {
  return new Program(process.env.STILT_PROGRAM, ['monitor', '--port', '0', '--no-browser', '--domain', kDomain, ...words]);
}

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'stilt-live-'));
  browser = await openBrowser();
  robot = startRobot();
  await robot.wrote(/ready/);
  controller = startController();
  monitor = startMonitor();
  [monitor.url] = await monitor.wrote(/http:\S+/);
  page = await openPage(browser, monitor.url);
});

after(async () => {
  await browser.close();
  await Program.killAll();
  for (const program of [monitor, controller, robot]) console.log(`${program?.name}: ${program?.output.slice(-1500)}`);
  rmSync(folder, { recursive: true, force: true });
});

test('the page finds the controller and shows the robot standing up and walking', async () => {
  await until('live data', async () => (await text('#link-status')).startsWith('live'));
  const plot = 'figure[data-title="Height of the hip"] canvas';
  const before = await pixels(page, plot);
  await state('idle');
  await page.keyboard.press('s');
  await state('stand');
  await page.fill('#speed', '0.3');
  await walk();
  const from = await hipX(page);
  const still = await pixels(page, '#stage-canvas');
  await until('a metre', async () => (await hipX(page)) > from + 1);
  assert.notEqual(await pixels(page, '#stage-canvas'), still);
  assert.notEqual(await pixels(page, plot), before);
  await until('0.3 m/s', async () => Math.abs((await shownSpeed(page)) - 0.3) < 0.08);
});

test('another speed from the page changes the measured speed', async () => {
  await page.fill('#speed', '0.5');
  await answer(/speed 0.50 m\/s: accepted/);
  await until('0.5 m/s', async () => Math.abs((await shownSpeed(page)) - 0.5) < 0.08);
  await page.waitForTimeout(3000);
  await picture(page, 'live_walking');
  console.log(`${Number(await page.getAttribute('#frame-rate', 'data-value')).toFixed(1)} frames per second with all plots`);
});

test('a tunable changes while the robot walks', async () => {
  const input = '[data-name="gait.swing_height_m"] input';
  await page.fill(input, '0.07');
  await page.press(input, 'Enter');
  await answer(/gait.swing_height_m = 0.07: accepted/);
  await until('the active value', async () => (await page.inputValue(input)) === '0.07');
});

test('a wrong token is refused in words', async () => {
  const guess = join(folder, 'guess');
  writeFileSync(guess, 'a-guess-of-a-token', { mode: 0o600 });
  const other = startMonitor(['--token-file', guess]);
  const [url] = await other.wrote(/http:\S+/);
  const intruder = await openPage(browser, url);
  await until('live data', async () => (await intruder.textContent('#link-status')).startsWith('live'));
  await intruder.keyboard.press('d');
  const refused = await until('a refusal', async () => {
    const said = await intruder.textContent('#answer');
    return /refused/.test(said) ? said : null;
  });
  console.log(refused);
  assert.match(refused, /token/i);
  assert.equal(await text('#state'), 'walk');
  await intruder.close();
  await other.kill();
});

/** Another simulated robot and its stiltd on the same domain. */
async function startSecond(words) {
  const buses = kBuses.map((word) => word.replace('loopback:', 'loopback:second_'));
  const second = startRobot(buses);
  await second.wrote(/ready/);
  const its = startController(buses, words, 'second-token');
  return { second, its, end: async () => { await its.kill('SIGKILL'); await second.kill('SIGKILL'); } };
}

test('a second robot that starts takes the page from no walking one', async () => {
  const { end } = await startSecond([]);
  await until('both', async () => /2 controllers send/.test(await text('#runs')));
  const from = await hipX(page);
  await until('another metre', async () => (await hipX(page)) > from + 1);
  assert.equal(await text('#state'), 'walk');
  assert.doesNotMatch(await text('#note'), /Another run/);
  await end();
  await until('the walking one alone', () => page.isHidden('#runs'));
  assert.equal(await text('#state'), 'walk');
});

test('stop stops both robots, of which the page shows one', async () => {
  const { its, end } = await startSecond(['--start', 'walk@0.3']);
  await until('both', async () => /2 controllers send/.test(await text('#runs')));
  await its.wrote(/ s {2}walk/);
  await picture(page, 'live_two_robots');
  await page.bringToFront();
  await page.keyboard.press('Space');
  await answer(/stop: accepted/);
  await state('stand');
  await its.wrote(/ s {2}walk[^]* s {2}stand/);
  await end();
  await until('one alone', () => page.isHidden('#runs'));
});

test('a page without the link that was given both tokens stops both robots, too', async () => {
  const other = startMonitor();
  const [url] = await other.wrote(/http:\S+/);
  const phone = await openPage(browser, new URL('/', url).href);
  const said = (pattern) => waitFor('#answer', pattern, phone);
  const enter = async (name) => {
    await phone.fill('#token', readFileSync(join(folder, name), 'utf-8').trim());
    await phone.evaluate(() => { document.activeElement.blur(); document.getElementById('answer').textContent = ''; });
  };
  await until('live data there', async () => (await phone.textContent('#link-status')).startsWith('live'));
  await enter('token');
  await phone.keyboard.press('Space');
  await said(/stop: accepted/);
  const { its, end } = await startSecond(['--start', 'walk@0.3']);
  await its.wrote(/ s {2}walk/);
  const first = await phone.textContent('#run-list');
  await phone.click('#runs button');
  await until('the other run', async () => (await phone.textContent('#run-list')) !== first);
  await enter('second-token');
  await page.bringToFront();
  await page.click('[data-command=walk]');
  await state('walk');
  await phone.bringToFront();
  await phone.keyboard.press('Space');
  await said(/stop: accepted/);
  await state('stand');
  await its.wrote(/ s {2}walk[^]* s {2}stand/);
  await phone.close();
  await other.kill();
  await end();
  await until('one alone', () => page.isHidden('#runs'));
});

test('stop stops', async () => {
  await page.bringToFront();
  await page.keyboard.press('Space');
  await answer(/stop: accepted/);
  await state('stand');
  await until('rest', async () => Math.abs(await shownSpeed(page)) < 0.03);
});

test('a killed robot is a fault with its cause, and the picture is marked as old once its controller has ended', async () => {
  await state('stand');
  await robot.kill('SIGKILL');
  await waitFor('#event-list', /a bus is gone/);
  await waitFor('#fault-list', /bus_disconnected 305.*Cause: a bus is gone.*The robot: damps the joints/);
  await waitFor('#alarm', /No data for .* the data are stale/);
  await until('the cover', async () => (await text('#stage-cover')) === 'STALE DATA');
  await picture(page, 'live_killed_robot');
  assert.deepEqual(page.problems, []);
});

test('a killed controller leaves a stale picture, marked as one, and the next is another run', async () => {
  robot = startRobot();
  await robot.wrote(/ready/);
  controller = startController();
  await until('live data', async () => (await text('#link-status')).startsWith('live'));
  await controller.kill('SIGKILL');
  await until('the alarm', async () => /No data for .* the data are stale/.test(await text('#alarm')));
  await until('the cover', async () => (await text('#stage-cover')) === 'STALE DATA');
  await picture(page, 'live_stale');
  controller = startController();
  await until('the note', async () => /Another run/.test(await text('#note')));
  await until('live data', async () => (await text('#link-status')).startsWith('live'));
  assert.deepEqual(page.problems, []);
});

test('a watch shows limp joints and the emergency stop, and takes no order but its end', async () => {
  await controller.kill('SIGKILL');
  await robot.kill('SIGKILL');
  robot = startRobot(kBuses, ['--hang']);
  await robot.wrote(/ready/);
  controller = start(process.env.STILTD_PROGRAM, ['watch', ...kTurns, ...kBuses,
    '--set', `telemetry.domain=${kDomain}`, '--set', `telemetry.token_file=${join(folder, 'token')}`]);
  await state('watch');
  await waitFor('#emergency-stop', /^emergency stop released$/);
  for (const command of ['stand', 'step', 'walk', 'sit', 'reset']) {
    assert.equal(await page.getAttribute(`[data-command="${command}"]`, 'aria-disabled'), 'true', command);
  }
  assert.ok(await page.isDisabled('#height'));
  await until('the pose', async () => /the place of the hip is not known/.test(await text('#stage-detail')));
  await picture(page, 'live_watch');
  await page.click('#cut');
  assert.equal(await controller.ended, 0);
  assert.deepEqual(page.problems, []);
});
