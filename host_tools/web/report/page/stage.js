// The animation: the camera follows the hip, the picture is drawn anew for each change of the player.

const kBelowGround_px = 36;
const kReadout_px = 32;
const kRobotHeight_m = 1.42;

/** Mean hip position around `time`, so that the camera glides. */
function cameraX(run, time) {
  const offsets = [-0.3, -0.15, 0, 0.15, 0.3];
  const column = run.samples.true_state[0];
  const sum = offsets.reduce((total, offset) => {
    const clamped = Math.min(run.end_s, Math.max(run.start_s, time + offset));
    return total + interpolate(run.samples.time, column, clamped);
  }, 0);
  return sum / offsets.length;
}

function stanceName(samples, i) {
  const [left, right] = [samples.scheduled_mode[0][i], samples.scheduled_mode[1][i]];
  if (left && right) return 'both feet';
  if (left) return 'left foot';
  return right ? 'right foot' : 'no foot';
}

class Stage {
  constructor(run, player) {
    this.run = run;
    this.player = player;
    this.canvas = document.getElementById('stage-canvas');
    this.readout = document.getElementById('readout');
    this.showPlan = document.getElementById('show-plan');
    this.showForces = document.getElementById('show-forces');
    this.footprints = footprintsOf(run);
    this.colours = readColours();
    this.showPlan.addEventListener('change', () => this.draw());
    this.showForces.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    player.listen(() => this.draw());
  }

  recolour() {
    this.colours = readColours();
    this.draw();
  }

  draw() {
    const { run, colours } = this;
    const { context, width, height } = fitCanvas(this.canvas);
    if (run.samples.rows === 0 || width === 0) return;
    const time = this.player.time_s;
    const camera = cameraX(run, time);
    const scale = (height - kBelowGround_px - kReadout_px) / kRobotHeight_m;
    const base_z = groundHeight(run.ground, camera) - kBelowGround_px / scale;
    const lead_m = Math.min(0.35, (0.18 * width) / scale);
    const view = makeView(context, width, height, camera + lead_m, base_z, scale);
    const pose = poseOfState(run.robot, stateAt(run, 'true_state', time));

    drawGround(view, run.ground, colours, this.footprints.filter((place) => place.time <= time));
    if (this.showPlan.checked) {
      const knots = planAt(run, time);
      drawPlannedTorso(view, run.robot, knots, colours, time);
      drawPlannedPaths(view, knots, colours, time);
    }
    drawRobot(view, pose, colours);
    if (this.showForces.checked) drawForcesAt(view, run, pose, colours, time);
    drawPushAt(view, run, pose, colours, time);
    this.writeReadout(time);
  }

  writeReadout(time) {
    const samples = this.run.samples;
    const i = lastIndexUpTo(samples.time, time);
    const speed = samples.true_state[7][i].toFixed(2);
    const command = samples.commanded_speed_m_s[0][i].toFixed(2);
    this.readout.textContent = `${speed} m/s (commanded ${command}) · stance: ${stanceName(samples, i)}`;
  }
}
