// What a report reads of its run: the page's own scripts, without a browser.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import { packedRun, scriptsOf, stateAt } from './packed_run.mjs';

const { RecordedRun } = scriptsOf('RecordedRun');

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
