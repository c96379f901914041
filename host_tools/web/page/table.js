// The last seconds of a stream of samples: columns of numbers in rings, ascending in time.

class RingTable {
  /** `columns`: names, the first is the time; `capacity`: rows kept. */
  constructor(columns, capacity) {
    this.columns = columns;
    this.index = new Map(columns.map((name, k) => [name, k]));
    this.capacity = capacity;
    this.time = new Float64Array(capacity);
    this.values = columns.map((_, k) => (k === 0 ? this.time : new Float32Array(capacity)));
    this.clear();
  }

  clear() {
    this.rows = 0;
    this.next = 0;
    this.appended = 0;
  }

  /** Column of that name; throws when there is none, so that a misspelling is seen at once. */
  column(name) {
    const k = this.index.get(name);
    if (k === undefined) throw new Error(`no column ${name}`);
    return this.values[k];
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

  /** Slot of the row `row`, 0 the oldest. */
  slot(row) {
    const first = this.next - this.rows;
    const slot = first + row;
    return slot < 0 ? slot + this.capacity : slot;
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

  /** Value of a column at `time_s`, linear between samples; null without samples up to then. */
  at(values, time_s) {
    const row = this.lastRowUpTo(time_s);
    if (row < 0) return null;
    const a = this.slot(row);
    if (row + 1 >= this.rows) return values[a];
    const b = this.slot(row + 1);
    const share = (time_s - this.time[a]) / Math.max(1e-9, this.time[b] - this.time[a]);
    return values[a] + share * (values[b] - values[a]);
  }

  /** Newest value up to `time_s`; null without. */
  before(values, time_s) {
    const row = this.lastRowUpTo(time_s);
    return row < 0 ? null : values[this.slot(row)];
  }
}

/** One line of a plot as two points a bucket, smallest and largest in the order they came. */
function extremesInto(out, table, values, firstRow, bounds) {
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
}

/**
 * Data for uPlot of the rows between two times: all of them when they are few, otherwise smallest and largest of
 * each of `buckets` equal times, which begin at multiples of their length so that lines do not shimmer.
 */
function windowOf(table, columns, from_s, to_s, buckets) {
  const first = Math.max(0, table.lastRowUpTo(from_s));
  const last = table.lastRowUpTo(to_s);
  const count = last - first + 1;
  if (count <= 0) return [[], ...columns.map(() => [])];
  if (count <= 2 * buckets) {
    const pick = (values) => Array.from({ length: count }, (_, k) => {
      const value = values[table.slot(first + k)];
      return Number.isFinite(value) ? value : null;
    });
    return [pick(table.time), ...columns.map(pick)];
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
  return [times, ...columns.map((values) => {
    const out = new Array(times.length);
    extremesInto(out, table, values, first, bounds);
    return out;
  })];
}
