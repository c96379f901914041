// State of the monitor's page: what is drawn of the robot, and the newest of everything else.

const kKept_s = kLookBack_s + kPausedOn_s + 2;
/** Ticks of a faster torque loop are kept for less time, so that they take no more memory. */
const kMostTicks_hz = 2000;
const kNodesKept = kKept_s * 2000;
const kFootprintsKept = kKept_s * 4;
const kFeetColumns = ['left_foot_z_m', 'right_foot_z_m'];
const kAddedColumns = [...kFeetColumns, 'commanded_height_m'];

/** Shares of the robot's torque limits: what anything may ask for, and what plans and torque law may, where that is less. */
function torqueShares(toml) {
  const value = (key) => Number(toml.match(new RegExp(`^${key} = ([\\d.e+-]+)`, 'm'))?.[1] ?? 1);
  const share = value('torque_limit_share');
  return [...new Set([share, Math.min(share, value('torque_limit_scale'))])];
}

class RobotState extends RobotData {
  constructor() {
    super('estimated_state', 1);
    this.clock = new LiveClock();
    this.hello = null;
    this.configuration = null;
  }

  /** Another run, or another monitor. There are no tables until the configuration gives the rates of their rows. */
  forget() {
    this.clear();
    this.supervisor = null;
    this.timing = null;
    this.poseBefore = null;
    this.lifted = [false, false];
    this.clock.reset();
  }

  makeTables({ tick_rate_hz, plan_rate_hz }) {
    const { ticks, planner, plan, truth } = this.hello.columns;
    this.tables = {
      ticks: new Table([...ticks, ...kAddedColumns], Math.ceil(kKept_s * Math.min(tick_rate_hz, kMostTicks_hz))),
      planner: new Table(planner, Math.ceil(kKept_s * plan_rate_hz)),
      plan: new Table(plan, kNodesKept),
      truth: new Table(truth, kKept_s * 250),
      force: new Table(['time_s', 'left_N', 'right_N'], kKept_s * 100),
    };
  }

  /** Memory of all samples: it is taken at once and does not grow. */
  get bytes() {
    const columns = Object.values(this.tables ?? {}).flatMap((table) => table.values);
    return columns.reduce((sum, values) => sum + values.byteLength, 0);
  }

  greet(hello) {
    this.hello = hello;
    this.configuration = null;
    this.forget();
  }

  configure(configuration) {
    if (this.configuration?.run_id !== configuration.run_id) {
      this.forget();
      this.makeTables(configuration);
    }
    this.configuration = configuration;
    this.geometry = configuration.drawing;
    const limits = this.geometry?.torque_limit_Nm ?? [];
    this.torqueLimits_Nm = torqueShares(configuration.toml).map((share) => limits.map((limit) => share * limit));
    this.friction_coefficient = Number(configuration.toml.match(/^friction_coefficient = ([\d.e+-]+)/m)?.[1]);
  }

  /** Takes the samples of a message (see protocol.js) that came at `now_s` of the page's clock. */
  take(message, now_s) {
    if (!this.tables) return;
    const { ticks } = this.tables;
    const isTicks = message.name === 'ticks' && message.rows > 0;
    if (!this.clock.playing && message.base_s > this.clock.pausedAt_s + kPausedOn_s) {
      if (isTicks) this.clock.arrived(ticks.oldestTime, message.base_s, now_s);
      return;
    }
    const table = this.tables[message.name];
    if (message.name === 'plan') this.notePlan(message, table.appended);
    for (let row = 0; row < message.rows; ++row) {
      const from = row * message.width;
      const slot = table.append(message.base_s + message.values[from]);
      for (let k = 1; k < message.width; ++k) table.values[k][slot] = message.values[from + k];
      if (isTicks) this.addToTick(slot);
      if (table === this.tables.truth) this.notePush(table.time[slot], table.column('push_N')[slot]);
    }
    if (isTicks) this.clock.arrived(ticks.oldestTime, ticks.newestTime, now_s);
    if (this.pushes[0]?.to_s < this.clock.newest_s - kKept_s) this.pushes.shift();
  }

  /** Writes the columns that the page works out itself. */
  addToTick(slot) {
    const { ticks } = this.tables;
    const state = ticks.group(this.stateGroup).map((values) => values[slot]);
    const known = this.geometry && state.slice(0, 7).every(Number.isFinite);
    const pose = known ? poseOfState(this.geometry, state) : null;
    ticks.column('commanded_height_m')[slot] = this.supervisor?.base_height_m || NaN;
    const before = this.poseBefore;
    this.poseBefore = pose;
    ['left', 'right'].forEach((side, foot) => {
      ticks.column(kFeetColumns[foot])[slot] = pose ? pose[side].foot.z : NaN;
      if (pose && before) this.noteTouchDown(ticks.time[slot], foot, pose[side].foot, before[side].foot);
    });
  }

  /** A foot that stops coming down leaves a print. */
  noteTouchDown(time_s, foot, now, before) {
    const kLifted_m = 0.02;
    const kDown_m = 0.006;
    if (now.z > kLifted_m) this.lifted[foot] = true;
    if (!this.lifted[foot] || now.z > kDown_m || Math.abs(now.x - before.x) > 0.002) return;
    this.lifted[foot] = false;
    this.footprints.push({ foot, x: now.x, z: 0, time: time_s });
    if (this.footprints.length > kFootprintsKept) this.footprints.shift();
  }

  /** Notes the plan whose nodes come next in their table; those whose nodes are gone from it are forgotten. */
  notePlan(message, first) {
    const { plan, force } = this.tables;
    this.plans.push({ time_s: message.base_s, first, count: message.rows });
    while (this.plans[0].first < first + message.rows - plan.capacity) this.plans.shift();
    const slot = force.append(message.base_s);
    const z = plan.index.get('contact_force_N1');
    force.column('left_N')[slot] = message.values[z];
    force.column('right_N')[slot] = message.values[z + 2];
  }
}
