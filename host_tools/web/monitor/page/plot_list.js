// Which plots the page shows; the fields of a plot are described in plot.js.

const kCommanded = { dash: [5, 4] };
const kSides = [['left', 'left', 0], ['right', 'right', 2]];

function motionPlots() {
  return [
    {
      title: 'Forward speed', axis: 'm/s', unit: 'm/s', table: 'ticks', least: 0.4,
      lines: [{ label: 'hip', colour: 'body', column: 'estimated_state7' },
        { label: 'commanded', colour: 'plan', ...kCommanded, column: 'commanded_speed_m_s' }],
    },
    {
      title: 'Height of the hip', axis: 'm', unit: 'm', digits: 3, table: 'ticks', least: 0.1,
      lines: [{ label: 'hip', colour: 'body', column: 'estimated_state1' },
        { label: 'commanded', colour: 'plan', ...kCommanded, column: 'commanded_height_m' }],
    },
    {
      title: 'Pitch of the torso', axis: 'rad', unit: 'rad', digits: 3, table: 'ticks', least: 0.1,
      lines: [{ label: 'pitch', colour: 'body', column: 'estimated_state2' }],
    },
    {
      title: 'Height of the feet', axis: 'm', unit: 'm', digits: 3, table: 'ticks', least: 0.08,
      lines: kSides.map(([label, colour]) => ({ label, colour, column: `${label}_foot_z_m` })),
    },
  ];
}

function jointPlots(robot) {
  const angle = (k) => kSides.flatMap(([label, colour, first]) => [
    { label, colour, column: `estimated_state${3 + first + k}` },
    { label: 'wanted', colour, ...kCommanded, column: `wanted_position_rad${first + k}`, unnamed: true },
  ]);
  const torque = (k) => kSides.map(([label, colour, first]) => (
    { label, colour, column: `asked_torque_Nm${first + k}` }));
  return [
    { title: 'Hip angle (dashed: wanted)', axis: 'rad', unit: '', table: 'ticks', least: 0.2, lines: angle(0) },
    { title: 'Knee angle (dashed: wanted)', axis: 'rad', unit: '', table: 'ticks', least: 0.2, lines: angle(1) },
    { title: 'Asked hip torque (dotted: limit)', axis: 'Nm', unit: 'Nm', digits: 1, table: 'ticks', limits: () => torqueLimits(robot, 0), lines: torque(0) },
    { title: 'Asked knee torque (dotted: limit)', axis: 'Nm', unit: 'Nm', digits: 1, table: 'ticks', limits: () => torqueLimits(robot, 1), lines: torque(1) },
  ];
}

/** What the faults of single joints watch. */
function measuredJointPlots() {
  const velocity = (k) => kSides.map(([label, colour, first]) => (
    { label, colour, column: `estimated_state${10 + first + k}` }));
  const torque = (k) => kSides.flatMap(([label, colour, first]) => [
    { label, colour, column: `measured_torque_Nm${first + k}` },
    { label: 'asked', colour, ...kCommanded, column: `asked_torque_Nm${first + k}`, unnamed: true },
  ]);
  const plot = { table: 'ticks', digits: 1 };
  return [
    { title: 'Hip velocity', axis: 'rad/s', unit: 'rad/s', least: 1, lines: velocity(0), ...plot },
    { title: 'Knee velocity', axis: 'rad/s', unit: 'rad/s', least: 1, lines: velocity(1), ...plot },
    { title: 'Measured hip torque (dashed: asked)', axis: 'Nm', unit: 'Nm', lines: torque(0), ...plot },
    { title: 'Measured knee torque (dashed: asked)', axis: 'Nm', unit: 'Nm', lines: torque(1), ...plot },
  ];
}

function plannerPlots(robot) {
  const budget = () => {
    const limit_us = robot.timing?.histograms.find((one) => one.name === 'solve')?.deadline_us;
    return limit_us > 0 ? [limit_us / 1000] : [];
  };
  return [
    {
      title: 'Solve time', axis: 'ms', unit: 'ms', table: 'planner', fromZero: true, limits: budget,
      lines: [{ label: 'one plan', colour: 'plan', column: 'solve_ms' }],
    },
    {
      title: 'Iterations', axis: '', unit: '', digits: 0, table: 'planner', fromZero: true, least: 4,
      lines: [{ label: 'of a plan', colour: 'plan', column: 'iterations', steps: true }],
    },
    {
      title: 'Violations', axis: '', unit: '', table: 'planner', logarithmic: true,
      lines: [{ label: 'dynamics', colour: 'plan', column: 'dynamics_defect_max' },
        { label: 'equalities', colour: 'push', column: 'equality_violation_max' }],
    },
    {
      title: 'Planned beyond ground and drives', axis: 'N, Nm', unit: '', digits: 0, table: 'planner', fromZero: true, least: 10,
      lines: [{ label: 'friction cone', colour: 'plan', column: 'friction_cone_violation_max_N' },
        { label: 'pulling force', colour: 'push', column: 'pulling_force_max_N' },
        { label: 'joint torque', colour: 'body', column: 'torque_violation_max_Nm' }],
    },
    {
      title: 'Planned contact force', axis: 'N', unit: 'N', digits: 0, table: 'force', fromZero: true, least: 100,
      lines: kSides.map(([label, colour]) => ({ label, colour, column: `${label}_N` })),
    },
  ];
}

function loopPlots() {
  return [
    {
      title: 'Torque loop: wake-up latency', axis: 'µs', unit: 'µs', digits: 0, table: 'ticks', fromZero: true, least: 50,
      lines: [{ label: 'wake-up', colour: 'force', column: 'wakeup_latency_us' }],
    },
    {
      title: 'Torque loop: duration', axis: 'µs', unit: 'µs', digits: 0, table: 'ticks', fromZero: true, least: 50,
      lines: [{ label: 'tick', colour: 'body', column: 'execution_us' }],
    },
    {
      title: 'Age of the plan', axis: 'ms', unit: 'ms', digits: 1, table: 'ticks', fromZero: true, least: 10,
      lines: [{ label: 'in use', colour: 'plan', column: 'plan_age_ms' }],
    },
    {
      title: 'Bus round trip', axis: 'µs', unit: 'µs', digits: 0, table: 'ticks', fromZero: true, least: 50,
      lines: [{ label: 'command to last reply', colour: 'push', column: 'bus_round_trip_us', steps: true }],
    },
  ];
}

function plotSections(robot) {
  return [
    { title: 'Motion', plots: motionPlots() },
    { title: 'Joints', plots: jointPlots(robot) },
    { title: 'Velocities and measured torques', plots: measuredJointPlots(), folded: true },
    { title: 'Planner', plots: plannerPlots(robot) },
    { title: 'Loop and buses', plots: loopPlots() },
  ];
}
