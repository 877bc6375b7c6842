// Writes www/assets/screenshots/untangle.png: two hooks in the middle of a step, their zones in colour and their contacts.
// Run after `npm run build`: node www/screenshot-untangle.mjs [FILE.png] [query] [WIDTHxHEIGHT]
import { fileURLToPath } from 'node:url';
import { launch, openPage } from './tests/harness.mjs';

const [file = fileURLToPath(new URL('assets/screenshots/untangle.png', import.meta.url)), query = '&body=hooks', size = '1300x850'] = process.argv.slice(2);
const [width, height] = size.split('x').map(Number);
const site = await launch();
try {
  const { page } = await openPage(site, { query: `?mode=untangle&theme=light${query}`, viewport: { width, height } });
  await page.evaluate(() => { document.getElementById('pace').value = '0'; }); // phones do not show it
  for (const button of ['#unfold', '#further']) {
    if (await page.isHidden(button)) continue;
    await page.click(button);
    await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
    await page.waitForSelector('#play:not(.playing)');
  }
  // an iteration of the polisher with zones, and much that is wrong yet
  const at = await page.evaluate(() => {
    const { records } = globalThis.foldfreePage.session;
    const score = ({ part, zones, inverted, contacts }) => (part === 'polish' && zones > 0 ? inverted + (contacts?.active ?? 0) : -1);
    return records.reduce((best, record, i) => (score(record) > score(records[best]) ? i : best), 0);
  });
  await page.fill('#history', String(at));
  await page.waitForTimeout(400);
  await page.screenshot({ path: file });
  console.log(`${file}: part ${at}`);
} finally {
  await site.close();
}
