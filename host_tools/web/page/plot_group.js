// All plots. They show the same seconds; a frame draws those that moved by a pixel, in turn, and not all of them where
// drawing takes longer than the screen's rate allows: the robot moves smoothly first.

/** However slow the machine, a frame draws this share of the plots in view. */
const kLeastShare = 0.25;
const kSlow = 1.4;

class LivePlots {
  constructor(robot, sections, container) {
    this.robot = robot;
    this.colours = readColours();
    this.window_s = 10;
    this.now_s = 0;
    this.shortest_s = 1;
    this.atOnce = Infinity;
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
    this.setPace(now_s);
    this.now_s = now_s;
    let drawn = 0;
    for (let tried = 0; tried < this.panels.length && drawn < this.atOnce; ++tried) {
      const panel = this.panels[this.next];
      this.next = (this.next + 1) % this.panels.length;
      if (panel.visible && panel.draw(time_s)) ++drawn;
    }
  }

  /** How many plots a frame may draw: fewer while frames come later than the screen could show them. */
  setPace(now_s) {
    const took_s = now_s - this.now_s;
    if (!(took_s > 0.001 && took_s < 0.5)) return;
    this.shortest_s = Math.min(took_s, this.shortest_s * 1.002);
    const inView = this.panels.filter((panel) => panel.visible).length;
    const wanted = took_s > kSlow * this.shortest_s ? 0.85 * this.atOnce : this.atOnce + 0.2;
    this.atOnce = Math.min(inView, Math.max(kLeastShare * inView, wanted));
  }

  recolour() {
    this.colours = readColours();
    this.panels.forEach((panel) => panel.build());
  }
}
