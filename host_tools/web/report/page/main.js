// Starts the page. Fragment options are described in still.js.

const kStances = ['no foot', 'left foot', 'right foot', 'both feet'];

/** Speed, command and stance at `time_s`, of which the robot is drawn, as text. */
function readout(run, time_s) {
  if (run.hipUnknown) return kHipUnknown;
  if (run.missing.some(({ from_s, to_s }) => time_s >= from_s && time_s <= to_s)) return 'The ticks of this time are missing';
  const { ticks } = run.tables;
  const columns = [`${run.stateGroup}7`, 'commanded_speed_m_s', 'scheduled_mode0', 'scheduled_mode1'];
  const [speed, command, left, right] = ticks.before(columns.map((name) => ticks.column(name)), time_s);
  const commanded = Number.isFinite(command) ? ` (commanded ${signed(command, 2)})` : '';
  const planned = !run.controller || ticks.before([ticks.column('planned_contact_force_N0')], time_s).every(Number.isFinite);
  const stance = planned ? ` · stance: ${kStances[(left ? 1 : 0) + (right ? 2 : 0)]}` : '';
  return Number.isFinite(speed) ? `${signed(speed, 2)} m/s${commanded}${stance}` : '';
}

function openReport(run, options, names) {
  const player = new Player(run.start_s, run.end_s);
  const filled = run.tables.ticks.rows > 0;
  if (run.other) {
    showComparisonHeader(run, names);
    showComparison(run, names);
  } else {
    showHeader(run);
    showSummary(run);
  }
  if (filled) bindKeyboard(player);
  document.querySelector('.key.plan').hidden = run.plans.length === 0;  // a robot has no data of its controller
  const showPlayer = bindControls(player);
  const views = viewsOf(run);
  const { window: fixed } = views[Math.min(1, views.length - 1)];
  const plots = new PlotGroup({
    data: run, clock: player, sections: plotSections(run), container: document.getElementById('plots'),
    fixed, lineWidth_px: 1.5,
  });
  addViewButtons(views, plots);
  const detail = document.getElementById('stage-detail');
  const viewer = new Viewer({
    data: run, clock: player, plots,
    drawn: (time_s) => {
      if (showPlayer() && filled) detail.textContent = readout(run, time_s);
    },
  });
  followTheme(options.theme, () => viewer.recolour());
  player.seek(options.time_s ?? fixed[0]);
  if (options.time_s === null && filled && !window.matchMedia('(prefers-reduced-motion: reduce)').matches) player.toggle();
}

const data = JSON.parse(document.getElementById('run-data').textContent);
const run = data.runs
  ? joinRuns(new RecordedRun(data.runs[0]), new RecordedRun(data.runs[1], data.shift_s))
  : new RecordedRun(data);
const options = readFragment();
followTheme(options.theme, () => {});
if (options.still) {
  drawStill(run, options);
  window.addEventListener('resize', () => drawStill(run, options));
} else {
  openReport(run, options, data.names && shortNames(data.names));
}
