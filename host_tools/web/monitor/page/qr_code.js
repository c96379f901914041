// QR codes (ISO/IEC 18004) of a text: byte mode, error correction level M, versions 1 to 9. Written here because it is
// small, and a library would be a dependency of the page (docs/decisions/0026-operating-the-page.md).

/** Of versions 1 to 9: codewords in all, those of error correction in a block, blocks, second alignment place. */
const kQrVersions = [[26, 10, 1], [44, 16, 1, 18], [70, 26, 1, 22], [100, 18, 2, 26], [134, 24, 2, 30], [172, 16, 4, 34],
  [196, 18, 4, 22], [242, 22, 4, 24], [292, 22, 5, 26]];
const kQrMasks = [
  (x, y) => (x + y) % 2 === 0, (x, y) => y % 2 === 0, (x) => x % 3 === 0, (x, y) => (x + y) % 3 === 0,
  (x, y) => ((x / 3 | 0) + (y >> 1)) % 2 === 0, (x, y) => ((x * y) % 2) + ((x * y) % 3) === 0,
  (x, y) => (((x * y) % 2) + ((x * y) % 3)) % 2 === 0, (x, y) => (((x + y) % 2) + ((x * y) % 3)) % 2 === 0];

/** Product in GF(256) modulo x^8 + x^4 + x^3 + x^2 + 1. */
function gfProduct(a, b) {
  let product = 0;
  for (let bit = 7; bit >= 0; --bit) product = (product << 1) ^ (product >> 7 ? 0x11d : 0) ^ ((b >> bit) & 1 ? a : 0);
  return product;
}

/** The `count` Reed-Solomon codewords of a block. */
function correctionOf(data, count) {
  let generator = [1];
  for (let k = 0, root = 1; k < count; ++k, root = gfProduct(root, 2)) {
    generator = [...generator, 0].map((one, i) => one ^ (i > 0 ? gfProduct(generator[i - 1], root) : 0));
  }
  const rest = [...data, ...new Array(count).fill(0)];
  for (let k = 0; k < data.length; ++k) {
    const factor = rest[k];
    generator.forEach((one, i) => { rest[k + i] ^= gfProduct(one, factor); });
  }
  return rest.slice(data.length);
}

/** `value` with the remainder of its division by `divisor` behind it, both polynomials over GF(2). */
function withRemainder(value, divisor) {
  const degree = 31 - Math.clz32(divisor);
  let rest = value << degree;
  while (rest >= 1 << degree) rest ^= divisor << (31 - Math.clz32(rest) - degree);
  return (value << degree) | rest;
}

/** All codewords in the order in which they are drawn: blocks interleaved, the shorter ones first. */
function codewordsOf(bytes, [total, correction, blocks]) {
  const room = total - correction * blocks;
  const nibbles = [4, bytes.length >> 4, bytes.length & 15, ...[...bytes].flatMap((one) => [one >> 4, one & 15]), 0];
  const data = Array.from({ length: room }, (_, k) => (
    2 * k < nibbles.length ? (nibbles[2 * k] << 4) | nibbles[2 * k + 1] : (k - nibbles.length / 2) % 2 ? 0x11 : 0xec));
  const short = Math.floor(room / blocks);
  const parts = Array.from({ length: blocks }, (_, k) => {
    const longBefore = Math.max(0, k - (blocks - room % blocks));
    const from = k * short + longBefore;
    return data.slice(from, from + short + (k >= blocks - room % blocks ? 1 : 0));
  });
  const interleaved = (lists, longest) => Array.from({ length: longest }, (_, k) => lists.map((list) => list[k])).flat();
  return [...interleaved(parts, short + 1).filter((one) => one !== undefined),
    ...interleaved(parts.map((part) => correctionOf(part, correction)), correction)];
}

class QrDrawing {
  constructor(version) {
    this.version = version;
    this.size = 17 + 4 * version;
    this.dark = Array.from({ length: this.size }, () => new Array(this.size).fill(false));
    this.fixed = Array.from({ length: this.size }, () => new Array(this.size).fill(false));
    this.drawPatterns();
  }

  set(x, y, dark) {
    this.dark[y][x] = Boolean(dark);
    this.fixed[y][x] = true;
  }

  /** Rings around a place: all are dark but those of the given distances. */
  drawRings(x, y, radius, light) {
    for (let dy = -radius; dy <= radius; ++dy) {
      for (let dx = -radius; dx <= radius; ++dx) {
        if (x + dx < 0 || y + dy < 0 || x + dx >= this.size || y + dy >= this.size) continue;
        this.set(x + dx, y + dy, !light.includes(Math.max(Math.abs(dx), Math.abs(dy))));
      }
    }
  }

  drawPatterns() {
    const last = this.size - 7;
    for (let k = 0; k < this.size; ++k) {
      this.set(6, k, k % 2 === 0);
      this.set(k, 6, k % 2 === 0);
    }
    for (const [x, y] of [[3, 3], [3, this.size - 4], [this.size - 4, 3]]) this.drawRings(x, y, 4, [2, 4]);
    const second = kQrVersions[this.version - 1][3];
    const places = second === undefined ? [] : [...new Set([6, second, last])];
    for (const x of places) {
      for (const y of places) {
        const inCorner = (x === 6 && y === 6) || (x === 6 && y === last) || (x === last && y === 6);
        if (!inCorner) this.drawRings(x, y, 2, [1]);
      }
    }
    this.drawFormat(0);
    if (this.version >= 7) this.drawVersion();
  }

  drawFormat(mask) {
    const bits = withRemainder(mask, 0x537) ^ 0x5412;
    for (let k = 0; k < 15; ++k) {
      const bit = (bits >> k) & 1;
      const along = k < 6 ? k : k < 8 ? k + 1 : null;
      if (along !== null) this.set(8, along, bit);
      else this.set(k === 8 ? 7 : 14 - k, 8, bit);
      if (k < 8) this.set(this.size - 1 - k, 8, bit);
      else this.set(8, this.size - 15 + k, bit);
    }
    this.set(8, this.size - 8, true);
  }

  drawVersion() {
    const bits = withRemainder(this.version, 0x1f25);
    for (let k = 0; k < 18; ++k) {
      const [across, along] = [this.size - 11 + (k % 3), Math.floor(k / 3)];
      this.set(across, along, (bits >> k) & 1);
      this.set(along, across, (bits >> k) & 1);
    }
  }

  /** Fills the codewords in, in pairs of columns from the right, up and down in turn. */
  drawData(codewords) {
    let bit = 0;
    for (let right = this.size - 1, up = true; right > 0; right -= 2, up = !up) {
      if (right === 6) right = 5;
      for (let k = 0; k < this.size; ++k) {
        const y = up ? this.size - 1 - k : k;
        for (const x of [right, right - 1]) {
          if (this.fixed[y][x]) continue;
          this.dark[y][x] = Boolean((codewords[bit >> 3] >> (7 - (bit & 7))) & 1);
          ++bit;
        }
      }
    }
  }

  invert(mask) {
    this.dark.forEach((row, y) => row.forEach((dark, x) => {
      if (!this.fixed[y][x] && kQrMasks[mask](x, y)) row[x] = !dark;
    }));
  }

  /** How hard it is to read: long runs, squares, what looks like a corner, more dark than light. */
  penalty() {
    const rows = this.dark.map((row) => row.map(Number).join(''));
    const columns = this.dark.map((_, x) => this.dark.map((row) => Number(row[x])).join(''));
    let sum = 0;
    for (const line of [...rows, ...columns]) {
      for (const [run] of line.matchAll(/0{5,}|1{5,}/g)) sum += run.length - 2;
      sum += 40 * [...line.matchAll(/(?=10111010000|00001011101)/g)].length;
    }
    for (let y = 1; y < this.size; ++y) {
      for (let x = 1; x < this.size; ++x) {
        const four = rows[y - 1].slice(x - 1, x + 1) + rows[y].slice(x - 1, x + 1);
        if (four === '0000' || four === '1111') sum += 3;
      }
    }
    const share = rows.join('').replaceAll('0', '').length / this.size ** 2;
    return sum + 10 * Math.floor(Math.abs(share - 0.5) / 0.05);
  }
}

/** Rows of a QR code, true is dark; null when the text has more than 180 bytes. */
function qrCode(text) {
  const bytes = new TextEncoder().encode(text);
  const fits = ([total, correction, blocks]) => bytes.length + 2 <= total - correction * blocks;
  const version = kQrVersions.findIndex(fits) + 1;
  if (version === 0) return null;
  const drawing = new QrDrawing(version);
  drawing.drawData(codewordsOf(bytes, kQrVersions[version - 1]));
  const tries = kQrMasks.map((_, mask) => {
    drawing.drawFormat(mask);
    drawing.invert(mask);
    const penalty = drawing.penalty();
    drawing.invert(mask);
    return penalty;
  });
  const best = tries.indexOf(Math.min(...tries));
  drawing.drawFormat(best);
  drawing.invert(best);
  return drawing.dark;
}

/** The code of a text as a picture, dark on light in every theme; null when the text is too long. */
function qrPicture(text, label) {
  const rows = qrCode(text);
  if (rows === null) return null;
  const kQuiet = 4;
  const size = rows.length + 2 * kQuiet;
  const node = (name, attributes) => {
    const made = document.createElementNS('http://www.w3.org/2000/svg', name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    return made;
  };
  const squares = rows.flatMap((row, y) => row.flatMap((dark, x) => (dark ? [`M${x + kQuiet} ${y + kQuiet}h1v1h-1z`] : [])));
  const picture = node('svg', { class: 'qr-code', viewBox: `0 0 ${size} ${size}`, role: 'img', 'aria-label': label, 'shape-rendering': 'crispEdges' });
  picture.append(node('rect', { width: size, height: size, fill: '#fff' }), node('path', { d: squares.join(''), fill: '#000' }));
  return picture;
}
