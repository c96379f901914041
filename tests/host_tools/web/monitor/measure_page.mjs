// How fast the page is: time from opening to the first frame in which the robot had moved, and frames per second while
// walking. Measured in the usual window (a part of the plots in view) and in one that shows all of them. Medians over
// fresh pages.
//
//   node measure_page.mjs BUILD [synthetic|stiltd] [PAGES]
//
// stiltd follows the clock here, with limits so wide that a busy machine ends no run. BUILD holds the tests, too.

import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { firstMotion_ms, openBrowser, openPage, Program, until } from './browser.mjs';

const [build, source = 'synthetic', pages = '5'] = process.argv.slice(2);
const kDomain = '99';
const kSettle_ms = 12_000;  // until the plots are full
const kCounted_ms = 10_000;
const kWindows = { 'usual window, 1440 x 900': { width: 1440, height: 900 }, '1920 x 1900': { width: 1920, height: 1900 } };
const kWide = ['supervisor.torque_loop_stall_s=10', 'supervisor.missed_hold_ticks=500', 'supervisor.missed_damp_ticks=1000',
  'supervisor.stale_plan_s=5', 'hardware.driver_watchdog_s=0.1', `telemetry.domain=${kDomain}`];

/** Programs that make a robot walk, and the address of its page. */
async function start(folder) {
  if (source === 'synthetic') {
    const monitor = new Program(join(build, 'tests/synthetic_monitor'), []);
    return { programs: [monitor], url: (await monitor.wrote(/http:\S+/))[0] };
  }
  const buses = ['left', 'right'].flatMap((side) => ['--bus', `loopback:measure_page_${process.pid}_${side}`]);
  const robot = new Program(join(build, 'bin/stilt'), ['robot', ...buses]);
  await robot.wrote(/ready/);
  const settings = [...kWide, `telemetry.token_file=${join(folder, 'token')}`].flatMap((setting) => ['--set', setting]);
  const controller = new Program(join(build, 'bin/stiltd'), [...buses, '--start', 'walk@0.5', ...settings]);
  const monitor = new Program(join(build, 'bin/stilt'), ['monitor', '--port', '0', '--no-browser', '--domain', kDomain]);
  await controller.wrote(/s {2}walk\n/);
  return { programs: [monitor, controller, robot], url: (await monitor.wrote(/http:\S+/))[0] };
}

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)];
}

/** Frames per second, counted by the page itself. */
function frameRate(page) {
  return page.evaluate((counted_ms) => new Promise((resolve) => {
    let frames = 0;
    const start = performance.now();
    const count = (now) => {
      ++frames;
      if (now - start < counted_ms) requestAnimationFrame(count);
      else resolve((frames * 1000) / (now - start));
    };
    requestAnimationFrame(count);
  }), kCounted_ms);
}

async function measure(browser, url, viewport) {
  const page = await openPage(browser, url);
  await page.setViewportSize(viewport);
  const first_ms = await firstMotion_ms(page);
  await page.waitForTimeout(kSettle_ms);
  const rate = await frameRate(page);
  const state = await page.textContent('#state');
  if (state !== 'walk' || page.problems.length > 0) throw new Error(`the robot is in state ${state}; ${page.problems}`);
  await page.close();
  return { first_ms, rate };
}

const folder = mkdtempSync(join(tmpdir(), 'stilt-measure-page-'));
const browser = await openBrowser();
const { programs, url } = await start(folder);
try {
  if (source === 'synthetic') {  // the first page to be measured finds it walking
    const page = await openPage(browser, url);
    await until('live data', async () => (await page.textContent('#link-status')).startsWith('live'));
    await page.keyboard.press('w');
    await until('walking', async () => (await page.textContent('#state')) === 'walk');
    await page.close();
  }
  for (const [name, viewport] of Object.entries(kWindows)) {
    const runs = [];
    for (let k = 0; k < Number(pages); ++k) runs.push(await measure(browser, url, viewport));
    const firsts = runs.map((run) => run.first_ms);
    const rates = runs.map((run) => Number(run.rate.toFixed(1)));
    console.log(`${source}, ${name}: first moving frame after ${median(firsts)} ms (${firsts.join(', ')}); ` +
      `${median(rates)} frames/s (${rates.join(', ')})`);
  }
} finally {
  await browser.close();
  for (const program of programs) await program.kill('SIGKILL');
  rmSync(folder, { recursive: true, force: true });
}
