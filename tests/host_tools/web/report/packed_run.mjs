// Runs as they are in a page, made of plain columns, and the scripts of the page without a browser.

import { readFileSync } from 'node:fs';

const kFolder = new URL('../../../../host_tools/web/', import.meta.url);
const kScripts = ['page/elements.js', 'page/table.js', 'page/kinematics.js', 'page/robot_data.js', 'page/svg_context.js',
  'page/plot_parts.js', 'report/page/run_data.js', 'report/page/views.js', 'report/page/plot_list.js', 'report/page/summary.js',
  'report/page/comparison.js'];

/** The names given, of the scripts of the page. */
export function scriptsOf(...names) {
  const source = kScripts.map((name) => readFileSync(new URL(name, kFolder), 'utf-8')).join('\n');
  return new Function(`${source}\nreturn { ${names.join(', ')} };`)();
}

const kGroups = {
  time_s: 1, true_state: 14, estimated_state: 14, planned_state: 14, torque_Nm: 4, contact_force_N: 4,
  planned_contact_force_N: 4, foot_position_m: 4, scheduled_mode: 2, push_N: 1, push_above_hip_m: 1, commanded_speed_m_s: 1,
};

const kSolveGroups = {
  time_s: 1, solve_ms: 1, status: 1, iterations: 1, dynamics_defect_max: 1, equality_violation_max: 1,
  friction_cone_violation_max_N: 1, pulling_force_max_N: 1, torque_violation_max_Nm: 1,
};

/** Packed columns. `values(name, row)` gives those of a group, or nothing where they are unknown. */
function packed(groups, rows, values) {
  const columns = Object.entries(groups).flatMap(([name, width]) => (
    Array.from({ length: width }, (_, k) => Array.from({ length: rows }, (__, row) => values(name, row)?.[k] ?? NaN))));
  const bytes = Buffer.from(Float32Array.from(columns.flat()).buffer);
  return {
    rows,
    groups: Object.entries(groups).map(([name, width]) => ({ name, width })),
    float32_base64: bytes.toString('base64'),
  };
}

/** A run of stiltd with a row per entry of `ticks`: {time_s: [..], estimated_state: [..], ...}. `more` replaces parts. */
export function packedRun(ticks, more = {}) {
  return {
    command_line: 'stiltd',
    robot: { name: 'amber3m', torso_length_m: 0.5, thigh_length_m: 0.4, shin_length_m: 0.4 },
    torque_limit_Nm: [80, 80, 80, 80],
    friction_coefficient: 0.6,
    ground: { x_m: [], z_m: [] },
    controller: { last_state: 'ready', events: [] },
    settings: {},
    ticks: { ...packed(kGroups, ticks.length, (name, row) => ticks[row][name]), stride: 1 },
    plans: { time_s: [], first_node: [], nodes: packed({ time_s: 1, base_x_m: 1 }, 0, () => []) },
    planner: { ...packed(kSolveGroups, 0, () => []), status_names: [] },
    ...more,
    summary: {
      survived: true, fall_time_s: null, duration_s: 1, distance_m: 1, mean_speed_m_s: 1, steps: [],
      step_length_min_m: 0, step_length_max_m: 0, peak_torque_Nm: [1, 2, 3, 4], peak_joint_speed_rad_s: [1, 2, 3, 4],
      slip_distance_m: null, ...more.summary,
    },
  };
}

/** A state of straight legs: hip at (x_m, z_m), null where it is not known. */
export function stateAt(x_m, z_m) {
  const state = Array(14).fill(0);
  Object.assign(state, [x_m, z_m]);
  if (x_m === null) Object.assign(state, { 7: null, 8: null });
  return state;
}
