// Reads the run that host_tools/web/report/run_data.cc wrote into the page.

/** Decodes packed columns into {group name: [Float32Array a column]}. */
function unpackColumns(packed) {
  const bytes = Uint8Array.from(atob(packed.float32_base64), (c) => c.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const littleEndian = new Uint8Array(new Uint16Array([1]).buffer)[0] === 1;
  const numbers = littleEndian
    ? new Float32Array(bytes.buffer)
    : Float32Array.from({ length: bytes.length / 4 }, (_, i) => view.getFloat32(4 * i, true));
  const table = { rows: packed.rows };
  let next = 0;
  for (const group of packed.groups) {
    table[group.name] = [];
    for (let column = 0; column < group.width; ++column) {
      table[group.name].push(numbers.subarray(next, next + packed.rows));
      next += packed.rows;
    }
  }
  return table;
}

function readRun() {
  const run = JSON.parse(document.getElementById('run-data').textContent);
  const stride = run.samples.stride;
  run.samples = unpackColumns(run.samples);
  run.samples.stride = stride;
  run.samples.time = run.samples.time_s[0];
  run.plans.knots = unpackColumns(run.plans.knots);
  run.solves = { ...unpackColumns(run.solves), status_names: run.solves.status_names };
  const times = run.samples.time;
  run.start_s = times.length ? times[0] : 0;
  run.end_s = times.length ? times[times.length - 1] : 1;
  run.pushes = findPushes(run.samples);
  return run;
}

/** Intervals of non-zero push: [{from_s, to_s, force_N}]. */
function findPushes(samples) {
  const pushes = [];
  const force = samples.push_N[0];
  for (let i = 0; i < samples.rows; ++i) {
    if (force[i] === 0) continue;
    const last = pushes[pushes.length - 1];
    if (i > 0 && last && force[i] === force[i - 1]) last.to_s = samples.time[i];
    else pushes.push({ from_s: samples.time[i], to_s: samples.time[i], force_N: force[i] });
  }
  return pushes;
}

/** State x (14 numbers) of one of the three state groups at `time`. */
function stateAt(run, group, time) {
  return run.samples[group].map((column) => interpolate(run.samples.time, column, time));
}
