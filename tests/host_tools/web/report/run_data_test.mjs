// What a report reads of its run: the page's own scripts, without a browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { packedRun, scriptsOf, stateAt } from './packed_run.mjs';

const { RecordedRun, headline, jointRows, outcomeRows, stepRows } = scriptsOf('RecordedRun', 'headline', 'jointRows', 'outcomeRows',
  'stepRows');

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
