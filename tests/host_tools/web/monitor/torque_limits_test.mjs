// The torque limits that the plots draw: the page's own scripts, without a browser.

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';

const kScripts = ['page/table.js', 'page/kinematics.js', 'page/robot_data.js', 'page/plot_parts.js', 'monitor/page/live_clock.js',
  'monitor/page/robot_state.js'];
const kFolder = new URL('../../../../host_tools/web/', import.meta.url);

const source = kScripts.map((name) => readFileSync(new URL(name, kFolder), 'utf-8')).join('\n');
const { RobotState, torqueLimits } = new Function(`${source}\nreturn { RobotState, torqueLimits };`)();

/** Limits of the knees of a robot with this configuration. */
function kneeLimits(toml, torque_limit_Nm = [80, 60, 80, 50]) {
  const robot = new RobotState();
  robot.greet({ columns: { ticks: ['time_s'], planner: ['time_s'], plan: ['time_s'], truth: ['time_s'] } });
  robot.configure({ run_id: '1', toml, drawing: { torque_limit_Nm }, tick_rate_hz: 1000, plan_rate_hz: 500 });
  return torqueLimits(robot, 1);
}

test('the limit is the share of the weaker joint that the configuration allows', () => {
  assert.deepEqual(kneeLimits('[supervisor]\ntorque_limit_share = 0.5\n'), [-25, 25]);
  assert.deepEqual(kneeLimits('[robot]\ntorque_limit_scale = 0.5\n[supervisor]\ntorque_limit_share = 0.5\n'), [-25, 25]);
  assert.deepEqual(kneeLimits(''), [-50, 50], 'all of it');
  assert.deepEqual(kneeLimits('torque_limit_share = 0.5', []), [], 'not known');
});

test('a smaller limit of plans and torque law is drawn within the one of all', () => {
  assert.deepEqual(kneeLimits('[robot]\ntorque_limit_scale = 0.25\n[supervisor]\ntorque_limit_share = 0.5\n'), [-25, 25, -12.5, 12.5]);
  assert.deepEqual(kneeLimits('[robot]\ntorque_limit_scale = 2.0\n[supervisor]\ntorque_limit_share = 1.0\n'), [-50, 50]);
});

test('other keys that end alike are not meant', () => {
  assert.deepEqual(kneeLimits('[supervisor]\n# torque_limit_share = 0.1\nhot_torque_limit_share = 0.2\n'), [-50, 50]);
});
