// Starts the page and draws its frames.

const kStatusPeriod_s = 0.1;
const kEventsShown = 100;

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
        this.status.configure(message, before !== undefined && before !== message.session, now_s);
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

  addEvent(event) {
    const list = document.getElementById('event-list');
    list.prepend(element('li', { className: event.serious ? 'serious' : '' },
      element('time', { textContent: `${event.time_s.toFixed(2)} s` }), ` ${event.text}`));
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
    const pause = document.getElementById('pause');
    const togglePause = () => {
      this.paused_s = this.paused_s === null ? this.robot.clock.shown_s : null;
      const paused = this.paused_s !== null;
      pause.setAttribute('aria-pressed', String(paused));
      document.body.classList.toggle('paused', paused);
    };
    pause.addEventListener('click', togglePause);
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
