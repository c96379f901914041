// What the page knows: tables of samples and the newest of everything else.

/** How far one may look back, and how long the page may be paused before it takes nothing new, to keep that. */
const kLookBack_s = 60;
const kKept_s = 2 * kLookBack_s + 2;
const kPlansKept = kKept_s * 30;
const kFeetColumns = ['left_foot_z_m', 'right_foot_z_m'];
const kAddedColumns = [...kFeetColumns, 'commanded_speed_m_s', 'commanded_height_m'];

/** Knots of the plan table, as kinematics.js and scene.js want them. */
function knotsOf(table, names) {
  const k = Object.fromEntries(names.map((name, index) => [name, index]));
  return Array.from({ length: table.rows }, (_, row) => {
    const value = (name) => table.values[row * table.width + k[name]];
    return {
      time: table.base_s + value('time_s'),
      hip: { x: value('hip_x_m'), z: value('hip_z_m') },
      pitch: value('pitch_rad'),
      feet: [{ x: value('foot_position_m0'), z: value('foot_position_m1') },
        { x: value('foot_position_m2'), z: value('foot_position_m3') }],
      forces: [0, 1, 2, 3].map((i) => value(`contact_force_N${i}`)),
      carries: [value('carries0') > 0.5, value('carries1') > 0.5],
    };
  });
}

class RobotState {
  constructor() {
    this.pausedAt_s = null;
    this.clock = new ShowClock();
    this.hello = null;
    this.configuration = null;
    this.drawing = null;
    this.forget();
  }

  /** Another session, or another monitor. */
  forget() {
    this.tables = null;
    this.plans = [];
    this.supervisor = null;
    this.timing = null;
    this.footprints = [];
    this.clock.reset();
    if (this.hello) this.makeTables();
  }

  greet(hello) {
    this.hello = hello;
    this.configuration = null;
    this.forget();
  }

  makeTables() {
    const { ticks, planner, truth } = this.hello.columns;
    this.tables = {
      ticks: new RingTable([...ticks, ...kAddedColumns], kKept_s * 1000),
      planner: new RingTable(planner, kKept_s * 500),
      truth: new RingTable(truth, kKept_s * 250),
      force: new RingTable(['time_s', 'left_N', 'right_N'], kKept_s * 100),
    };
  }

  configure(configuration) {
    if (this.configuration && this.configuration.session !== configuration.session) this.forget();
    this.configuration = configuration;
    this.drawing = configuration.drawing;
  }

  /** Called with null when the picture moves again. */
  pauseAt(time_s) {
    this.pausedAt_s = time_s;
  }

  take(table, now_s) {
    if (this.pausedAt_s !== null && table.base_s > this.pausedAt_s + kLookBack_s) {
      if (table.name === 'ticks') this.clock.arrived(table.base_s, now_s);
      return;
    }
    if (table.name === 'plan') {
      this.keepPlan(table);
      return;
    }
    const ring = this.tables[table.name];
    for (let row = 0; row < table.rows; ++row) {
      const from = row * table.width;
      const slot = ring.append(table.base_s + table.values[from]);
      for (let k = 1; k < table.width; ++k) ring.values[k][slot] = table.values[from + k];
      if (table.name === 'ticks') this.addFeet(ring, slot);
    }
    if (table.name === 'ticks' && table.rows > 0) this.clock.arrived(ring.newestTime, now_s);
  }

  addFeet(ring, slot) {
    const stateColumn = ring.index.get('state0');
    const q = [0, 1, 2, 3, 4, 5, 6].map((k) => ring.values[stateColumn + k][slot]);
    const pose = this.drawing ? poseOfState(this.drawing, q) : null;
    const walks = this.supervisor?.gait === 2;
    ring.column('commanded_speed_m_s')[slot] = walks ? this.supervisor.speed_m_s : 0;
    ring.column('commanded_height_m')[slot] = this.supervisor?.base_height_m || NaN;
    const before = this.poseBefore;
    this.poseBefore = pose;
    ['left', 'right'].forEach((side, foot) => {
      ring.column(kFeetColumns[foot])[slot] = pose ? pose[side].foot.z : NaN;
      if (pose && before) this.noteTouchDown(ring.time[slot], foot, pose[side].foot, before[side].foot);
    });
  }

  /** A foot that stops coming down leaves a print. */
  noteTouchDown(time_s, foot, now, before) {
    const kLifted_m = 0.02;
    const kDown_m = 0.006;
    this.lifted ??= [false, false];
    if (now.z > kLifted_m) this.lifted[foot] = true;
    if (!this.lifted[foot] || now.z > kDown_m || Math.abs(now.x - before.x) > 0.002) return;
    this.lifted[foot] = false;
    this.footprints.push({ foot, x: now.x, z: 0, time: time_s });
    if (this.footprints.length > 40) this.footprints.shift();
  }

  /** Plans are kept as they came, for looking back, and taken apart when they are drawn. */
  keepPlan(table) {
    this.plans.push(table);
    if (this.plans.length > kPlansKept) this.plans.shift();
    const [first] = knotsOf({ ...table, rows: 1 }, this.hello.columns.plan);
    const slot = this.tables.force.append(table.base_s);
    this.tables.force.column('left_N')[slot] = first.forces[1];
    this.tables.force.column('right_N')[slot] = first.forces[3];
  }

  /** Knots of the newest plan that had begun at `time_s`, none when it is long over. */
  planAt(time_s) {
    const plan = this.plans.findLast((table) => table.base_s <= time_s);
    if (!plan || plan.base_s < time_s - 1) return [];
    if (this.drawnPlan?.table !== plan) this.drawnPlan = { table: plan, knots: knotsOf(plan, this.hello.columns.plan) };
    const { knots } = this.drawnPlan;
    return knots.length > 1 && knots.at(-1).time > time_s ? knots : [];
  }

  supervise(message) {
    this.supervisor = message;
  }

  /** State x (14 numbers) at `time_s`, or null. */
  stateAt(time_s) {
    const ticks = this.tables?.ticks;
    if (!ticks || ticks.rows === 0) return null;
    const first = ticks.index.get('state0');
    const state = [];
    for (let k = 0; k < 14; ++k) state.push(ticks.at(ticks.values[first + k], time_s));
    return state[0] === null || !state.slice(0, 7).every(Number.isFinite) ? null : state;
  }

  /** Mean forward speed over the second before `time_s`, or null. */
  speedAt(time_s) {
    const ticks = this.tables?.ticks;
    if (!ticks || ticks.rows === 0) return null;
    const x = ticks.column('state0');
    const from = Math.max(ticks.time[ticks.slot(0)], time_s - 1);
    if (time_s - from < 0.2) return null;
    return (ticks.at(x, time_s) - ticks.at(x, from)) / (time_s - from);
  }
}
