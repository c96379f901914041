// When to show what (a clock, see viewer.js). Samples come in batches with varying delay. The picture follows the
// robot's clock evenly, a little behind, so that there is nearly always a sample to show. Paused, it looks back.

/** How far one may look back, and how long a paused page takes what is new before it takes nothing more, to keep that. */
const kLookBack_s = 300;
const kPausedOn_s = 60;

class LiveClock {
  constructor() {
    this.reset();
  }

  reset() {
    this.offset_s = null;
    this.oldest_s = null;
    this.newest_s = null;
    this.lag_s = 0.06;
    this.shown_s = null;
    this.pausedAt_s = null;
    this.held_s = null;
  }

  /** Samples from `oldest_s` to `newest_s` of the robot's clock are there at `now_s` of the page's. */
  arrived(oldest_s, newest_s, now_s) {
    this.oldest_s = oldest_s;
    this.newest_s = newest_s;
    const offset = now_s - newest_s;
    // The shortest way sets the offset; it fades slowly, for clocks do not run alike.
    this.offset_s = this.offset_s === null ? offset : Math.min(offset, this.offset_s + 2e-4);
    if (offset - this.offset_s > 2) this.offset_s = offset;
  }

  get start_s() {
    return Math.max(this.oldest_s, this.end_s - kLookBack_s);
  }

  get end_s() {
    return this.pausedAt_s ?? this.shown_s;
  }

  get playing() {
    return this.held_s === null;
  }

  /** Pauses at the time shown, or moves on. */
  toggle() {
    this.pausedAt_s = this.playing ? this.shown_s : null;
    this.held_s = this.pausedAt_s;
  }

  /** Samples may come with another delay from now on. */
  expectOtherDelay() {
    this.offset_s = null;
  }

  /** Moves a paused clock. */
  seek(time_s) {
    if (!this.playing) this.held_s = Math.min(this.end_s, Math.max(this.start_s, time_s));
  }

  /** The robot's time to show at `now_s`; null before the first sample. */
  time(now_s) {
    if (!this.playing) return this.held_s;
    if (this.offset_s === null) return this.shown_s;
    const ideal = now_s - this.offset_s;
    const late = ideal - this.newest_s;
    if (late < 0.5) this.lag_s = Math.min(0.3, Math.max(late, this.lag_s * 0.9995, 0.03));
    const wanted = Math.min(this.newest_s, ideal - this.lag_s);
    const jumps = this.shown_s === null || Math.abs(wanted - this.shown_s) > 1;
    this.shown_s = jumps ? wanted : Math.max(wanted, this.shown_s);
    return this.shown_s;
  }
}
