// The robot now: drawn anew for every frame.

const kBelowGround_px = 40;
const kReadout_px = 34;
const kRobotHeight_m = 1.42;
const kLevelGround = { x_m: [], z_m: [] };

class LiveStage {
  constructor(robot) {
    this.robot = robot;
    this.canvas = document.getElementById('stage-canvas');
    this.speed = document.getElementById('speed-now');
    this.detail = document.getElementById('stage-detail');
    this.showPlan = document.getElementById('show-plan');
    this.showForces = document.getElementById('show-forces');
    this.wrote_s = 0;
    this.size = { width: 0, height: 0 };
    new ResizeObserver(([entry]) => { this.size = entry.contentRect; }).observe(this.canvas);
    this.recolour();
  }

  recolour() {
    this.colours = readColours();
  }

  /** Mean hip position around now, so that the camera glides. */
  cameraX(time) {
    const x = this.robot.tables.ticks.column('state0');
    const offsets = [-0.6, -0.45, -0.3, -0.15, 0];
    const sum = offsets.reduce((total, offset) => total + (this.robot.tables.ticks.at(x, time + offset) ?? NaN), 0);
    const behind = sum / offsets.length;
    const state = this.robot.stateAt(time);
    return Number.isFinite(behind) ? behind + 0.3 * (this.robot.speedAt(time) ?? 0) : state[0];
  }

  draw(time, now_s) {
    const { context, width, height } = fitCanvas(this.canvas, this.size);
    if (width === 0) return;
    const scale = (height - kBelowGround_px - kReadout_px) / kRobotHeight_m;
    const state = time === null || !this.robot.drawing ? null : this.robot.stateAt(time);
    const camera = state ? this.cameraX(time) : 0;
    const lead_m = Math.min(0.35, (0.18 * width) / scale);
    const view = makeView(context, width, height, camera + lead_m, -kBelowGround_px / scale, scale);
    drawGround(view, kLevelGround, this.colours, this.robot.footprints.filter((place) => place.time <= time));
    if (state) this.drawRobotIn(view, state, time);
    if (now_s - this.wrote_s > 0.2) {
      this.wrote_s = now_s;
      this.write(state, time);
    }
  }

  /** For measuring how long it takes until the page shows a robot that moves. */
  noteFirstMotion(state) {
    if (this.moved) return;
    this.firstState ??= state;
    this.moved = state.some((value, k) => value !== this.firstState[k]);
    if (this.moved) performance.mark('first-moving-frame');
  }

  drawRobotIn(view, state, time) {
    const { robot, colours } = this;
    this.noteFirstMotion(state);
    const pose = poseOfState(robot.drawing, state);
    const knots = robot.planAt(time);
    if (this.showPlan.checked && knots.length > 0) {
      drawPlannedTorso(view, robot.drawing, knots, colours, time);
      drawPlannedPaths(view, knots, colours, time);
    }
    drawRobot(view, pose, colours);
    const truth = robot.tables.truth;
    const known = truth.rows > 0 && Math.abs(truth.newestTime - time) < 0.5;
    if (this.showForces.checked) {
      const forces = known ? this.truthAt('contact_force_N', 4, time) : forcesOf(knots, time);
      if (forces) drawContactForces(view, pose, forces, colours);
    }
    if (known) {
      const share = truth.before(truth.column('push_above_hip_m'), time) / robot.drawing.torso_length_m;
      drawPush(view, pose, truth.before(truth.column('push_N'), time), share, colours);
    }
  }

  truthAt(name, width, time) {
    const truth = this.robot.tables.truth;
    const values = Array.from({ length: width }, (_, k) => truth.before(truth.column(`${name}${k}`), time));
    return values[0] === null ? null : values;
  }

  write(state, time) {
    const speed = state ? this.robot.speedAt(time) : null;
    this.speed.textContent = speed === null ? '–' : signed(speed, 2);
    this.speed.dataset.value = speed ?? '';
    if (!state) {
      this.detail.textContent = '';
      return;
    }
    this.canvas.dataset.hipX = state[0];
    this.detail.textContent = `x ${signed(state[0], 2)} m · hip ${state[1].toFixed(3)} m high · ` +
      `lean ${signed((state[2] * 180) / Math.PI, 1)}°`;
  }
}

/** Planned contact forces at `time`: those of the knot before it. */
function forcesOf(knots, time) {
  let found = null;
  for (const knot of knots) {
    if (knot.time > time) break;
    found = knot;
  }
  return found?.forces ?? null;
}

function signed(value, digits) {
  return value.toFixed(digits).replace('-', '−');
}
