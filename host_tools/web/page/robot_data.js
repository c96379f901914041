// What the pages hold of a robot: tables of samples over time, plans, pushes, footprints. The monitor fills them as
// samples come, a report at once.

/** How long a sample of the simulation is drawn when no newer one has come. */
const kTruthLife_s = 0.5;

/** Shown beside the pose of a robot off its feet. */
const kHipUnknown = 'Pose of the joints; the place of the hip is not known off its feet';

/** Pushes of a run, and of the one to compare with: {from_s, to_s, force_N, second}. */
function pushesOf({ pushes, other }) {
  return [...pushes.map((push) => ({ ...push, second: false })), ...(other?.pushes ?? []).map((push) => ({ ...push, second: true }))];
}

class RobotData {
  /**
   * `stateGroup`: columns of the table `ticks` with the state that is drawn. `planLife_s`: how long after its start a
   * plan is drawn when no newer one has come. Tables: `ticks` of the controller, `truth` that only a simulation has,
   * `planner` with a row per solve, `plan` with a row per node. A page adds those of its plots. */
  constructor(stateGroup, planLife_s) {
    this.stateGroup = stateGroup;
    this.planLife_s = planLife_s;
    this.geometry = null;  // lengths of the links
    this.torqueLimits_Nm = [];  // lists of the joints' limits: of all, and of plans and torque law where that is less
    this.ground = { x_m: [], z_m: [] };
    this.other = null;  // another RobotData, of a run to compare with
    this.hipUnknown = false;  // whether the last stateAt() has a hip put anywhere, as of a robot off its feet
    this.clear();
  }

  clear() {
    this.tables = null;
    this.plans = [];  // {time_s, first, count}: nodes of the table `plan`, counted from its first one on
    this.pushes = [];  // {from_s, to_s, force_N}
    this.footprints = [];  // {foot, x, z, time}
    this.drawnPlan = null;
    this.push_N = 0;
  }

  /** State x (14 numbers) at `time_s`, or null. Without a place of its hip the lowest foot stands on the ground at 0. */
  stateAt(time_s) {
    const ticks = this.tables?.ticks;
    const state = ticks?.at(ticks.group(this.stateGroup), time_s);
    const known = Boolean(this.geometry) && (state?.slice(2, 7).every(Number.isFinite) ?? false);
    this.hipUnknown = known && !state.slice(0, 2).every(Number.isFinite);
    if (!this.hipUnknown) return known ? state : null;
    const { left, right } = poseOfState(this.geometry, [0, 0, ...state.slice(2, 7)]);
    return [0, -Math.min(left.foot.z, right.foot.z), ...state.slice(2)];
  }

  /** Mean forward speed over the second before `time_s`, or null. */
  speedAt(time_s) {
    const ticks = this.tables?.ticks;
    if (!ticks || ticks.rows === 0) return null;
    const x = ticks.group(this.stateGroup).slice(0, 1);
    const from = Math.max(ticks.oldestTime, time_s - 1);
    if (time_s - from < 0.2) return null;
    const speed = (ticks.at(x, time_s)[0] - ticks.at(x, from)[0]) / (time_s - from);
    return Number.isFinite(speed) ? speed : null;
  }

  /** Nodes of the newest plan that had begun at `time_s`, none when it is long over. */
  planAt(time_s) {
    const plan = this.plans.findLast((one) => one.time_s <= time_s);
    if (!plan || plan.time_s < time_s - this.planLife_s) return [];
    if (this.drawnPlan?.plan !== plan) this.drawnPlan = { plan, nodes: this.nodesOf(plan) };
    const { nodes } = this.drawnPlan;
    return nodes.length > 1 && nodes.at(-1).time > time_s ? nodes : [];
  }

  /** Nodes {time, hip, pitch, feet, forces}. The planner works from the estimate; they are drawn beside the robot. */
  nodesOf({ time_s, first, count }) {
    const table = this.tables.plan;
    const [dx, dz] = this.offsetOfEstimate(time_s);
    const [hipX, hipZ, pitch] = ['base_x_m', 'base_z_m', 'pitch_rad'].map((name) => table.column(name));
    const [leftX, leftZ, rightX, rightZ] = table.group('foot_position_m');
    return Array.from({ length: count }, (_, k) => {
      const slot = (first + k) % table.capacity;
      const point = (x, z) => ({ x: x[slot] + dx, z: z[slot] + dz });
      return {
        time: table.time[slot],
        hip: point(hipX, hipZ),
        pitch: pitch[slot],
        feet: [point(leftX, leftZ), point(rightX, rightZ)],
        forces: table.group('contact_force_N').map((values) => values[slot]),
      };
    });
  }

  /** Where the drawn hip is, seen from the estimated one: [x, z]. */
  offsetOfEstimate(time_s) {
    const { ticks } = this.tables;
    const [drawn, estimated] = [this.stateGroup, 'estimated_state'].map((name) => ticks.at(ticks.group(name), time_s));
    return [0, 1].map((k) => {
      const offset = drawn && estimated ? drawn[k] - estimated[k] : 0;
      return Number.isFinite(offset) ? offset : 0;
    });
  }

  /** The simulation's values of `columns` at `time_s`; null when it is a robot, or the simulation is silent. */
  truthAt(columns, time_s) {
    const { truth } = this.tables;
    const row = truth.lastRowUpTo(time_s);
    const known = row >= 0 && (row + 1 < truth.rows || time_s - truth.newestTime < kTruthLife_s);
    return known ? truth.before(columns, time_s) : null;
  }

  /** Contact forces [fxL, fzL, fxR, fzR] at `time_s`, or else those planned then; null when neither is known. */
  forcesAt(time_s) {
    const forces = this.truthAt(this.tables.truth.group('contact_force_N'), time_s);
    return forces ?? this.planAt(time_s).findLast((node) => node.time <= time_s)?.forces ?? null;
  }

  /** The push at `time_s`: {force_N, above_hip_m}, or null. */
  pushAt(time_s) {
    const { truth } = this.tables;
    const push = this.truthAt(['push_N', 'push_above_hip_m'].map((name) => truth.column(name)), time_s);
    return push && { force_N: push[0], above_hip_m: push[1] };
  }

  /** Adds a sample of the push to the intervals in which it does not change. */
  notePush(time_s, force_N) {
    if (force_N && force_N === this.push_N) this.pushes.at(-1).to_s = time_s;
    else if (force_N) this.pushes.push({ from_s: time_s, to_s: time_s, force_N });
    this.push_N = force_N;
  }

  footprintsUpTo(time_s) {
    return this.footprints.filter((place) => place.time <= time_s);
  }
}
