// What a report reads of its run: the page's own scripts, without a browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { packedRun, scriptsOf, stateAt } from './packed_run.mjs';

const { RecordedRun, headline, joinRuns, jointRows, missingText, outcomeRows, stepRows, torquePlot, windowOf } = scriptsOf(
  'RecordedRun', 'headline', 'joinRuns', 'jointRows', 'missingText', 'outcomeRows', 'stepRows', 'torquePlot', 'windowOf');

test('off its feet a robot has the pose of its joints, and no place of its hip', () => {
  const run = new RecordedRun(packedRun([
    { time_s: [0], estimated_state: stateAt(3, 0.7) },
    { time_s: [0.5], estimated_state: stateAt(3, 0.7) },
    { time_s: [1], estimated_state: stateAt(null, null) },
    { time_s: [1.5], estimated_state: stateAt(null, null) },
    { time_s: [2] },
  ]));
  assert.equal(run.stateAt(0)[0], 3);
  assert.equal(run.hipUnknown, false);
  assert.deepEqual(run.stateAt(1).slice(0, 2).map((value) => Number(value.toFixed(6))), [0, 0.8], 'it stands on the ground');
  assert.equal(run.hipUnknown, true);
  assert.equal(run.stateAt(2), null, 'the joints are not known');
  assert.equal(run.hipUnknown, false);
});

test('the next stand has no footprints of the one before: its place counts from another origin', () => {
  const row = (time_s, x_m) => (
    { time_s: [time_s], estimated_state: stateAt(x_m, x_m === null ? null : 0.8), foot_position_m: [x_m, 0, x_m, 0] });
  const steps = [{ time_s: 1, foot: 'L', length_m: 0.2 }, { time_s: 5, foot: 'R', length_m: 0.3 }];
  const run = new RecordedRun(packedRun([row(0, 0), row(1, 1), row(2, 2), row(3, null), row(4, 0), row(5, 0.5), row(6, 1)],
    { summary: { steps } }));
  const places = (time_s) => run.footprintsUpTo(time_s).map(({ x }) => x);
  assert.deepEqual([0.5, 2.5, 3, 4.5, 6].map(places), [[], [1], [], [], [0.5]]);
});

test('what is not known has a dash, and what was nothing is 0', () => {
  const figures = { distance_m: null, mean_speed_m_s: null, peak_torque_Nm: [null, 0, 1, 2], steps: [{ time_s: 0, foot: 'L', length_m: 0.2 }] };
  const run = new RecordedRun(packedRun([{ time_s: [0] }], { controller: null, summary: { ...figures, steps_known: false } }));
  const rows = new Map([...outcomeRows(run), ...stepRows(run.summary), ...jointRows(run.summary)]);
  for (const name of ['Distance', 'Mean speed', 'Slip of the feet', 'Steps', 'Shortest', 'Longest', 'Left hip']) {
    assert.equal(rows.get(name), '–', name);
  }
  assert.equal(rows.get('Left knee'), '0.0 Nm');
  assert.equal(headline(run), '1.0 s, 0 pushes');
  const stood = new RecordedRun(packedRun([{ time_s: [0] }]));
  assert.deepEqual(stepRows(stood.summary).map(([, value]) => value), ['0', '–', '–']);
  assert.equal(headline(stood), '1.0 s, 1.0 m, 0 steps, mean speed 1.00 m/s');
});

test('where ticks are missing nothing is drawn, and the page names them', () => {
  const ticks = [0, 1, 2, 3].map((time_s) => ({ time_s: [time_s], estimated_state: stateAt(time_s, 0.8), push_N: [5] }));
  const missing_ticks = [{ first: 1001, last: 1999, from_s: 1.001, to_s: 1.999 }, { first: 2001, last: 2001, from_s: 2.001, to_s: 2.001 }];
  const run = new RecordedRun(packedRun(ticks, { missing_ticks }));
  const { ticks: table } = run.tables;
  assert.deepEqual(windowOf(table, [table.column('estimated_state1')], 0, 3, 100)[1].map((z) => z && Number(z.toFixed(1))),
    [0.8, 0.8, null, 0.8, null, 0.8]);
  assert.deepEqual([0.5, 1.5, 2.5].map((time_s) => run.stateAt(time_s)?.[0] ?? null), [0.5, null, null]);
  assert.deepEqual(run.pushes.map(({ from_s, to_s }) => [from_s, to_s]), [[0, 1], [2, 2], [3, 3]]);
  assert.equal(missingText(run), 'Ticks are missing: 1001 to 1999 (1.00 to 2.00 s), 2001 (2.00 s).');
  const many = Array.from({ length: 7 }, (_, k) => ({ first: 10 * k, last: 10 * k, from_s: k, to_s: k }));
  assert.match(missingText({ missing: many }), /, 40 \(4\.00 s\) and 2 more gaps\.$/);
  assert.equal(missingText(new RecordedRun(packedRun(ticks))), '');
});

test('torque limits are those that the configuration allows, of both runs in a comparison', () => {
  const runOf = (...shares) => new RecordedRun(packedRun([{ time_s: [0] }, { time_s: [1] }],
    { allowed_torque_Nm: shares.map((share) => Array(4).fill(80 * share)) }));
  const plotOf = (run) => [torquePlot(run, 'Hip torque', 0).title, torquePlot(run, '', 0).limits()];
  assert.deepEqual(plotOf(runOf()), ['Hip torque (dotted: limit ±80 Nm)', [-80, 80]], 'not known');
  assert.deepEqual(plotOf(runOf(0.5)), ['Hip torque (dotted: limit ±40 Nm)', [-40, 40]]);
  assert.deepEqual(plotOf(runOf(0.5, 0.25)), ['Hip torque (dotted: limits ±40 and ±20 Nm)', [-40, 40, -20, 20]]);
  assert.deepEqual(plotOf(joinRuns(runOf(1), runOf(0.5))), ['Hip torque (dotted: limits ±80 and ±40 Nm)', [-80, 80, -40, 40]]);
});
