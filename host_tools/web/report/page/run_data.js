// Reads the run that host_tools/web/report/run_data.cc wrote into the page.

/** Decodes packed columns into a table; a group of several columns is named name0, name1, ... */
function unpackTable(packed) {
  const bytes = Uint8Array.from(atob(packed.float32_base64), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const littleEndian = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;
  const numbers = littleEndian
    ? new Float32Array(bytes.buffer)
    : Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
  const names = packed.groups.flatMap(({ name, width }) => (
    width === 1 ? [name] : Array.from({ length: width }, (_, k) => name + k)));
  return Table.of(names, names.map((_, k) => numbers.subarray(k * packed.rows, (k + 1) * packed.rows)));
}

/** A table with a row of unknown values at each of these times: nothing is drawn across them. */
function withBreaks(table, times_s) {
  if (times_s.length === 0) return table;
  const places = times_s.map((time_s) => table.lastRowUpTo(time_s) + 1);
  const values = table.values.map((column, k) => {
    const parts = places.map((place, i) => [...column.slice(places[i - 1] ?? 0, place), k === 0 ? times_s[i] : NaN]);
    return Float64Array.from([...parts.flat(), ...column.slice(places.at(-1))]);
  });
  return Table.of([...table.index.keys()], values);
}

class RecordedRun extends RobotData {
  /** `shift_s` is added to all times of the run. */
  constructor(run, shift_s = 0) {
    super(run.controller ? 'estimated_state' : 'true_state', Infinity);
    this.controller = run.controller ?? null;  // of a record of stiltd: {last_state, events}
    this.robot_name = run.robot.name;
    this.command_line = run.command_line;
    this.summary = run.summary;
    this.settings = run.settings ?? {};  // values by key; none in pages of release 0.1
    this.stride = run.ticks.stride;
    this.status_names = run.planner.status_names;
    this.friction_coefficient = run.friction_coefficient;
    this.geometry = run.robot;
    const allowed = run.allowed_torque_Nm ?? [];  // none where the file names no configuration
    this.torqueLimits_Nm = allowed.length > 0 ? allowed : [run.torque_limit_Nm];
    this.ground = run.ground;
    this.missing = run.missing_ticks ?? [];  // {first, last, from_s, to_s}: ticks that the file lacks
    const ticks = withBreaks(unpackTable(run.ticks), this.missing.map(({ from_s }) => from_s));
    const planner = unpackTable(run.planner);
    const nodes = unpackTable(run.plans.nodes);
    for (const table of [ticks, planner, nodes]) table.time.forEach((time_s, i) => { table.time[i] = time_s + shift_s; });
    for (const step of run.summary.steps) step.time_s += shift_s;
    // A simulation samples controller and robot together.
    this.tables = { ticks, truth: ticks, planner, plan: nodes };
    this.shift_s = shift_s;
    this.start_s = ticks.oldestTime ?? 0;
    this.end_s = Math.max(ticks.newestTime ?? 1, this.start_s + 1e-3);
    const ends = [...run.plans.first_node.slice(1), this.tables.plan.rows];
    this.plans = run.plans.time_s.map((time_s, i) => {
      const first = run.plans.first_node[i];
      return { time_s: time_s + shift_s, first, count: ends[i] - first };
    });
    ticks.column('push_N').forEach((force_N, i) => this.notePush(ticks.time[i], force_N));
    this.addSteps();
    addErrors(ticks);
    addFrictionRatios(ticks);
  }

  /** Contact forces at `time_s`, those planned where they are not measured in full; null when neither is known. */
  forcesAt(time_s) {
    const { ticks } = this.tables;
    const known = ['contact_force_N', 'planned_contact_force_N'].map((name) => ticks.before(ticks.group(name), time_s));
    return known.find((forces) => forces?.every(Number.isFinite)) ?? null;
  }

  /** Times of the samples of a robot off its feet, of which the pose alone is known. */
  offItsFeet() {
    const [x, , pitch] = this.tables.ticks.group(this.stateGroup);
    return this.tables.ticks.time.filter((_, row) => Number.isFinite(pitch[row]) && !Number.isFinite(x[row]));
  }

  footprintsUpTo(time_s) {
    return super.footprintsUpTo(time_s).filter((place) => time_s < place.until_s);
  }

  /** Footprints, and the table of step lengths at touch-down. Prints stay until the robot is off its feet. */
  addSteps() {
    const { steps } = this.summary;
    const { ticks } = this.tables;
    const feet = ticks.group('foot_position_m');
    const off_s = this.offItsFeet();
    this.footprints = steps.map((step) => {
      const foot = step.foot === 'L' ? 0 : 1;
      const x = ticks.before(feet, step.time_s)?.[2 * foot] ?? 0;
      const until_s = off_s.find((time_s) => time_s > step.time_s) ?? Infinity;
      return { foot, x, z: groundHeight(this.ground, x), time: step.time_s, until_s };
    });
    const lengths = (foot) => steps.map((step) => (step.foot === foot ? step.length_m ?? NaN : NaN));
    this.tables.steps = Table.of(['time_s', 'left_m', 'right_m'],
      [steps.map((step) => step.time_s), lengths('L'), lengths('R')]);
  }
}

/** Adds columns of the estimate's error: position in mm, velocity in m/s; forward and up. */
function addErrors(ticks) {
  const error = (k, factor) => {
    const truth = ticks.column(`true_state${k}`);
    return ticks.column(`estimated_state${k}`).map((value, i) => factor * (value - truth[i]));
  };
  [0, 1].forEach((k) => ticks.addColumn(`position_error_mm${k}`, error(k, 1000)));
  [0, 1].forEach((k) => ticks.addColumn(`velocity_error_m_s${k}`, error(7 + k, 1)));
}

const kLoaded_N = 10;

/** Adds columns of the ratio of tangential to normal force, of feet that carry over kLoaded_N. */
function addFrictionRatios(ticks) {
  for (const planned of ['', 'planned_']) {
    const forces = ticks.group(`${planned}contact_force_N`);
    [0, 1].forEach((foot) => {
      const normal = forces[2 * foot + 1];
      const ratio = forces[2 * foot].map((fx, i) => (normal[i] > kLoaded_N ? fx / normal[i] : NaN));
      ticks.addColumn(`${planned}friction_ratio${foot}`, ratio);
    });
  }
}
