// The clock of the page: current time, playing, speed. Everything that shows the time listens to it.

const kSpeeds = [0.1, 0.25, 0.5, 1, 2];

class Player {
  constructor(start_s, end_s) {
    this.start_s = start_s;
    this.end_s = end_s;
    this.time_s = start_s;
    this.speed = 1;
    this.playing = false;
    this.listeners = [];
    this.lastFrame_ms = null;
  }

  /** `listener(player)` is called after each change of time, speed or playing. */
  listen(listener) {
    this.listeners.push(listener);
    listener(this);
  }

  notify() {
    for (const listener of this.listeners) listener(this);
  }

  seek(time_s) {
    this.time_s = Math.min(this.end_s, Math.max(this.start_s, time_s));
    this.notify();
  }

  changeSpeed(places) {
    const index = kSpeeds.indexOf(this.speed) + places;
    this.speed = kSpeeds[Math.min(kSpeeds.length - 1, Math.max(0, index))];
    this.notify();
  }

  toggle() {
    this.playing = !this.playing;
    if (this.playing) {
      if (this.time_s >= this.end_s) this.time_s = this.start_s;
      this.lastFrame_ms = null;
      requestAnimationFrame((now) => this.frame(now));
    }
    this.notify();
  }

  frame(now_ms) {
    if (!this.playing) return;
    const elapsed_ms = this.lastFrame_ms === null ? 0 : Math.min(100, now_ms - this.lastFrame_ms);
    this.lastFrame_ms = now_ms;
    this.time_s = Math.min(this.end_s, this.time_s + (this.speed * elapsed_ms) / 1000);
    if (this.time_s >= this.end_s) this.playing = false;
    this.notify();
    if (this.playing) requestAnimationFrame((now) => this.frame(now));
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

/** Connects buttons, scrubber and speed list. */
function bindControls(player) {
  const play = document.getElementById('play');
  const scrubber = document.getElementById('scrubber');
  const clock = document.getElementById('clock');
  const speed = document.getElementById('speed');
  for (const factor of kSpeeds) speed.append(new Option(`${factor}×`, String(factor)));
  scrubber.min = player.start_s;
  scrubber.max = player.end_s;
  scrubber.step = 'any';
  play.addEventListener('click', () => player.toggle());
  scrubber.addEventListener('input', () => player.seek(Number(scrubber.value)));
  speed.addEventListener('change', () => {
    player.speed = Number(speed.value);
    player.notify();
  });
  player.listen(() => {
    play.textContent = player.playing ? '❚❚' : '▶';
    play.setAttribute('aria-label', player.playing ? 'Pause' : 'Play');
    scrubber.value = player.time_s;
    clock.textContent = `${player.time_s.toFixed(2)} / ${player.end_s.toFixed(1)} s`;
    speed.value = String(player.speed);
  });
}
