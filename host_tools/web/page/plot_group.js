// All plots of a page. They show the same seconds, those before the time shown or, chosen by the user, fixed ones. A
// frame draws the plots that moved by a pixel, in turn. It does not draw all of them where that takes longer than the
// screen's rate allows: the robot moves smoothly first.

/** However slow the machine, a frame draws this share of the plots in view. */
const kLeastShare = 0.25;
const kSlow = 1.4;

class PlotGroup {
  /** `follow_s`: length of the window that ends at the time shown; null: the window is `fixed`, [from_s, to_s]. */
  constructor({ data, clock, sections, container, follow_s = null, fixed = null, lineWidth_px }) {
    Object.assign(this, { data, clock, follow_s, fixed, lineWidth_px });
    this.colours = readColours();
    this.time_s = clock.start_s;
    this.now_s = 0;
    this.shortest_s = 1;
    this.atOnce = Infinity;
    this.next = 0;
    this.plots = sections.flatMap((section) => this.addSection(section, container));
    const observer = new IntersectionObserver((entries) => {
      for (const entry of entries) this.plots.find((one) => one.figure === entry.target).visible = entry.isIntersecting;
    }, { rootMargin: '60px' });
    this.plots.forEach((plot) => observer.observe(plot.figure));
    new ResizeObserver(() => this.plots.forEach((plot) => plot.resize())).observe(container);
  }

  addSection(section, container) {
    const grid = element('div', { className: 'plot-grid' });
    container.append(element('details', { open: !section.folded }, element('summary', { textContent: section.title }), grid));
    return section.plots.map((plot, k) => new Plot(this, plot, grid, k / section.plots.length));
  }

  get window() {
    return this.fixed ?? [this.time_s - this.follow_s, this.time_s];
  }

  /** Whether the user may choose time and window: not while they move on their own. */
  get choosable() {
    return this.follow_s === null || !this.clock.playing;
  }

  /** Shows a window chosen by the user; the time shown moves into it. */
  show(from_s, to_s) {
    this.fixed = [from_s, to_s];
    if (this.time_s < from_s || this.time_s > to_s) this.clock.seek(from_s);
  }

  showAll() {
    if (this.follow_s !== null) this.fixed = null;
    else this.show(this.clock.start_s, this.clock.end_s);
  }

  /** Shows the time that was clicked at, in the window that is there. */
  pick(time_s) {
    if (!this.choosable) return;
    this.fixed = this.window;
    this.clock.seek(time_s);
  }

  /** Scrolls to the first of the plots of these titles, unfolded, and marks them all while that one has the focus. */
  pointOut(titles) {
    const figures = this.plots.map((plot) => plot.figure).filter((figure) => titles.includes(figure.dataset.title));
    for (const figure of figures) {
      figure.closest('details').open = true;
      figure.classList.add('pointed-out');
    }
    figures[0].scrollIntoView({ block: 'center' });
    figures[0].focus({ preventScroll: true });
    const unmark = () => figures.forEach((figure) => figure.classList.remove('pointed-out'));
    figures[0].addEventListener('focusout', unmark, { once: true });
  }

  draw(time_s, now_s) {
    if (!this.data.tables) return;
    this.setPace(now_s);
    this.now_s = now_s;
    this.time_s = time_s;
    if (!this.choosable) this.fixed = null;
    this.turnPage();
    for (const plot of this.plots) if (this.isShown(plot)) plot.showTime();
    let drawn = 0;
    for (let tried = 0; tried < this.plots.length && drawn < this.atOnce; ++tried) {
      const plot = this.plots[this.next];
      this.next = (this.next + 1) % this.plots.length;
      if (this.isShown(plot) && plot.draw()) ++drawn;
    }
  }

  /** A picture that stands still is drawn whole, for printing, too. */
  isShown(plot) {
    return plot.visible || this.fixed !== null;
  }

  /** Moves a fixed window on when the time shown leaves it. */
  turnPage() {
    if (!this.fixed) return;
    const [from_s, to_s] = this.fixed;
    if (this.time_s >= from_s && this.time_s <= to_s) return;
    const ideal_s = this.time_s > to_s ? this.time_s : this.time_s - (to_s - from_s);
    const from = Math.max(this.clock.start_s, Math.min(ideal_s, this.clock.end_s - (to_s - from_s)));
    this.fixed = [from, from + (to_s - from_s)];
  }

  /** How many plots a frame may draw: fewer while frames come later than the screen could show them. */
  setPace(now_s) {
    const took_s = now_s - this.now_s;
    if (!(took_s > 0.001 && took_s < 0.5)) return;
    this.shortest_s = Math.min(took_s, this.shortest_s * 1.002);
    const inView = this.plots.filter((plot) => this.isShown(plot)).length;
    const wanted = took_s > kSlow * this.shortest_s ? 0.85 * this.atOnce : this.atOnce + 0.2;
    this.atOnce = Math.min(inView, Math.max(kLeastShare * inView, wanted));
  }

  recolour() {
    this.colours = readColours();
    this.plots.forEach((plot) => plot.build());
  }
}
