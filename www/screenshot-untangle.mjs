// Writes www/assets/screenshots/untangle.png: a twisted hand in the middle of a step, its zones in colour. Run after
// `npm run build`: node www/screenshot-untangle.mjs [FILE.png] [query]
import { fileURLToPath } from 'node:url';
import { launch, openPage } from './tests/harness.mjs';

const [file = fileURLToPath(new URL('assets/screenshots/untangle.png', import.meta.url)), query = ''] = process.argv.slice(2);
const site = await launch();
try {
  const { page } = await openPage(site, { query: `?mode=untangle&body=hand&theme=light${query}`, viewport: { width: 1400, height: 860 } });
  await page.selectOption('#pace', '0');
  await page.click('#unfold');
  await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
  await page.waitForSelector('#play:not(.playing)');
  // an iteration of the polisher with several zones, and much that is wrong yet
  const at = await page.evaluate(() => {
    const { records } = globalThis.foldfreePage.session;
    const score = ({ part, zones, inverted }) => (part === 'polish' && zones > 1 ? inverted : -1);
    return records.reduce((best, record, i) => (score(record) > score(records[best]) ? i : best), 0);
  });
  await page.fill('#history', String(at));
  await page.waitForTimeout(400);
  await page.screenshot({ path: file });
  console.log(`${file}: part ${at}`);
} finally {
  await site.close();
}
