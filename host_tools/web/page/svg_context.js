// Draws what a canvas draws as an SVG picture: as much of CanvasRenderingContext2D as the pages use.
// docs/decisions/0026-operating-the-page.md says why not by a library.

const kSvgAnchors = { left: 'start', center: 'middle', right: 'end' };
const kSvgBaselines = { top: 'text-before-edge', middle: 'central', bottom: 'text-after-edge', alphabetic: 'auto' };

function svgText(text) {
  return String(text).replace(/[&<>"]/g, (one) => `&#${one.charCodeAt(0)};`);
}

class SvgContext {
  /** A picture from (0, top) to (width, height), shown `scale` times smaller. */
  constructor(width, height, { top = 0, scale = 1 } = {}) {
    this.head = `<svg xmlns="http://www.w3.org/2000/svg" width="${width / scale}" height="${(height - top) / scale}" ` +
      `viewBox="0 ${top} ${width} ${height - top}">`;
    this.parts = [];
    this.clips = 0;
    this.saved = [];
    this.path = '';
    Object.assign(this, {
      fillStyle: '#000', strokeStyle: '#000', lineWidth: 1, lineJoin: 'miter', lineCap: 'butt', globalAlpha: 1,
      font: '10px sans-serif', textAlign: 'left', textBaseline: 'alphabetic', dash: [], clipped: '',
    });
  }

  toString() {
    return `${this.head}${this.parts.join('\n')}</svg>\n`;
  }

  save() {
    const { head, parts, clips, saved, path, ...state } = this;
    this.saved.push(state);
  }

  restore() {
    Object.assign(this, this.saved.pop());
  }

  setLineDash(dash) {
    this.dash = dash;
  }

  beginPath() {
    this.path = '';
  }

  moveTo(x, y) {
    this.path += `M${x.toFixed(2)} ${y.toFixed(2)}`;
  }

  lineTo(x, y) {
    this.path += `${this.path === '' ? 'M' : 'L'}${x.toFixed(2)} ${y.toFixed(2)}`;
  }

  closePath() {
    this.path += 'Z';
  }

  rect(x, y, width, height) {
    this.path += `M${x} ${y}h${width}v${height}h${-width}Z`;
  }

  /** Clockwise by default, as a canvas. */
  arc(x, y, radius, from, to) {
    const at = (angle) => [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
    const turn = to - from >= 2 * Math.PI ? 2 * Math.PI : (((to - from) % (2 * Math.PI)) + 2 * Math.PI) % (2 * Math.PI);
    this.lineTo(...at(from));
    for (const half of [0.5, 1]) {
      const [endX, endY] = at(from + half * turn);
      this.path += `A${radius} ${radius} 0 0 1 ${endX.toFixed(2)} ${endY.toFixed(2)}`;
    }
  }

  clip() {
    const id = `clip${this.clips++}`;
    this.parts.push(`<clipPath id="${id}"><path d="${this.path}"/></clipPath>`);
    this.clipped = ` clip-path="url(#${id})"`;
  }

  get strokeAttributes() {
    return `fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" stroke-linejoin="${this.lineJoin}" ` +
      `stroke-linecap="${this.lineCap}"${this.dash.length > 0 ? ` stroke-dasharray="${this.dash.join(' ')}"` : ''}`;
  }

  add(tag, attributes, content = '') {
    if (this.globalAlpha !== 1) attributes += ` opacity="${this.globalAlpha}"`;
    this.parts.push(`<${tag} ${attributes}${this.clipped}>${content}</${tag}>`);
  }

  fill() {
    this.add('path', `d="${this.path}" fill="${this.fillStyle}"`);
  }

  stroke() {
    this.add('path', `d="${this.path}" ${this.strokeAttributes}`);
  }

  fillRect(x, y, width, height) {
    this.add('rect', `x="${x}" y="${y}" width="${Math.max(0, width)}" height="${Math.max(0, height)}" fill="${this.fillStyle}"`);
  }

  addText(text, x, y, look) {
    this.add('text', `x="${x.toFixed(2)}" y="${y.toFixed(2)}" style="font: ${svgText(this.font)}" text-anchor="${kSvgAnchors[this.textAlign]}" ` +
      `dominant-baseline="${kSvgBaselines[this.textBaseline]}" ${look}`, svgText(text));
  }

  fillText(text, x, y) {
    this.addText(text, x, y, `fill="${this.fillStyle}"`);
  }

  strokeText(text, x, y) {
    this.addText(text, x, y, this.strokeAttributes);
  }
}
