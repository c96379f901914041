// One time plot. All plots of a page share the time axis, the cursor and the time shown.
//
// A plot is {title, axis, unit, digits, table, lines, limits, least, fromZero, logarithmic}. `table` is one of
// RobotData.tables; `limits` gives the values of dotted lines; the range of y is not below `least`. A line is {label,
// colour, column, dash, width, alpha, points, steps, unnamed}; an unnamed one has no value in the caption.

const kPlotHeight_px = 172;
const kCaptionPeriod_s = 0.25;

class Plot {
  /** `phase`, 0 to 1: plots that move by a pixel at different times do not all have to be drawn in the same frame. */
  constructor(group, plot, container, phase) {
    Object.assign(this, { group, plot, phase, visible: true, from_s: 0, to_s: 1, zero_s: 0 });
    this.range = new PlotRange(plot);
    this.legends = plot.lines.map((line, k) => this.makeLegend(line, k + 1));
    const named = this.legends.filter((_, k) => !plot.lines[k].unnamed).map((legend) => legend.item);
    const title = element('span', { className: 'title', textContent: plot.title });
    const save = element('button', { type: 'button', className: 'save', textContent: 'SVG', title: 'Save this plot as SVG' });
    save.setAttribute('aria-label', `Save ${plot.title} as SVG`);
    save.addEventListener('click', () => saveSvg(plot.title.replace(/\W+/g, '_'), plotSvg(this)));
    this.figure = element('figure', { tabIndex: -1 }, element('figcaption', {}, title, ...named, save));
    this.figure.dataset.title = plot.title;
    container.append(this.figure);
    this.build();
  }

  /** Where a line's value stands in the caption; a click hides the line. */
  makeLegend(line, series) {
    const value = element('b');
    value.style.minWidth = `${5 + (this.plot.digits ?? 2) + this.plot.unit.length}ch`;
    const item = element('button', { type: 'button', className: 'legend', title: 'Show or hide' }, `${line.label} `, value);
    item.setAttribute('aria-pressed', 'true');
    item.style.setProperty('--colour', `var(--${line.colour})`);
    if (line.dash) item.classList.add('dashed');
    item.addEventListener('click', () => {
      const show = !item.classList.toggle('off');
      item.setAttribute('aria-pressed', String(show));
      this.u.setSeries(series, { show });
    });
    return { item, value };
  }

  build() {
    const { plot, group } = this;
    const { colours } = group;
    const limits = () => plot.limits?.() ?? [];
    this.u?.destroy();
    const y = plot.logarithmic
      ? { distr: 3, range: (u, low, high) => (low > 0 ? uPlot.rangeLog(low, high, 10, true) : [1e-9, 1]) }
      : { range: (u, low, high) => this.range.around(low, high, limits(), !group.fixed, group.now_s) };
    const series = plot.lines.map((line, k) => (
      uplotSeries(line, !this.legends[k].item.classList.contains('off'), colours, group.lineWidth_px)));
    this.u = new uPlot({
      width: this.width(),
      height: kPlotHeight_px,
      padding: [6, 14, 0, 0],
      legend: { show: false },
      cursor: {
        sync: { key: 'time', filters: { pub: (type) => type === 'mousemove' || type === 'mouseleave' } },
        drag: { x: true, y: false, setScale: false },
        points: { size: 5 },
        bind: {
          mousedown: (u, target, select) => (event) => (group.choosable ? select(event) : null),
          dblclick: () => () => { group.showAll(); return null; },
        },
      },
      scales: { x: { time: false, range: () => [this.from_s, this.to_s] }, y },
      axes: uplotAxes(plot, colours, () => this.zero_s),
      series: [{}, ...series],
      hooks: {
        drawClear: [(u) => drawPushes(u, group.data, colours), (u) => drawLimits(u, limits(), colours)],
        setSelect: [(u) => this.zoomToSelection(u)],
      },
    }, [[], ...plot.lines.map(() => [])], this.figure);
    this.addTimes();
    this.stale = true;
  }

  width() {
    return Math.max(200, this.figure.clientWidth);
  }

  resize() {
    if (this.u.width !== this.width()) this.u.setSize({ width: this.width(), height: kPlotHeight_px });
    this.stale = true;
  }

  zoomToSelection(u) {
    if (u.select.width < 5) return;
    const from = u.posToVal(u.select.left, 'x');
    const to = u.posToVal(u.select.left + u.select.width, 'x');
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.group.show(from, to);
  }

  /** Adds the line of the time shown and the time at the pointer; a click moves the time shown. */
  addTimes() {
    const { over } = this.u;
    this.timeLine = element('div', { className: 'time-line', hidden: true });
    this.pointedTime = element('span', { className: 'pointed-time', hidden: true });
    this.line = null;
    this.wroteAt = null;
    over.append(this.timeLine, this.pointedTime);
    let pressedAt = 0;
    over.addEventListener('mousedown', (event) => { pressedAt = event.clientX; });
    over.addEventListener('click', (event) => {
      if (Math.abs(event.clientX - pressedAt) > 4) return;
      this.group.pick(this.u.posToVal(event.clientX - over.getBoundingClientRect().left, 'x'));
    });
  }

  get source() {
    const table = this.group.data.tables[this.plot.table];
    if (this.table !== table) {
      this.table = table;
      this.columns = this.plot.lines.map((line) => table.column(line.column));
    }
    return this;
  }

  /** Draws the group's window; false when that is the picture that is there. */
  draw() {
    if (!this.move()) return false;
    const { table, columns } = this.source;
    const data = windowOf(table, columns, this.from_s, this.to_s, Math.round(this.u.bbox.width / devicePixelRatio));
    if (this.plot.logarithmic) {
      for (const line of data.slice(1)) line.forEach((value, i) => { line[i] = value > 1e-16 ? value : null; });
    }
    this.u.batch(() => {
      this.u.setData(data, false);
      this.u.setScale('x', { min: this.from_s, max: this.to_s });
    });
    return true;
  }

  /** Moves to the group's window, in whole pixels while that follows the time; false when it stays where it is. */
  move() {
    let [from_s, to_s] = this.group.window;
    if (!this.group.fixed) {
      const pixel_s = (to_s - from_s) / this.u.bbox.width;
      const ahead_s = to_s - (Math.floor(to_s / pixel_s + this.phase) - this.phase) * pixel_s;
      from_s -= ahead_s;
      to_s -= ahead_s;
      this.zero_s = to_s;
    }
    if (!this.stale && to_s === this.to_s && from_s === this.from_s) return false;
    this.stale = false;
    this.from_s = from_s;
    this.to_s = to_s;
    return true;
  }

  /** Writes the values at the pointer, or else at the time shown, and moves the time line there. */
  showTime() {
    const { group, u } = this;
    const line = group.fixed ? `translateX(${u.valToPos(group.time_s, 'x')}px)` : null;
    if (line !== this.line) {
      this.line = line;
      this.timeLine.hidden = line === null;
      this.timeLine.style.transform = line;
    }
    const pointed = u.cursor.left >= 0;
    const at = pointed ? u.cursor.left : group.clock.playing ? -1 : group.time_s;
    if (at === this.wroteAt && group.now_s - this.wrote_s < kCaptionPeriod_s) return;
    this.wroteAt = at;
    this.wrote_s = group.now_s;
    const time_s = pointed ? u.posToVal(u.cursor.left, 'x') : group.time_s;
    this.writeCaption(time_s);
    this.pointedTime.hidden = !pointed;
    this.pointedTime.style.left = `${u.cursor.left}px`;
    this.pointedTime.textContent = `${signed(time_s - this.zero_s, 3)} s`;
  }

  writeCaption(time_s) {
    const { table, columns } = this.source;
    const values = table.before(columns, time_s);
    this.legends.forEach((legend, k) => {
      const value = values?.[k] ?? NaN;
      const shown = this.plot.logarithmic ? value.toExponential(1) : signed(value, this.plot.digits ?? 2);
      const text = Number.isFinite(value) ? `${shown} ${this.plot.unit}`.trim() : '–';
      if (legend.value.textContent !== text) legend.value.textContent = text;
    });
  }
}
