// Buttons and keys, and the page's sign of life while it commands.

const kAlivePeriod_ms = 100;
const kSpeedPeriod_ms = 100;
const kPatience_ms = 3000;
const kHeightTunable = 'reference.base_height_m';
/** States in which the robot stands, and the commands that lead there. */
const kOnItsFeet = ['stand', 'step', 'walk'];
/** Also by a page whose data are stale. */
const kAlwaysSent = ['stop', 'cut'];
const kKeys = { s: 'stand', t: 'step', w: 'walk', d: 'sit', r: 'reset' };

/** A link, and its QR code for the camera of a phone. */
function linkItem(link) {
  const code = qrPicture(link, 'QR code of this link');
  return element('li', {}, element('a', { href: link, textContent: link }), ...(code ? [code] : []));
}

/** Says under the pointer why a control is grey; without a reason, what it does. */
function explain(control, reason) {
  control.title0 ??= control.title;
  control.title = reason === undefined ? control.title0 : `Not now: ${reason}`;
}

class CommandPanel {
  constructor(connection, robot) {
    this.connection = connection;
    this.robot = robot;
    this.sequence = 0;
    this.waiting = new Map();
    this.answer = document.getElementById('answer');
    this.token = document.getElementById('token');
    this.access = { has_key: false, has_token: false };
    this.speed = document.getElementById('speed');
    this.speedSent_ms = 0;
    this.height = document.getElementById('height');
    this.takeLink();
    window.addEventListener('hashchange', () => this.followLink());
    this.token.addEventListener('input', () => this.keepToken());
    document.getElementById('new-key').addEventListener('click', () => this.connection.send({ new_key: true }));
    document.getElementById('token-form').addEventListener('submit', (event) => event.preventDefault());
    for (const button of document.querySelectorAll('[data-command]')) {
      button.addEventListener('click', () => this.ask(button.dataset.command));
    }
    document.getElementById('stop').addEventListener('click', () => this.ask('stop'));
    document.getElementById('cut').addEventListener('click', () => this.ask('cut'));
    this.speed.addEventListener('input', () => this.changeSpeed());
    this.showSpeed();
    this.height.addEventListener('input', () => this.showHeight());
    this.height.addEventListener('change', () => this.changeHeight());
    document.addEventListener('keydown', (event) => this.key(event), true);
    this.beat();
  }

  /**
   * Takes key or token out of the address of a link. The key stays in the storage of this origin. A cookie would go to
   * every port of the host, so also to what another user serves there.
   */
  takeLink() {
    const words = new URLSearchParams(window.location.hash.slice(1));
    if (words.has('key')) localStorage.setItem('key', words.get('key'));
    this.tokens = JSON.parse(sessionStorage.getItem('tokens') ?? '{}');
    this.given = words.get('token') ?? '';
    if (this.given !== '') this.token.value = this.given;
    words.delete('key');
    words.delete('token');
    history.replaceState(null, '', `${window.location.pathname}${words.toString() && `#${words}`}`);
  }

  /** A link was entered in the address bar of the open page, which does not load it again. */
  followLink() {
    this.takeLink();
    this.useGivenToken();
    this.present();
  }

  /** The connection is open: the monitor takes the key before any command, and reports what the page may do. */
  present() {
    this.linkTime_s = undefined;  // another monitor has another clock
    this.connection.send({ key: localStorage.getItem('key') ?? 'none' });
  }

  /** What this page may do now. */
  admit(access) {
    this.access = access;
    if (access.has_key) localStorage.setItem('key', access.key);
    document.getElementById('access').textContent = this.accessText();
    document.getElementById('links').hidden = !access.has_key;
    document.getElementById('link-list').replaceChildren(...access.urls.map((url) => linkItem(`${url}#key=${access.key}`)));
    document.getElementById('no-link').hidden = access.urls.length > 0;
    document.getElementById('link-box').hidden = access.urls.length === 0;
    this.openTokenBox();
  }

  accessText() {
    if (!this.access.has_key) {
      return 'This page only looks. It commands when it is opened by the link that stilt monitor printed, or with the token of the run.';
    }
    return this.access.has_token ? 'This page commands with the token that the monitor read.'
      : 'The monitor cannot read the token of this run: enter it.';
  }

  openTokenBox() {
    const commands = (this.access.has_key && this.access.has_token) || this.token.value !== '';
    document.getElementById('token-box').open = Boolean(this.robot.hello?.live) && !commands;
  }

  /** Tokens are of a run; those of all runs stop theirs. */
  keepToken() {
    const run = this.robot.configuration?.run_id;
    if (run === undefined) return;
    if (this.token.value === '') delete this.tokens[run];
    else this.tokens[run] = this.token.value;
    sessionStorage.setItem('tokens', JSON.stringify(this.tokens));
  }

  /** The token of a link is of the run that is shown when it is known. */
  useGivenToken() {
    if (this.run === undefined) return;
    this.given = '';
    this.keepToken();
    this.openTokenBox();
  }

  /** The run that is shown is this one from now on. */
  enterRun(run) {
    if (run === this.run) return;
    this.run = run;
    this.token.value = this.given || this.tokens[run] || '';
    this.useGivenToken();
  }

  greet(hello) {
    for (const button of document.querySelectorAll('[data-command], #stop, #cut')) button.disabled = !hello.live;
    for (const id of ['gaits', 'sliders', 'token-box', 'stop', 'cut']) document.getElementById(id).hidden = !hello.live;
    if (!hello.live) this.say(`A record: it takes no commands. ${hello.source}`, '');
  }

  /** Buttons that the robot would refuse are grey and say why. `latched`: names of faults that wait for a reset. */
  supervise(state, latched) {
    const sits = latched.length > 0 && kOnItsFeet.includes(state.name);
    const reason = `the robot sits down because of ${latched.join(' and ')}, which then takes a reset`;
    this.refused = { ...(sits ? Object.fromEntries(kOnItsFeet.map((command) => [command, reason])) : {}), ...state.refused };
    for (const button of document.querySelectorAll('[data-command]')) {
      button.setAttribute('aria-disabled', String(this.refused[button.dataset.command] !== undefined));
      explain(button, this.refused[button.dataset.command]);
    }
    this.admitHeight();
  }

  /** There is a height to change, of a robot that takes it. */
  admitHeight() {
    const refused = this.refused?.height;
    this.height.disabled = this.activeHeight_m === undefined || !this.robot.hello.live || refused !== undefined;
    explain(this.height, refused);
  }

  /** The sliders go as far as the controller lets. */
  configure(configuration) {
    this.enterRun(configuration.run_id);
    this.configureHeight(configuration.tunables.find((tunable) => tunable.name === kHeightTunable));
    const limit = Number(configuration.toml.match(/^speed_limit_m_s = ([\d.e+-]+)/m)?.[1]);
    if (!(limit > 0)) return;
    this.speed.min = String(-limit);
    this.speed.max = String(limit);
    this.showSpeed();
  }

  configureHeight(tunable) {
    this.activeHeight_m = tunable?.value;
    this.admitHeight();
    if (tunable === undefined) return;
    this.height.min = String(tunable.min);
    this.height.max = String(tunable.max);
    this.showActiveHeight();
  }

  showHeight() {
    document.getElementById('height-value').textContent = `${Number(this.height.value).toFixed(3)} m`;
  }

  /** Asked for when the slider is released, as the planner's terminal cost is worked out anew for each. */
  changeHeight() {
    this.showHeight();
    const value = Number(this.height.value);
    this.ask('height', { value, what: `hip height ${value.toFixed(3)} m` });
  }

  nudgeHeight(steps) {
    if (this.height.disabled && this.refused?.height === undefined) return;
    this.height.value = String(Number(this.height.value) + 0.01 * steps);
    this.changeHeight();
  }

  /** Why a command is not even sent; undefined: it is. What the robot would refuse is not known from stale data. */
  unsent(command) {
    if (!document.body.classList.contains('stale')) return this.refused?.[command];
    return kAlwaysSent.includes(command) ? undefined
      : 'not sent, because the data are stale and it would act later; Stop and Motors off are sent';
  }

  /** Sends a command; the answer appears below the buttons. */
  ask(command, extra = {}) {
    const reason = this.unsent(command);
    if (reason !== undefined) {
      this.say(`${command}: ${reason}${/from (stand|ready)/.test(reason) && !this.refused.stand ? '. Press Stand first' : ''}`, 'bad');
      this.showActiveHeight();
      return;
    }
    const sequence = ++this.sequence;
    const message = { command, sequence, token: this.token.value, link_time_s: this.linkTime_s, ...extra };
    if (command === 'stop') message.tokens = this.tokens;
    if (command === 'walk' && extra.value === undefined) message.value = Number(this.speed.value);
    if (!this.connection.send(message)) {
      this.say(`${command}: not sent, the monitor does not answer`, 'bad');
      return;
    }
    const what = extra.what ?? (command === 'walk' ? `walk at ${signed(message.value, 2)} m/s` : command);
    const asked = { what, doubt: '' };
    asked.timer = setTimeout(() => this.say(`${what}: no answer from the robot yet${asked.doubt}`, 'bad'), kPatience_ms);
    this.waiting.set(sequence, asked);
  }

  /** Anybody may send a refusal without proof of the token: the robot's own reply is still waited for. */
  replyOfSomebody(message) {
    const asked = this.waiting.get(message.sequence);
    if (!asked) return;
    const doubt = `refused by somebody without this token: ${message.reason}`;
    asked.doubt = `; ${doubt}`;
    this.say(`${asked.what}: ${doubt}`, 'bad');
    this.showActiveHeight();
  }

  reply(message) {
    if (!message.proven) {
      this.replyOfSomebody(message);
      return;
    }
    const asked = this.waiting.get(message.sequence);
    if (!asked) {
      if (!message.accepted) this.say(message.reason, 'bad');
      return;
    }
    clearTimeout(asked.timer);
    this.waiting.delete(message.sequence);
    if (message.accepted) this.say(`${asked.what}: accepted${message.reason && `; ${message.reason}`}`, message.reason ? '' : 'good');
    else this.say(`${asked.what}: refused. ${message.reason}`, 'bad');
    if (!message.accepted) this.showActiveHeight();
  }

  showActiveHeight() {
    if (this.activeHeight_m === undefined) return;
    this.height.value = String(this.activeHeight_m);
    this.showHeight();
  }

  say(text, kind) {
    this.answer.textContent = text;
    this.answer.className = kind;
  }

  showSpeed() {
    document.getElementById('speed-value').textContent = `${signed(Number(this.speed.value), 2)} m/s`;
  }

  get walks() {
    return this.robot.hello?.states[this.robot.supervisor?.state]?.name === 'walk';
  }

  /** Sets the slider to a share, -1 to 1, of the largest speed in that direction; whether a robot that walks is sent it. */
  setSpeedShare(share) {
    const before = this.speed.value;
    this.speed.value = String(Math.abs(share) * Number(share < 0 ? this.speed.min : this.speed.max));
    if (this.speed.value === before) return false;
    this.changeSpeed();
    return this.walks;
  }

  /** While the robot walks a new speed is sent at once, at most ten times per second. */
  changeSpeed() {
    this.showSpeed();
    if (!this.walks || this.speedTimer) return;
    const wait = Math.max(0, this.speedSent_ms + kSpeedPeriod_ms - performance.now());
    this.speedTimer = setTimeout(() => {
      this.speedTimer = null;
      this.speedSent_ms = performance.now();
      const value = Number(this.speed.value);
      this.ask('speed', { value, what: `speed ${signed(value, 2)} m/s` });
    }, wait);
  }

  nudge(steps) {
    this.speed.value = String(Number(this.speed.value) + 0.05 * steps);
    this.changeSpeed();
  }

  /** Space and Escape stop, with Shift they cut, wherever the focus is; buttons answer to Enter. */
  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (event.key === ' ' || event.key === 'Escape') {
      event.preventDefault();
      event.stopPropagation();
      if (!event.repeat) this.ask(event.shiftKey ? 'cut' : 'stop');
      return;
    }
    if (event.target.closest('input:not([type=range]):not([type=checkbox]), select, textarea') || event.repeat) return;
    const command = kKeys[event.key.toLowerCase()];
    if (command) this.ask(command);
    else if (event.key === 'ArrowUp' && event.target !== this.speed) this.nudge(1);
    else if (event.key === 'ArrowDown' && event.target !== this.speed) this.nudge(-1);
    else if (event.key === '+' || event.key === '=') this.nudgeHeight(1);
    else if (event.key === '-') this.nudgeHeight(-1);
    else return;
    event.preventDefault();
  }

  /** A worker keeps time even when the page is in the background; it stops when the page hangs. */
  beat() {
    const source = `setInterval(() => postMessage(0), ${kAlivePeriod_ms});`;
    const worker = new Worker(URL.createObjectURL(new Blob([source], { type: 'text/javascript' })));
    worker.onmessage = () => this.connection.send({ alive: true, link_time_s: this.linkTime_s });
    this.worker = worker;
  }
}
