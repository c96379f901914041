// A gamepad commands like the keys, with an enabling button. Nothing moves unless it is held, and letting go stops what
// the gamepad has moved. Stop needs no enabling. Indices are those of the W3C's standard layout.

const kPadPeriod_ms = 20;
const kPadStop = 1;
const kPadEnabling = [4, 5];
const kPadCommands = new Map([[0, 'walk'], [2, 'step'], [3, 'stand']]);
const kPadSpeedAxis = 1;  // left stick, forward is negative
const kPadDeadZone = 0.15;

/** Share of the largest speed, -1 to 1, that a stick at `deflection` asks for: 0 near its middle. */
function stickShare(deflection) {
  const beyond = (Math.abs(deflection) - kPadDeadZone) / (1 - kPadDeadZone);
  return beyond > 0 ? Math.sign(deflection) * Math.min(1, beyond) : 0;
}

class GamepadPanel {
  constructor(commands) {
    this.commands = commands;
    this.text = document.getElementById('gamepad');
    this.pressed = new Map();  // of each gamepad by its index: which buttons were
    this.enabledBy = null;
    this.moves = false;  // whether this gamepad has asked for motion since it was enabled
    document.addEventListener('visibilitychange', () => { if (document.hidden) this.release(); });
    setInterval(() => this.poll(), kPadPeriod_ms);
  }

  /** A browser shows gamepads only to pages of this machine or behind TLS, and once a button was pressed. */
  poll() {
    const pads = [...navigator.getGamepads?.() ?? []].filter((pad) => pad?.connected);
    for (const index of this.pressed.keys()) if (!pads.some((pad) => pad.index === index)) this.forget(index);
    for (const pad of pads) this.take(pad);
    this.describe(pads);
  }

  forget(index) {
    this.pressed.delete(index);
    if (this.enabledBy === index) this.release();
  }

  /** Only a press that was seen commands: what is held when a gamepad appears may be jammed. Stop is taken at once. */
  take(pad) {
    const now = pad.buttons.map((button) => button.pressed);
    const before = this.pressed.get(pad.index) ?? now.map((held, k) => held && pad.mapping === 'standard' && k !== kPadStop);
    this.pressed.set(pad.index, now);
    const begins = (k) => now[k] && !before[k];
    if (pad.mapping === 'standard' ? begins(kPadStop) : now.some((_, k) => begins(k))) this.stop();
    if (pad.mapping !== 'standard' || document.hidden) return;
    if (this.enabledBy === pad.index && !kPadEnabling.some((k) => now[k])) this.release();
    if (this.enabledBy === null && kPadEnabling.some(begins)) this.enabledBy = pad.index;
    if (this.enabledBy !== pad.index) return;
    this.steer(pad.axes[kPadSpeedAxis] ?? 0);
    for (const [k, command] of kPadCommands) if (begins(k)) this.ask(command);
  }

  stop() {
    this.moves = false;
    this.commands.ask('stop');
  }

  release() {
    this.enabledBy = null;
    if (this.moves) this.stop();
  }

  ask(command) {
    this.moves ||= command !== 'stand';
    this.commands.ask(command);
  }

  steer(deflection) {
    const share = -stickShare(deflection);
    if (this.commands.setSpeedShare(share)) this.moves = true;
  }

  describe(pads) {
    const [pad] = pads;
    const name = pad?.id.replace(/ \(.*/, '');
    const words = !pad ? '' : pads.every((one) => one.mapping !== 'standard')
      ? `Gamepad: the browser has no layout for ${name}, so each of its buttons stops, and it does nothing else.`
      : this.enabledBy === null ? `Gamepad ${name}: hold LB or RB to command. B stops.`
        : `Gamepad ${name} is enabled: left stick speed, A walk, X step, Y stand, B stop; letting go stops.`;
    if (this.text.textContent !== words) this.text.textContent = words;
    this.text.hidden = !pad;
    this.text.classList.toggle('enabled', this.enabledBy !== null);
  }
}
