// Parts of uPlot plots; see plot.js.

function formatTick(value) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(0);
  return String(Number(value.toPrecision(4))).replace('-', '−');
}

/** Length of 1, 2 or 5 times a power of ten, not below `length`. */
function roundLength(length) {
  const power = 10 ** Math.floor(Math.log10(length));
  return power * ([1, 2, 5].find((digit) => digit * power > 0.999 * length) ?? 10);
}

/** Marks of the time axis, counted from `zero`. */
function timeMarks(low, high, zero) {
  const step = roundLength((high - low) / 6);
  const first = Math.ceil((low - zero) / step - 1e-6);
  const last = Math.floor((high - zero) / step + 1e-6);
  return Array.from({ length: last - first + 1 }, (_, k) => zero + (first + k) * step);
}

/** The range of y: round ends around the data shown and the limits. */
class PlotRange {
  constructor(plot) {
    this.plot = plot;
    this.low = null;
    this.high = null;
    this.small_since = null;
  }

  static roundEnds(low, high) {
    const step = 10 ** Math.floor(Math.log10(Math.max(1e-9, high - low)));
    const unit = (high - low) / step > 5 ? step : (high - low) / step > 2 ? step / 2 : step / 5;
    return [Math.floor(low / unit + 0.04) * unit, Math.ceil(high / unit - 0.04) * unit];
  }

  /** `steady`: the range grows at once and shrinks only when it has long been too large. */
  around(low, high, limits, steady, now_s) {
    if (!Number.isFinite(low) || !Number.isFinite(high)) return [this.low ?? 0, this.high ?? 1];
    const least = this.plot.least ?? 1e-6;
    const middle = (low + high) / 2;
    let from = Math.min(low, middle - least / 2, ...limits);
    const to = Math.max(high, middle + least / 2, ...limits);
    if (this.plot.fromZero) from = Math.min(0, from);
    const [a, b] = PlotRange.roundEnds(from, to);
    const fits = steady && this.low !== null && a >= this.low - 1e-12 && b <= this.high + 1e-12;
    const roomy = fits && b - a < 0.6 * (this.high - this.low);
    if (!roomy) this.small_since = null;
    else this.small_since ??= now_s;
    if (!fits || (roomy && now_s - this.small_since > 3)) {
      const keep = steady && this.low !== null && !fits;
      this.low = keep ? Math.min(a, this.low) : a;
      this.high = keep ? Math.max(b, this.high) : b;
      this.small_since = null;
    }
    return [this.low, this.high];
  }
}

/** Draws limits as dotted lines. */
function drawLimits(u, limits, colours) {
  const c = u.ctx;
  const ratio = devicePixelRatio || 1;
  c.save();
  c.strokeStyle = colours.limit;
  c.lineWidth = 1.2 * ratio;
  c.setLineDash([2 * ratio, 4 * ratio]);
  for (const limit of limits) {
    const y = u.valToPos(limit, 'y', true);
    c.beginPath();
    c.moveTo(u.bbox.left, y);
    c.lineTo(u.bbox.left + u.bbox.width, y);
    c.stroke();
  }
  c.restore();
}

/** Shades the pushes behind the lines and writes their force above; those of a second run fainter, between dashes. */
function drawPushes(u, data, colours) {
  const c = u.ctx;
  const ratio = devicePixelRatio || 1;
  c.save();
  c.beginPath();
  c.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  c.clip();
  c.fillStyle = colours.push;
  c.font = `${10 * ratio}px system-ui, sans-serif`;
  c.textAlign = 'left';
  c.textBaseline = 'top';
  c.strokeStyle = colours.push;
  c.lineWidth = ratio;
  c.setLineDash([4 * ratio, 4 * ratio]);
  for (const push of pushesOf(data)) {
    if (push.to_s < u.scales.x.min || push.from_s > u.scales.x.max) continue;
    const from = u.valToPos(push.from_s, 'x', true);
    const to = Math.max(from + ratio, u.valToPos(push.to_s, 'x', true));
    c.globalAlpha = push.second ? 0.06 : 0.16;
    c.fillRect(from, u.bbox.top, to - from, u.bbox.height);
    c.globalAlpha = 1;
    for (const x of push.second ? [from, to] : []) {
      c.beginPath();
      c.moveTo(x, u.bbox.top);
      c.lineTo(x, u.bbox.top + u.bbox.height);
      c.stroke();
    }
    const text = `${signed(push.force_N, 0)} N${push.second ? ', second' : ''}`;
    c.fillText(text, Math.max(from, u.bbox.left) + 3 * ratio, u.bbox.top + (push.second ? 14 : 2) * ratio);
  }
  c.restore();
}

/** Axes of time and of the plot; `zero()` is the time that is written as 0. */
function uplotAxes(plot, colours, zero) {
  const common = {
    stroke: colours.muted,
    font: '11px system-ui, sans-serif',
    gap: 4,
    grid: { stroke: colours.line, width: 1 },
    ticks: { show: false },
  };
  return [
    {
      ...common, size: 26,
      splits: (u, axis, low, high) => timeMarks(low, high, zero()),
      values: (u, marks) => marks.map((mark) => `${formatTick(Number((mark - zero()).toFixed(4)))} s`),
    },
    {
      ...common, size: 52, label: plot.axis, labelSize: 18, labelGap: 0, labelFont: common.font,
      values: (u, marks) => marks.map((mark) => (mark === null ? null : formatTick(mark))),
    },
  ];
}

function uplotSeries(line, show, colours, width) {
  const colour = colours[line.colour];
  return {
    show,
    label: line.label,
    stroke: colour,
    width: line.width ?? width,
    dash: line.dash,
    alpha: line.alpha ?? 1,
    paths: line.points ? () => null : line.steps ? uPlot.paths.stepped({ align: 1 }) : undefined,
    points: line.points ? { show: true, size: 5, fill: line.dash ? 'transparent' : colour, stroke: colour } : { show: false },
  };
}

/** ± the limits `data.torqueLimits_Nm` of the left joint `first` and its right one, whichever is less; none when not known. */
function torqueLimits(data, first) {
  const limits = data.torqueLimits_Nm.map((list) => Math.min(...[list[first], list[first + 2]].filter((one) => one > 0)));
  return [...new Set(limits)].filter(Number.isFinite).flatMap((limit) => [-limit, limit]);
}
