// One plot of the last seconds. `plot`: {title, axis, unit, digits, table, lines: [{label, colour, column, dash}],
// limits, logarithmic, fromZero}; an unnamed line has no value in the caption; `table` is one of RobotState.tables.

const kPlotHeight_px = 172;
/** Wider lines take a browser without a graphics processor twice as long, more than all else on the page together. */
const kLineWidth_px = 1;

/** A y range that grows at once and shrinks only when it has long been too large, with round ends. */
class SteadyRange {
  constructor(plot) {
    this.plot = plot;
    this.low = null;
    this.high = null;
    this.small_since = null;
  }

  static nice(low, high) {
    const step = 10 ** Math.floor(Math.log10(Math.max(1e-9, high - low)));
    const unit = (high - low) / step > 5 ? step : (high - low) / step > 2 ? step / 2 : step / 5;
    return [Math.floor(low / unit + 0.04) * unit, Math.ceil(high / unit - 0.04) * unit];
  }

  range(low, high, now_s) {
    if (!Number.isFinite(low) || !Number.isFinite(high)) return [this.low ?? 0, this.high ?? 1];
    const limits = this.plot.limits?.() ?? [];
    const least = this.plot.least ?? 1e-6;
    const middle = (low + high) / 2;
    let from = Math.min(low, middle - least / 2, ...limits);
    const to = Math.max(high, middle + least / 2, ...limits);
    if (this.plot.fromZero) from = Math.min(0, from);
    const [a, b] = SteadyRange.nice(from, to);
    const fits = this.low !== null && a >= this.low - 1e-12 && b <= this.high + 1e-12;
    const roomy = fits && b - a < 0.6 * (this.high - this.low);
    if (!roomy) this.small_since = null;
    else this.small_since ??= now_s;
    if (!fits || (roomy && now_s - this.small_since > 3)) {
      const keep = this.low !== null && !fits;
      this.low = keep ? Math.min(a, this.low) : a;
      this.high = keep ? Math.max(b, this.high) : b;
      this.small_since = null;
    }
    return [this.low, this.high];
  }
}

/** Where a line's value stands in the caption. */
function legendItem(line) {
  const item = document.createElement('span');
  item.className = 'legend';
  item.style.setProperty('--colour', `var(--${line.colour})`);
  if (line.dash) item.classList.add('dashed');
  item.append(`${line.label} `);
  const value = document.createElement('b');
  item.append(value);
  return { item, value };
}

class LivePlot {
  /** `phase`, 0 to 1: plots that move by a pixel at different times do not all have to be drawn in the same frame. */
  constructor(group, plot, container, phase) {
    this.group = group;
    this.plot = plot;
    this.phase = phase;
    this.visible = true;
    this.from_s = 0;
    this.to_s = 1;
    this.drawn = 0;
    this.wrote_s = 0;
    this.steady = new SteadyRange(plot);
    this.figure = document.createElement('figure');
    this.figure.dataset.title = plot.title;
    const caption = document.createElement('figcaption');
    const title = document.createElement('span');
    title.className = 'title';
    title.textContent = plot.title;
    caption.append(title);
    this.legends = plot.lines.map((line) => {
      const legend = legendItem(line);
      if (!line.unnamed) caption.append(legend.item);
      return legend;
    });
    this.figure.append(caption);
    container.append(this.figure);
    this.build();
  }

  build() {
    const { plot, group } = this;
    const colours = group.colours;
    this.u?.destroy();
    const y = plot.logarithmic
      ? { distr: 3, range: (u, low, high) => (low > 0 ? uPlot.rangeLog(low, high, 10, true) : [1e-9, 1]) }
      : { range: (u, low, high) => this.steady.range(low, high, group.now_s) };
    const series = plot.lines.map((line) => ({
      label: line.label,
      stroke: colours[line.colour],
      width: kLineWidth_px,
      dash: line.dash,
      points: { show: false },
      paths: line.steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
    }));
    const axes = uplotAxes(plot, colours);
    axes[0].values = (u, ticks) => ticks.map((tick) => `${formatTick(Number((tick - this.to_s).toFixed(3)))} s`);
    axes[0].splits = (u, axis, low, high) => group.splits(low, high);
    this.u = new uPlot({
      width: this.width(),
      height: kPlotHeight_px,
      padding: [6, 14, 0, 0],
      legend: { show: false },
      cursor: { sync: { key: 'live' }, drag: { x: false, y: false }, points: { size: 5 } },
      scales: { x: { time: false, range: () => [this.from_s, this.to_s] }, y },
      axes,
      series: [{}, ...series],
      hooks: { drawClear: [(u) => limitLines({ limits: plot.limits?.() ?? [] }, colours)(u)] },
    }, [[], ...plot.lines.map(() => [])], this.figure);
    this.stale = true;
  }

  width() {
    return Math.max(200, this.figure.clientWidth);
  }

  resize() {
    if (this.u.width !== this.width()) this.u.setSize({ width: this.width(), height: kPlotHeight_px });
    this.stale = true;
  }

  /** Shows the time up to `time_s`. False when that would be the picture that is there. */
  draw(time_s) {
    const { group, plot } = this;
    const table = group.robot.tables?.[plot.table];
    if (!table) return false;
    const columns = plot.lines.map((line) => table.column(line.column));
    if (group.now_s - this.wrote_s > 0.25) this.writeLegend(table, columns);
    if (!this.move(time_s)) return false;
    const data = windowOf(table, columns, this.from_s, this.to_s, Math.round(this.u.bbox.width / devicePixelRatio));
    if (plot.transform) for (const line of data.slice(1)) line.forEach((value, i) => { line[i] = plot.transform(value); });
    this.u.batch(() => {
      this.u.setData(data, false);
      this.u.setScale('x', { min: this.from_s, max: this.to_s });
    });
    ++this.drawn;
    this.figure.dataset.drawn = this.drawn;
    return true;
  }

  /** Moves the window in whole pixels; false when it stays where it is. */
  move(time_s) {
    const pixel_s = this.group.window_s / this.u.bbox.width;
    const to_s = (Math.floor(time_s / pixel_s + this.phase) - this.phase) * pixel_s;
    const from_s = to_s - this.group.window_s;
    if (!this.stale && to_s === this.to_s && from_s === this.from_s) return false;
    this.stale = false;
    this.from_s = from_s;
    this.to_s = to_s;
    return true;
  }

  /** Values at the pointer, or else the newest. */
  writeLegend(table, columns) {
    this.wrote_s = this.group.now_s;
    const pointed = this.u.cursor.left >= 0 ? this.u.posToVal(this.u.cursor.left, 'x') : this.to_s;
    this.legends.forEach((legend, k) => {
      const value = table.before(columns[k], pointed);
      const shown = value === null || !Number.isFinite(value) ? '–'
        : this.plot.logarithmic ? value.toExponential(1) : signed(value, this.plot.digits ?? 2);
      legend.value.textContent = `${shown} ${this.plot.unit}`.trim();
    });
  }
}
