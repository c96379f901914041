// One time plot. All plots share the time axis, the cursor and the current time of the player.

const kPlotHeight_px = 190;
const kSyncKey = 'time';

/** Numbers for uPlot: what is not finite becomes a gap. */
function withGaps(column, transform = (value) => value) {
  return Array.from(column, (value, i) => {
    const shown = transform(value, i);
    return Number.isFinite(shown) ? shown : null;
  });
}

/** Shades the pushes behind the lines and writes their force above. */
function pushShading(run, colours) {
  return (u) => {
    const c = u.ctx;
    const ratio = devicePixelRatio || 1;
    c.save();
    c.beginPath();
    c.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
    c.clip();
    for (const push of run.pushes) {
      if (push.to_s < u.scales.x.min || push.from_s > u.scales.x.max) continue;
      const from = u.valToPos(push.from_s, 'x', true);
      const to = Math.max(from + ratio, u.valToPos(push.to_s, 'x', true));
      c.globalAlpha = 0.16;
      c.fillStyle = colours.push;
      c.fillRect(from, u.bbox.top, to - from, u.bbox.height);
      c.globalAlpha = 1;
      c.font = `${10 * ratio}px system-ui, sans-serif`;
      c.textAlign = 'left';
      c.textBaseline = 'top';
      c.fillText(`${push.force_N.toFixed(0).replace('-', '−')} N`, Math.max(from, u.bbox.left) + 3 * ratio, u.bbox.top + 2 * ratio);
    }
    c.restore();
  };
}

function uplotSeries(line, colours, unit, digits) {
  const points = line.points
    ? { show: true, size: 5, fill: colours[line.colour], stroke: colours[line.colour] }
    : { show: false };
  return {
    label: line.label,
    stroke: colours[line.colour],
    width: line.width ?? 1.5,
    dash: line.dash,
    alpha: line.alpha ?? 1,
    paths: line.points ? () => null : undefined,
    points,
    spanGaps: line.spanGaps ?? false,
    value: (u, value) => (value == null ? '–' : line.exponent
      ? value.toExponential(1) : `${value.toFixed(digits).replace('-', '−')} ${unit}`),
  };
}

class PlotPanel {
  constructor(group, plot, container) {
    this.group = group;
    this.plot = plot;
    this.figure = document.createElement('figure');
    const caption = document.createElement('figcaption');
    caption.textContent = plot.title;
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
      : { range: yRange(plot) };
    this.u = new uPlot({
      width: this.width(),
      height: kPlotHeight_px,
      padding: [6, 18, 0, 0],
      scales: { x: { time: false, range: (u, low, high) => [low, high] }, y },
      axes: uplotAxes(plot, colours),
      series: [
        { label: 'time', value: (u, value) => (value == null ? '–' : `${value.toFixed(3)} s`) },
        ...plot.lines.map((line) => uplotSeries(line, colours, plot.unit, plot.digits ?? 2)),
      ],
      cursor: {
        sync: { key: kSyncKey, filters: { pub: (type) => type === 'mousemove' || type === 'mouseleave' } },
        drag: { x: true, y: false, setScale: false },
        points: { size: 6 },
        bind: { dblclick: () => () => { group.showAll(); return null; } },
      },
      hooks: {
        drawClear: [pushShading(group.run, colours), limitLines(plot, colours)],
        setSelect: [(u) => this.zoomToSelection(u)],
        // After drawing, uPlot clears the legend; the time is shown once that is done.
        draw: [() => queueMicrotask(() => this.showTime())],
      },
    }, [plot.time, ...plot.lines.map((line) => line.values)], this.figure);
    this.u.setScale('x', { min: group.from_s, max: group.to_s });
    this.addTimeLine();
  }

  width() {
    return Math.max(220, this.figure.clientWidth);
  }

  resize() {
    if (this.u.width !== this.width()) this.u.setSize({ width: this.width(), height: kPlotHeight_px });
  }

  zoomToSelection(u) {
    if (u.select.width < 5) return;
    const from = u.posToVal(u.select.left, 'x');
    const to = u.posToVal(u.select.left + u.select.width, 'x');
    u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
    this.group.show(from, to);
  }

  addTimeLine() {
    const over = this.u.over;
    this.timeLine = document.createElement('div');
    this.timeLine.className = 'time-line';
    over.append(this.timeLine);
    let pressedAt = 0;
    over.addEventListener('mousedown', (event) => { pressedAt = event.clientX; });
    over.addEventListener('click', (event) => {
      if (Math.abs(event.clientX - pressedAt) > 4) return;
      this.group.player.seek(this.u.posToVal(event.clientX - over.getBoundingClientRect().left, 'x'));
    });
    this.showTime();
  }

  /** Moves the time line and, while the pointer is elsewhere, the values in the legend. */
  showTime() {
    if (!this.timeLine?.isConnected) return;
    const time = this.group.player.time_s;
    this.timeLine.style.transform = `translateX(${this.u.valToPos(time, 'x')}px)`;
    if (this.u.cursor.left < 0) this.u.setLegend({ idx: lastIndexUpTo(this.plot.time, time) });
  }
}

const kWindow_s = 8;
const kBeforePush_s = 2;

/** All plots of the page. They show one window of time, which always holds the player's time. */
class PlotGroup {
  constructor(run, player, sections, container) {
    this.run = run;
    this.player = player;
    this.colours = readColours();
    this.views = this.makeViews();
    [this.from_s, this.to_s] = this.views[this.views.length > 1 ? 1 : 0].window;
    if (player.time_s < this.from_s) player.seek(this.from_s);
    this.addViewButtons(container);
    this.panels = sections.flatMap((section) => this.addSection(section, container));
    player.listen(() => this.follow());
    new ResizeObserver(() => this.panels.forEach((panel) => panel.resize())).observe(container);
  }

  /** The whole run and, when it is long, a window at each push or at the start. */
  makeViews() {
    const { start_s, end_s, pushes } = this.run;
    const views = [{ name: 'Whole run', window: [start_s, Math.max(end_s, start_s + 1e-3)] }];
    if (end_s - start_s < 1.5 * kWindow_s) return views;
    const windowAt = (from) => {
      const first = Math.max(start_s, Math.min(from, end_s - kWindow_s));
      return [first, first + kWindow_s];
    };
    for (const push of pushes.slice(0, 6)) {
      views.push({
        name: `Push of ${push.force_N.toFixed(0).replace('-', '−')} N at ${push.from_s.toFixed(1)} s`,
        window: windowAt(push.from_s - kBeforePush_s),
      });
    }
    if (pushes.length === 0) views.push({ name: `${kWindow_s} s`, window: windowAt(start_s) });
    return views;
  }

  addViewButtons(container) {
    const bar = document.createElement('div');
    bar.className = 'views';
    for (const view of this.views) {
      const button = Object.assign(document.createElement('button'), { type: 'button', textContent: view.name });
      button.addEventListener('click', () => this.show(...view.window));
      bar.append(button);
    }
    container.append(bar);
  }

  addSection(section, container) {
    const heading = document.createElement('h2');
    heading.textContent = section.title;
    const grid = document.createElement('div');
    grid.className = 'plot-grid';
    container.append(heading, grid);
    return section.plots.map((plot) => new PlotPanel(this, plot, grid));
  }

  setWindow(from_s, to_s) {
    this.from_s = from_s;
    this.to_s = to_s;
    for (const panel of this.panels) panel.u.setScale('x', { min: from_s, max: to_s });
  }

  /** Shows a window chosen by the user; the player moves into it. */
  show(from_s, to_s) {
    this.setWindow(from_s, to_s);
    if (this.player.time_s < from_s || this.player.time_s > to_s) this.player.seek(from_s);
  }

  showAll() {
    this.show(...this.views[0].window);
  }

  /** Turns the page when the player leaves the window. */
  follow() {
    const time = this.player.time_s;
    const width = this.to_s - this.from_s;
    if (time < this.from_s || time > this.to_s) {
      const ideal = time > this.to_s ? time : time - width;
      const from = Math.max(this.run.start_s, Math.min(ideal, this.run.end_s - width));
      this.setWindow(from, from + width);
    }
    this.panels.forEach((panel) => panel.showTime());
  }

  recolour() {
    this.colours = readColours();
    this.panels.forEach((panel) => panel.build());
  }
}
