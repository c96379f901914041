// What axe-core, an engine that checks pages against WCAG, finds on a page.

import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { readFileSync } from 'node:fs';
import { picture, until } from './browser.mjs';

const kAxe = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf-8');

/** Serious and critical findings on all that the page can unfold, as lines of rule, element and reason. */
async function findings(page) {
  await page.evaluate(() => { for (const box of document.querySelectorAll('details')) box.open = true; });
  await page.evaluate(kAxe);
  return page.evaluate(async () => {
    const { violations } = await axe.run(document, { resultTypes: ['violations'] });
    return violations.filter(({ impact }) => impact === 'serious' || impact === 'critical').flatMap((rule) => (
      rule.nodes.map((node) => `${rule.id}: ${node.target.join(' ')}: ${node.failureSummary.replace(/\s+/g, ' ')}`)));
  });
}

/** Asserts that there are none in the light and in the dark of the system; a picture of both is kept. */
export async function assertAccessible(page, name) {
  for (const theme of ['light', 'dark']) {
    await page.emulateMedia({ colorScheme: theme });
    await until(`the page ${theme}`, async () => (await page.getAttribute('html', 'data-theme')) === theme);
    await picture(page, `${name}_${theme}`);
    assert.deepEqual(await findings(page), [], `${name}, ${theme}`);
  }
}
