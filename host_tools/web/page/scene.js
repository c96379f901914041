// What a picture of the run is made of: ground, robot, plan, forces.

const kForceScale_m_N = 0.0017;
const kLongestForce_m = 1;
const kConeFrom_N = 10;
const kPushScale_m_N = 0.006;

function drawGround(view, ground, colours, footprints) {
  const c = view.context;
  const half = view.width / 2 / view.scale;
  const from = view.centre_x - half;
  const to = view.centre_x + half;
  const inside = ground.x_m.map((x, i) => ({ x, z: ground.z_m[i] })).filter((p) => p.x > from && p.x < to);
  const profile = [{ x: from, z: groundHeight(ground, from) }, ...inside, { x: to, z: groundHeight(ground, to) }];

  c.beginPath();
  for (const p of profile) c.lineTo(view.x(p.x), view.y(p.z));
  c.lineTo(view.width, view.height);
  c.lineTo(0, view.height);
  c.fillStyle = colours.ground;
  c.fill();
  drawPath(view, profile, colours.muted, 1.5);

  const spacing_m = view.scale < 120 ? 1 : 0.5;
  c.font = '11px system-ui, sans-serif';
  c.textAlign = 'center';
  c.textBaseline = 'alphabetic';
  for (let k = Math.ceil(from / spacing_m); k * spacing_m <= to; ++k) {
    const x = k * spacing_m;
    const y = view.y(groundHeight(ground, x));
    c.fillStyle = colours.muted;
    c.fillRect(view.x(x) - 0.5, y, 1, 16);
    c.fillText(`${x.toFixed(spacing_m < 1 ? 1 : 0)} m`, view.x(x), y + 28);
  }
  for (const place of footprints) {
    if (place.x > from && place.x < to) {
      drawFoothold(view, place, place.foot === 0 ? colours.left : colours.right, true);
    }
  }
}

function drawLeg(view, pose, side, colour, edge) {
  const { knee, foot } = pose[side];
  drawLink(view, knee, foot, 0.026, 0.014, colour, edge);
  drawLink(view, pose.hip, knee, 0.04, 0.028, colour, edge);
  drawDisc(view, knee, 0.012, edge);
  drawDisc(view, foot, 0.018, colour, edge);
}

/** The robot in full. The right leg stands behind the torso, the left before it. */
function drawRobot(view, pose, colours) {
  drawLeg(view, pose, 'right', colours.right, colours.card);
  drawLink(view, pose.hip, pose.head, 0.045, 0.058, colours.body, colours.card);
  drawLeg(view, pose, 'left', colours.left, colours.card);
  drawDisc(view, pose.hip, 0.017, colours.card);
}

/** The robot as thin lines. */
function drawSkeleton(view, pose, colours, width, dash = []) {
  drawPath(view, [pose.hip, pose.right.knee, pose.right.foot], colours.right, width, dash);
  drawPath(view, [pose.hip, pose.head], colours.body, width, dash);
  drawPath(view, [pose.hip, pose.left.knee, pose.left.foot], colours.left, width, dash);
}

/** Planned torso poses ahead of `time`, a quarter of a second apart. */
function drawPlannedTorso(view, robot, nodes, colours, time) {
  const kSpacing_s = 0.25;
  view.context.globalAlpha = 0.45;
  let next = time + kSpacing_s;
  for (const node of nodes) {
    if (node.time < next) continue;
    drawPath(view, [node.hip, torsoTop(robot, node.hip, node.pitch)], colours.plan, 2);
    next += kSpacing_s;
  }
  view.context.globalAlpha = 1;
}

/** Planned hip and foot paths and footholds ahead of `time`. */
function drawPlannedPaths(view, nodes, colours, time) {
  const ahead = nodes.filter((node) => node.time >= time - 0.05);
  if (ahead.length < 2) return;
  const c = view.context;
  c.globalAlpha = 0.9;
  drawPath(view, ahead.map((node) => node.hip), colours.plan, 2, [5, 5]);
  drawPath(view, ahead.map((node) => node.feet[1]), colours.right, 1.6, [4, 4]);
  drawPath(view, ahead.map((node) => node.feet[0]), colours.left, 1.6, [4, 4]);
  c.globalAlpha = 1;
  for (const place of footholds(ahead)) {
    if (place.time > time) drawFoothold(view, place, place.foot === 0 ? colours.left : colours.right, false);
  }
}

/** Contact forces [fxL, fzL, fxR, fzR] as arrows from the feet; impacts are drawn with a length of kLongestForce_m. */
function drawContactForces(view, pose, forces, colours) {
  ['left', 'right'].forEach((side, foot) => {
    const [fx, fz] = [forces[2 * foot], forces[2 * foot + 1]];
    const from = pose[side].foot;
    const scale = Math.min(kForceScale_m_N, kLongestForce_m / Math.hypot(fx, fz));
    drawArrow(view, from, { x: from.x + scale * fx, z: from.z + scale * fz }, colours.force, 3);
  });
}

/** A push as an arrow that ends where it acts, `share` of the torso above the hip, with its force and `whose` beside. */
function drawPush(view, pose, force_N, share, colours, whose = '') {
  if (!force_N) return;
  const tip = { x: pose.hip.x + share * (pose.head.x - pose.hip.x), z: pose.hip.z + share * (pose.head.z - pose.hip.z) };
  const side = Math.sign(force_N);
  const end = { x: tip.x - side * 0.06, z: tip.z };
  const tail = { x: end.x - side * Math.max(0.12, Math.abs(kPushScale_m_N * force_N)), z: tip.z };
  drawArrow(view, tail, end, colours.push, 5);
  const c = view.context;
  const label = `${Math.abs(force_N).toFixed(0)} N${whose}`;
  c.font = '600 13px system-ui, sans-serif';
  c.textAlign = 'center';
  c.textBaseline = 'bottom';
  const [x, y] = [(view.x(tail.x) + view.x(end.x)) / 2, view.y(tail.z) - 9];
  c.lineWidth = 4;
  c.lineJoin = 'round';
  c.strokeStyle = colours.sky;
  c.strokeText(label, x, y);
  c.fillStyle = colours.push;
  c.fillText(label, x, y);
}

/**
 * Friction cones of the feet that carry, as high as their normal force: a force within its cone ends on the upper edge.
 * The cone of a foot whose force is not within has the colour of a limit.
 */
function drawFrictionCones(view, pose, forces, mu, colours) {
  const c = view.context;
  ['left', 'right'].forEach((side, foot) => {
    const [fx, fz] = [forces[2 * foot], forces[2 * foot + 1]];
    if (!(fz > kConeFrom_N)) return;
    const { x, z } = pose[side].foot;
    const height_m = fz * Math.min(kForceScale_m_N, kLongestForce_m / Math.hypot(fx, fz));
    const edges = [{ x: x - mu * height_m, z: z + height_m }, { x, z }, { x: x + mu * height_m, z: z + height_m }];
    const colour = Math.abs(fx) > mu * fz ? colours.limit : colours.force;
    const alpha = c.globalAlpha;
    c.beginPath();
    for (const p of edges) c.lineTo(view.x(p.x), view.y(p.z));
    c.closePath();
    c.globalAlpha = 0.16 * alpha;
    c.fillStyle = colour;
    c.fill();
    c.globalAlpha = 0.7 * alpha;
    drawPath(view, edges, colour, 1);
    c.globalAlpha = alpha;
  });
}

/** The robot of a second run, as dashed lines with the push on it. */
function drawSecond(view, data, pose, colours, time_s) {
  drawSkeleton(view, pose, colours, 2.5, [6, 4]);
  const push = data.pushAt(time_s);
  if (push) drawPush(view, pose, push.force_N, push.above_hip_m / data.geometry.torso_length_m, colours, ', second');
}

/** The robot at `time_s` with the push on it and, when wanted, its contact forces and friction cones. */
function drawRobotAt(view, data, pose, colours, time_s, withForces = true, withCones = false) {
  const forces = data.forcesAt(time_s);
  if (withCones && forces && data.friction_coefficient > 0) {
    drawFrictionCones(view, pose, forces, data.friction_coefficient, colours);
  }
  drawRobot(view, pose, colours);
  if (withForces && forces) drawContactForces(view, pose, forces, colours);
  const push = data.pushAt(time_s);
  if (push) drawPush(view, pose, push.force_N, push.above_hip_m / data.geometry.torso_length_m, colours);
}
