// The page of a record: a walk of the simulated robot, recorded, then played by `stilt replay --monitor`.

import assert from 'node:assert/strict';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, afterEach, before, beforeEach, test } from 'node:test';
import { assertAccessible } from './accessibility.mjs';
import { hipX, openBrowser, openPage, ownDomain, picture, Program, until } from './browser.mjs';

const kDomain = ownDomain();
const kBuses = ['left', 'right'].flatMap((side) => ['--bus', `loopback:stilt_record_${process.pid}_${side}`]);

let browser;
let folder;
let replay;
let url;
let page;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'stilt-record-'));
  const file = join(folder, 'walk.mcap');
  const record = new Program(process.env.STILT_PROGRAM, ['record', '--out', file, '--domain', kDomain]);
  await record.wrote(/recording to/);
  const robot = new Program(process.env.STILT_PROGRAM, ['robot', '--lockstep', '--once', ...kBuses]);
  await robot.wrote(/ready/);
  const controller = new Program(process.env.STILTD_PROGRAM, ['--lockstep', ...kBuses, '--start', 'walk@0.5', '--duration', '20',
    '--set', `telemetry.domain=${kDomain}`, '--set', `telemetry.token_file=${join(folder, 'token')}`]);
  assert.equal(await controller.ended, 0, controller.output);
  await robot.ended;
  await record.kill('SIGINT');
  replay = new Program(process.env.STILT_PROGRAM, ['replay', file, '--monitor', '--port', '0', '--no-browser']);
  [url] = await replay.wrote(/http:\S+/);
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  await Program.killAll();
  rmSync(folder, { recursive: true, force: true });
});

beforeEach(async () => { page = await openPage(browser, url); });

afterEach(async () => {
  const { problems } = page;
  await page.close();
  assert.deepEqual(problems, []);
});

/** Place in the record and its length as a page shows them, s. */
async function shownTime(of = page) {
  const [, at_s, length_s] = (await of.textContent('#record-time')).match(/([\d.]+) of ([\d.]+) s/) ?? [];
  return { at_s: Number(at_s), length_s: Number(length_s) };
}

const held = async (of = page) => (await of.getAttribute('#record-hold', 'aria-label')) === 'Play on';

test('a record plays to its end, and its bar shows where it is', async () => {
  await until('a robot in the picture', () => page.getAttribute('#stage-canvas', 'data-hip-x'));
  const { length_s } = await shownTime();
  assert.ok(length_s > 15 && length_s < 30, `${length_s} s`);
  await page.fill('#record-at', String(length_s - 1));
  await until('its end', async () => (await shownTime()).at_s === length_s);
});

test('the bar plays the record on from any time, and Home from its start', async () => {
  await until('the bar', async () => (await shownTime()).length_s > 0);
  await page.keyboard.press('p');
  await until('a pause', () => held());
  const shows = (what, time_s) => until(what, async () => Math.abs((await shownTime()).at_s - time_s) < 0.06);
  await page.fill('#record-at', '12');
  await shows('12 s', 12);
  await until('the picture', async () => (await hipX(page)) > 0);
  const early_m = await hipX(page);
  await page.fill('#record-at', '18');
  await shows('18 s', 18);
  await until('a robot farther on, at about 0.5 m/s', async () => Math.abs((await hipX(page)) - early_m - 3) < 0.5);
  assert.equal(await page.textContent('#state'), 'walk');
  assert.match(await page.textContent('#event-list'), /walk/);
  await picture(page, 'record');
  await page.keyboard.press('Home');
  await shows('the start', 0);
  await until('the events until then', async () => /^[\d.]+ s(calibrate|idle|boot)/.test(await page.textContent('#event-list')));
  assert.doesNotMatch(await page.textContent('#event-list'), /walk/);
  await page.click('#record-hold');
  await until('it plays', async () => (await shownTime()).at_s > 0.5);
});

test('a pause holds the record on every page', async () => {
  const other = await openPage(browser, url);
  await until('both pages', async () => (await shownTime(other)).length_s > 0 && (await shownTime()).length_s > 0);
  await other.click('#record-start');
  await other.keyboard.press('p');  // by the same page: requests of two pages have no order
  await until('a pause on both', async () => (await held()) && (await held(other)));
  const { at_s } = await shownTime(other);
  await page.waitForTimeout(700);
  assert.equal((await shownTime(other)).at_s, at_s);
  assert.equal((await shownTime()).at_s, at_s);
  await page.keyboard.press('p');
  await until('both go on', async () => (await shownTime()).at_s > at_s + 0.2 && (await shownTime(other)).at_s > at_s + 0.2);
  assert.ok(!(await held()) && !(await held(other)));
  await other.close();
});

test('no serious finding by the rules of accessibility, in the light and in the dark', async () => {
  await until('the bar', async () => (await shownTime()).length_s > 0);
  await assertAccessible(page, 'accessible_record');
});
