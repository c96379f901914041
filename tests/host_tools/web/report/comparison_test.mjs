// What the page of two runs shows of the second: the page's own scripts, without a browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { packedRun, scriptsOf, stateAt } from './packed_run.mjs';

const { RecordedRun, SvgContext, differences, drawPushes, joinRuns, plotSections, viewsOf } = scriptsOf(
  'RecordedRun', 'SvgContext', 'differences', 'drawPushes', 'joinRuns', 'plotSections', 'viewsOf');

/** A run of 20 s: of stiltd, or of a simulation with a push of `force_N` from 5 s to 6 s. */
function runOf({ stiltd = false, force_N = 0, settings = {}, shift_s = 0 }) {
  const state = stateAt(1, 0.8);
  const ticks = Array.from({ length: 21 }, (_, time_s) => ({
    time_s: [time_s],
    [stiltd ? 'estimated_state' : 'true_state']: state,
    push_N: [time_s === 5 || time_s === 6 ? force_N : 0],
    push_above_hip_m: [0.25],
  }));
  return new RecordedRun(packedRun(ticks, { controller: stiltd ? { last_state: 'ready', events: [] } : null, settings }), shift_s);
}

const labelsOf = (run) => plotSections(run)[0].plots[0].lines.map(({ label }) => label);

test('a state has the name of its own run', () => {
  assert.deepEqual(labelsOf(joinRuns(runOf({}), runOf({ stiltd: true }))), ['true', 'estimated, second']);
  assert.deepEqual(labelsOf(joinRuns(runOf({ stiltd: true }), runOf({}))), ['estimated', 'true, second']);
  assert.deepEqual(labelsOf(joinRuns(runOf({}), runOf({}))), ['true', 'true, second']);
});

test('pushes of the second run are drawn, chosen and listed', () => {
  globalThis.devicePixelRatio = 1;
  const run = joinRuns(runOf({}), runOf({ force_N: 30, shift_s: 2 }));
  const picture = new SvgContext(100, 100);
  const plot = { ctx: picture, bbox: { left: 0, top: 0, width: 100, height: 100 }, scales: { x: { min: 0, max: 20 } }, valToPos: (t) => 5 * t };
  drawPushes(plot, run, { push: '#f00' });
  assert.match(String(picture), /<rect x="35" y="0" width="5"[^>]* opacity="0.06"/);
  assert.match(String(picture), />30 N, second</);
  assert.deepEqual(viewsOf(run).map(({ name }) => name), ['Whole run', 'Push of 30 N at 7.0 s, second']);
  const text = '30.0 N from 5.00 to 6.00 s, 0.25 m above the hip';
  assert.deepEqual(differences(run, true), [['pushes', 'none', text]], 'in the time of its run');
});

test('pushes that are the same, or that no file holds, are no difference', () => {
  const settings = { robot: 'amber3m', 'gait.swing_height_m': '0.07' };
  const same = joinRuns(runOf({ force_N: 30, settings }), runOf({ force_N: 30, shift_s: 2, settings }));
  assert.deepEqual(differences(same, true), []);
  const records = joinRuns(runOf({ stiltd: true, settings }), runOf({ stiltd: true, settings: { ...settings, robot: 'rabbit' } }));
  assert.deepEqual(differences(records, true), [['robot', 'amber3m', 'rabbit']]);
  assert.deepEqual(differences(records, false), []);
  assert.deepEqual(differences(joinRuns(runOf({ stiltd: true }), runOf({})), true), []);
  assert.equal(differences(joinRuns(runOf({ stiltd: true }), runOf({ force_N: 30 })), true)[0][1], '–');
});
