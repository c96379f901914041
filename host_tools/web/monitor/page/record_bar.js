// The time bar of a record. All pages show one record, so its place is the monitor's.

class RecordBar {
  constructor(connection, clock) {
    Object.assign(this, { connection, clock, playback: null, sought: false });
    [this.box, this.hold, this.bar, this.time] = ['bar', 'hold', 'at', 'time'].map((id) => document.getElementById(`record-${id}`));
    document.getElementById('record-start').addEventListener('click', () => this.playFrom(0));
    this.hold.addEventListener('click', () => this.toggleHold());
    this.bar.addEventListener('input', () => {
      this.sought = true;
      this.write(Number(this.bar.value));
    });
    this.bar.addEventListener('change', () => this.playFrom(Number(this.bar.value)));
    document.addEventListener('keydown', (event) => {
      if (event.key !== 'Home' || !this.playback || event.target.closest('input, select')) return;
      this.playFrom(0);
      event.preventDefault();
    });
  }

  playFrom(from_s) {
    this.sought = false;
    this.connection.send({ from: from_s });
  }

  /** Stops a record or lets it go on; false when no record is shown. */
  toggleHold() {
    if (!this.playback) return false;
    this.connection.send({ hold: !this.playback.held });
    return true;
  }

  /** Takes where the playing is: {at_s, length_s, held}; null for a live robot. */
  show(playback) {
    this.playback = playback;
    this.box.hidden = !playback;
    if (!playback) return;
    if (playback.held === this.clock.playing) {
      this.clock.toggle();
      if (!playback.held) this.clock.expectOtherDelay();
    }
    this.hold.textContent = playback.held ? '▶' : '❚❚';
    this.hold.setAttribute('aria-label', playback.held ? 'Play on' : 'Pause');
    this.bar.max = String(playback.length_s);
    if (this.sought) return;
    this.bar.value = String(playback.at_s);
    this.write(playback.at_s);
  }

  write(at_s) {
    this.time.textContent = `${at_s.toFixed(1)} of ${this.playback.length_s.toFixed(1)} s`;
  }
}
