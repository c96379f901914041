// Saves what the page shows: the stage as PNG, SVG or WebM, a plot as SVG.

const kVideoFrames_s = 30;
const kLongestVideo_s = 120;

function saveFile(name, blob) {
  const link = element('a', { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

function saveSvg(name, drawing) {
  saveFile(`${name}.svg`, new Blob([String(drawing)], { type: 'image/svg+xml' }));
}

class StageExport {
  constructor(stage) {
    this.stage = stage;
    this.recorder = null;
    this.video = document.getElementById('save-video');
    document.getElementById('save-png').addEventListener('click', () => {
      stage.canvas.toBlob((blob) => saveFile(`${this.name}.png`, blob));
    });
    document.getElementById('save-svg').addEventListener('click', () => saveSvg(this.name, this.svg()));
    this.video.addEventListener('click', () => (this.recorder ? this.recorder.stop() : this.record()));
    this.video.hidden = !window.MediaRecorder?.isTypeSupported('video/webm');
  }

  get name() {
    return `stilt_${(this.stage.time_s ?? 0).toFixed(2)}_s`;
  }

  svg() {
    const { width, height } = this.stage.size;
    const drawing = new SvgContext(width, height);
    this.stage.paint(drawing, width, height);
    return drawing;
  }

  /** Films the stage from now on, as fast as it moves; a second press, or the longest time, ends that. */
  record() {
    const { name } = this;
    const recorder = new MediaRecorder(this.stage.canvas.captureStream(kVideoFrames_s), { mimeType: 'video/webm' });
    const parts = [];
    const longest = setTimeout(() => recorder.stop(), 1000 * kLongestVideo_s);
    recorder.ondataavailable = ({ data }) => parts.push(data);
    recorder.onstop = () => {
      clearTimeout(longest);
      this.show(null);
      saveFile(`${name}.webm`, new Blob(parts, { type: 'video/webm' }));
    };
    recorder.start();
    this.show(recorder);
  }

  show(recorder) {
    this.recorder = recorder;
    this.video.setAttribute('aria-pressed', String(recorder !== null));
    this.video.textContent = recorder ? 'End video' : 'Video';
  }
}

/** A plot as it stands, with its title and the names of its lines, in the canvas's pixels. */
function plotSvg({ u, plot, legends, zero_s, group }) {
  const ratio = devicePixelRatio || 1;
  const { colours } = group;
  const kTitle_px = 26 * ratio;
  const { width, height } = u.ctx.canvas;
  const c = new SvgContext(width, height, { top: -kTitle_px, scale: ratio });
  const shown = plot.lines.map((line, k) => ({ line, values: u.data[k + 1], colour: colours[line.colour], off: legends[k].item.classList.contains('off') }))
    .filter(({ off }) => !off);
  c.fillStyle = colours.card;
  c.fillRect(0, -kTitle_px, width, height + kTitle_px);
  const like = { ctx: c, bbox: u.bbox, scales: u.scales, valToPos: (...words) => u.valToPos(...words) };
  drawPushes(like, group.data, colours);
  drawSvgAxes(c, u, plot, zero_s, colours, ratio);
  drawLimits(like, plot.limits?.() ?? [], colours);
  c.save();
  c.beginPath();
  c.rect(u.bbox.left, u.bbox.top, u.bbox.width, u.bbox.height);
  c.clip();
  for (const { line, values, colour } of shown) drawSvgLine(c, u, line, values, colour, ratio, line.width ?? group.lineWidth_px);
  c.restore();
  c.textBaseline = 'alphabetic';
  c.font = `${13 * ratio}px sans-serif`;
  c.fillStyle = colours.text;
  c.fillText(plot.title, 10 * ratio, -9 * ratio);
  c.textAlign = 'right';
  let right = width - 10 * ratio;
  for (const { line, colour } of shown.filter((one) => !one.line.unnamed).reverse()) {
    c.fillStyle = colour;
    c.fillText(line.label, right, -9 * ratio);
    right -= (line.label.length * 7.5 + 12) * ratio;
  }
  return c;
}

function drawSvgAxes(c, u, plot, zero_s, colours, ratio) {
  const { left, top, width, height } = u.bbox;
  const { x, y } = u.scales;
  const decades = () => {
    const first = Math.ceil(Math.log10(y.min));
    return Array.from({ length: Math.max(0, Math.floor(Math.log10(y.max)) - first + 1) }, (_, k) => 10 ** (first + k));
  };
  Object.assign(c, { lineWidth: ratio, font: `${11 * ratio}px sans-serif`, fillStyle: colours.muted, strokeStyle: colours.line });
  const line = (...ends) => {
    c.beginPath();
    for (const [px, py] of ends) c.lineTo(px, py);
    c.stroke();
  };
  Object.assign(c, { textAlign: 'center', textBaseline: 'top' });
  for (const mark of timeMarks(x.min, x.max, zero_s)) {
    const px = u.valToPos(mark, 'x', true);
    line([px, top], [px, top + height]);
    c.fillText(`${formatTick(Number((mark - zero_s).toFixed(4)))} s`, px, top + height + 4 * ratio);
  }
  Object.assign(c, { textAlign: 'right', textBaseline: 'middle' });
  for (const mark of plot.logarithmic ? decades() : timeMarks(y.min, y.max, 0)) {
    const py = u.valToPos(mark, 'y', true);
    line([left, py], [left + width, py]);
    c.fillText(formatTick(Number(mark.toPrecision(10))), left - 5 * ratio, py);
  }
  Object.assign(c, { textAlign: 'left', textBaseline: 'top' });
  c.fillText(plot.axis, 4 * ratio, top - 4 * ratio);
}

function drawSvgLine(c, u, line, values, colour, ratio, width_px) {
  const places = u.data[0].map((time, k) => (
    Number.isFinite(values[k]) ? [u.valToPos(time, 'x', true), u.valToPos(values[k], 'y', true)] : null));
  Object.assign(c, { strokeStyle: colour, fillStyle: colour, lineWidth: width_px * ratio, globalAlpha: line.alpha ?? 1 });
  c.setLineDash((line.dash ?? []).map((one) => one * ratio));
  c.beginPath();
  places.forEach((place, k) => {
    if (place === null) return;
    if (line.points) c.fillRect(place[0] - 2 * ratio, place[1] - 2 * ratio, 4 * ratio, 4 * ratio);
    else if (!places[k - 1]) c.moveTo(...place);
    else {
      if (line.steps) c.lineTo(place[0], places[k - 1][1]);
      c.lineTo(...place);
    }
  });
  if (!line.points) c.stroke();
  c.setLineDash([]);
  c.globalAlpha = 1;
}
