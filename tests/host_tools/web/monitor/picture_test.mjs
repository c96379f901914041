// Friction cones, and what the page saves: PNG, SVG and WebM; with a synthetic robot: synthetic_monitor.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { hipX, pixels, until } from './browser.mjs';
import { browser, page, press } from './synthetic.mjs';

const kMu = 0.6;  // of the synthetic robot's configuration

/** What a click on `button` saves: its name and content. */
async function saved(button, of = page) {
  const [download] = await Promise.all([of.waitForEvent('download'), of.click(button)]);
  return { name: download.suggestedFilename(), content: readFileSync(await download.path()) };
}

/** Share of the pixels of the stage that differ visibly from an image that the page loads from `type` and `content`. */
function difference(content, type, alike) {
  return page.evaluate(async ([base64, media, tolerance]) => {
    const image = new Image();
    image.src = `data:${media};base64,${base64}`;
    await image.decode();
    const stage = document.getElementById('stage-canvas');
    const canvas = Object.assign(document.createElement('canvas'), { width: stage.width, height: stage.height });
    canvas.getContext('2d').drawImage(image, 0, 0, stage.width, stage.height);
    const [a, b] = [stage, canvas].map((one) => one.getContext('2d').getImageData(0, 0, stage.width, stage.height).data);
    let others = 0;
    for (let k = 0; k < a.length; k += 4) {
      if ([0, 1, 2].some((channel) => Math.abs(a[k + channel] - b[k + channel]) > tolerance)) ++others;
    }
    return (4 * others) / a.length;
  }, [content.toString('base64'), type, alike]);
}

/** Walks a little and pauses, so that the picture stands still. */
async function walkAndPause() {
  await press('w');
  await until('motion', async () => (await hipX(page)) > 0.3);
  await page.keyboard.press('p');
  await until('a still picture', async () => {
    const first = await pixels(page, '#stage-canvas');
    await page.waitForTimeout(200);
    return (await pixels(page, '#stage-canvas')) === first;
  });
}

/** Corners of the open triangles in an SVG picture, pixels. */
function triangles(svg) {
  return [...svg.matchAll(/<path d="M(\S+) (\S+?)L(\S+) (\S+?)L(\S+) ([\d.]+?)" fill="none"/g)]
    .map((match) => match.slice(1).map(Number)).map(([x0, y0, x1, y1, x2, y2]) => ({ x0, y0, x1, y1, x2, y2 }))
    .filter(({ x0, y0, x1, y1, x2, y2 }) => Math.abs(y0 - y2) < 0.02 && y1 > y0 && Math.abs(x0 + x2 - 2 * x1) < 0.03);
}

test('the friction cone of a foot that carries opens by the friction coefficient, and can be left out', async () => {
  await until('the robot', () => page.getAttribute('#stage-canvas', 'data-hip-x'));
  const cones = triangles((await saved('#save-svg')).content.toString());
  assert.equal(cones.length, 2, 'it stands on both feet');
  for (const { x0, y0, x2, y1 } of cones) assert.ok(Math.abs((x2 - x0) / 2 / (y1 - y0) - kMu) < 0.01);
  await page.uncheck('#show-cones');
  assert.equal(triangles((await saved('#save-svg')).content.toString()).length, 0);
});

/** An SVG picture by a function of the page's drawings, 400 by 300 pixels, 200 per metre; (0, 0) is (200, 280). */
function drawn(name, ...words) {
  const folder = new URL('../../../../host_tools/web/page/', import.meta.url);
  const files = ['canvas_shapes.js', 'svg_context.js', 'scene.js', 'kinematics.js'];
  const source = files.map((file) => readFileSync(new URL(file, folder), 'utf-8')).join('\n');
  const { draw, makeView, SvgContext } = new Function(`${source}\nreturn { draw: ${name}, makeView, SvgContext };`)();
  const context = new SvgContext(400, 300);
  draw(makeView(context, 400, 300, 0, -0.1, 200), ...words);
  return String(context);
}

const kPose = { left: { foot: { x: 0, z: 0 } }, right: { foot: { x: 0.3, z: 0.1 } }, hip: { x: 0, z: 0.8 }, head: { x: 0.1, z: 1.3 } };

/** Tips of arrow heads and footholds: first corners of the filled or hollow triangles of a colour. */
function tips(svg, colour) {
  return [...svg.matchAll(/<path d="M(\S+) (\S+?)L\S+ \S+?L[^"]*"([^>]*)/g)]
    .filter(([, , , style]) => style.includes(colour)).map(([, x, y]) => [Number(x), Number(y)]);
}

test('a force outside its friction cone gives the cone the colour of a limit, and a foot in the air has none', () => {
  const draw = (forces) => drawn('drawFrictionCones', kPose, forces, kMu, { limit: 'red', force: 'green' });
  assert.match(draw([59, 100, 0, 0]), /green/);
  assert.doesNotMatch(draw([59, 100, 0, 0]), /red/);
  assert.match(draw([-61, 100, 0, 0]), /red/);
  assert.equal(triangles(draw([20, 100, 0, 5])).length, 1);
});

test('an arrow of a contact force goes from the foot along the force, 1.7 mm for each N, and 1 m at most', () => {
  const draw = (forces) => tips(drawn('drawContactForces', kPose, forces, { force: 'green' }), 'green');
  assert.deepEqual(draw([50, 200, 0, 0]), [[200 + 200 * 0.085, 280 - 200 * 0.34]]);
  assert.deepEqual(draw([0, 0, -20, 100]), [[260 - 200 * 0.034, 260 - 200 * 0.17]]);
  assert.deepEqual(draw([0, 5000, 0, 0]), [[200, 80]]);
  assert.deepEqual(draw([0, 0, 0, 0]), []);
});

test('the arrow of a push ends 6 cm before the place where it acts, on the side that it comes from, with its force', () => {
  const draw = (force, share) => drawn('drawPush', kPose, force, share, { push: 'red', sky: 'white' });
  assert.deepEqual(tips(draw(40, 0), 'red'), [[188, 120]]);
  assert.deepEqual(tips(draw(-40, 0.5), 'red'), [[222, 70]]);
  assert.match(draw(-40, 0.5), />40 N</);
  assert.equal(tips(draw(0, 0), 'red').length, 0);
});

test('a planned foothold is a hollow triangle in the colour of its foot, where the plan puts the foot down', () => {
  const node = (time, left, right) => ({ time, hip: { x: 0, z: 0.8 }, feet: [left, right] });
  const nodes = [node(1.0, { x: 0, z: 0 }, { x: -0.1, z: 0.05 }), node(1.1, { x: 0, z: 0 }, { x: 0.2, z: 0.05 }),
    node(1.2, { x: 0, z: 0 }, { x: 0.25, z: 0 }), node(1.3, { x: 0, z: 0.05 }, { x: 0.25, z: 0 })];
  const svg = drawn('drawPlannedPaths', nodes, { plan: 'grey', left: 'blue', right: 'orange' }, 1.0);
  const places = [...svg.matchAll(/<path d="M(\S+) (\S+?)L\S+ \S+?L\S+ \S+?Z"([^>]*)/g)];
  assert.equal(places.length, 1, svg);
  assert.deepEqual(places[0].slice(1, 3).map(Number), [250, 283]);
  assert.match(places[0][3], /orange/);
  assert.match(places[0][3], /fill="none"/);
});

test('an arc of a saved picture runs clockwise, as that of a canvas', async () => {
  const source = readFileSync(new URL('../../../../host_tools/web/page/svg_context.js', import.meta.url), 'utf-8');
  const context = new Function(`${source}\nreturn new SvgContext(20, 20);`)();
  context.arc(0, 0, 10, 0, Math.PI / 2);
  const [radius, angle] = await page.evaluate((data) => {
    const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
    path.setAttribute('d', data);
    const { x, y } = path.getPointAtLength(path.getTotalLength() / 4);
    return [Math.hypot(x, y), Math.atan2(y, x)];
  }, context.path);
  assert.ok(Math.abs(radius - 10) < 0.05 && Math.abs(angle - Math.PI / 8) < 0.01, `${radius}, ${angle} rad`);
});

test('PNG and SVG show what the stage shows', async () => {
  await walkAndPause();
  const png = await saved('#save-png');
  assert.match(png.name, /^stilt_[\d.]+_s\.png$/);
  assert.equal(await difference(png.content, 'image/png', 0), 0);
  const svg = await saved('#save-svg');
  assert.match(svg.name, /^stilt_[\d.]+_s\.svg$/);
  const share = await difference(svg.content, 'image/svg+xml', 60);
  assert.ok(share < 0.01, `${(100 * share).toFixed(2)} % of the pixels differ`);
  await page.keyboard.press('p');
  await until('motion', async () => (await difference(svg.content, 'image/svg+xml', 60)) > 0.02);
});

test('a plot is saved as SVG, without the lines that are hidden', async () => {
  await walkAndPause();
  const figure = 'figure[data-title="Height of the feet"]';
  const lines = (svg) => page.evaluate((text) => {
    const picture = new DOMParser().parseFromString(text, 'image/svg+xml');
    return {
      error: picture.querySelector('parsererror')?.textContent ?? null,
      words: picture.documentElement.textContent,
      long: [...picture.querySelectorAll('path')].map((path) => path.getAttribute('d')).filter((d) => d.split('L').length > 50).length,
    };
  }, svg.content.toString());
  const all = await saved(`${figure} .save`);
  assert.equal(all.name, 'Height_of_the_feet.svg');
  const { error, words, long } = await lines(all);
  assert.equal(error, null);
  assert.match(words, /Height of the feet/);
  assert.match(words, /−?\d s/);
  assert.equal(long, 2);
  await page.click(`${figure} .legend`);
  assert.equal((await lines(await saved(`${figure} .save`))).long, 1);
});

test('a video of the stage is a WebM file that plays, and its button says that it films', async () => {
  await press('w');
  await until('motion', async () => (await hipX(page)) > 0.3);
  await page.click('#save-video');
  assert.equal(await page.getAttribute('#save-video', 'aria-pressed'), 'true');
  assert.equal(await page.textContent('#save-video'), 'End video');
  const from = await hipX(page);
  await until('half a metre', async () => (await hipX(page)) > from + 0.5);
  const { name, content } = await saved('#save-video');
  assert.match(name, /^stilt_[\d.]+_s\.webm$/);
  assert.equal(content.subarray(0, 4).toString('hex'), '1a45dfa3');
  const stage = await page.$eval('#stage-canvas', ({ width, height }) => ({ width, height }));
  const other = await browser.context.newPage();
  const film = await other.evaluate(async (base64) => {
    const video = Object.assign(document.createElement('video'), { src: `data:video/webm;base64,${base64}`, muted: true });
    await new Promise((resolve, reject) => { video.onloadeddata = resolve; video.onerror = () => reject(video.error); });
    await video.play();
    await new Promise((resolve) => { video.onended = resolve; });
    return { width: video.videoWidth, height: video.videoHeight, length_s: video.currentTime };
  }, content.toString('base64'));
  await other.close();
  assert.ok(Math.abs(film.width - stage.width) < 2 && Math.abs(film.height - stage.height) < 2, JSON.stringify([film, stage]));
  assert.ok(film.length_s > 0.5, `${film.length_s} s`);
  assert.equal(await page.textContent('#save-video'), 'Video');
});
