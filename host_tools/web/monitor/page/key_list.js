// The list of keys. It covers nothing that stops: no dialog, which would put the rest of the page out of reach.

class KeyList {
  constructor() {
    this.list = document.getElementById('keys');
    this.button = document.getElementById('keys-button');
    this.button.addEventListener('click', () => this.show(this.list.hidden));
    document.getElementById('keys-close').addEventListener('click', () => this.show(false));
    document.addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      if (event.key === 'Escape') this.show(false);
      if (event.key === '?' && !event.target.closest('input:not([type=range]):not([type=checkbox])')) this.show(this.list.hidden);
    }, true);
  }

  show(shown) {
    if (shown === !this.list.hidden) return;
    this.list.hidden = !shown;
    this.button.setAttribute('aria-expanded', String(shown));
    if (shown) this.list.focus();
    else this.button.focus();
  }
}
