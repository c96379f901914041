// The planar skeleton. Angles are rotations about +y: positive pitch leans forward, a positive joint angle
// swings the lower link backward; links hang straight down at zero.

const joint = { pitch: 2, hipL: 3, kneeL: 4, hipR: 5, kneeR: 6 };

function leg(robot, hip, thighAngle, shinAngle) {
  const knee = {
    x: hip.x - robot.thigh_length_m * Math.sin(thighAngle),
    z: hip.z - robot.thigh_length_m * Math.cos(thighAngle),
  };
  const foot = {
    x: knee.x - robot.shin_length_m * Math.sin(shinAngle),
    z: knee.z - robot.shin_length_m * Math.cos(shinAngle),
  };
  return { knee, foot };
}

function torsoTop(robot, hip, pitch) {
  return { x: hip.x + robot.torso_length_m * Math.sin(pitch), z: hip.z + robot.torso_length_m * Math.cos(pitch) };
}

/** Pose {hip, head, left: {knee, foot}, right} of positions q (the first 7 of a state). */
function poseOfState(robot, q) {
  const hip = { x: q[0], z: q[1] };
  const pitch = q[joint.pitch];
  const left = pitch + q[joint.hipL];
  const right = pitch + q[joint.hipR];
  return {
    hip,
    head: torsoTop(robot, hip, pitch),
    left: leg(robot, hip, left, left + q[joint.kneeL]),
    right: leg(robot, hip, right, right + q[joint.kneeR]),
  };
}

/** Leg from hip to foot with the knee in front (positive knee angle); the foot is moved if out of reach. */
function legToFoot(robot, hip, foot) {
  const a = robot.thigh_length_m;
  const b = robot.shin_length_m;
  const dx = foot.x - hip.x;
  const dz = foot.z - hip.z;
  const reach = Math.min(a + b, Math.max(Math.abs(a - b), Math.hypot(dx, dz)));
  const kneeAngle = Math.acos(Math.min(1, Math.max(-1, (reach * reach - a * a - b * b) / (2 * a * b))));
  const thighAngle = Math.atan2(-dx, -dz) - Math.atan2(b * Math.sin(kneeAngle), a + b * Math.cos(kneeAngle));
  return leg(robot, hip, thighAngle, thighAngle + kneeAngle);
}

/** Pose of a planned node {hip, pitch, feet: [left, right]}. */
function poseOfNode(robot, node) {
  return {
    hip: node.hip,
    head: torsoTop(robot, node.hip, node.pitch),
    left: legToFoot(robot, node.hip, node.feet[0]),
    right: legToFoot(robot, node.hip, node.feet[1]),
  };
}

/** Height of the drawn ground at x: linear between the points of its profile, level beyond them and without any. */
function groundHeight({ x_m, z_m }, x) {
  const next = x_m.findIndex((at) => at > x);
  if (next <= 0) return (next < 0 ? z_m.at(-1) : z_m[0]) ?? 0;
  const share = (x - x_m[next - 1]) / (x_m[next] - x_m[next - 1]);
  return z_m[next - 1] + share * (z_m[next] - z_m[next - 1]);
}

/** Planned footholds: places where a foot rests for two nodes or more. [{foot, x, z, time}], time of arrival. */
function footholds(nodes) {
  const kRestDistance_m = 0.004;
  const places = [];
  for (const foot of [0, 1]) {
    let resting = false;
    for (let k = 1; k < nodes.length; ++k) {
      const before = nodes[k - 1].feet[foot];
      const now = nodes[k].feet[foot];
      const rests = Math.hypot(now.x - before.x, now.z - before.z) < kRestDistance_m;
      if (rests && !resting) places.push({ foot, x: now.x, z: now.z, time: nodes[k - 1].time });
      resting = rests;
    }
  }
  return places;
}
