// Which plots show what a fault watches, by name of the fault and titles of plots; the others watch what no plot shows.

const kAnglePlots = ['Hip angle (dashed: wanted)', 'Knee angle (dashed: wanted)'];
const kMeasuredTorquePlots = ['Measured hip torque (dashed: asked)', 'Measured knee torque (dashed: asked)'];
const kFaultPlots = {
  joint_position_limit: kAnglePlots,
  joint_speed_limit: ['Hip velocity', 'Knee velocity'],
  joint_torque_limit: kMeasuredTorquePlots,
  torque_mismatch: kMeasuredTorquePlots,
  following_error: kAnglePlots,
  encoder_frozen: kAnglePlots,
  encoder_jump: kAnglePlots,
  base_pitch_limit: ['Pitch of the torso'],
  stale_torso_sensor: ['Pitch of the torso'],
  torso_sensor_implausible: ['Pitch of the torso'],
  hip_height_limit: ['Height of the hip'],
  missed_replies: ['Bus round trip'],
  lost_replies: ['Bus round trip'],
  bus_error: ['Bus round trip'],
  bus_off: ['Bus round trip'],
  bus_disconnected: ['Bus round trip'],
  stale_plan: ['Age of the plan'],
  plan_missing: ['Age of the plan'],
  planner_lost: ['Age of the plan'],
  failed_solves: ['Violations'],
  planner_overrun: ['Solve time'],
  torque_loop_overrun: ['Torque loop: wake-up latency'],
  torque_loop_stalled: ['Torque loop: wake-up latency'],
};

/** The button that leads to the plots of a fault, with `words` on it; null when it has none. */
function plotButton(fault, words, showPlots) {
  const titles = kFaultPlots[fault.name];
  if (!titles) return null;
  const button = element('button', { type: 'button', className: 'to-plot', textContent: words, title: `Go to the plot: ${titles.join(', ')}` });
  button.addEventListener('click', () => showPlots(titles));
  return button;
}
