// Starts the page. Fragment options are described in still.js.

function openReport(run, options) {
  const player = new Player(run.start_s, run.end_s);
  showHeader(run);
  showSummary(run);
  if (run.samples.rows > 0) bindKeyboard(player);
  bindControls(player);
  const stage = new Stage(run, player);
  const plots = new PlotGroup(run, player, plotSections(run), document.getElementById('plots'));
  followTheme(options.theme, () => { stage.recolour(); plots.recolour(); });
  if (options.time_s !== null) player.seek(options.time_s);
  else if (run.samples.rows > 0 && !window.matchMedia('(prefers-reduced-motion: reduce)').matches) player.toggle();
}

const run = readRun();
const options = readFragment();
followTheme(options.theme, () => {});
if (options.still) {
  drawStill(run, options);
  window.addEventListener('resize', () => drawStill(run, options));
} else {
  openReport(run, options);
}
