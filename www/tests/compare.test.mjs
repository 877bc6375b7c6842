// The Compare mode of the built page, end to end.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { audit, download, drop, launch, onPageOf, playToTheEnd, status, wavySheet } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());
const onPage = onPageOf(() => site);

const SMALL = 'triangles=1000';
const shown = (page, index) => page.waitForFunction((i) => globalThis.foldfreePage.shown === i, index);
const lanes = (page) => page.evaluate(() => globalThis.foldfreePage.session.lanes.map(({ method, records, error, finished }) => ({
  method, iterations: records.length - 1, finished, error: error && String(error.message), last: records.at(-1),
})));

/** The colours that occur in a part of the screen often enough to be drawn there. */
async function colours(page, clip) {
  const image = (await page.screenshot({ clip })).toString('base64');
  return page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const canvas = new OffscreenCanvas(bitmap.width, bitmap.height);
    const context = canvas.getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const { data: bytes } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    const counts = new Map();
    for (let i = 0; i < bytes.length; i += 4) {
      const key = `${bytes[i]},${bytes[i + 1]},${bytes[i + 2]}`;
      counts.set(key, (counts.get(key) ?? 0) + 1);
    }
    return [...counts];
  }, image);
}

describe('comparing', () => {
  onPage('an address opens a comparison; all go on together by iterations', { query: `?compare=wrapd,wrapd%2Bcm,cm&${SMALL}`, viewport: { width: 1300, height: 850 } }, async (page) => {
    assert.equal(await page.getAttribute('body', 'data-mode'), 'compare');
    assert.deepEqual((await lanes(page)).map(({ method }) => method), ['wrapd', 'wrapd+cm', 'cm']);
    const first = await status(page);
    assert.deepEqual([first.iteration, first.inverted], [0, 0]);
    assert.match(await page.textContent('#invite-text'), /WRAPD, WRAPD\+CM and CM begin at the same map without inversions/);
    await page.click('#step');
    await shown(page, 1);
    assert.ok((await lanes(page)).every(({ iterations }) => iterations === 1));
    await page.click('#step-ten');
    await shown(page, 11);
    assert.ok((await lanes(page)).every(({ iterations, finished }) => iterations === 11 || finished));
    assert.match((await status(page)).text, /(WRAPD\+CM|CM) is lowest|^iteration 11 · energy/);
    await page.fill('#history', '3');
    assert.match((await status(page)).text, /^iteration 3 of 11/);
    assert.match(await page.textContent('#spoken'), /iteration 3 of 11, (WRAPD\+CM|CM) is lowest, energy [\d.]+, 0 inverted in all maps/);
    assert.ok(await page.isHidden('#notice'));
  });

  onPage('by time each shows what it had; the clock can be changed back', { query: `?compare=wrapd,cm&clock=seconds&${SMALL}` }, async (page) => {
    await page.click('#step-ten');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 10);
    const { clock, at, times, order } = await page.evaluate(() => {
      const { session, shown: index } = globalThis.foldfreePage;
      const moment = session.moments[index];
      return {
        clock: session.clock, at: moment.at, order: session.moments.map((m) => m.at),
        times: session.shownAt(moment).map((k, i) => [session.lanes[i].records[k].seconds, session.lanes[i].records[k + 1]?.seconds ?? Infinity]),
      };
    });
    assert.equal(clock, 'seconds');
    for (const [time, next] of times) assert.ok(time <= at && next > at, `${time}, ${at}, ${next}`);
    assert.ok(order.every((time, i) => i === 0 || time > order[i - 1]));
    assert.match((await status(page)).text, /^[\d.e-]+ m?s · /);
    await page.keyboard.press('s');
    assert.match((await status(page)).text, /^iteration \d+/);
    assert.equal(await page.getAttribute('#clock [data-clock="iterations"]', 'aria-pressed'), 'true');
    assert.doesNotMatch(page.url(), /clock/);
    await page.click('#clock [data-clock="seconds"]');
    assert.match(page.url(), /clock=seconds/);
  });

  onPage('to the end: the lowest is settled, and the table has every iterate', { query: `?compare=wrapd%2Bcm,cm&${SMALL}` }, async (page) => {
    await playToTheEnd(page);
    const [hybrid, cm] = await lanes(page);
    assert.ok(hybrid.last.status === 'converged' && cm.last.status === 'converged');
    assert.ok(hybrid.last.switchedAt >= 1);
    assert.ok(Math.abs(hybrid.last.energy - cm.last.energy) < 1e-8);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.session.best.settled), true);
    const { name, bytes } = await download(page, '#export-csv');
    assert.equal(name, 'bumpy-cap-compared.csv');
    const rows = bytes.toString().trim().split('\n').slice(1).map((line) => line.split(','));
    assert.equal(rows.length, hybrid.iterations + cm.iterations + 2);
    assert.equal(Number(rows.at(-1)[3]), cm.last.energy);
    const trace = JSON.parse((await download(page, '#export-trace')).bytes.toString());
    assert.deepEqual(trace.solvers.map(({ method }) => method), ['wrapd+cm', 'cm']);
    // what has been solved is played again, slowly enough to be seen
    await page.selectOption('#pace', '4');
    await page.click('#play');
    await page.waitForFunction(() => globalThis.foldfreePage.shown > 0 && globalThis.foldfreePage.shown < globalThis.foldfreePage.session.moments.length - 1);
  });

  onPage('solvers join and leave; from a folded start those that cannot begin say so and the others run', { query: `?compare=wrapd,cm&${SMALL}` }, async (page) => {
    const pressed = () => page.$$eval('#contestants [aria-pressed="true"]', (list) => list.map((button) => button.dataset.method));
    await page.click('#contestants [data-method="slim"]');
    await page.waitForFunction(() => globalThis.foldfreePage.session.lanes.length === 3);
    assert.deepEqual(await pressed(), ['wrapd', 'cm', 'slim']);
    assert.match(page.url(), /compare=wrapd,cm,slim/);
    await page.selectOption('#start', 'random');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.startInverted > 0);
    assert.deepEqual((await lanes(page)).map(({ error }) => Boolean(error)), [false, true, true]);
    assert.match(await page.textContent('#invite-text'), /upside down/);
    await page.click('#step');
    await shown(page, 1);
    assert.equal((await lanes(page))[0].iterations, 1);
    assert.ok((await status(page)).inverted > 0);
    for (const method of ['cm', 'slim']) await page.click(`#contestants [data-method="${method}"]`);
    await page.waitForSelector('#notice:visible');
    assert.match(await page.textContent('#notice'), /Two at least/);
    assert.equal((await pressed()).length, 2);
  });

  onPage('the surface of Flatten comes along; what was compared stays', { query: `?sample=torus&${SMALL}&start=automatic`, viewport: { width: 1300, height: 850 } }, async (page) => {
    await page.click('[data-mode-button="compare"]');
    await page.waitForFunction(() => globalThis.foldfreePage.session?.lanes?.length === 4);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.session.problem.source.sample), 'torus');
    assert.match(page.url(), /compare=wrapd,wrapd%2Bcm,cm,slim/);
    await page.click('#step');
    await shown(page, 1);
    await page.click('[data-mode-button="flatten"]');
    assert.equal(await page.inputValue('#start'), 'automatic');
    assert.equal((await status(page)).iteration, 0);
    await page.click('[data-mode-button="compare"]');
    assert.equal(await page.inputValue('#start'), 'tutte');
    assert.match((await status(page)).text, /^iteration 1/);
    await drop(page, 'sheet.obj', wavySheet(12));
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.name === 'sheet.obj');
    await drop(page, 'broken.obj', 'v 0 0 0\nf 1 2 9\n');
    await page.waitForSelector('#notice:visible');
    assert.match(await page.textContent('#notice'), /line 2/i);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.session.problem.source.name), 'sheet.obj');
  });

  onPage('maps and curves are drawn, each in its own place and colour', { query: `?compare=wrapd,cm&${SMALL}&at=8&theme=light`, viewport: { width: 1300, height: 850 } }, async (page) => {
    await shown(page, 8);
    await page.waitForTimeout(500);
    const { x, y, width, height } = await (await page.$('#canvas')).boundingBox();
    const views = width - 292;
    const plot = Math.min(340, 0.46 * height);
    const seen = new Map(await colours(page, { x, y: y + height - plot, width: views, height: plot }));
    for (const own of ['0,114,178', '0,132,96']) assert.ok((seen.get(own) ?? 0) > 150, `${own} is in the plot: ${seen.get(own)}`);
    assert.equal(seen.get('16,42,112'), undefined, 'WRAPD+CM takes no part');
    for (const pane of [0, 1]) {
      const drawn = await colours(page, { x: x + (pane * views) / 2, y, width: views / 2, height: height - plot });
      assert.ok(drawn.length > 300, `map ${pane} is drawn: ${drawn.length} colours`);
    }
  });
});

describe('for everybody', () => {
  for (const colorScheme of ['light', 'dark']) {
    onPage(`no accessibility violation, ${colorScheme}`, { colorScheme, query: `?compare=wrapd,cm&${SMALL}`, viewport: { width: 1300, height: 850 } }, async (page) => {
      await audit(page, 'start');
      await page.click('#step');
      await shown(page, 1);
      await page.click('#help');
      await audit(page, 'help');
      await page.keyboard.press('Escape');
      await page.keyboard.press('p');
      assert.ok(await page.isHidden('#contestants'));
      await page.keyboard.press('Escape');
    });
  }

  onPage('a phone shows one map at a time with the plot below', { query: `?compare=wrapd,wrapd%2Bcm,cm&${SMALL}`, viewport: { width: 390, height: 800 }, hasTouch: true, isMobile: true }, async (page) => {
    await audit(page, 'phone');
    const tabs = await page.$$eval('#pane-tabs [role="tab"]', (list) => list.map((tab) => tab.textContent));
    assert.deepEqual(tabs, ['WRAPD', 'WRAPD+CM', 'CM', 'Numbers']);
    await page.tap('#step-ten');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 10);
    await page.tap('#pane-tabs [data-pane="2"]');
    assert.equal(await page.getAttribute('#pane-tabs [data-pane="2"]', 'aria-selected'), 'true');
    assert.equal(await page.getAttribute('#pane-tabs [data-pane="0"]', 'aria-selected'), 'false');
    await page.tap('#pane-tabs [data-view="inspector"]');
    assert.equal(await page.getAttribute('#pane-tabs [data-view="inspector"]', 'aria-selected'), 'true');
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth > innerWidth), false, 'nothing scrolls sideways');
    await page.tap('[data-mode-button="flatten"]');
    assert.ok(await page.isVisible('#view-tabs') && await page.isHidden('#pane-tabs'));
  });

  onPage('by keyboard: play, step, scrub, clock, solvers', { query: `?compare=wrapd,cm&${SMALL}` }, async (page) => {
    await page.keyboard.press('ArrowRight');
    await shown(page, 1);
    await page.keyboard.press('Shift+ArrowRight');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 8);
    await page.keyboard.press('Home');
    assert.equal((await status(page)).iteration, 0);
    for (const key of ['e', 'x', 'w', 'f']) await page.keyboard.press(key);
    await page.keyboard.press('4');
    await page.waitForFunction(() => globalThis.foldfreePage.session.lanes.length === 3);
    await page.keyboard.press('Space');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.playing);
    await page.keyboard.press('Space');
    await page.waitForFunction(() => !globalThis.foldfreePage.mode.playing);
    await page.keyboard.press('m');
    await page.waitForFunction(() => document.body.dataset.mode === 'round');
  });
});

test('the colours of the buttons are those of the curves', async () => {
  const { readFile } = await import('node:fs/promises');
  const [css, rust] = await Promise.all(['../style.css', '../src/colour.rs'].map((path) => readFile(new URL(path, import.meta.url), 'utf8')));
  const inCss = [...css.matchAll(/\[data-method="([^"]+)"\] \{ --own: light-dark\(#(\w{6}), #(\w{6})\)/g)];
  assert.ok(inCss.length >= 8);
  for (const [, method, light, dark] of inCss) {
    const own = new RegExp(`"${method.replace('+', '\\+')}" => \\(\\s*\\[([\\d, ]+)\\],\\s*\\[([\\d, ]+)\\]`);
    const [, a, b] = own.exec(rust) ?? /_ => \(\s*\[([\d, ]+)\],\s*\[([\d, ]+)\]/.exec(rust);
    const hex = (list) => list.split(', ').map((n) => Number(n).toString(16).padStart(2, '0')).join('');
    assert.deepEqual([hex(a), hex(b)], [light, dark], method);
  }
});
