// The page of a run in a browser: a short walk with a push.

import assert from 'node:assert/strict';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { pathToFileURL } from 'node:url';
import { after, afterEach, before, test } from 'node:test';
import { assertAccessible } from '../monitor/accessibility.mjs';
import { openBrowser, openPage, ownDomain, picture, pixels, Program, until } from '../monitor/browser.mjs';

const kDomain = ownDomain();
const kSpeed = 'figure[data-title="Forward speed"]';

let browser;
let folder;
let url;
let page;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'stilt-report-'));
  const file = join(folder, 'run.html');
  const words = ['sim', '--gait', 'walk', '--speed', '0.5', '--duration', '3', '--push', '30@2+0.2', '--report', file];
  const run = new Program(process.env.STILT_PROGRAM, words);
  assert.equal(await run.ended, 0, run.output);
  url = pathToFileURL(file).href;
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  rmSync(folder, { recursive: true, force: true });
});

afterEach(async () => {
  const { problems } = page;
  await page.close();
  assert.deepEqual(problems, []);
});

/** The time that the page shows, s. */
const shownTime = async () => Number((await page.textContent('#clock')).split(' ')[0]);
const kPixel_s = 0.02;
const shows = (time_s) => until(`${time_s} s`, async () => Math.abs((await shownTime()) - time_s) < kPixel_s);
const caption = () => page.textContent(`${kSpeed} figcaption`);

/** Place of a time in the plot of the speed while the whole run is shown. */
async function placeOf(time_s) {
  const box = await page.locator(`${kSpeed} .u-over`).boundingBox();
  return { x: box.x + (box.width * time_s) / 3, y: box.y + box.height / 2 };
}

test('a run plays when its page is opened, and space pauses it', async () => {
  page = await openPage(browser, url);
  await until('motion', async () => (await shownTime()) > 0.3);
  await page.keyboard.press('Space');
  const paused_s = await shownTime();
  await page.waitForTimeout(300);
  assert.ok((await shownTime()) - paused_s < 0.1);
});

test('the robot, the values and the push are those of the time shown', async () => {
  page = await openPage(browser, url, '#t=2.1');
  await shows(2.1);
  await until('the speed commanded', async () => /commanded 0.50 m\/s/.test(await caption()));
  const pushed = await pixels(page, '#stage-canvas');
  await picture(page, 'report');
  await page.keyboard.press('Home');
  await shows(0);
  await until('another picture', async () => (await pixels(page, '#stage-canvas')) !== pushed);
});

test('heights, pitch and speed have the names of the monitor', async () => {
  page = await openPage(browser, url);
  const monitor = readFileSync(new URL('../../../../host_tools/web/monitor/page/plot_list.js', import.meta.url), 'utf-8');
  const titles = await page.$$eval('figure', (all) => all.slice(0, 4).map((figure) => figure.dataset.title.replace(/ \(.*/, '')));
  for (const title of titles) assert.ok(monitor.includes(`title: '${title}'`), title);
});

test('a click on a plot moves the time, dragging zooms all plots, a double click shows the whole run', async () => {
  page = await openPage(browser, url, '#t=0');
  const other = 'figure[data-title="Height of the feet"] canvas';
  await page.locator(kSpeed).scrollIntoViewIfNeeded();
  const middle = await placeOf(1.5);
  await page.mouse.click(middle.x, middle.y);
  await shows(1.5);
  await page.mouse.move(0, 0);
  const whole = await pixels(page, other);
  const [from, to] = [await placeOf(1), await placeOf(2)];
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, { steps: 5 });
  await page.mouse.up();
  await until('zoomed plots', async () => (await pixels(page, other)) !== whole);
  await page.mouse.dblclick(to.x, to.y);
  await page.mouse.move(0, 0);
  await until('the whole run', async () => (await pixels(page, other)) === whole);
});

test('a click on a name hides its line and shows it again', async () => {
  page = await openPage(browser, url, '#t=1');
  await shows(1);
  const canvas = `${kSpeed} canvas`;
  await until('values', async () => /true −?\d/.test(await caption()));
  const both = await pixels(page, canvas);
  await page.click(`${kSpeed} .legend`);
  await until('a line less', async () => (await pixels(page, canvas)) !== both);
  await page.click(`${kSpeed} .legend`);
  await until('the line', async () => (await pixels(page, canvas)) === both);
});

test('the still picture shows the robot without the page around it', async () => {
  page = await openPage(browser, url, '#t=2.1&still');
  assert.ok(await page.isHidden('#plots'));
  const empty = await page.evaluate(() => {
    const canvas = document.getElementById('still-canvas');
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    const colours = new Set();
    for (let i = 0; i < data.length; i += 4) colours.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
    return colours.size < 10;
  });
  assert.ok(!empty);
});

test('the report of a robot behind its buses speaks of no plan and no command', async () => {
  const file = join(folder, 'robot.html');
  const buses = ['left', 'right'].flatMap((side) => ['--bus', `loopback:stilt_report_${process.pid}_${side}`]);
  const robot = new Program(process.env.STILT_PROGRAM, ['robot', '--lockstep', '--once', ...buses, '--report', file]);
  await robot.wrote(/ready/);
  const controller = new Program(process.env.STILTD_PROGRAM,
    ['--lockstep', ...buses, '--set', 'telemetry.enabled=false', '--start', 'walk@0.3', '--duration', '6']);
  assert.equal(await controller.ended, 0, controller.output);
  assert.equal(await robot.ended, 0, robot.output);
  page = await openPage(browser, pathToFileURL(file).href);
  const detail = await until('a readout', async () => (await page.textContent('#stage-detail')) || null);
  assert.match(detail, /m\/s · stance/);
  assert.doesNotMatch(detail, /NaN|commanded/);
  assert.ok(await page.isHidden('.key.plan'));
  await picture(page, 'robot_report');
});

/** A record of a robot that stands up and walks in lock-step. */
async function record(name, words) {
  const file = join(folder, `${name}.mcap`);
  const buses = ['left', 'right'].flatMap((side) => ['--bus', `loopback:stilt_${name}_${process.pid}_${side}`]);
  const recorder = new Program(process.env.STILT_PROGRAM, ['record', '--out', file, '--domain', kDomain]);
  await recorder.wrote(/recording to/);
  const robot = new Program(process.env.STILT_PROGRAM, ['robot', '--lockstep', '--once', ...buses]);
  await robot.wrote(/ready/);
  const controller = new Program(process.env.STILTD_PROGRAM,
    ['--lockstep', ...buses, '--set', `telemetry.domain=${kDomain}`, ...words]);
  assert.equal(await controller.ended, 0, controller.output);
  assert.equal(await robot.ended, 0, robot.output);
  recorder.kill('SIGINT');
  assert.equal(await recorder.ended, 0, recorder.output);
  return file;
}

test('two records are in one page: plots, settings that differ, outcomes, events', async () => {
  const files = [
    await record('slow', ['--start', 'walk@0.3', '--duration', '6']),
    await record('high', ['--start', 'walk@0.3', '--duration', '5', '--set', 'gait.swing_height_m=0.09']),
  ];
  const file = join(folder, 'both.html');
  const report = new Program(process.env.STILT_PROGRAM, ['report', ...files, '--out', file]);
  assert.equal(await report.ended, 0, report.output);
  page = await openPage(browser, pathToFileURL(file).href, '#t=5');
  await shows(5);
  assert.equal(await page.textContent('#headline'), 'slow.mcap (in full) and high.mcap (dashed)');
  const text = await page.textContent('#summary');
  assert.match(text, /gait\.swing_height_m0\.070\.09/);
  assert.doesNotMatch(text, /gait\.single_support_s/);
  assert.match(text, /Last statereadyready/);
  assert.match(text, /events of slow\.mcap[^]*walk[^]*events of high\.mcap[^]*walk/);
  assert.match(await caption(), /estimated −?\d[^]*estimated, second −?\d/);
  const foot = 'figure[data-title="Height of the feet"] .u-over';
  await page.locator(foot).scrollIntoViewIfNeeded();
  const canvas = `figure[data-title="Height of the feet"] canvas`;
  const both = await pixels(page, canvas);
  const second = page.locator('figure[data-title="Height of the feet"] .legend', { hasText: 'left, second' });
  await second.click();
  await until('a line less', async () => (await pixels(page, canvas)) !== both);
  await assertAccessible(page, 'accessible_comparison');
});

test('the report of a record shows the estimate, the events and no true state', async () => {
  const file = join(folder, 'record.html');
  const report = new Program(process.env.STILT_PROGRAM, ['report', join(folder, 'slow.mcap'), '--out', file]);
  assert.equal(await report.ended, 0, report.output);
  page = await openPage(browser, pathToFileURL(file).href, '#t=5');
  await shows(5);
  assert.equal(await page.textContent('#outcome'), 'ended in state ready');
  assert.match(await page.textContent('#summary'), /Mean speed in state walk0\.[23]/);
  assert.doesNotMatch(await page.textContent('#plots'), /true|NaN/);
  const empty = await pixels(page, '#stage-canvas');
  await page.keyboard.press('Home');
  await until('another picture', async () => (await pixels(page, '#stage-canvas')) !== empty);
  await picture(page, 'record_report');
  await page.keyboard.press('End');
  await until('a robot that sits', async () => /not known off its feet/.test(await page.textContent('#stage-detail')));
});

test('no serious finding by the rules of accessibility, in the light and in the dark', async () => {
  page = await openPage(browser, url, '#t=2.1');
  await shows(2.1);
  await assertAccessible(page, 'accessible_report');
});
