// Who may command through the page, in a browser, with a synthetic robot: synthetic_monitor.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync } from 'node:fs';
import http from 'node:http';
import https from 'node:https';
import net from 'node:net';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { test } from 'node:test';
import { openPage, picture, Program, until } from './browser.mjs';
import { qrCode, readQrCode, readQrPicture } from './qr_code.mjs';
import { answer, browser, monitor, page, press, state, text } from './synthetic.mjs';

/** A page without the monitor's key: as if it were opened by the address alone. */
async function pageWithoutKey() {
  await until('the key of the first page stored', async () => /This page commands/.test(await text('#access')));
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

test('a link that is entered in the open page of the plain address lets it command and leaves the address bar', async () => {
  const looker = await pageWithoutKey();
  await until('the words', async () => /This page only looks/.test(await looker.textContent('#access')));
  await looker.evaluate((hash) => { window.location.hash = hash; }, new URL(monitor.url).hash);
  await until('the words', async () => /This page commands/.test(await looker.textContent('#access')));
  assert.equal(new URL(looker.url()).hash, '');
  await looker.keyboard.press('w');
  await state('walk');
  await looker.evaluate(() => { window.location.hash = 'token=open-sesame'; });
  await until('the token', async () => (await looker.inputValue('#token')) === 'open-sesame');
  assert.equal(new URL(looker.url()).hash, '');
  await looker.close();
});

test('a refusal that does not prove the token is called one, and the reply of the robot itself still counts', async () => {
  monitor.write('forge the robot is tired');
  monitor.write('event replies are forged');
  await until('the event', async () => /replies are forged/.test(await text('#event-list')));
  assert.match(await press('w'), /^walk at 0.50 m\/s: refused by somebody without this token: the robot is tired$/);
  monitor.write('answer');
  await answer(/walk at 0.50 m\/s: accepted/);
});

test('a wrong text in the field of the token keeps neither Stop nor Motors off from the robot', async () => {
  await press('w');
  await page.click('#token-box summary');
  await page.fill('#token', 'a guess');
  await page.keyboard.press('Escape');
  await answer(/stop: accepted/);
  await state('stand');
  await page.keyboard.press('Shift+Escape');
  await answer(/cut: accepted/);
  await state('off');
});

/** A reverse proxy that speaks TLS with a certificate of its own. */
async function tlsProxy(target) {
  const folder = mkdtempSync(join(tmpdir(), 'stilt-proxy-'));
  const [key, cert] = ['key.pem', 'cert.pem'].map((name) => join(folder, name));
  execFileSync('openssl', ['req', '-x509', '-newkey', 'ec', '-pkeyopt', 'ec_paramgen_curve:prime256v1', '-nodes',
    '-subj', '/CN=localhost', '-days', '1', '-keyout', key, '-out', cert], { stdio: 'ignore' });
  const proxy = https.createServer({ key: readFileSync(key), cert: readFileSync(cert) });
  rmSync(folder, { recursive: true });
  const pass = ({ url, method, headers }) => http.request(new URL(url, target), { method, headers });
  proxy.on('request', (request, response) => {
    const passed = pass(request);
    passed.on('response', (answered) => { response.writeHead(answered.statusCode, answered.headers); answered.pipe(response); });
    passed.end();
  });
  proxy.on('upgrade', (request, socket, first) => {
    const passed = pass(request);
    passed.on('response', (answered) => socket.end(`HTTP/1.1 ${answered.statusCode} Refused\r\n\r\n`));
    passed.on('upgrade', (answered, behind, firstBehind) => {
      const lines = Object.entries(answered.headers).map(([name, value]) => `${name}: ${value}\r\n`);
      socket.write(`HTTP/1.1 101 Switching Protocols\r\n${lines.join('')}\r\n`);
      socket.write(firstBehind);  // what came in one piece with the headers
      behind.write(first);
      for (const end of [socket, behind]) end.on('error', () => {});
      behind.pipe(socket).pipe(behind);
    });
    passed.end();
  });
  await new Promise((resolve) => { proxy.listen(0, '127.0.0.1', resolve); });
  return proxy;
}

test('the page shows the link for a phone as a QR code, in the light and in the dark', async () => {
  const other = new Program(process.env.STILT_SYNTHETIC_MONITOR, ['http://192.168.178.20:8080/', 'http://robot.example.com:8080/']);
  const [url] = await other.wrote(/http:\S+/);
  const here = await openPage(browser, url);
  await until('the links', async () => (await here.locator('#link-list a').count()) === 2);
  await here.click('#token-box summary');
  const links = await here.locator('#link-list a').allTextContents();
  assert.deepEqual(links, ['http://192.168.178.20:8080/', 'http://robot.example.com:8080/'].map((link) => link + new URL(url).hash));
  for (const theme of ['light', 'dark']) {
    await here.emulateMedia({ colorScheme: theme });
    for (const [k, link] of links.entries()) {
      assert.equal(await readQrPicture(here, here.locator('.qr-code').nth(k)), link, theme);
    }
  }
  await picture(here, 'qr_code');
  await here.close();
  other.process.stdin.end();
  await other.ended;
});

test('QR codes of every length up to 180 bytes are read by an independent decoder, and longer texts have none', () => {
  for (let length = 1; length <= 180; ++length) {
    const words = Array.from({ length }, (_, k) => String.fromCharCode(33 + ((k * 7919 + length * 31) % 90))).join('');
    assert.equal(readQrCode(qrCode(words)), words);
  }
  assert.equal(readQrCode(qrCode('http://röbot.example/#key=ß')), 'http://röbot.example/#key=ß');
  assert.equal(qrCode('x'.repeat(181)), null);
});

test('behind a reverse proxy with TLS the page works as without', async (context) => {
  const proxy = await tlsProxy(monitor.url);
  context.after(() => { proxy.close(); proxy.closeAllConnections(); });
  const secure = await openPage(browser, `https://127.0.0.1:${proxy.address().port}/${new URL(monitor.url).hash}`);
  await until('the robot there', () => secure.getAttribute('#stage-canvas', 'data-hip-x'));
  await secure.keyboard.press('t');
  await state('step');
  await secure.close();
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
  await press('w');
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
  assert.equal(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: `https://${host}` }), 101, 'behind TLS');
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: 'http://example.com' }), 101);
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: 'https://example.com' }), 101);
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Origin: `http://evil${host}` }), 101);
  assert.notEqual(await statusOf(monitor.url, '/live', { ...kUpgrade, Host: 'example.com' }), 101);
  assert.equal(await statusOf(monitor.url, '/', { Host: host }), 200);
  assert.equal(await statusOf(monitor.url, '/', { Host: 'example.com' }), 403);
  assert.equal(await statusOf(monitor.url, '/../etc/passwd', {}), 404);
});
