// Samples over time: columns of numbers, ascending in time.

/** Rows of numbers in a ring: when it is full, a new row takes the place of the oldest. */
class Table {
  /** `names` of the columns, the first is the time; `capacity`: rows kept. */
  constructor(names, capacity) {
    this.index = new Map(names.map((name, k) => [name, k]));
    this.groups = new Map();
    this.capacity = capacity;
    this.values = names.map((_, k) => (k === 0 ? new Float64Array(capacity) : new Float32Array(capacity)));
    this.rows = 0;
    this.next = 0;
    this.appended = 0;
  }

  /** A table that is full from the start. */
  static of(names, values) {
    const rows = values[0].length;
    return Object.assign(new Table(names, 0), { values, capacity: rows, rows, appended: rows });
  }

  get time() {
    return this.values[0];
  }

  /** Column of that name; throws when there is none, so that a misspelling is seen at once. */
  column(name) {
    const k = this.index.get(name);
    if (k === undefined) throw new Error(`no column ${name}`);
    return this.values[k];
  }

  /** The columns name0, name1, ... */
  group(name) {
    if (!this.groups.has(name)) {
      const columns = [];
      while (this.index.has(name + columns.length)) columns.push(this.column(name + columns.length));
      this.groups.set(name, columns);
    }
    return this.groups.get(name);
  }

  addColumn(name, values) {
    this.index.set(name, this.values.push(values) - 1);
  }

  /** Opens a row at `time_s` and returns where it is; the caller writes the other columns there. */
  append(time_s) {
    const slot = this.next;
    this.time[slot] = time_s;
    this.next = (slot + 1) % this.capacity;
    if (this.rows < this.capacity) ++this.rows;
    ++this.appended;
    return slot;
  }

  /** Where row `row` is, 0 the oldest. */
  slot(row) {
    const slot = this.next - this.rows + row;
    return slot < 0 ? slot + this.capacity : slot;
  }

  get oldestTime() {
    return this.rows > 0 ? this.time[this.slot(0)] : null;
  }

  get newestTime() {
    return this.rows > 0 ? this.time[this.slot(this.rows - 1)] : null;
  }

  /** Row of the last sample that is not after `time_s`; -1 when all are. */
  lastRowUpTo(time_s) {
    let low = 0;
    let high = this.rows;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.time[this.slot(middle)] <= time_s) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /** Values of `columns` at `time_s`, linear between samples; null without samples up to then. */
  at(columns, time_s) {
    const row = this.lastRowUpTo(time_s);
    if (row < 0) return null;
    const a = this.slot(row);
    if (row + 1 >= this.rows) return columns.map((values) => values[a]);
    const b = this.slot(row + 1);
    const share = (time_s - this.time[a]) / Math.max(1e-9, this.time[b] - this.time[a]);
    return columns.map((values) => values[a] + share * (values[b] - values[a]));
  }

  /** Newest values of `columns` up to `time_s`; null without. */
  before(columns, time_s) {
    const row = this.lastRowUpTo(time_s);
    return row < 0 ? null : columns.map((values) => values[this.slot(row)]);
  }
}

/** One line of a plot as two points per bucket, smallest and largest in the order they came. */
function extremes(table, values, firstRow, bounds) {
  const out = new Array(2 * bounds.length);
  let row = firstRow;
  for (let bucket = 0; bucket < bounds.length; ++bucket) {
    let low = Infinity;
    let high = -Infinity;
    let lowRow = -1;
    let highRow = -1;
    for (; row < bounds[bucket]; ++row) {
      const value = values[table.slot(row)];
      if (value < low) { low = value; lowRow = row; }
      if (value > high) { high = value; highRow = row; }
    }
    const found = lowRow >= 0;
    out[2 * bucket] = found ? (lowRow <= highRow ? low : high) : null;
    out[2 * bucket + 1] = found ? (lowRow <= highRow ? high : low) : null;
  }
  return out;
}

/**
 * Data for uPlot of the rows between two times and of one row on either side. When they are few, all of them. Otherwise
 * smallest and largest of each of `buckets` equal times. These begin at multiples of their length, so that lines do not
 * shimmer. What is not finite becomes a gap.
 */
function windowOf(table, columns, from_s, to_s, buckets) {
  const first = Math.max(0, table.lastRowUpTo(from_s));
  const last = Math.min(table.rows - 1, table.lastRowUpTo(to_s) + 1);
  const count = last - first + 1;
  if (count <= 2 * buckets) {
    return [table.time, ...columns].map((values) => Array.from({ length: count }, (_, k) => {
      const value = values[table.slot(first + k)];
      return Number.isFinite(value) ? value : null;
    }));
  }
  const width = (to_s - from_s) / buckets;
  const start = Math.floor(from_s / width);
  const bounds = [];
  const times = [];
  for (let k = 0; k <= buckets; ++k) {
    const end = (start + k + 1) * width;
    bounds.push(Math.min(last, table.lastRowUpTo(end)) + 1);
    times.push(end - 0.75 * width, end - 0.25 * width);
  }
  return [times, ...columns.map((values) => extremes(table, values, first, bounds))];
}
