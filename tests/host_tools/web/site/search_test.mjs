// The documentation site in a browser that reaches no other machine: a search finds a page, and the page opens.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createServer } from 'node:http';
import { mkdirSync, mkdtempSync, readFileSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { extname, join, normalize } from 'node:path';
import { after, before, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { openBrowser, openPage, until } from '../monitor/browser.mjs';

const kSite = fileURLToPath(new URL('../../../../toolchain/site', import.meta.url));
const kTypes = { '.html': 'text/html', '.js': 'text/javascript', '.css': 'text/css', '.svg': 'image/svg+xml',
  '.png': 'image/png', '.json': 'application/json' };

let folder;
let server;
let browser;
let address;

before(async () => {
  folder = mkdtempSync(join(tmpdir(), 'stilt-site-'));
  execFileSync(kSite, ['--no-api', '--out', folder], { stdio: 'inherit' });
  server = createServer((request, response) => {
    const path = join(folder, normalize(new URL(request.url, 'http://site').pathname));
    try {
      response.writeHead(200, { 'content-type': kTypes[extname(path)] ?? 'application/octet-stream' });
      response.end(readFileSync(path));
    } catch {
      response.destroy();
    }
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  address = `http://127.0.0.1:${server.address().port}`;
  browser = await openBrowser();
});

after(async () => {
  await browser?.close();
  server?.close();
  rmSync(folder, { recursive: true, force: true });
});

test('a search without the internet finds a fault, and its page opens at the heading', async () => {
  const page = await openPage(browser, `${address}/index.html`);
  const found = page.locator('.md-search-result__link', { hasText: 'heartbeat_lost' }).first();
  await until('a result', async () => {  // keys that were pressed before the page's script came are not searched
    await page.fill('input[name=query]', '');
    await page.type('input[name=query]', 'heartbeat_lost');
    return found.waitFor({ timeout: 2000 }).then(() => true, () => false);
  });
  if (process.env.STILT_SCREENSHOTS) {
    mkdirSync(process.env.STILT_SCREENSHOTS, { recursive: true });
    await page.screenshot({ path: join(process.env.STILT_SCREENSHOTS, 'site_search.png') });
  }
  await found.click();
  await page.waitForURL(/docs\/troubleshooting\.html/);
  assert.match(await page.textContent('article'), /heartbeat_lost/);
  assert.deepEqual(page.problems, []);
  await page.close();
});

test('figures are drawn and a page fits a narrow screen', async () => {
  const page = await openPage(browser, `${address}/docs/controller.html`);
  await page.setViewportSize({ width: 400, height: 800 });
  const widths_px = await page.$$eval('article img', (images) => images.map((image) => image.naturalWidth));
  assert.ok(widths_px.length > 0 && widths_px.every((width_px) => width_px > 100), `${widths_px}`);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth) <= 400);
  await page.close();
});
