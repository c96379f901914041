// The moving part of a page: stage and plots, drawn in every frame at the time that a clock gives.

/**
 * A clock: `time(now_s)` the time to show at `now_s` of the page, null before there is any. `start_s` and `end_s`, what
 * may be shown; `playing`, `toggle()`; `seek(time_s)` moves a clock that may be moved. Player and LiveClock are clocks.
 */
class Viewer {
  /** `drawn(time_s, state, now_s)` is called after each frame; `state` is null when it is not known. */
  constructor({ data, clock, plots, drawn }) {
    Object.assign(this, { clock, plots, drawn, stage: new Stage(data) });
    requestAnimationFrame((now_ms) => this.frame(now_ms));
  }

  frame(now_ms) {
    const now_s = now_ms / 1000;
    const time_s = this.clock.time(performance.now() / 1000);
    const state = this.stage.draw(time_s);
    if (time_s !== null) this.plots.draw(time_s, now_s);
    this.drawn(time_s, state, now_s);
    requestAnimationFrame((next_ms) => this.frame(next_ms));
  }

  recolour() {
    this.stage.recolour();
    this.plots.recolour();
  }
}
