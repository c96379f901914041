// A headless browser and programs beside it, for the tests of the monitor's page.

import { spawn } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

/** Generous: the machine may be busy. Nothing waits so long when all is well. */
export const kPatience_ms = 1000 * Number(process.env.STILT_PATIENCE_S ?? 120);

const kArguments = ['--headless', '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run',
  '--disable-background-networking', '--disable-component-update', '--disable-sync'];

/** The DDS domain of this test alone. None is assumed: in domain 0 may be a real robot. */
export function ownDomain() {
  const domain = process.env.STILT_TEST_DOMAIN;
  if (!domain) throw new Error('STILT_TEST_DOMAIN is not set; run tests/own_domain.py node --test FILE');
  return domain;
}

export function sleep(milliseconds) {
  return new Promise((resolve) => setTimeout(resolve, milliseconds));
}

/** Calls `look` until it gives something true, and returns that; throws with `what` after the patience. */
export async function until(what, look, patience_ms = kPatience_ms) {
  const end = Date.now() + patience_ms;
  for (;;) {
    const seen = await look();
    if (seen) return seen;
    if (Date.now() > end) throw new Error(`waited ${patience_ms / 1000} s in vain: ${what}`);
    await sleep(50);
  }
}

/** A program of the build; `output` is all that it wrote. */
export class Program {
  static #all = [];

  /** Also those of a test that failed: a process that goes on would keep this one. */
  static async killAll() {
    for (const program of Program.#all) await program.kill('SIGKILL');
  }

  constructor(command, words, options = {}) {
    this.name = command.split('/').pop();
    this.output = '';
    this.status = null;
    this.process = spawn(command, words, options);
    Program.#all.push(this);
    for (const stream of [this.process.stdout, this.process.stderr]) {
      stream.on('data', (text) => { this.output += text; });
    }
    this.ended = new Promise((resolve) => {
      this.process.on('exit', (status, signal) => {
        this.status = status ?? signal;
        resolve(this.status);
      });
    });
  }

  write(line) {
    this.process.stdin.write(`${line}\n`);
  }

  /** The first match of `pattern` in what it writes. */
  wrote(pattern) {
    return until(`${this.name} to write ${pattern}; it wrote:\n${this.output}`, () => {
      const match = this.output.match(pattern);
      if (!match && this.status !== null) throw new Error(`${this.name} ended (${this.status}):\n${this.output}`);
      return match;
    });
  }

  kill(signal = 'SIGTERM') {
    if (this.status === null) this.process.kill(signal);
    return this.ended;
  }
}

/** Opens a browser with a profile of its own; close() removes it. */
export async function openBrowser() {
  const profile = mkdtempSync(join(tmpdir(), 'stilt-browser-'));
  const context = await chromium.launchPersistentContext(profile, {
    executablePath: process.env.STILT_CHROMIUM ?? '/usr/bin/chromium',
    args: kArguments,
    headless: true,
    viewport: { width: 1440, height: 900 },
    ignoreHTTPSErrors: true,
    timeout: kPatience_ms,
  });
  context.setDefaultTimeout(kPatience_ms);
  return {
    context,
    async close() {
      await context.close();
      rmSync(profile, { recursive: true, force: true, maxRetries: 5 });
    },
  };
}

/** A page of the monitor at `url`. Errors in its scripts are collected in `errors`. */
export async function openPage(browser, url, fragment = '') {
  const page = await browser.context.newPage();
  page.problems = [];
  page.on('pageerror', (error) => page.problems.push(error.message));
  page.on('request', (request) => {
    const from = new URL(request.url());
    if (!['data:', 'blob:'].includes(from.protocol) && from.host !== new URL(url).host) {
      page.problems.push(`the page asks another host for something: ${request.url()}`);
    }
  });
  await page.goto(url + fragment);
  return page;
}

/** Hip position that the picture shows, m. */
export async function hipX(page) {
  return Number(await page.getAttribute('#stage-canvas', 'data-hip-x'));
}

/** Time from the start of the navigation to the first frame in which the robot had moved, ms. */
export function firstMotion_ms(page) {
  return until('a robot that moves', () => page.evaluate(() => {
    const mark = performance.getEntriesByName('first-moving-frame')[0];
    return mark ? Math.round(mark.startTime) : null;
  }));
}

/** Mean forward speed over a second as the page shows it, m/s; null before it is known. */
export async function shownSpeed(page) {
  const text = await page.getAttribute('#speed-now', 'data-value');
  return text === '' ? null : Number(text);
}

/** A number that changes with the pixels of a canvas. */
export function pixels(page, selector) {
  return page.evaluate((canvasSelector) => {
    const canvas = document.querySelector(canvasSelector);
    const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
    let sum = 0;
    for (let i = 0; i < data.length; ++i) sum = (sum * 31 + data[i]) | 0;
    return sum;
  }, selector);
}

/** Keeps a picture of the page in the build tree. */
export async function picture(page, name) {
  const folder = process.env.STILT_SCREENSHOTS ?? join(tmpdir(), 'stilt-screenshots');
  mkdirSync(folder, { recursive: true });
  await page.screenshot({ path: join(folder, `${name}.png`) });
}
