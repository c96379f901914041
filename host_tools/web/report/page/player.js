// The clock of the page (see viewer.js) and its controls.

const kSpeeds = [0.1, 0.25, 0.5, 1, 2];

class Player {
  constructor(start_s, end_s) {
    this.start_s = start_s;
    this.end_s = end_s;
    this.time_s = start_s;
    this.speed = 1;
    this.playing = false;
    this.before_s = 0;
  }

  seek(time_s) {
    this.time_s = Math.min(this.end_s, Math.max(this.start_s, time_s));
  }

  changeSpeed(places) {
    const index = kSpeeds.indexOf(this.speed) + places;
    this.speed = kSpeeds[Math.min(kSpeeds.length - 1, Math.max(0, index))];
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing && this.time_s >= this.end_s) this.time_s = this.start_s;
  }

  /** The run's time to show at `now_s`. */
  time(now_s) {
    if (this.playing) this.seek(this.time_s + this.speed * Math.min(0.1, now_s - this.before_s));
    if (this.time_s >= this.end_s) this.playing = false;
    this.before_s = now_s;
    return this.time_s;
  }
}

/** Space plays, arrows move or change speed, Home and End jump. */
function bindKeyboard(player) {
  const actions = {
    ' ': () => player.toggle(),
    ArrowLeft: (event) => player.seek(player.time_s - (event.shiftKey ? 1 : 0.05)),
    ArrowRight: (event) => player.seek(player.time_s + (event.shiftKey ? 1 : 0.05)),
    ArrowUp: () => player.changeSpeed(1),
    ArrowDown: () => player.changeSpeed(-1),
    Home: () => player.seek(player.start_s),
    End: () => player.seek(player.end_s),
  };
  document.addEventListener('keydown', (event) => {
    const action = actions[event.key];
    const owned = event.target.closest('select, button, input[type=checkbox], summary');
    if (!action || owned || event.ctrlKey || event.altKey || event.metaKey) return;
    event.preventDefault();
    action(event);
  });
}

/** Connects buttons, scrubber and speed list. Returns what shows the player there; that is false when all is shown. */
function bindControls(player) {
  const [play, scrubber, clock, speed] = ['play', 'scrubber', 'clock', 'speed'].map((id) => document.getElementById(id));
  for (const factor of kSpeeds) speed.append(new Option(`${factor}×`, String(factor)));
  Object.assign(scrubber, { min: player.start_s, max: player.end_s, step: 'any' });
  play.addEventListener('click', () => player.toggle());
  scrubber.addEventListener('input', () => player.seek(Number(scrubber.value)));
  speed.addEventListener('change', () => { player.speed = Number(speed.value); });
  let shown = '';
  return () => {
    const now = `${player.time_s} ${player.playing} ${player.speed}`;
    if (now === shown) return false;
    shown = now;
    play.textContent = player.playing ? '❚❚' : '▶';
    play.setAttribute('aria-label', player.playing ? 'Pause' : 'Play');
    scrubber.value = player.time_s;
    clock.textContent = `${player.time_s.toFixed(2)} / ${player.end_s.toFixed(1)} s`;
    speed.value = String(player.speed);
    return true;
  };
}
