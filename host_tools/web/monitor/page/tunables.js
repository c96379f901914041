// Values that may change while the robot moves. A value outside its range is not sent; the robot checks again.

/** As many digits as carry information. */
function shortNumber(value) {
  return String(Number(value.toPrecision(4)));
}

class TunablesPanel {
  constructor(commands) {
    this.commands = commands;
    this.list = document.getElementById('tunable-list');
    this.filter = document.getElementById('tunable-filter');
    this.filter.addEventListener('input', () => this.applyFilter());
    this.rows = new Map();
  }

  configure(tunables) {
    const known = [...this.rows.keys()].join();
    if (known === tunables.map((tunable) => tunable.name).join()) {
      for (const tunable of tunables) this.update(tunable);
      return;
    }
    this.rows.clear();
    this.list.replaceChildren();
    let section = null;
    for (const tunable of tunables) {
      const [group] = tunable.name.split('.');
      if (group !== section) this.list.append(element('h3', { textContent: `[${group}]` }));
      section = group;
      this.addRow(tunable);
    }
    document.getElementById('tunables').hidden = tunables.length === 0;
    this.applyFilter();
  }

  addRow(tunable) {
    const input = element('input', { type: 'number', step: 'any', min: tunable.min, max: tunable.max, value: tunable.value });
    const key = tunable.name.split('.').pop();
    const unit = tunable.unit === '1' ? '' : tunable.unit;
    input.setAttribute('aria-label', tunable.name);
    const say = element('small');
    const row = element('div', { className: 'tunable', title: tunable.description },
      element('label', {}, key), input, element('span', { className: 'unit', textContent: unit }), say);
    row.dataset.name = tunable.name;
    const entry = { tunable, input, row, say };
    input.addEventListener('input', () => this.check(entry));
    input.addEventListener('keydown', (event) => { if (event.key === 'Enter') this.apply(entry); });
    this.rows.set(tunable.name, entry);
    this.describe(entry);
    this.list.append(row);
  }

  describe(entry) {
    const { tunable } = entry;
    entry.say.textContent = `${shortNumber(tunable.min)} to ${shortNumber(tunable.max)}`;
    entry.row.classList.remove('wrong', 'changed');
  }

  /** The robot publishes the active values. */
  update(tunable) {
    const entry = this.rows.get(tunable.name);
    const typing = document.activeElement === entry.input && entry.row.classList.contains('changed');
    entry.tunable = tunable;
    if (typing) return;
    entry.input.value = tunable.value;
    this.describe(entry);
  }

  check(entry) {
    const value = Number(entry.input.value);
    const { min, max } = entry.tunable;
    const fits = entry.input.value !== '' && Number.isFinite(value) && value >= min && value <= max;
    entry.row.classList.toggle('wrong', !fits);
    entry.row.classList.toggle('changed', fits && value !== entry.tunable.value);
    entry.say.textContent = fits ? 'Enter applies' : `must be ${shortNumber(min)} to ${shortNumber(max)}`;
    return fits;
  }

  apply(entry) {
    if (!this.check(entry)) return;
    const value = Number(entry.input.value);
    entry.row.classList.remove('changed');
    this.commands.ask('tunable', { tunable: entry.tunable.name, value, what: `${entry.tunable.name} = ${value}` });
  }

  applyFilter() {
    const wanted = this.filter.value.trim().toLowerCase();
    for (const { row } of this.rows.values()) row.hidden = wanted !== '' && !row.dataset.name.includes(wanted);
  }
}
