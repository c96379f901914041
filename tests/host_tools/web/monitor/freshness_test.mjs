// What the page shows of the age of its picture: its own script, without a browser.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const source = readFileSync(new URL('../../../../host_tools/web/monitor/page/status.js', import.meta.url), 'utf-8');
const StatusPanel = new Function(`${source}\nreturn StatusPanel;`)();

/** What the page shows 0.1 s after a link message with these fields, of a live robot unless `live` is false. */
function connection(fields, live = true) {
  const panel = new StatusPanel({ hello: { live, source: 'stiltd on interface lo' } });
  panel.connected = true;
  panel.report({ received: true, silent_s: 0, behind_s: 0, refused: '', ...fields }, 10);
  return panel.connectionAt(10.1);
}

const kRefused = 'run 7 has messages of wire version 4';

test('data are live while ticks come and the page keeps up', () => {
  assert.deepEqual(connection({ behind_s: 0.4, silent_s: 0.4 }), { level: 'live', words: 'live', alarm: null });
  assert.equal(connection({ refused: kRefused }).level, 'live', 'another run that cannot be read is an event');
  assert.equal(connection({ behind_s: 3, silent_s: 3 }, false).level, 'live', 'of a record');
});

test('a page that is behind is stale although ticks come', () => {
  const { level, words, alarm } = connection({ behind_s: 6 });
  assert.deepEqual([level, words], ['stale', '6.0 s behind']);
  assert.match(alarm, /This page is 6.0 s behind the monitor: the data are stale/);
});

test('a controller that cannot be read is the alarm, not that nothing was received', () => {
  const { level, words, alarm, serious } = connection({ received: false, refused: kRefused });
  assert.deepEqual([level, words, serious], ['waiting', 'not readable', undefined]);
  assert.equal(alarm, `Nothing can be shown: ${kRefused}.`);
  const waiting = connection({ received: false });
  assert.deepEqual([waiting.words, waiting.serious], ['waiting', false]);
  assert.match(waiting.alarm, /nothing received yet from stiltd on interface lo/);
});

test('after a controller that has ended, one that cannot be read is the alarm', () => {
  assert.match(connection({ silent_s: 2, refused: kRefused }).alarm, /No data for 2.0 s: .* Nothing newer can be shown: run 7 has messages/);
  assert.match(connection({ silent_s: 2 }).alarm, /No data for 2.0 s: .* stiltd has ended/);
});
