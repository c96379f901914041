// How far a page looks back and what that takes: its own scripts, fed with minutes of samples, without a browser.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const kScripts = ['page/table.js', 'page/kinematics.js', 'page/robot_data.js', 'monitor/page/live_clock.js', 'monitor/page/robot_state.js'];
const kFolder = new URL('../../../../host_tools/web/', import.meta.url);
const kBatch_ticks = 25;
const kNodes = 60;
const kMegabytes = 115;

/** Columns of the messages, as many as the monitor sends: host_tools/web/monitor/page_tables.cc. */
const kColumns = {
  ticks: ['time_s', ...Array.from({ length: 14 }, (_, k) => `estimated_state${k}`), ...Array.from({ length: 22 }, (_, k) => `other${k}`)],
  planner: ['time_s', ...Array.from({ length: 9 }, (_, k) => `solve${k}`)],
  plan: ['time_s', 'base_x_m', 'base_z_m', 'pitch_rad', ...[0, 1, 2, 3].map((k) => `foot_position_m${k}`),
    ...[0, 1, 2, 3].map((k) => `contact_force_N${k}`), 'left_stance', 'right_stance'],
  truth: ['time_s', ...[0, 1, 2, 3].map((k) => `contact_force_N${k}`), 'push_N', 'push_above_hip_m'],
};

const source = kScripts.map((name) => readFileSync(new URL(name, kFolder), 'utf-8')).join('\n');
const { RobotState, kLookBack_s, kPausedOn_s } = new Function(`${source}\nreturn { RobotState, kLookBack_s, kPausedOn_s };`)();

function makeRobot(tick_rate_hz = 1000) {
  const robot = new RobotState();
  robot.greet({ columns: kColumns });
  const drawing = { torso_length_m: 0.4, thigh_length_m: 0.4, shin_length_m: 0.4 };
  robot.configure({ run_id: '1', toml: '', drawing, tick_rate_hz, plan_rate_hz: 500 });
  return robot;
}

function message(name, base_s, rows, write) {
  const width = kColumns[name].length;
  const values = new Float32Array(rows * width);
  for (let row = 0; row < rows; ++row) write(values.subarray(row * width, (row + 1) * width), row);
  return { name, base_s, first: 0, rows, width, values };
}

/** Samples from one time to another: the hip is at x = t / 10, plans are as frequent as those of the monitor. */
function feed(robot, from_s, to_s) {
  const rate_hz = robot.configuration.tick_rate_hz;
  const batches = Math.round((to_s - from_s) * rate_hz / kBatch_ticks);
  for (let k = 0; k < batches; ++k) {
    const base_s = from_s + (k * kBatch_ticks) / rate_hz;
    robot.take(message('ticks', base_s, kBatch_ticks, (row, tick) => {
      row[0] = tick / rate_hz;
      row[1] = (base_s + tick / rate_hz) / 10;
      row[2] = 0.75;
    }), base_s);
    robot.clock.time(base_s + 0.05);
    if (k % (rate_hz / 500) === 0) robot.take(message('plan', base_s, kNodes, (row, node) => { row[0] = node / 50; }), base_s);
  }
}

test('a page looks back five minutes, paused or not, and its memory neither grows nor exceeds its bound', () => {
  const robot = makeRobot();
  const { bytes } = robot;
  assert.ok(bytes < kMegabytes * 1e6, `${bytes / 1e6} MB`);
  feed(robot, 0, 420);
  const before = process.memoryUsage().arrayBuffers;
  const { clock } = robot;
  assert.equal(kLookBack_s, 300);
  assert.ok(Math.abs(clock.end_s - clock.start_s - kLookBack_s) < 1e-6);
  clock.toggle();
  const paused_s = clock.end_s;
  clock.seek(0);
  assert.ok(Math.abs(clock.held_s - (paused_s - kLookBack_s)) < 1e-6);
  feed(robot, 420, 420 + 2 * kPausedOn_s);
  for (const back_s of [300, 250, 100, 1]) {
    clock.seek(paused_s - back_s);
    assert.ok(Math.abs(robot.stateAt(clock.held_s)[0] - clock.held_s / 10) < 1e-3, `${back_s} s back`);
    assert.ok(robot.planAt(clock.held_s).length > 0, `no plan ${back_s} s back`);
  }
  assert.equal(robot.bytes, bytes);
  const grown = process.memoryUsage().arrayBuffers - before;
  assert.ok(grown < 5e6, `${grown / 1e6} MB more`);
  console.log(`${(bytes / 1e6).toFixed(1)} MB for ${kLookBack_s} s, ${robot.plans.length} plans, ${robot.footprints.length} footprints`);
});

test('a page that was paused for long goes on with what is new', () => {
  const robot = makeRobot();
  feed(robot, 0, 30);
  robot.clock.toggle();
  feed(robot, 30, 30 + kPausedOn_s + 40);
  robot.clock.toggle();
  feed(robot, 130, 140);
  assert.ok(Math.abs(robot.clock.end_s - 140) < 0.5);
  assert.ok(Math.abs(robot.stateAt(robot.clock.end_s)[0] - robot.clock.end_s / 10) < 1e-3);
});

test('a page looks back as far with twice the ticks per second', () => {
  const robot = makeRobot(2000);
  feed(robot, 0, 310);
  assert.ok(Math.abs(robot.clock.end_s - robot.clock.start_s - kLookBack_s) < 1e-6);
  console.log(`${(robot.bytes / 1e6).toFixed(1)} MB with 2,000 ticks per second`);
});

test('with the most ticks per second a page takes no more memory, and paused keeps what it shows', () => {
  const robot = makeRobot(10000);
  assert.equal(robot.bytes, makeRobot(2000).bytes);
  feed(robot, 0, 20);
  robot.clock.toggle();
  feed(robot, 20, 20 + kPausedOn_s + 10);
  assert.ok(robot.clock.start_s < robot.clock.held_s - 10);
  assert.ok(Math.abs(robot.stateAt(robot.clock.held_s)[0] - robot.clock.held_s / 10) < 1e-3);
});

test('samples that come before the configuration are left out', () => {
  const robot = new RobotState();
  robot.greet({ columns: kColumns });
  robot.take(message('truth', 0, 1, () => {}), 0);
  assert.equal(robot.stateAt(0), null);
});
