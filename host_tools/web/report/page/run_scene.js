// What a run gives to draw at a time.

/**
 * Newest plan at `time` as knots, moved by the error of the estimate at the time it was made: the planner
 * works from the estimate, and is drawn relative to the robot.
 */
function planAt(run, time) {
  const plans = run.plans;
  if (plans.time_s.length === 0 || plans.time_s[0] > time) return [];
  const index = lastIndexUpTo(plans.time_s, time);
  const end = index + 1 < plans.first_knot.length ? plans.first_knot[index + 1] : plans.knots.rows;
  const i = lastIndexUpTo(run.samples.time, plans.time_s[index]);
  const shift = [0, 1].map((k) => {
    const error = run.samples.true_state[k][i] - run.samples.estimated_state[k][i];
    return Number.isFinite(error) ? error : 0;
  });
  const table = plans.knots;
  const knots = [];
  for (let k = plans.first_knot[index]; k < end; ++k) {
    const point = (x, z) => ({ x: x[k] + shift[0], z: z[k] + shift[1] });
    const feet = table.foot_position_m;
    knots.push({
      time: table.time_s[0][k],
      hip: point(table.hip_x_m[0], table.hip_z_m[0]),
      pitch: table.pitch_rad[0][k],
      feet: [point(feet[0], feet[1]), point(feet[2], feet[3])],
    });
  }
  return knots;
}

/** Contact forces of the sample at `time`. */
function drawForcesAt(view, run, pose, colours, time) {
  const i = lastIndexUpTo(run.samples.time, time);
  drawContactForces(view, pose, run.samples.contact_force_N.map((column) => column[i]), colours);
}

/** The push of the sample at `time`. */
function drawPushAt(view, run, pose, colours, time) {
  const i = lastIndexUpTo(run.samples.time, time);
  const share = run.samples.push_above_hip_m[0][i] / run.robot.torso_length_m;
  drawPush(view, pose, run.samples.push_N[0][i], share, colours);
}

/** Places where feet touched down, from the summary's steps: [{foot, x, z, time}]. */
function footprintsOf(run) {
  return run.summary.steps.map((step) => {
    const foot = step.foot === 'L' ? 0 : 1;
    const i = lastIndexUpTo(run.samples.time, step.time_s);
    const x = run.samples.foot_position_m[2 * foot][i];
    return { foot, x, z: groundHeight(run.ground, x), time: step.time_s };
  });
}
