// The animation: the camera follows the hip.

const kBelowGround_px = 40;
const kReadout_px = 34;
const kRobotHeight_m = 1.42;
const kUnknownAlpha = 0.35;

class Stage {
  constructor(data) {
    this.data = data;
    this.canvas = document.getElementById('stage-canvas');
    this.showPlan = document.getElementById('show-plan');
    this.showForces = document.getElementById('show-forces');
    this.showCones = document.getElementById('show-cones');
    this.size = { width: 0, height: 0 };
    for (const box of [this.showPlan, this.showForces, this.showCones]) box.addEventListener('change', () => { this.stale = true; });
    new ResizeObserver(([entry]) => {
      this.size = entry.contentRect;
      this.stale = true;
    }).observe(this.canvas);
    this.recolour();
    this.export = new StageExport(this);
  }

  recolour() {
    this.colours = readColours();
    this.stale = true;
  }

  /** Draws the robot at `time_s`, unless that is the picture that is there. Returns its state, null when not known. */
  draw(time_s) {
    const { data } = this;
    if (!this.stale && time_s === this.time_s && data.geometry === this.geometry) return this.state;
    this.stale = false;
    this.time_s = time_s;
    this.geometry = data.geometry;
    this.state = time_s === null || !data.geometry ? null : data.stateAt(time_s);
    const { context, width, height } = fitCanvas(this.canvas, this.size);
    if (width > 0) this.paint(context, width, height);
    return this.state;
  }

  /** Paints the state shown on a canvas, or on what stands for one (svg_context.js). */
  paint(context, width, height) {
    const { data, time_s } = this;
    context.fillStyle = this.colours.sky;
    context.fillRect(0, 0, width, height);
    const camera = this.state ? this.cameraX() : 0;
    const scale = (height - kBelowGround_px - kReadout_px) / kRobotHeight_m;
    const base_z = groundHeight(data.ground, camera) - kBelowGround_px / scale;
    const lead_m = Math.min(0.35, (0.18 * width) / scale);
    const view = makeView(context, width, height, camera + lead_m, base_z, scale);
    drawGround(view, data.ground, this.colours, data.footprintsUpTo(time_s));
    if (!this.state) return;
    if (this.showPlan.checked && !data.hipUnknown) {
      drawPlannedTorso(view, data.geometry, data.planAt(time_s), this.colours, time_s);
      drawPlannedPaths(view, data.planAt(time_s), this.colours, time_s);
    }
    context.globalAlpha = data.hipUnknown ? kUnknownAlpha : 1;
    drawRobotAt(view, data, poseOfState(data.geometry, this.state), this.colours, time_s,
      this.showForces.checked && !data.hipUnknown, this.showCones.checked && !data.hipUnknown);
    const compared = data.other?.stateAt(time_s);
    context.globalAlpha = data.other?.hipUnknown ? kUnknownAlpha : 1;
    if (compared) drawSecond(view, data.other, poseOfState(data.other.geometry, compared), this.colours, time_s);
    context.globalAlpha = 1;
  }

  /** Mean hip position of late, moved ahead with the speed, so that the camera glides. */
  cameraX() {
    const { ticks } = this.data.tables;
    const x = ticks.group(this.data.stateGroup).slice(0, 1);
    const offsets = [-0.6, -0.45, -0.3, -0.15, 0];
    const sum = offsets.reduce((total, offset) => total + (ticks.at(x, this.time_s + offset)?.[0] ?? NaN), 0);
    const behind = sum / offsets.length;
    return Number.isFinite(behind) ? behind + 0.3 * (this.data.speedAt(this.time_s) ?? 0) : this.state[0];
  }
}
