// Which plots the page shows; the fields of a plot are described in plot.js.

const kPlanned = { dash: [5, 4], width: 1.2, alpha: 0.85 };
const kSides = ['left', 'right'];

/** Lines of a quantity of the left and right side, and of what was planned where that is known. */
function sideLines(column, [left, right], planned = null) {
  return [left, right].flatMap((k, side) => {
    const line = { label: kSides[side], colour: kSides[side], column: column + k };
    if (planned === null) return [line];
    return [line, { ...line, ...kPlanned, label: `${line.label}, planned`, column: planned + k }];
  });
}

/** What the state that is drawn is: true or estimated. */
function stateName({ stateGroup }) {
  return stateGroup.split('_')[0];
}

function basePlots(run) {
  const { stateGroup } = run;
  const label = stateName(run);
  const lines = (k) => [
    { label, colour: 'body', column: `${stateGroup}${k}` },
    { label: 'planned', colour: 'plan', ...kPlanned, column: `planned_state${k}` },
  ];
  const commanded = { label: 'commanded', colour: 'command', dash: [2, 3], column: 'commanded_speed_m_s' };
  return [
    { title: 'Height of the hip', axis: 'height, m', unit: 'm', digits: 3, table: 'ticks', lines: lines(1) },
    { title: 'Pitch of the torso (positive leans forward)', axis: 'pitch, rad', unit: 'rad', digits: 3, table: 'ticks', lines: lines(2) },
    { title: 'Forward speed', axis: 'speed, m/s', unit: 'm/s', table: 'ticks', lines: [...lines(7), commanded] },
    { title: 'Height of the feet', axis: 'height, m', unit: 'm', digits: 3, table: 'ticks', lines: sideLines('foot_position_m', [1, 3]) },
  ];
}

function jointPlots({ stateGroup }) {
  const lines = (k) => sideLines(stateGroup, [k, k + 2], 'planned_state');
  return [
    { title: 'Hip angle', axis: 'angle, rad', unit: 'rad', table: 'ticks', lines: lines(3) },
    { title: 'Knee angle', axis: 'angle, rad', unit: 'rad', table: 'ticks', lines: lines(4) },
    { title: 'Hip velocity', axis: 'velocity, rad/s', unit: 'rad/s', table: 'ticks', lines: lines(10) },
    { title: 'Knee velocity', axis: 'velocity, rad/s', unit: 'rad/s', table: 'ticks', lines: lines(11) },
  ];
}

function torquePlot(run, title, first) {
  const limits = [...new Set([run, run.other].flatMap((one) => (one ? torqueLimits(one, first) : [])))];
  const sizes = limits.filter((limit) => limit > 0).map((limit) => `±${formatTick(limit)}`);
  return {
    title: sizes.length > 0 ? `${title} (dotted: ${sizes.length > 1 ? 'limits' : 'limit'} ${sizes.join(' and ')} Nm)` : title,
    axis: 'torque, Nm', unit: 'Nm', digits: 1, table: 'ticks', limits: () => limits,
    lines: sideLines('torque_Nm', [first, first + 2]),
  };
}

function forcePlots(run) {
  const lines = (indices) => sideLines('contact_force_N', indices, 'planned_contact_force_N');
  const mu = run.friction_coefficient;
  return [
    { title: 'Normal contact force', axis: 'force, N', unit: 'N', digits: 0, table: 'ticks', lines: lines([1, 3]) },
    { title: 'Tangential contact force', axis: 'force, N', unit: 'N', digits: 0, table: 'ticks', lines: lines([0, 2]) },
    {
      title: `Friction ratio of feet that carry over ${kLoaded_N} N (dotted: ±${formatTick(mu)})`,
      axis: 'tangential / normal', unit: '', table: 'ticks', limits: () => [-mu, mu],
      lines: sideLines('friction_ratio', [0, 1], 'planned_friction_ratio'),
    },
    {
      title: 'Step length at touch-down', axis: 'length, m', unit: 'm', digits: 3, table: 'steps', fromZero: true,
      lines: kSides.map((side) => ({ label: side, colour: side, points: true, column: `${side}_m` })),
    },
  ];
}

function estimatorPlots() {
  const lines = (column) => [
    { label: 'forward', colour: 'body', column: `${column}0` },
    { label: 'up', colour: 'plan', column: `${column}1` },
  ];
  return [
    { title: 'Error of the estimated base position', axis: 'error, mm', unit: 'mm', digits: 1, table: 'ticks', lines: lines('position_error_mm') },
    { title: 'Error of the estimated base velocity', axis: 'error, m/s', unit: 'm/s', digits: 3, table: 'ticks', lines: lines('velocity_error_m_s') },
  ];
}

function solverPlots() {
  return [
    {
      title: 'Solve time', axis: 'time, ms', unit: 'ms', table: 'planner', fromZero: true,
      lines: [{ label: 'solve', colour: 'body', width: 1, column: 'solve_ms' }],
    },
    {
      title: 'SQP iterations', axis: 'iterations', unit: '', digits: 0, table: 'planner', fromZero: true,
      lines: [{ label: 'iterations', colour: 'body', width: 1, column: 'iterations' }],
    },
    {
      title: 'Residuals at the end of each solve', axis: 'largest, mixed units', unit: '', table: 'planner', logarithmic: true,
      lines: [
        { label: 'dynamics defect', colour: 'body', width: 1, column: 'dynamics_defect_max' },
        { label: 'equality violation', colour: 'plan', width: 1, column: 'equality_violation_max' },
      ],
    },
    {
      title: 'Planned beyond what ground and drives can give', axis: 'largest, N or Nm', unit: '', table: 'planner', fromZero: true, least: 10,
      lines: [
        { label: 'friction cone', colour: 'body', width: 1, column: 'friction_cone_violation_max_N' },
        { label: 'pulling force', colour: 'plan', width: 1, column: 'pulling_force_max_N' },
        { label: 'joint torque', colour: 'push', width: 1, column: 'torque_violation_max_Nm' },
      ],
    },
  ];
}

/** Sections of plots; lines, plots and sections without data are left out: the robot alone has no plan. */
function plotSections(run) {
  const sections = [
    { title: 'Base and feet', plots: basePlots(run) },
    { title: 'Torques', plots: [torquePlot(run, 'Hip torque', 0), torquePlot(run, 'Knee torque', 1)] },
    { title: 'Contact forces and steps', plots: forcePlots(run) },
    { title: 'Joints', plots: jointPlots(run) },
    { title: 'Estimator', plots: estimatorPlots() },
    { title: 'Planner', plots: solverPlots() },
  ];
  const isKnown = (plot, line) => run.tables[plot.table].column(line.column).some(Number.isFinite);
  for (const section of sections) {
    if (run.other) for (const plot of section.plots) plot.lines = comparedLines(run, plot.lines);
    for (const plot of section.plots) plot.lines = plot.lines.filter((line) => isKnown(plot, line));
    section.plots = section.plots.filter((plot) => plot.lines.length > 0);
  }
  return sections.filter((section) => section.plots.length > 0);
}
