// Histograms of durations: logarithmic time, logarithmic count, deadline as a line.

const kHistogramHeight_px = 120;
const kHistogramTitles = { wakeup_latency: 'Wake-up latency', execution: 'Duration of a tick', bus_round_trip: 'Bus round trip', solve: 'Solve' };
const kDecades = [0, 5];  // 1 us to 100 ms

function duration(us) {
  if (us >= 1e6) return `${(us / 1e6).toPrecision(3)} s`;
  return us >= 1000 ? `${(us / 1000).toPrecision(3)} ms` : `${Number(us.toPrecision(3))} µs`;
}

class Histogram {
  constructor(name, container) {
    this.figure = element('figure', { className: 'histogram' });
    this.caption = element('figcaption');
    this.canvas = element('canvas');
    this.canvas.style.height = `${kHistogramHeight_px}px`;
    this.text = element('p', { className: 'hint' });
    this.figure.append(this.caption, this.canvas, this.text);
    this.caption.textContent = kHistogramTitles[name] ?? name;
    container.append(this.figure);
  }

  show(data, colours) {
    this.data = data;
    const late = data.deadline_us > 0 && data.max_us > data.deadline_us;
    this.text.textContent = `median ${duration(data.p50_us)} · 99 % ${duration(data.p99_us)} · 99.9 % ${duration(data.p999_us)} · ` +
      `longest ${duration(data.max_us)}${data.deadline_us > 0 ? ` · deadline ${duration(data.deadline_us)}` : ''}`;
    this.text.classList.toggle('warned', late);
    this.canvas.setAttribute('role', 'img');
    this.canvas.setAttribute('aria-label', `${data.name}: ${this.text.textContent}`);
    this.draw(colours);
  }

  draw(colours) {
    const { context: c, width, height } = fitCanvas(this.canvas);
    if (!this.data || width === 0) return;
    const base = height - 16;
    const x = (us) => ((Math.log10(Math.max(us, 1)) - kDecades[0]) / (kDecades[1] - kDecades[0])) * width;
    const most = Math.max(10, ...this.data.in_bin);
    const y = (count) => base - (Math.log10(count + 1) / Math.log10(most + 1)) * (base - 6);
    this.drawAxis(c, x, base, width, colours);
    this.data.in_bin.forEach((count, k) => {
      const edge = this.data.upper_edge_us[k] || 10 ** kDecades[1];
      const late = this.data.deadline_us > 0 && edge > this.data.deadline_us * 1.13;
      const from = x(edge / 1.11);
      c.fillStyle = late ? colours.limit : colours.left;
      c.fillRect(from, y(count), Math.max(1.5, x(edge) - from - 0.5), base - y(count));
    });
    if (this.data.deadline_us > 0) this.drawDeadline(c, x(this.data.deadline_us), base, colours);
  }

  drawAxis(c, x, base, width, colours) {
    c.font = '10.5px system-ui, sans-serif';
    c.textAlign = 'center';
    c.textBaseline = 'bottom';
    for (let decade = kDecades[0]; decade <= kDecades[1]; ++decade) {
      const at = Math.min(width - 1, Math.max(1, x(10 ** decade)));
      c.fillStyle = colours.line;
      c.fillRect(at - 0.5, 0, 1, base);
      c.fillStyle = colours.muted;
      c.textAlign = decade === kDecades[0] ? 'left' : decade === kDecades[1] ? 'right' : 'center';
      c.fillText(duration(10 ** decade), at, base + 15);
    }
    c.fillStyle = colours.muted;
    c.fillRect(0, base, width, 1);
  }

  drawDeadline(c, at, base, colours) {
    c.strokeStyle = colours.limit;
    c.lineWidth = 1.5;
    c.setLineDash([4, 3]);
    c.beginPath();
    c.moveTo(at, 0);
    c.lineTo(at, base);
    c.stroke();
    c.setLineDash([]);
  }
}

class TimingPanel {
  constructor() {
    this.container = document.getElementById('histograms');
    this.histograms = new Map();
    this.recolour();
    new ResizeObserver(() => this.redraw()).observe(this.container);
  }

  recolour() {
    this.colours = readColours();
    this.redraw();
  }

  redraw() {
    for (const histogram of this.histograms?.values() ?? []) histogram.draw(this.colours);
  }

  show(timing) {
    document.getElementById('timing-text').textContent =
      `${timing.ticks.toLocaleString('en')} ticks, ${timing.late_ticks.toLocaleString('en')} late, ` +
      `${timing.dropped.toLocaleString('en')} records dropped`;
    for (const data of timing.histograms) {
      if (!this.histograms.has(data.name)) this.histograms.set(data.name, new Histogram(data.name, this.container));
      this.histograms.get(data.name).show(data, this.colours);
    }
  }
}
