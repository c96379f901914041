// Colours: defined once in page.css, read here for the canvases and plots.

/** Applies the theme asked for in the fragment, or the system's, and calls `changed` when that changes. */
function followTheme(asked, changed) {
  const root = document.documentElement;
  if (asked === 'light' || asked === 'dark') {
    root.dataset.theme = asked;
    return;
  }
  const system = window.matchMedia('(prefers-color-scheme: dark)');
  const apply = () => { root.dataset.theme = system.matches ? 'dark' : 'light'; };
  apply();
  system.addEventListener('change', () => { apply(); changed(); });
}

const colourNames = ['text', 'muted', 'line', 'card', 'sky', 'ground', 'left', 'right', 'body', 'plan', 'force',
  'push', 'limit', 'command'];

/** Current colours by name. */
function readColours() {
  const style = getComputedStyle(document.documentElement);
  return Object.fromEntries(colourNames.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
}

/** Colours of a fainter copy: opaque, moved towards the background by `amount` from 0 to 1. */
function fadeColours(colours, amount) {
  const channels = (hex) => [1, 3, 5].map((i) => Number.parseInt(hex.slice(i, i + 2), 16));
  const background = channels(colours.sky);
  return Object.fromEntries(Object.entries(colours).map(([name, hex]) => {
    const mixed = channels(hex).map((value, i) => Math.round(value + amount * (background[i] - value)));
    return [name, `rgb(${mixed.join(' ')})`];
  }));
}
