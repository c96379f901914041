// Two runs in one page: the first as ever, the second dashed.

const kSecond = 'second.';  // before the names of its columns

/** Columns of both tables over the times of both. Values hold until the next one of their run, or for their row alone. */
function mergedTable(first, second, holds) {
  const times = Float64Array.from([...new Set([...first.time, ...second.time])].sort((a, b) => a - b));
  const names = ['time_s'];
  const values = [times];
  for (const [table, prefix] of [[first, ''], [second, kSecond]]) {
    const rows = Array.from(times, (time_s) => {
      const row = table.lastRowUpTo(time_s);
      const ended = time_s > table.newestTime || row < 0;
      return ended || (!holds && table.time[row] !== time_s) ? -1 : row;
    });
    for (const name of table.index.keys()) {
      if (name === 'time_s') continue;
      const column = table.column(name);
      names.push(prefix + name);
      values.push(Float32Array.from(rows, (row) => (row < 0 ? NaN : column[row])));
    }
  }
  return Table.of(names, values);
}

/** Puts the second run into the tables of the first. */
function joinRuns(first, second) {
  for (const run of [first, second]) {
    run.solveRows = run.tables.planner.rows > 0 ? [...plannerRows(run.summary), ...solveEndRows(run)] : [];
  }
  first.other = second;
  first.start_s = Math.min(first.start_s, second.start_s);
  first.end_s = Math.max(first.end_s, second.end_s);
  const merged = (name, holds) => mergedTable(first.tables[name], second.tables[name], holds);
  const ticks = merged('ticks', true);
  first.tables = { ...first.tables, ticks, truth: ticks, planner: merged('planner', true), steps: merged('steps', false) };
  return first;
}

/** The lines of a plot that are not planned, of both runs. */
function comparedLines(run, lines) {
  return lines.filter((line) => !line.dash).flatMap((line) => {
    const column = kSecond + line.column.replace(/^(true|estimated)_state/, run.other.stateGroup);
    const name = line.label === stateName(run) ? stateName(run.other) : line.label;
    return [line, { ...line, label: `${name}, second`, dash: [6, 4], width: 1.2, column }];
  });
}

/** File names without the folders that both have in common. */
function shortNames(names) {
  const parts = names.map((name) => name.split('/'));
  let same = 0;
  while (same < Math.min(...parts.map((list) => list.length)) - 1 && parts[0][same] === parts[1][same]) same += 1;
  return parts.map((list) => list.slice(same).join('/'));
}

function showComparisonHeader(run, names) {
  document.getElementById('robot-name').textContent = 'Comparison';
  document.getElementById('headline').textContent = `${names[0]} (in full) and ${names[1]} (dashed)`;
  document.getElementById('command-line').textContent = `${run.command_line}\n${run.other.command_line}`;
  showThinned(Math.max(run.stride, run.other.stride));
  const missing = [run, run.other].map((one, k) => [names[k], missingText(one)]).filter(([, text]) => text !== '');
  showMissing(missing.map(([name, text]) => `${name}: ${text}`).join('\n'));
}

/** Rows of the same name side by side, those of one run alone with a dash. */
function sideBySide(rowsOf, run) {
  const [mine, others] = [run, run.other].map((one) => new Map(rowsOf(one).map(([name, ...values]) => [name, values])));
  const width = Math.max(...[...mine.values(), ...others.values()].map((values) => values.length));
  return [...new Set([...mine.keys(), ...others.keys()])].map((name) => {
    const [a, b] = [mine, others].map((rows) => rows.get(name) ?? []);
    return [name, ...Array.from({ length: width }, (_, k) => [a[k] ?? '–', b[k] ?? '–']).flat()];
  });
}

/** Settings with another value in the second run: [key, value, value]. */
function differingSettings(run) {
  return sideBySide((one) => Object.entries(one.settings), run).filter(([, first, second]) => first !== second);
}

/** The pushes of a run, in its own time, as texts. A record of stiltd has none of them. */
function pushTexts({ pushes, controller, shift_s, tables: { ticks } }) {
  if (controller) return ['–'];
  if (pushes.length === 0) return ['none'];
  return pushes.map(({ force_N, from_s, to_s }) => {
    const [above_m] = ticks.before([ticks.column('push_above_hip_m')], from_s);
    const [from, to] = [from_s, to_s].map((time_s) => (time_s - shift_s).toFixed(2));
    return `${signed(force_N, 1)} N from ${from} to ${to} s, ${above_m.toFixed(2)} m above the hip`;
  });
}

/** The first texts of a list, and how many more there are. */
function firstOf(texts) {
  const more = texts.length - kMostPushes;
  return texts.slice(0, kMostPushes).join('; ') + (more > 0 ? ` and ${more} more` : '');
}

/** Pushes and settings with another value in the second run: [key, value, value]. */
function differences(run, withSettings) {
  const pushes = [run, run.other].map(pushTexts);
  const differ = pushesOf(run).length > 0 && pushes[0].join() !== pushes[1].join();
  return [...(differ ? [['pushes', ...pushes.map(firstOf)]] : []), ...(withSettings ? differingSettings(run) : [])];
}

function addSettings(container, run, names) {
  const without = names.filter((_, k) => Object.keys([run, run.other][k].settings).length === 0);
  const differing = differences(run, without.length === 0);
  addTable(container, 'Pushes and settings that differ', differing, ['', ...names]);
  const note = without.length > 0 ? `${without.join(' and ')} ${without.length > 1 ? 'name' : 'names'} no settings.`
    : differing.length === 0 ? 'All pushes and settings are the same.' : '';
  if (note) container.append(element('p', { className: 'hint', textContent: note }));
}

function showComparison(run, names) {
  const container = document.getElementById('summary');
  container.classList.add('compared');
  const heads = ['', ...names];
  addTable(group(container), 'Outcome', sideBySide(outcomeRows, run), heads);
  const settings = group(container);
  settings.classList.add('settings');
  addSettings(settings, run, names);
  [run, run.other].forEach(({ controller }, k) => {
    if (controller) addEvents(settings, controller.events, `of ${names[k]}`, false);
  });
  addTable(group(container), 'Joints', sideBySide((one) => jointRows(one.summary), run),
    ['', 'Peak torque, first', 'second', 'Peak speed, first', 'second']);
  const steps = group(container);
  addTable(steps, 'Steps', sideBySide((one) => stepRows(one.summary), run), heads);
  const planner = sideBySide((one) => one.solveRows, run);
  if (planner.length > 0) addTable(steps, 'Planner', planner, heads);
}
