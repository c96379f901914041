// Header and summary tables. Text from the run enters as textContent, never as markup.

function number(value, digits, unit = '') {
  if (value === null || value === undefined || !Number.isFinite(value)) return '–';
  return `${signed(value, digits)}${unit && ` ${unit}`}`;
}

/** A time in µs; null where none was measured, as in lock-step. */
function milliseconds(value_us) {
  return number(value_us === null ? null : value_us / 1000, 2, 'ms');
}

function exponent(value) {
  if (value === null || !Number.isFinite(value)) return '–';
  return value === 0 ? '0' : value.toExponential(1).replace('-', '−');
}

function megabytes(value) {
  return `${(value / 1e6).toFixed(2)} MB`;
}

function outcomeRows({ summary: s, controller }) {
  if (controller) {
    return [
      ['Last state', controller.last_state],
      ['Duration', number(s.duration_s, 1, 's')],
      ['Distance', number(s.distance_m, 2, 'm')],
      ['Mean speed in state walk', number(s.mean_speed_m_s, 3, 'm/s')],
    ];
  }
  const survived = [
    ['Survived', s.survived ? 'yes' : 'no'],
    ['Fell at', s.fall_time_s === null ? 'did not fall' : number(s.fall_time_s, 2, 's')],
  ];
  return [
    ...(s.survived === null ? [] : survived),
    ['Duration', number(s.duration_s, 1, 's')],
    ['Distance', number(s.distance_m, 2, 'm')],
    ['Mean speed', number(s.mean_speed_m_s, 3, 'm/s')],
    ['Slip of the feet', number(s.slip_distance_m === null ? null : 1000 * s.slip_distance_m, 1, 'mm')],
  ];
}

/** How many steps there were; null when some of them are not known. */
function stepCount(s) {
  return s.steps_known === false ? null : s.steps.length;
}

function stepRows(s) {
  const lengths = [s.step_length_min_m, s.step_length_max_m].map((value) => (stepCount(s) > 0 ? value : null));
  return [
    ['Steps', number(stepCount(s), 0)],
    ['Shortest', number(lengths[0], 3, 'm')],
    ['Longest', number(lengths[1], 3, 'm')],
  ];
}

function jointRows(s) {
  return ['Left hip', 'Left knee', 'Right hip', 'Right knee'].map((name, k) => (
    [name, number(s.peak_torque_Nm[k], 1, 'Nm'), number(s.peak_joint_speed_rad_s[k], 2, 'rad/s')]));
}

function plannerRows(s) {
  return [
    ['Solve time, median', milliseconds(s.solve_time_us.p50)],
    ['Solve time, 99th percentile', milliseconds(s.solve_time_us.p99)],
    ['Solve time, longest', milliseconds(s.solve_time_us.max)],
    ['SQP iterations, mean', number(s.sqp_iterations.mean, 2)],
    ['SQP iterations, most', String(s.sqp_iterations.max)],
    ['Largest dynamics defect', exponent(s.dynamics_defect_max)],
    ['Largest equality violation', exponent(s.equality_violation_max)],
  ];
}

/** How solves ended: rows of name and count, those that happened. */
function solveEndRows(run) {
  const ends = run.tables.planner.column('status');
  return run.status_names
    .map((name, status) => [`Solves: ${name}`, String(ends.filter((value) => value === status).length)])
    .filter(([, count]) => count !== '0');
}

function memoryRows({ summary: s, controller }) {
  const allocations = ['Heap allocations in the loop', String(s.heap_allocations_in_loop)];
  return controller ? [allocations] : [allocations, ['Controller object', megabytes(s.controller_bytes)]];
}

function addTable(container, title, rows, heads = []) {
  const table = element('table', {}, element('caption', { textContent: title }));
  if (heads.length > 0) {
    table.createTHead().insertRow().append(...heads.map((head) => element('th', { textContent: head, scope: 'col' })));
  }
  const cells = ([name, ...values]) => (
    [element('th', { textContent: name, scope: 'row' }), ...values.map((value) => element('td', { textContent: value }))]);
  table.append(element('tbody', {}, ...rows.map((row) => element('tr', {}, ...cells(row)))));
  container.append(table);
}

function addStepList(container, { steps, ...s }) {
  if (steps.length === 0) return;
  const which = s.steps_known === false ? `${steps.length} steps with known forces or plans` : `All ${steps.length} steps`;
  const details = element('details', {}, element('summary', { textContent: which }));
  const rows = steps.map((step) => (
    [number(step.time_s, 3, 's'), step.foot === 'L' ? 'left' : 'right', number(step.length_m, 3, 'm')]));
  addTable(details, '', rows, ['Touch-down', 'Foot', 'Length']);
  container.append(details);
}

function addEvents(container, events, ofWhat = '', open = events.length <= 12) {
  const details = element('details', { open },
    element('summary', { textContent: `${events.length} events ${ofWhat}` }));
  addTable(details, '', events.map(({ time_s, text }) => [number(time_s, 3, 's'), text]), ['Time', 'Event']);
  container.append(details);
}

function group(container) {
  const box = element('div');
  container.append(box);
  return box;
}

/** Text and class of the badge. */
function outcomeOf({ summary: s, controller }) {
  if (controller) return [`ended in state ${controller.last_state}`, controller.last_state === 'fault' ? 'bad' : 'good'];
  if (s.survived === null) return ['outcome not in the file', 'unknown'];
  if (s.survived) return ['survived', 'good'];
  return [s.fall_time_s === null ? 'did not survive' : `fell at ${number(s.fall_time_s, 2, 's')}`, 'bad'];
}

/** A run in one line. What is not known is left out. */
function headline({ summary: s, pushes, controller }) {
  return [
    number(s.duration_s, 1, 's'),
    ...(s.distance_m === null ? [] : [number(s.distance_m, 1, 'm')]),
    ...(stepCount(s) === null ? [] : [`${stepCount(s)} steps`]),
    ...(s.mean_speed_m_s === null ? [] : [`mean speed ${number(s.mean_speed_m_s, 2, 'm/s')}`]),
    ...(controller ? [] : [pushes.length === 1 ? '1 push' : `${pushes.length} pushes`]),
  ].join(', ');
}

function showHeader(run) {
  const s = run.summary;
  document.getElementById('robot-name').textContent = run.robot_name;
  const badge = document.getElementById('outcome');
  const [text, kind] = outcomeOf(run);
  badge.textContent = text;
  badge.classList.add(kind);
  document.getElementById('headline').textContent = headline(run);
  document.getElementById('command-line').textContent = run.command_line;
  showThinned(run.stride);
  showMissing(missingText(run));
}

/** Which ticks a run lacks, as a sentence; empty when it lacks none. */
function missingText({ missing }) {
  const kNamed = 5;
  if (missing.length === 0) return '';
  const named = missing.slice(0, kNamed).map(({ first, last, from_s, to_s }) => (first === last
    ? `${first} (${from_s.toFixed(2)} s)` : `${first} to ${last} (${from_s.toFixed(2)} to ${to_s.toFixed(2)} s)`));
  const more = missing.length > kNamed ? ` and ${missing.length - kNamed} more gaps` : '';
  return `Ticks are missing: ${named.join(', ')}${more}.`;
}

function showMissing(text) {
  const note = document.getElementById('missing');
  note.hidden = text === '';
  note.textContent = text;
}

function showThinned(stride) {
  if (stride === 1) return;
  const note = document.getElementById('thinned');
  note.hidden = false;
  note.textContent = `A long run: plots and animation show every ${stride}th sample; ` +
    'the summary is of all of them.';
}

function showSummary(run) {
  const container = document.getElementById('summary');
  const s = run.summary;
  const outcome = group(container);
  addTable(outcome, 'Outcome', outcomeRows(run));
  if (run.controller) addEvents(outcome, run.controller.events);
  addTable(group(container), 'Joints', jointRows(s), ['', 'Peak torque', 'Peak speed']);
  const steps = group(container);
  addTable(steps, 'Steps', stepRows(s));
  addStepList(steps, s);
  if (run.tables.planner.rows === 0) return;  // a record of the robot alone: nothing is known of its controller
  addTable(steps, 'Memory', memoryRows(run));
  addTable(group(container), 'Planner', [...plannerRows(s), ...solveEndRows(run)]);
}
