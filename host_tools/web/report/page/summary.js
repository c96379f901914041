// Header and summary tables. Text from the run enters as textContent, never as markup.

function number(value, digits, unit = '') {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  return `${value.toFixed(digits).replace('-', '−')}${unit && ` ${unit}`}`;
}

function exponent(value) {
  if (value === null || !Number.isFinite(value)) return '–';
  return value === 0 ? '0' : value.toExponential(1).replace('-', '−');
}

function bytes(value) {
  return value >= 1024 ? `${(value / 1024).toFixed(0)} KiB` : `${value} B`;
}

function outcomeRows(s) {
  return [
    ['Survived', s.survived ? 'yes' : 'no'],
    ['Fell at', s.fall_time_s === null ? 'did not fall' : number(s.fall_time_s, 2, 's')],
    ['Duration', number(s.duration_s, 1, 's')],
    ['Distance', number(s.distance_m, 2, 'm')],
    ['Mean speed', number(s.mean_speed_m_s, 3, 'm/s')],
    ['Slip of the feet', number(1000 * s.slip_distance_m, 1, 'mm')],
  ];
}

function stepRows(s) {
  return [
    ['Steps', String(s.steps.length)],
    ['Shortest', number(s.step_length_min_m, 3, 'm')],
    ['Longest', number(s.step_length_max_m, 3, 'm')],
  ];
}

function jointRows(s) {
  return ['Left hip', 'Left knee', 'Right hip', 'Right knee'].map((name, k) => (
    [name, number(s.peak_torque_Nm[k], 1, 'Nm'), number(s.peak_joint_speed_rad_s[k], 2, 'rad/s')]));
}

function plannerRows(s) {
  return [
    ['Solve time, median', number(s.solve_time_us.p50 / 1000, 2, 'ms')],
    ['Solve time, 99th percentile', number(s.solve_time_us.p99 / 1000, 2, 'ms')],
    ['Solve time, longest', number(s.solve_time_us.max / 1000, 2, 'ms')],
    ['SQP iterations, mean', number(s.sqp_iterations.mean, 2)],
    ['SQP iterations, most', String(s.sqp_iterations.max)],
    ['Largest dynamics defect', exponent(s.dynamics_defect_max)],
    ['Largest equality violation', exponent(s.equality_violation_max)],
  ];
}

/** How solves ended: rows of name and count, those that happened. */
function solveEndRows(solves) {
  return solves.status_names
    .map((name, status) => [`Solves: ${name}`, String(solves.status[0].filter((value) => value === status).length)])
    .filter(([, count]) => count !== '0');
}

function memoryRows(s) {
  return [
    ['Heap allocations in the loop', String(s.heap_allocations_in_loop)],
    ['Controller object', bytes(s.controller_bytes)],
  ];
}

function addTable(container, title, rows, heads = []) {
  const table = document.createElement('table');
  table.createCaption().textContent = title;
  if (heads.length > 0) {
    const row = table.createTHead().insertRow();
    for (const head of heads) row.append(Object.assign(document.createElement('th'), { textContent: head, scope: 'col' }));
  }
  const body = table.createTBody();
  for (const [name, ...values] of rows) {
    const row = body.insertRow();
    row.append(Object.assign(document.createElement('th'), { textContent: name, scope: 'row' }));
    for (const value of values) row.insertCell().textContent = value;
  }
  container.append(table);
}

function addStepList(container, steps) {
  if (steps.length === 0) return;
  const details = document.createElement('details');
  details.append(Object.assign(document.createElement('summary'), { textContent: `All ${steps.length} steps` }));
  const rows = steps.map((step) => (
    [number(step.time_s, 3, 's'), step.foot === 'L' ? 'left' : 'right', number(step.length_m, 3, 'm')]));
  addTable(details, '', rows, ['Touch-down', 'Foot', 'Length']);
  container.append(details);
}

function group(container) {
  const box = document.createElement('div');
  container.append(box);
  return box;
}

function showHeader(run) {
  const s = run.summary;
  document.getElementById('robot-name').textContent = run.robot.name;
  const badge = document.getElementById('outcome');
  badge.textContent = s.survived ? 'survived' : s.fall_time_s === null ? 'did not survive' : `fell at ${number(s.fall_time_s, 2, 's')}`;
  badge.classList.add(s.survived ? 'good' : 'bad');
  const pushes = run.pushes.length === 1 ? '1 push' : `${run.pushes.length} pushes`;
  document.getElementById('headline').textContent =
    `${number(s.duration_s, 1, 's')}, ${number(s.distance_m, 1, 'm')}, ${s.steps.length} steps, ` +
    `mean speed ${number(s.mean_speed_m_s, 2, 'm/s')}, ${pushes}`;
  document.getElementById('command-line').textContent = run.command_line;
  if (run.samples.stride > 1) {
    const note = document.getElementById('thinned');
    note.hidden = false;
    note.textContent = `A long run: plots and animation show every ${run.samples.stride}th sample; ` +
      'the summary is of all of them.';
  }
}

function showSummary(run) {
  const container = document.getElementById('summary');
  const s = run.summary;
  addTable(group(container), 'Outcome', outcomeRows(s));
  addTable(group(container), 'Joints', jointRows(s), ['', 'Peak torque', 'Peak speed']);
  const steps = group(container);
  addTable(steps, 'Steps', stepRows(s));
  addStepList(steps, s.steps);
  if (run.solves.rows === 0) return;  // a record of the robot alone: nothing is known of its controller
  addTable(steps, 'Memory', memoryRows(s));
  addTable(group(container), 'Planner', [...plannerRows(s), ...solveEndRows(run.solves)]);
}
