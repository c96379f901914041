// Reads the page's QR codes with jsQR, a decoder that has nothing in common with it.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

const jsQR = createRequire(import.meta.url)('jsqr');
const kScript = new URL('../../../../host_tools/web/monitor/page/qr_code.js', import.meta.url);

/** The page's encoder: rows of a code, true is dark, or null. */
export const qrCode = new Function(`${readFileSync(kScript, 'utf-8')}\nreturn qrCode;`)();

/** Text of a code of which only the rows are known. */
export function readQrCode(rows) {
  const kModule_px = 4;
  const kQuiet = 4;
  const width = (rows.length + 2 * kQuiet) * kModule_px;
  const isDark = (px, py) => rows[Math.floor(py / kModule_px) - kQuiet]?.[Math.floor(px / kModule_px) - kQuiet];
  const pixels = Uint8ClampedArray.from({ length: 4 * width * width }, (_, k) => {
    const at = k >> 2;
    return k % 4 < 3 && isDark(at % width, Math.floor(at / width)) ? 0 : 255;
  });
  return jsQR(pixels, width, width)?.data ?? null;
}

/** Text of a code as it looks on the page. */
export async function readQrPicture(page, locator) {
  const png = (await locator.screenshot()).toString('base64');
  const { width, height, values } = await page.evaluate(async (base64) => {
    const image = new Image();
    image.src = `data:image/png;base64,${base64}`;
    await image.decode();
    const canvas = Object.assign(document.createElement('canvas'), { width: image.width, height: image.height });
    const context = canvas.getContext('2d');
    context.drawImage(image, 0, 0);
    return { width: image.width, height: image.height, values: [...context.getImageData(0, 0, image.width, image.height).data] };
  }, png);
  return jsQR(Uint8ClampedArray.from(values), width, height)?.data ?? null;
}
