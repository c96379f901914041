// All plots. They show the same seconds; each frame draws those that moved by a pixel, as many as fit into its time, in
// turn.

const kBudget_ms = 8;

class LivePlots {
  constructor(robot, sections, container) {
    this.robot = robot;
    this.colours = readColours();
    this.window_s = 10;
    this.now_s = 0;
    this.next = 0;
    this.panels = sections.flatMap((section) => this.addSection(section, container));
    const observer = new IntersectionObserver((entries) => {
      for (const entry of entries) {
        const panel = this.panels.find((one) => one.figure === entry.target);
        panel.visible = entry.isIntersecting;
      }
    }, { rootMargin: '60px' });
    this.panels.forEach((panel) => observer.observe(panel.figure));
    new ResizeObserver(() => this.panels.forEach((panel) => panel.resize())).observe(container);
  }

  addSection(section, container) {
    const box = document.createElement('details');
    box.open = section.open ?? true;
    const heading = document.createElement('summary');
    heading.textContent = section.title;
    const grid = document.createElement('div');
    grid.className = 'plot-grid';
    box.append(heading, grid);
    container.append(box);
    return section.plots.map((plot, k) => new LivePlot(this, plot, grid, k / section.plots.length));
  }

  /** Marks of the time axis, at whole seconds before now. */
  splits(low, high) {
    const step = this.window_s > 40 ? 10 : this.window_s > 15 ? 5 : this.window_s > 6 ? 2 : 1;
    const marks = [];
    for (let back = 0; high - back >= low - 1e-9; back += step) marks.unshift(high - back);
    return marks;
  }

  draw(time_s, now_s) {
    this.now_s = now_s;
    const start = performance.now();
    for (let tried = 0; tried < this.panels.length; ++tried) {
      const panel = this.panels[this.next];
      this.next = (this.next + 1) % this.panels.length;
      if (panel.visible && panel.draw(time_s) && performance.now() - start > kBudget_ms) return;
    }
  }

  recolour() {
    this.colours = readColours();
    this.panels.forEach((panel) => panel.build());
  }
}
