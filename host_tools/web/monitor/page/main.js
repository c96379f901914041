// Starts the page and draws its frames.

const kStatusPeriod_s = 0.1;
const kEventsShown = 100;
const kLookBackStep_s = 0.05;

class Monitor {
  constructor() {
    this.robot = new RobotState();
    this.status = new StatusPanel(this.robot);
    this.stage = new LiveStage(this.robot);
    this.plots = new LivePlots(this.robot, plotSections(this.robot), document.getElementById('plots'));
    this.timing = new TimingPanel();
    this.connection = new Connection(this);
    this.commands = new CommandPanel(this.connection, this.robot);
    this.tunables = new TunablesPanel(this.commands);
    this.paused_s = null;
    this.frames = [];
    this.status_s = 0;
    this.bindOptions();
    requestAnimationFrame((now_ms) => this.frame(now_ms));
  }

  opened() {
    this.status.connected = true;
    this.status.link = null;
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
        const before = this.robot.configuration?.session;
        this.robot.configure(message);
        const another = before !== undefined && before !== message.session;
        if (another && this.paused_s !== null) document.getElementById('pause').click();
        this.status.configure(message, another, now_s);
        this.tunables.configure(message.tunables);
        this.commands.configure(message);
      },
      supervisor: () => {
        this.robot.supervise(message);
        this.status.supervise(message);
      },
      event: () => this.addEvent(message),
      timing: () => {
        this.robot.timing = message;
        this.timing.show(message);
      },
      link: () => { this.status.link = message; },
      reply: () => this.commands.reply(message),
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

  frame(now_ms) {
    const now_s = now_ms / 1000;
    const time = this.paused_s ?? this.robot.clock.time(performance.now() / 1000);
    this.stage.draw(time, now_s);
    if (time !== null) this.plots.draw(time, now_s);
    if (now_s - this.status_s > kStatusPeriod_s) {
      this.status_s = now_s;
      this.status.update(now_s);
      this.countFrames(now_ms);
    }
    this.frames.push(now_ms);
    requestAnimationFrame((next_ms) => this.frame(next_ms));
  }

  countFrames(now_ms) {
    const kOver_ms = 2000;
    while (this.frames.length > 0 && this.frames[0] < now_ms - kOver_ms) this.frames.shift();
    if (this.frames.length < 2) return;
    const rate = ((this.frames.length - 1) * 1000) / (this.frames.at(-1) - this.frames[0]);
    const box = document.getElementById('frame-rate');
    box.textContent = `${rate.toFixed(0)} frames/s`;
    box.dataset.value = rate;
  }

  bindOptions() {
    const togglePause = this.bindPause();
    document.getElementById('window').addEventListener('change', (event) => { this.plots.window_s = Number(event.target.value); });
    const toggleTheme = () => this.setTheme(document.documentElement.dataset.theme === 'dark' ? 'light' : 'dark');
    document.getElementById('theme').addEventListener('click', toggleTheme);
    document.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey || event.target.closest('input, select')) return;
      if (event.key === 'p') togglePause();
      if (event.key === 'l') toggleTheme();
    });
    const asked = new URLSearchParams(window.location.hash.slice(1)).get('theme') ?? localStorage.getItem('theme');
    followTheme(asked, () => this.recolour());
    this.recolour();
  }

  /** While the picture is paused a slider looks back, as far as the page remembers. Returns what toggles. */
  bindPause() {
    const pause = document.getElementById('pause');
    const back = document.getElementById('back');
    const look = () => {
      this.paused_s = this.pausedAt_s + Number(back.value);
      document.getElementById('back-value').textContent = `${signed(Number(back.value), 2)} s`;
    };
    const toggle = () => {
      const pausing = this.paused_s === null && this.robot.clock.shown_s !== null;
      this.pausedAt_s = this.robot.clock.shown_s;
      this.paused_s = null;
      this.robot.pauseAt(pausing ? this.pausedAt_s : null);
      if (pausing) {
        const { ticks } = this.robot.tables;
        back.min = String(-Math.floor(Math.min(kLookBack_s, this.pausedAt_s - ticks.time[ticks.slot(0)])));
        back.value = '0';
        look();
      }
      pause.setAttribute('aria-pressed', String(pausing));
      document.getElementById('look-back').hidden = !pausing;
    };
    pause.addEventListener('click', toggle);
    back.addEventListener('input', look);
    document.addEventListener('keydown', (event) => {
      const step = { ArrowLeft: -kLookBackStep_s, ArrowRight: kLookBackStep_s }[event.key];
      if (step === undefined || this.paused_s === null || event.target.closest('input, select')) return;
      back.value = String(Number(back.value) + step);
      look();
      event.preventDefault();
    });
    return toggle;
  }

  setTheme(theme) {
    localStorage.setItem('theme', theme);
    document.documentElement.dataset.theme = theme;
    this.recolour();
  }

  recolour() {
    this.stage.recolour();
    this.plots.recolour();
    this.timing.recolour();
  }
}

new Monitor();
