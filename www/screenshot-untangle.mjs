// Writes the pictures of the Untangle mode, www/assets/screenshots/untangle.png: a twisted hand in the middle of a step, its
// zones in colour; and untangle-contacts.png: a cushion pressed in a box, its contacts in the colours of their zones. Run
// after `npm run build`: node www/screenshot-untangle.mjs; or, of any problem, pressed so often, of any size:
// node www/screenshot-untangle.mjs FILE.png QUERY PRESSES WIDTHxHEIGHT
import { fileURLToPath } from 'node:url';
import { launch, openPage } from './tests/harness.mjs';

const asset = (name) => fileURLToPath(new URL(`assets/screenshots/${name}.png`, import.meta.url));
const [file, query = '', presses = '0', size = '1400x860'] = process.argv.slice(2);
const pictures = file
  ? [{ file, query, presses: Number(presses), size }]
  : [
    { file: asset('untangle'), query: '&body=hand', presses: 0, size },
    { file: asset('untangle-contacts'), query: '&body=cushion', presses: 4, size },
  ];

async function take(site, { file, query, presses, size }) {
  const [width, height] = size.split('x').map(Number);
  const { page, close } = await openPage(site, { query: `?mode=untangle&theme=light${query}`, viewport: { width, height } });
  await page.evaluate(() => { document.getElementById('pace').value = '0'; }); // phones do not show it
  for (let press = 0; press <= presses; press += 1) {
    await page.click(press ? '#further' : '#unfold');
    await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
    await page.waitForSelector('#play:not(.playing)');
  }
  // an iteration of the polisher, or its beginning, with zones and much that is wrong yet
  const at = await page.evaluate(() => {
    const { records } = globalThis.foldfreePage.session;
    const score = ({ part, zones, inverted, contacts }) => ((part === 'polish' || contacts) && zones > 1 ? inverted + (contacts?.active ?? 0) : -1);
    return records.reduce((best, record, i) => (score(record) > score(records[best]) ? i : best), 0);
  });
  await page.evaluate((k) => globalThis.foldfreePage.mode.scrub(k), at);
  await page.waitForTimeout(400);
  await page.screenshot({ path: file });
  await close();
  console.log(`${file}: part ${at}`);
}

const site = await launch();
try {
  for (const picture of pictures) await take(site, picture);
} finally {
  await site.close();
}
