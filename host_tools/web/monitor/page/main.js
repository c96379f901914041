// Starts the page and draws its frames.

const kStatusPeriod_s = 0.1;
const kNumbersPeriod_s = 0.2;
/** Wider lines take a browser without a graphics processor twice as long, more than all else on the page together. */
const kLineWidth_px = 1;
const kEventsShown = 100;
const kLookBackStep_s = 0.05;

class Monitor {
  constructor() {
    this.robot = new RobotState();
    this.status = new StatusPanel(this.robot, (run) => this.connection.send({ run }), (titles) => this.plots.pointOut(titles));
    this.plots = new PlotGroup({
      data: this.robot, clock: this.robot.clock, sections: plotSections(this.robot),
      container: document.getElementById('plots'), follow_s: 10, lineWidth_px: kLineWidth_px,
    });
    this.viewer = new Viewer({
      data: this.robot, clock: this.robot.clock, plots: this.plots, drawn: (...frame) => this.drawn(...frame),
    });
    this.timing = new TimingPanel();
    this.connection = new Connection(this);
    this.commands = new CommandPanel(this.connection, this.robot);
    this.gamepad = new GamepadPanel(this.commands);
    this.keys = new KeyList();
    this.record = new RecordBar(this.connection, this.robot.clock);
    this.tunables = new TunablesPanel(this.commands);
    this.frames_s = [];
    this.numbers_s = 0;
    this.status_s = 0;
    this.bindOptions();
  }

  opened() {
    this.status.connected = true;
    this.status.link = null;
    this.commands.present();
  }

  closed() {
    this.status.connected = false;
  }

  text(message) {
    const now_s = performance.now() / 1000;
    const takers = {
      hello: () => {
        this.robot.greet(message);
        this.status.greet(message);
        this.commands.greet(message);
        document.getElementById('event-list').replaceChildren();
      },
      configuration: () => {
        const before = this.robot.configuration?.run_id;
        this.robot.configure(message);
        const another = before !== undefined && before !== message.run_id;
        if (another) document.getElementById('event-list').replaceChildren();
        this.status.configure(message, another, now_s);
        this.tunables.configure(message.tunables);
        this.commands.configure(message);
      },
      supervisor: () => {
        this.robot.supervisor = message;
        this.status.supervise(message);
        this.commands.supervise(this.robot.hello.states[message.state], this.status.latched);
      },
      event: () => this.addEvent(message),
      timing: () => {
        this.robot.timing = message;
        this.timing.show(message);
      },
      link: () => {
        this.status.report(message, now_s);
        this.commands.linkTime_s = message.time_s;
        this.record.show(message.playback);
      },
      reply: () => this.commands.reply(message),
      access: () => this.commands.admit(message),
    };
    takers[message.type]?.();
  }

  table(table) {
    this.robot.take(table, performance.now() / 1000);
  }

  /** Newest on top; what happens again and again is one line with a count. */
  addEvent(event) {
    const list = document.getElementById('event-list');
    const newest = list.firstElementChild;
    const again = newest?.dataset.text === event.text;
    const count = again ? Number(newest.dataset.count) + 1 : 1;
    if (again) newest.remove();
    const line = element('li', { className: event.serious ? 'serious' : event.warning ? 'warned' : '' },
      element('time', { textContent: `${event.time_s.toFixed(2)} s` }),
      element('span', { textContent: count > 1 ? `${event.text} (${count} times)` : event.text }));
    Object.assign(line.dataset, { text: event.text, count });
    list.prepend(line);
    while (list.children.length > kEventsShown) list.lastChild.remove();
  }

  /** What changes with every frame beside stage and plots. */
  drawn(time_s, state, now_s) {
    this.noteFirstMotion(state);
    this.showPause();
    if (now_s - this.numbers_s > kNumbersPeriod_s) {
      this.numbers_s = now_s;
      this.writeNumbers(time_s, state);
    }
    if (now_s - this.status_s > kStatusPeriod_s) {
      this.status_s = now_s;
      this.status.update(now_s);
      this.countFrames(now_s);
    }
    this.frames_s.push(now_s);
  }

  /** For measuring how long it takes until the page shows a robot that moves. */
  noteFirstMotion(state) {
    if (this.moved || !state) return;
    this.firstState ??= state;
    this.moved = state.some((value, k) => value !== this.firstState[k]);
    if (this.moved) performance.mark('first-moving-frame');
  }

  writeNumbers(time_s, state) {
    const speed = state && this.status.fresh ? this.robot.speedAt(time_s) : null;
    const box = document.getElementById('speed-now');
    box.textContent = speed === null ? '–' : signed(speed, 2);
    box.dataset.value = speed ?? '';
    if (state) document.getElementById('stage-canvas').dataset.hipX = state[0];
    document.getElementById('stage-detail').textContent = !state ? (time_s === null ? '' : 'The joints do not answer, so no pose is known')
      : this.robot.hipUnknown ? kHipUnknown
      : `x ${signed(state[0], 2)} m · hip ${state[1].toFixed(3)} m high · pitch ${signed((state[2] * 180) / Math.PI, 1)}°`;
  }

  countFrames(now_s) {
    const kOver_s = 2;
    while (this.frames_s.length > 0 && this.frames_s[0] < now_s - kOver_s) this.frames_s.shift();
    if (this.frames_s.length < 2) return;
    const rate = (this.frames_s.length - 1) / (this.frames_s.at(-1) - this.frames_s[0]);
    const box = document.getElementById('frame-rate');
    box.textContent = `${rate.toFixed(0)} frames/s`;
    box.dataset.value = rate;
  }

  bindOptions() {
    this.bindPause();
    document.getElementById('window').addEventListener('change', (event) => { this.plots.follow_s = Number(event.target.value); });
    const toggleTheme = () => this.setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    document.getElementById('theme').addEventListener('click', toggleTheme);
    document.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.target.closest('input:not([type=range]):not([type=checkbox]), select')) return;
      if (event.key === 'p') this.togglePause();
      if (event.key === 'l') toggleTheme();
    });
    const asked = new URLSearchParams(window.location.hash.slice(1)).get('theme') ?? localStorage.getItem('theme');
    followTheme(asked, () => this.recolour());
    this.recolour();
  }

  /** A record stands still itself, on every page. */
  togglePause() {
    if (!this.record.toggleHold()) this.robot.clock.toggle();
  }

  /** A bar looks back, as far as the page keeps data; who moves it pauses the picture. */
  bindPause() {
    const { clock } = this.robot;
    this.back = document.getElementById('back');
    document.getElementById('pause').addEventListener('click', () => this.togglePause());
    this.back.addEventListener('input', () => {
      if (clock.playing) clock.toggle();
      clock.seek(clock.end_s + Number(this.back.value));
    });
    document.addEventListener('keydown', (event) => {
      const step_s = { ArrowLeft: -kLookBackStep_s, ArrowRight: kLookBackStep_s }[event.key];
      if (step_s === undefined || clock.playing || event.target.closest('input, select')) return;
      clock.seek(clock.held_s + step_s);
      event.preventDefault();
    });
  }

  showPause() {
    const { clock, hello } = this.robot;
    const remembered_s = Math.floor(clock.end_s - clock.start_s);
    const shown = `${clock.held_s} ${remembered_s} ${hello?.live}`;
    if (shown === this.shownPause) return;
    this.shownPause = shown;
    document.getElementById('pause').setAttribute('aria-pressed', String(!clock.playing));
    document.getElementById('look-back').hidden = clock.playing && !hello?.live;
    const back_s = clock.playing ? 0 : clock.held_s - clock.end_s;
    this.back.min = String(-remembered_s);
    this.back.value = String(back_s);
    this.back.title = `The last ${remembered_s} s are remembered, ${kLookBack_s} s at most, in ${Math.round(this.robot.bytes / 1e6)} MB. Left and right arrow`;
    document.getElementById('back-value').textContent = clock.playing ? 'live' : `${signed(back_s, 2)} s`;
  }

  setTheme(theme) {
    localStorage.setItem('theme', theme);
    document.documentElement.dataset.theme = theme;
    this.recolour();
  }

  recolour() {
    this.viewer.recolour();
    this.timing.recolour();
  }
}

new Monitor();
