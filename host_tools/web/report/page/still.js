// A still picture for documents: #t=12.3&still shows the robot at 12.3 s, where it was before, and the motion
// planned ahead. Options: poses=5 (how many earlier poses), spacing=0.6 (seconds between them), theme=dark.

/** Options after '#': t (seconds), theme (light or dark), still, poses, spacing. */
function readFragment() {
  const options = new URLSearchParams(window.location.hash.slice(1));
  const number = (name, fallback) => {
    const value = Number.parseFloat(options.get(name));
    return Number.isFinite(value) ? value : fallback;
  };
  return {
    time_s: number('t', null),
    still: options.has('still'),
    theme: options.get('theme'),
    poses: Math.min(20, Math.max(0, Math.round(number('poses', 5)))),
    spacing_s: Math.max(0.01, number('spacing', 0.6)),
  };
}

/** Earlier poses, oldest first: [{pose, age}] with age 1 for the newest. */
function earlierPoses(run, time, options) {
  const list = [];
  for (let age = options.poses; age >= 1; --age) {
    const then = time - age * options.spacing_s;
    const state = then >= run.start_s ? run.stateAt(then) : null;
    if (state && !run.hipUnknown) list.push({ pose: poseOfState(run.geometry, state), age });
  }
  return list;
}

function drawStill(run, options) {
  document.body.classList.add('still');
  document.getElementById('still').hidden = false;
  const { context, width, height } = fitCanvas(document.getElementById('still-canvas'));
  const time = Math.min(run.end_s, Math.max(run.start_s, options.time_s ?? run.end_s));
  const state = run.stateAt(time);
  if (!state) return;
  const colours = readColours();
  const pose = poseOfState(run.geometry, state);
  const placed = !run.hipUnknown;
  const earlier = placed ? earlierPoses(run, time, options) : [];
  const nodes = placed ? run.planAt(time) : [];
  const footX = [pose, ...earlier.map((entry) => entry.pose)].flatMap((p) => [p.hip.x, p.left.foot.x, p.right.foot.x]);
  const planX = nodes.flatMap((node) => [node.hip.x, node.feet[0].x, node.feet[1].x]);
  const from = Math.min(...footX, ...planX) - 0.25;
  const to = Math.max(...footX, ...planX) + 0.25;
  const scale = Math.min(height / 1.6, width / (to - from));
  const groundZ = groundHeight(run.ground, pose.hip.x);
  const belowGround_m = Math.max(40, (height - 1.42 * scale) / 2) / scale;
  const view = makeView(context, width, height, (from + to) / 2, groundZ - belowGround_m, scale);

  context.fillStyle = colours.sky;
  context.fillRect(0, 0, width, height);
  drawGround(view, run.ground, colours, run.footprintsUpTo(time));
  for (const { pose: ghost, age } of earlier) {
    const faded = fadeColours(colours, 0.45 + (0.4 * age) / (options.poses + 1));
    drawRobot(view, ghost, { ...faded, card: colours.sky });
  }
  drawPlannedPaths(view, nodes, colours, time);
  context.globalAlpha = 0.5;
  for (let k = 1; time + k * options.spacing_s < (nodes.at(-1)?.time ?? 0); ++k) {
    const node = nodes.findLast((one) => one.time <= time + k * options.spacing_s) ?? nodes[0];
    drawSkeleton(view, poseOfNode(run.geometry, node), colours, 3);
  }
  context.globalAlpha = placed ? 1 : kUnknownAlpha;
  drawRobotAt(view, run, pose, colours, time, placed);
  context.globalAlpha = 1;
}
