// Who may command through the page, in a browser, with a synthetic robot: synthetic_monitor.

import assert from 'node:assert/strict';
import http from 'node:http';
import net from 'node:net';
import { test } from 'node:test';
import { openPage, picture, until } from './browser.mjs';
import { answer, browser, monitor, page, state, text } from './synthetic.mjs';

/** A page without the monitor's key: as if it were opened by the address alone. */
async function pageWithoutKey() {
  await page.evaluate(() => localStorage.clear());
  const other = await openPage(browser, new URL('/', monitor.url).href);
  await until('the robot there', () => other.getAttribute('#stage-canvas', 'data-hip-x'));
  return other;
}

test('a page that was not opened by the link looks, commands nothing, and says how it would', async () => {
  const looker = await pageWithoutKey();
  const said = (pattern) => until(`there ${pattern}`, async () => pattern.test(await looker.textContent('#answer')));
  await until('the words', async () => /This page only looks/.test(await looker.textContent('#access')));
  assert.ok(await looker.isVisible('#token'));
  assert.ok(await looker.isHidden('#links'));
  await picture(looker, 'without_the_link');
  await looker.keyboard.press('w');
  await said(/This page only looks: open the link that stilt monitor printed/);
  await looker.keyboard.press('Space');
  await said(/stop: refused/);
  assert.equal(await text('#state'), 'stand');
  await looker.fill('#token', 'open-sesame');
  await looker.click('[data-command=walk]');
  await said(/accepted/);
  await looker.close();
});

test('the key stays with the pages of this address: neither the address bar nor another port of it gets it', async () => {
  const key = new URL(monitor.url).hash.slice('#key='.length);
  assert.ok(!page.url().includes(key), page.url());
  const received = [];
  const neighbour = http.createServer((request, response) => {
    received.push(`${request.url} ${JSON.stringify(request.headers)}`);
    response.end('<p>the server of another user</p>');
  });
  await new Promise((resolve) => { neighbour.listen(0, '127.0.0.1', resolve); });
  const its = await browser.context.newPage();
  await its.goto(`http://127.0.0.1:${neighbour.address().port}/`);
  assert.ok(received.length > 0 && !received.join().includes(key), received.join());
  assert.equal(await its.evaluate(() => document.cookie + JSON.stringify({ ...localStorage, ...sessionStorage })), '{}');
  await its.close();
  neighbour.close();
});

test('a page that is opened by its plain address later has the key, and a new link ends what others may do', async () => {
  const phone = await openPage(browser, new URL('/', monitor.url).href);
  const said = (pattern) => until(`there ${pattern}`, async () => pattern.test(await phone.textContent('#answer')));
  await until('the robot there', () => phone.getAttribute('#stage-canvas', 'data-hip-x'));
  await phone.keyboard.press('t');
  await said(/step: accepted/);
  await state('step');
  await page.click('#token-box summary');
  await picture(page, 'access');
  await page.click('#new-key');
  await until('the words', async () => /This page only looks/.test(await phone.textContent('#access')));
  await phone.keyboard.press('w');
  await said(/This page only looks/);
  await page.keyboard.press('Space');
  await answer(/stop: accepted/);
  await phone.close();
});

test('stop of the open page and of a new one arrive among hundreds of silent connections', async () => {
  await page.keyboard.press('w');
  await state('walk');
  const port = Number(new URL(monitor.url).port);
  const silent = [];
  for (let k = 0; k < 400; ++k) {
    const socket = net.connect(port, '127.0.0.1');
    socket.on('error', () => {});
    silent.push(socket);
    await new Promise((resolve) => { socket.on('connect', resolve); });
    if (k % 2) socket.write(`GET / HTTP/1.1\r\nHost: 127.0.0.1:${port}\r\n`);
  }
  await page.keyboard.press('Space');
  await answer(/stop: accepted/);
  await state('stand');
  const late = await openPage(browser, monitor.url);
  await until('the robot there', () => late.getAttribute('#stage-canvas', 'data-hip-x'));
  await late.keyboard.press('Space');
  await until('its stop', async () => /stop: accepted/.test(await late.textContent('#answer')));
  for (const socket of silent) socket.destroy();
  await late.close();
});

/** Status of a request to the monitor with other headers than a browser of this page would send. */
function statusOf(url, path, headers) {
  return new Promise((resolve, reject) => {
    const request = http.request(new URL(path, url), { headers });
    request.on('response', (response) => { response.resume(); resolve(response.statusCode); });
    request.on('upgrade', (response, socket) => { socket.destroy(); resolve(response.statusCode); });
    request.on('error', (error) => (error.code === 'ECONNRESET' ? resolve('closed') : reject(error)));
    request.end();
  });
}

const kUpgrade = {
  Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Version': '13', 'Sec-WebSocket-Key': 'c3RpbHRzdGlsdHN0aWx0cw==',
};

test('pages of other sites, and other names for this machine, get nothing', async () => {
  const { host, origin } = new URL(monitor.url);
  assert.equal(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: origin }), 101);
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: 'http://example.com' }), 101);
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: `http://evil${host}` }), 101);
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Host: 'example.com' }), 101);
  assert.equal(await statusOf(monitor.url, '/', { Host: host }), 200);
  assert.equal(await statusOf(monitor.url, '/', { Host: 'example.com' }), 403);
  assert.equal(await statusOf(monitor.url, '/../etc/passwd', {}), 404);
});
