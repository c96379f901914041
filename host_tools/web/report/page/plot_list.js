// Which plots the page shows. A plot: {title, axis, unit, digits, time, limits, lines: [{label, colour,
// values, dash}]}; colour names one of theme.js, values has one number or null for each of time.

const kPlanned = { dash: [5, 4], width: 1.2, alpha: 0.85 };
const kSides = [['left', 'left'], ['right', 'right']];

function basePlots(run, time) {
  const samples = run.samples;
  const pair = (index) => [
    { label: 'true', colour: 'body', values: withGaps(samples.true_state[index]) },
    { label: 'planned', colour: 'plan', ...kPlanned, values: withGaps(samples.planned_state[index]) },
  ];
  return [
    { title: 'Base height', axis: 'height, m', unit: 'm', digits: 3, time, lines: pair(1) },
    { title: 'Base pitch (positive leans forward)', axis: 'pitch, rad', unit: 'rad', digits: 3, time, lines: pair(2) },
    {
      title: 'Forward speed of the base', axis: 'speed, m/s', unit: 'm/s', time,
      lines: [...pair(7), {
        label: 'commanded', colour: 'command', dash: [2, 3], values: withGaps(samples.commanded_speed_m_s[0]),
      }],
    },
    {
      title: 'Foot height', axis: 'height, m', unit: 'm', digits: 3, time,
      lines: kSides.map(([label, colour], k) => (
        { label, colour, values: withGaps(samples.foot_position_m[2 * k + 1]) })),
    },
  ];
}

function jointPlots(run, time) {
  const pairs = (first) => kSides.flatMap(([label, colour], k) => [
    { label, colour, values: withGaps(run.samples.true_state[first + 2 * k]) },
    { label: `${label}, planned`, colour, ...kPlanned, values: withGaps(run.samples.planned_state[first + 2 * k]) },
  ]);
  return [
    { title: 'Hip angle', axis: 'angle, rad', unit: 'rad', time, lines: pairs(3) },
    { title: 'Knee angle', axis: 'angle, rad', unit: 'rad', time, lines: pairs(4) },
    { title: 'Hip velocity', axis: 'velocity, rad/s', unit: 'rad/s', time, lines: pairs(10) },
    { title: 'Knee velocity', axis: 'velocity, rad/s', unit: 'rad/s', time, lines: pairs(11) },
  ];
}

function torquePlot(run, time, title, first) {
  const limits = [run.torque_limit_Nm[first], run.torque_limit_Nm[first + 2]].filter((limit) => limit > 0);
  const limit = Math.min(...limits);
  return {
    title: limits.length > 0 ? `${title} (dotted: limit ±${formatTick(limit)} Nm)` : title,
    axis: 'torque, Nm', unit: 'Nm', digits: 1, time,
    limits: limits.length > 0 ? [-limit, limit] : [],
    lines: kSides.map(([label, colour], k) => (
      { label, colour, values: withGaps(run.samples.torque_Nm[first + 2 * k]) })),
  };
}

function forcePlots(run, time) {
  const samples = run.samples;
  const component = (k) => kSides.flatMap(([label, colour], foot) => [
    { label, colour, values: withGaps(samples.contact_force_N[2 * foot + k]) },
    { label: `${label}, planned`, colour, ...kPlanned, values: withGaps(samples.planned_contact_force_N[2 * foot + k]) },
  ]);
  const kLoaded_N = 10;
  const ratio = (forces, foot) => withGaps(forces[2 * foot], (fx, i) => {
    const fz = forces[2 * foot + 1][i];
    return fz > kLoaded_N ? fx / fz : NaN;
  });
  const mu = run.friction_coefficient;
  return [
    { title: 'Normal contact force', axis: 'force, N', unit: 'N', digits: 0, time, lines: component(1) },
    { title: 'Tangential contact force', axis: 'force, N', unit: 'N', digits: 0, time, lines: component(0) },
    {
      title: `Friction ratio of feet that carry over ${kLoaded_N} N (dotted: ±${formatTick(mu)})`,
      axis: 'tangential / normal', unit: '', time, limits: [-mu, mu],
      lines: kSides.flatMap(([label, colour], foot) => [
        { label, colour, values: ratio(samples.contact_force_N, foot) },
        { label: `${label}, planned`, colour, ...kPlanned, values: ratio(samples.planned_contact_force_N, foot) },
      ]),
    },
  ];
}

function stepPlot(run) {
  const steps = run.summary.steps;
  return {
    title: 'Step length at touch-down', axis: 'length, m', unit: 'm', digits: 3, fromZero: true,
    time: steps.map((step) => step.time_s),
    lines: [['left', 'L'], ['right', 'R']].map(([side, foot]) => ({
      label: side, colour: side, points: true,
      values: steps.map((step) => (step.foot === foot && Number.isFinite(step.length_m) ? step.length_m : null)),
    })),
  };
}

function estimatorPlots(run, time) {
  const { estimated_state, true_state } = run.samples;
  const error = (index, factor) => withGaps(estimated_state[index], (value, i) => (
    factor * (value - true_state[index][i])));
  const lines = (indices, factor) => [
    { label: 'forward', colour: 'body', values: error(indices[0], factor) },
    { label: 'up', colour: 'plan', values: error(indices[1], factor) },
  ];
  return [
    { title: 'Error of the estimated base position', axis: 'error, mm', unit: 'mm', digits: 1, time, lines: lines([0, 1], 1000) },
    { title: 'Error of the estimated base velocity', axis: 'error, m/s', unit: 'm/s', digits: 3, time, lines: lines([7, 8], 1) },
  ];
}

function solverPlots(run) {
  const solves = run.solves;
  const time = Array.from(solves.time_s[0]);
  const positive = (column) => withGaps(column, (value) => (value > 0 ? value : NaN));
  return [
    {
      title: 'Solve time', axis: 'time, ms', unit: 'ms', time, fromZero: true,
      lines: [{ label: 'solve', colour: 'body', width: 1, values: withGaps(solves.solve_us[0], (us) => us / 1000) }],
    },
    {
      title: 'SQP iterations', axis: 'iterations', unit: '', digits: 0, time, fromZero: true,
      lines: [{ label: 'iterations', colour: 'body', width: 1, values: withGaps(solves.iterations[0]) }],
    },
    {
      title: 'Residuals at the end of each solve', axis: 'largest, mixed units', unit: '', time, logarithmic: true,
      lines: [
        { label: 'dynamics defect', colour: 'body', width: 1, exponent: true, values: positive(solves.dynamics_defect_max[0]) },
        { label: 'equality violation', colour: 'plan', width: 1, exponent: true, values: positive(solves.equality_violation_max[0]) },
      ],
    },
  ];
}

/** The plot without the lines that nothing is known of: the robot alone knows no plan. */
function knownLines(plot) {
  return { ...plot, lines: plot.lines.filter((line) => line.values.some((value) => value !== null)) };
}

/** Sections of plots; those without data are left out. */
function plotSections(run) {
  const time = Array.from(run.samples.time);
  const sections = [
    { title: 'Base and feet', plots: basePlots(run, time) },
    { title: 'Torques', plots: [torquePlot(run, time, 'Hip torque', 0), torquePlot(run, time, 'Knee torque', 1)] },
    { title: 'Contact forces and steps', plots: [...forcePlots(run, time), stepPlot(run)] },
    { title: 'Joints', plots: jointPlots(run, time) },
    { title: 'Estimator', plots: estimatorPlots(run, time) },
    { title: 'Planner', plots: solverPlots(run) },
  ];
  return sections
    .map((section) => ({ ...section, plots: section.plots.map(knownLines).filter((plot) => plot.lines.length > 0) }))
    .filter((section) => section.plots.length > 0);
}
