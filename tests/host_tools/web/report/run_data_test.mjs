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
