// Parts of uPlot plots. A plot: {axis, unit, limits, fromZero, ...}; see plot_list.js of each page.

function formatTick(value) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(0);
  return String(Number(value.toPrecision(4))).replace('-', '−');
}

/** Draws the plot's limits as dotted lines. */
function limitLines(plot, colours) {
  return (u) => {
    const c = u.ctx;
    const ratio = devicePixelRatio || 1;
    c.save();
    c.strokeStyle = colours.limit;
    c.lineWidth = 1.2 * ratio;
    c.setLineDash([2 * ratio, 4 * ratio]);
    for (const limit of plot.limits ?? []) {
      const y = u.valToPos(limit, 'y', true);
      c.beginPath();
      c.moveTo(u.bbox.left, y);
      c.lineTo(u.bbox.left + u.bbox.width, y);
      c.stroke();
    }
    c.restore();
  };
}

function uplotAxes(plot, colours) {
  const common = {
    stroke: colours.muted,
    font: '11px system-ui, sans-serif',
    grid: { stroke: colours.line, width: 1 },
    ticks: { show: false },
  };
  return [
    { ...common, size: 26, gap: 4, values: (u, ticks) => ticks.map((tick) => `${formatTick(tick)} s`) },
    {
      ...common, size: 52, gap: 4, label: plot.axis, labelSize: 18, labelGap: 0,
      labelFont: '11px system-ui, sans-serif',
      values: (u, ticks) => ticks.map((tick) => (tick === null ? null : formatTick(tick))),
    },
  ];
}

/** The y scale holds the data shown and the plot's limits. */
function yRange(plot) {
  return (u, low, high) => {
    if (low === null || high === null || low === undefined) return [0, 1];
    const from = Math.min(low, ...(plot.limits ?? []));
    const to = Math.max(high, ...(plot.limits ?? []));
    return uPlot.rangeNum(from, to, { min: { pad: 0.06, soft: 0, mode: plot.fromZero ? 1 : 0 },
      max: { pad: 0.06, soft: 0, mode: 0 } });
  };
}
