// The state of the robot and of the connection, in words.

const kStale_s = 0.5;
/** The monitor reports on the link ten times per second. */
const kUnreported_s = 1;
const kReactionText = {
  none: 'nothing', warn: 'nothing; it is only reported', slow: 'walking becomes stepping in place, and that standing',
  hold: 'holds the pose', sit: 'sits down, then damps the joints', damp: 'damps the joints', off: 'disables the drivers',
};
const kLevelText = {
  plan: 'following the newest plan', plan_feedback: 'following an aged plan', gait: 'following the gait library',
  hold: 'holding the pose',
  sit: 'sitting down', damp: 'joints damped', off: 'motors off',
};

/** What the robot does about a fault; `toml`: of the run, undefined where none is known. */
function reactionText(fault, toml) {
  if (fault.name !== 'emergency_stop') return kReactionText[fault.reaction];
  const damps_s = toml?.match(/^damped_before_off_s = ([\d.e+-]+)/m)?.[1];
  return `damps the joints${damps_s === undefined ? '' : ` for ${Number(damps_s)} s`}, then turns the motors off`;
}

/** Numbers of more than 32 bits are beyond the bitwise operators. */
const hasBit = (number, bit) => Math.floor(number / 2 ** bit) % 2 === 1;

class StatusPanel {
  /** `choose(runId)` asks for another run to be shown; `showPlots(titles)` leads to plots. */
  constructor(robot, choose, showPlots) {
    Object.assign(this, { robot, choose, showPlots });
    this.link = null;
    this.reported_s = 0;
    this.connected = false;
    this.fresh = false;
    this.runChanged_s = -Infinity;
    this.lastFaults = null;
    this.runsWritten = null;
  }

  greet(hello) {
    const table = element('table');
    table.createTHead().innerHTML = '<tr><th>Number</th><th>Fault</th><th>Cause</th><th>The robot</th><th>Clears when</th></tr>';
    const body = table.createTBody();
    for (const fault of hello.faults) {
      const row = body.insertRow();
      for (const text of [fault.number, fault.name, fault.cause, reactionText(fault), clearing(fault)]) {
        row.insertCell().textContent = text;
      }
      const button = plotButton(fault, fault.name, this.showPlots);
      if (button) row.cells[1].replaceChildren(button);
    }
    document.getElementById('fault-table').replaceChildren(table);
    this.forgetState();
  }

  /** Another monitor, or another time of a record: nothing is known of the robot. */
  forgetState() {
    const pill = document.getElementById('state');
    pill.textContent = '–';
    delete pill.dataset.state;
    document.getElementById('state-text').textContent = '';
    document.getElementById('fault-list').replaceChildren();
    document.body.classList.remove('faulty');
    this.lastFaults = null;
  }

  configure(configuration, isOther, now_s) {
    document.getElementById('robot-name').textContent = configuration.robot.toUpperCase();
    document.title = `${configuration.robot} – Stilt`;
    document.getElementById('configuration').textContent = configuration.toml;
    const facts = [['Run', configuration.run_id || 'not known'], ['Controller', configuration.build],
      ['Source', this.robot.hello.source]];
    if (configuration.drawn_instead) facts.push(['Picture', `of ${configuration.drawn_instead}: this URDF file is not on the monitor's computer`]);
    document.getElementById('run-list').replaceChildren(
      ...facts.flatMap(([name, value]) => [element('dt', { textContent: name }), element('dd', { textContent: value })]));
    if (isOther) this.runChanged_s = now_s;
  }

  /** Names of the faults that wait for a reset. */
  get latched() {
    return this.robot.hello.faults.filter((_, bit) => hasBit(this.robot.supervisor.latched, bit)).map(({ name }) => name);
  }

  /** The supervisor's state, the fallback level and the faults. */
  supervise(message) {
    const { hello } = this.robot;
    const name = hello.states[message.state].name;
    const pill = document.getElementById('state');
    pill.textContent = name;
    pill.dataset.state = name;
    document.getElementById('state-text').textContent =
      `${hello.states[message.state].description}. Now: ${kLevelText[hello.fallback_levels[message.fallback_level]] ?? hello.fallback_levels[message.fallback_level]}.` +
      (message.commander === '' ? ' No commander.'
        : ` In command: ${message.commander}${message.commander_alive ? '' : ', silent'}.`);
    this.showFaults(message);
  }

  showFaults(message) {
    const found = message.found ?? {};
    const key = `${message.present}/${message.latched}/${JSON.stringify(found)}`;
    if (key === this.lastFaults) return;
    this.lastFaults = key;
    const cards = this.robot.hello.faults.flatMap((fault, bit) => {
      const present = hasBit(message.present, bit);
      const latched = hasBit(message.latched, bit);
      if (!present && !latched) return [];
      const toPlot = plotButton(fault, 'Plot', this.showPlots);
      return [faultCard(fault, present, latched, found[fault.name], toPlot, this.robot.configuration?.toml)];
    });
    const list = document.getElementById('fault-list');
    list.replaceChildren(...(cards.length > 0 ? cards : [element('p', { className: 'fine', textContent: 'None.' })]));
    document.body.classList.toggle('faulty', message.latched !== 0);
  }

  /** Takes the monitor's report on the link to the source, which came at `now_s`. */
  report(link, now_s) {
    this.link = link;
    this.reported_s = now_s;
  }

  /** Says how old the picture is; called several times per second, also when no message comes. */
  update(now_s) {
    const { alarm, level, words, serious = true } = this.connectionAt(now_s);
    this.fresh = level === 'live';
    const box = document.getElementById('alarm');
    box.hidden = alarm === null;
    box.classList.toggle('serious', serious);
    if (alarm !== null && box.textContent !== alarm) box.textContent = alarm;
    document.body.classList.toggle('stale', level === 'stale');
    document.body.classList.toggle('waiting', level === 'waiting');
    document.getElementById('stage-cover').textContent = level === 'stale' ? 'STALE DATA' : level === 'waiting' ? 'NO DATA YET' : '';
    const note = document.getElementById('note');
    const fresh = now_s - this.runChanged_s < 15;
    note.hidden = !fresh;
    if (fresh) {
      note.textContent = `Another run is shown (${this.robot.configuration?.run_id}): the one before is silent, or this one was chosen. ` +
        'What was before it is gone from the plots, and it takes commands with its own token.';
    }
    this.writeEmergencyStop();
    this.writeRuns(this.connected ? this.link?.talking ?? [] : []);
    this.writeLink(words);
  }

  writeEmergencyStop() {
    const name = this.fresh ? this.link.emergency_stop : 'not known';
    const box = document.getElementById('emergency-stop');
    box.textContent = name ? `emergency stop ${name}` : '';
    box.classList.toggle('bad', name === 'pressed' || name === 'silent');
  }

  /** When several controllers send: which one is shown, and a button for each other. */
  writeRuns(talking) {
    const shown = this.robot.configuration?.run_id;
    const key = `${shown}/${talking.map((run) => run.run_id)}`;
    if (key === this.runsWritten) return;
    this.runsWritten = key;
    const box = document.getElementById('runs');
    box.hidden = talking.length < 2;
    const name = (run) => `${run.robot.toUpperCase()}, run ${run.run_id}`;
    const others = talking.filter((run) => run.run_id !== shown).map((run) => {
      const button = element('button', { type: 'button', textContent: `Show ${name(run)}` });
      button.addEventListener('click', () => this.choose(run.run_id));
      return button;
    });
    const here = talking.find((run) => run.run_id === shown);
    box.replaceChildren(element('span', {
      textContent: `${talking.length} controllers send. Shown and commanded: ${here ? name(here) : 'none of them'}. STOP goes to all whose token is known.`,
    }), ...others);
  }

  /** How old the picture is: its level, the alarm or null, whether that is serious, and the words at the top. */
  connectionAt(now_s) {
    const { link, robot: { hello } } = this;
    if (!this.connected) {
      return { level: 'stale', words: 'monitor lost', alarm: 'The monitor does not answer: stilt monitor has ended, or the network is gone. Trying again.' };
    }
    const unreported_s = now_s - this.reported_s;
    if (link && unreported_s > kUnreported_s) {
      return { level: 'stale', words: `silent ${unreported_s.toFixed(0)} s`,
        alarm: `Nothing from the monitor for ${unreported_s.toFixed(1)} s: the data are stale. stilt monitor hangs, or the network is gone.` };
    }
    if (!link?.received) {
      if (link?.refused) return { level: 'waiting', words: 'not readable', alarm: `Nothing can be shown: ${link.refused}.` };
      return { level: 'waiting', words: 'waiting', serious: false, alarm: `Waiting for a controller: nothing received yet from ${hello?.source ?? 'the source'}.` };
    }
    if (hello.live && link.behind_s > kStale_s) {
      return { level: 'stale', words: `${link.behind_s.toFixed(1)} s behind`,
        alarm: `This page is ${link.behind_s.toFixed(1)} s behind the monitor: the data are stale. The network or this computer is too slow.` };
    }
    if (hello.live && link.silent_s > kStale_s) {
      return { level: 'stale', words: `silent ${link.silent_s.toFixed(0)} s`,
        alarm: `No data for ${link.silent_s.toFixed(1)} s: the data are stale. ` +
          (link.refused ? `Nothing newer can be shown: ${link.refused}.` : 'stiltd has ended, or the network is gone.') };
    }
    return { level: 'live', words: hello.live ? 'live' : 'record', alarm: null };
  }

  writeLink(words) {
    const { link } = this;
    const lost = link ? link.missing + link.not_sent + (this.robot.timing?.dropped ?? 0) : 0;
    const box = document.getElementById('link-status');
    box.textContent = lost > 0 ? `${words} · ${lost} lost` : words;
    box.title = link ? `${link.ticks} ticks received; ${link.missing} missing on the way, ${this.robot.timing?.dropped ?? 0} ` +
      `dropped by the controller, ${link.not_sent} messages not sent to this page because it did not keep up` : '';
    box.classList.toggle('good', lost === 0 && words === 'live');
    box.classList.toggle('bad', words !== 'live' && words !== 'record');
    box.classList.toggle('warned', lost > 0);
  }
}

function clearing(fault) {
  return fault.severity === 'latched' ? `${fault.clears}; then Reset` : fault.clears;
}

/** `found`: joint or bus, driver, value and limit, in words; `toPlot`: button to its plot. Each may be missing, as `toml`. */
function faultCard(fault, present, latched, found, toPlot, toml) {
  const when = present ? 'happening now' : 'waits for Reset';
  return element('article', { className: `fault ${latched ? 'latched' : fault.severity}` },
    element('h3', {}, `${fault.name} `, element('small', { textContent: `${fault.number} · ${when}` }), ...(toPlot ? [toPlot] : [])),
    element('p', {}, `Cause: ${fault.cause}.`),
    ...(found ? [element('p', { className: 'found', textContent: `Found: ${found}.` })] : []),
    element('p', {}, `The robot: ${reactionText(fault, toml)}.`),
    element('p', {}, `Clears when: ${clearing(fault)}.`));
}
