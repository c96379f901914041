// Windows of time to choose from.

const kWindow_s = 8;
const kBeforePush_s = 2;
const kMostPushes = 6;

/** The whole run and, when it is long, a window at each push or at the start. */
function viewsOf(run) {
  const { start_s, end_s } = run;
  const pushes = pushesOf(run);
  const views = [{ name: 'Whole run', window: [start_s, end_s] }];
  if (end_s - start_s < 1.5 * kWindow_s) return views;
  const windowAt = (from) => {
    const first = Math.max(start_s, Math.min(from, end_s - kWindow_s));
    return [first, first + kWindow_s];
  };
  for (const push of pushes.slice(0, kMostPushes)) {
    views.push({
      name: `Push of ${signed(push.force_N, 0)} N at ${push.from_s.toFixed(1)} s${push.second ? ', second' : ''}`,
      window: windowAt(push.from_s - kBeforePush_s),
    });
  }
  if (pushes.length === 0) views.push({ name: `${kWindow_s} s`, window: windowAt(start_s) });
  return views;
}

function addViewButtons(views, plots) {
  for (const view of views) {
    const button = element('button', { type: 'button', textContent: view.name });
    button.addEventListener('click', () => plots.show(...view.window));
    document.getElementById('views').append(button);
  }
}
