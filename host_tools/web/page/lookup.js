// Finding and interpolating in ascending times.

/** Index of the last entry of ascending `times` that is not after `time`; 0 before the first. */
function lastIndexUpTo(times, time) {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle] <= time) low = middle + 1;
    else high = middle;
  }
  return Math.max(0, low - 1);
}

/** Value of a column at `time`, linear between samples. */
function interpolate(times, column, time) {
  const i = lastIndexUpTo(times, time);
  if (i + 1 >= times.length || time <= times[i]) return column[i];
  return column[i] + ((time - times[i]) / (times[i + 1] - times[i])) * (column[i + 1] - column[i]);
}
