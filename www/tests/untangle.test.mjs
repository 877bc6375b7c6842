// The Untangle mode of the built page, end to end, and its problems.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { initSync } from '../../pkg/core.js';
import { readAddress } from '../page/address.js';
import { FIGURES } from '../page/figures.js';
import { ENERGIES, HELD, STARTS, invertedOf, outsideOf, problemOf, readPins } from '../page/untangle-problems.js';
import { UntangleSession } from '../page/untangle-session.js';
import { audit, download, drop, launch, onPageOf, openPage } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());
const onPage = onPageOf(() => site);

const core = initSync(readFileSync(new URL('../../pkg/single/foldfree_bg.wasm', import.meta.url)));
const WIDE = { width: 1300, height: 820 };
const BAR = '?mode=untangle&size=1000';
const SQUARE = '?mode=untangle&body=square&size=400';

const shownIs = (page, index) => page.waitForFunction((k) => globalThis.foldfreePage.shown === k, index);
const records = (page) => page.evaluate(() => globalThis.foldfreePage.session.records);
const statusText = async (page) => {
  await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }));
  return (await page.textContent('#status')).replaceAll('\u00a0', '');
};
const inverted = async (page) => Number(/(\d+) inverted/.exec(await statusText(page))[1]);
const drawn = (page) => page.evaluate(() => globalThis.foldfreePage.board.drawnInverted);
const toTheEnd = async (page) => {
  await page.selectOption('#pace', '0');
  await page.click('#unfold');
  await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
  await page.waitForSelector('#play:not(.playing)');
};

/** Bodies of the library and of the page. */
const bodies = () => [core.generateSolid('bar', 800), core.generateSolid('box', 600), core.mesh(FIGURES.square.make(300)), core.mesh(FIGURES.gingerbread.make(500))];

describe('problems', () => {
  test('everything held has a solution, and everything else starts elsewhere', () => {
    for (const body of bodies()) {
      for (const held of Object.keys(HELD)) {
        for (const start of Object.keys(STARTS)) {
          const what = `${body.indices ? 'triangles' : 'tetrahedra'}, ${held}, ${start}`;
          const { pins, start: places } = problemOf(body, { held, start });
          assert.equal(pins.length === 0, held === 'nothing', what);
          assert.equal(new Set(pins).size, pins.length, what);
          assert.ok(pins.length < body.positions.length / 3, what);
          assert.ok(places.every(Number.isFinite), what);
          assert.ok(invertedOf(body, places) > 0.2 * (body.indices ?? body.tetrahedra).length / (body.indices ? 3 : 4), what);
          if (body.indices) assert.ok(places.every((x, i) => i % 3 < 2 || x === 0), 'it stays in its plane');
          const solver = core.untangle(body, { pins, start: places });
          let last;
          for (last of solver);
          assert.equal(last.criterion, 'injective', what);
          solver.free();
        }
      }
    }
  });

  test('the outside of a body, and lists of pins', () => {
    const square = FIGURES.square.make(200);
    const n = Math.sqrt(square.positions.length / 3);
    assert.equal(outsideOf(square).length, 4 * (n - 1));
    const box = core.generateSolid('box', 300);
    assert.deepEqual([...outsideOf(box)].sort(), [...new Set(box.surface)].sort());
    assert.equal(invertedOf(square, square.positions), 0);
    assert.deepEqual([...readPins('# held\n3\n\n 1 # and this\n3\n', 5, 'p.txt')], [3, 1]);
    assert.throws(() => readPins('1\n9\n', 5, 'p.txt'), /p\.txt: line 2: vertex 9 of 5/);
    assert.throws(() => readPins('one', 5, 'p.txt'), /p\.txt: line 1: expected a vertex index/);
  });

  test('the address has what it has, and nothing else', () => {
    const { body, size, held, start, energy, state, field } = readAddress('untangle', '?mode=untangle&body=square&held=ends&start=point&energy=neo-hookean&state=primary&field=stress');
    assert.deepEqual([body, size, held, start, energy, state, field], ['square', 3000, 'ends', 'point', 'arap', 'primary', 'zone']);
  });
});

describe('the session', () => {
  /** The library without a worker, as the session uses it. */
  const library = {
    version: core.version, threads: 1,
    generateSolid: async (...args) => core.generateSolid(...args),
    mesh: async (...args) => core.mesh(...args),
    solid: async (...args) => core.solid(...args),
    untangle: async (body, options) => core.untangle(body, options),
  };

  test('a step comes in its parts, and what is handed out never gets worse', async () => {
    const session = new UntangleSession(library);
    const first = await session.open({ source: { body: 'bar', size: 800 }, held: 'twisted', start: 'random', energy: 'arap' });
    const { body } = session;
    assert.deepEqual(first.record.counts.map((n) => n === first.record.inverted), [true, true, true]);
    let before = first;
    while (!session.finished) {
      const part = await session.step();
      const { record } = part;
      assert.equal(record, session.newest);
      assert.deepEqual(record.counts, [part.trial, part.result, part.primary].map((p) => invertedOf(body, p)), `${record.iteration} ${record.part} ${record.k}`);
      if (record.part === 'outcome') {
        assert.equal(record.gini.polish.length, record.of);
        if (record.gini.reached) assert.deepEqual(part.result, part.trial);
      } else {
        assert.equal(part.result, before.result, 'until the outcome what is handed out stays');
      }
      if (record.part === 'polish' || record.part === 'quadratic') assert.ok(record.violated >= record.inverted);
      if (record.zones > 0) assert.ok(part.zones.some((zone) => zone === record.zones));
      assert.ok(record.counts[1] <= before.record.counts[1]);
      before = part;
    }
    const parts = session.records.slice(1).map(({ iteration, part, k }) => [iteration, part, k].join());
    const expected = [...Array(session.newest.iteration).keys()].flatMap((i) => {
      const { of } = session.records.find((record) => record.iteration === i + 1 && record.part === 'outcome');
      const quadratic = session.records.find((record) => record.iteration === i + 1 && record.part === 'quadratic').gini.qpIterations;
      return [`${i + 1},local,0`, ...Array.from({ length: quadratic + 1 }, (_, k) => `${i + 1},quadratic,${k}`), ...Array.from({ length: of }, (_, k) => `${i + 1},polish,${k + 1}`), `${i + 1},outcome,${of}`];
    });
    assert.deepEqual(parts, expected);
    assert.equal(session.newest.counts[1], 0);
    assert.equal(session.newest.status, 'converged');
    assert.deepEqual(session.result.outcome.notPositive, []);
    assert.equal(await session.step(), undefined);
    const trace = await session.trace();
    assert.deepEqual([trace.problem.body, trace.settings.held, trace.iterations.length], ['bar', 'twisted', session.newest.iteration]);
  });

  test('what fails or is overtaken leaves the bench as it was', async () => {
    const session = new UntangleSession(library);
    const wanted = { held: 'outside', start: 'point', energy: 'arap' };
    await session.open({ source: { body: 'box', size: 300 }, ...wanted });
    const { body, records: before } = session;
    const broken = { name: 'a.obj', files: [{ name: 'a.obj', format: 'obj', bytes: new TextEncoder().encode('v 0 0 0\nf 1 2 3\n') }] };
    await assert.rejects(session.open({ source: broken, ...wanted }), /index/);
    assert.equal(session.body, body);
    assert.equal(session.records, before);
    const [late, good] = await Promise.all([
      session.open({ source: { body: 'bar', size: 300 }, ...wanted }), session.open({ source: { body: 'square', size: 100 }, ...wanted }),
    ]);
    assert.equal(late, undefined);
    assert.ok(good && session.planar);
    await assert.rejects(session.open({ source: session.problem.source, ...wanted, energy: 'neo-hookean' }), { code: 'invalid-option' });
    assert.ok(session.planar && session.ready);
    while (!session.finished) await session.step();
    assert.equal(session.newest.counts[1], 0);
  });
});

describe('the page', () => {
  onPage('a twisted bar comes free, part by part', { query: BAR, viewport: WIDE }, async (page) => {
    assert.equal(await page.getAttribute('[data-mode-button="untangle"]', 'aria-current'), 'page');
    const tabs = await page.$$eval('[data-mode-button]', (list) => list.map((b) => b.textContent));
    assert.deepEqual(tabs, ['Flatten', 'Deform', 'Untangle', 'Compare', 'Round']);
    assert.match(await page.textContent('#invite-text'), /held where a twist takes it.*random place.*are inverted or flat/);
    const first = await inverted(page);
    assert.ok(first > 200);
    assert.equal(await drawn(page), first);
    // one part after the other
    for (const [key, words] of [['ArrowRight', /step 1 · local step/], ['ArrowRight', /step 1 · QP 0 of \d+ · \d+ below η/], ['ArrowRight', /step 1 · QP 1 of \d+/]]) {
      const { length } = await records(page);
      await page.keyboard.press(key);
      await shownIs(page, length);
      assert.match(await statusText(page), words);
    }
    assert.equal(await drawn(page), await inverted(page));
    await page.keyboard.press('Shift+ArrowRight');
    await page.waitForFunction(() => globalThis.foldfreePage.shown > 5 || globalThis.foldfreePage.session.finished);
    await page.selectOption('#pace', '0');
    await page.click('#play');
    await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
    assert.equal(await inverted(page), 0);
    assert.equal(await drawn(page), 0);
    assert.match(await statusText(page), /handed out/);
    const { certificate, outcome } = await page.evaluate(() => globalThis.foldfreePage.session.result);
    assert.deepEqual([certificate.inverted.length, certificate.degenerate.length, outcome.notPositive.length], [0, 0, 0]);
    assert.ok(await page.isHidden('#notice'));
  });

  onPage('three states can be shown of every part', { query: BAR, viewport: WIDE }, async (page) => {
    await toTheEnd(page);
    const all = await records(page);
    const at = all.findIndex(({ part, counts }) => part === 'quadratic' && counts[1] !== counts[2]);
    assert.ok(at > 0, 'a part in which the states differ');
    await page.fill('#history', String(at));
    for (const [state, index] of [['trial', 0], ['result', 1], ['primary', 2]]) {
      await page.click(`[data-state="${state}"]`);
      assert.equal(await page.getAttribute(`[data-state="${state}"]`, 'aria-pressed'), 'true');
      assert.equal(await inverted(page), all[at].counts[index]);
      assert.equal(await drawn(page), all[at].counts[index]);
    }
    assert.match(page.url(), /state=primary/);
    await page.keyboard.press('s');
    assert.equal(await page.getAttribute('[data-state="trial"]', 'aria-pressed'), 'true');
    for (const field of ['stretch', 'volume', 'zone']) {
      await page.selectOption('#field', field);
      assert.equal(await drawn(page), all[at].counts[0]);
    }
    assert.ok(await page.evaluate(() => globalThis.foldfreePage.bench.cutTetrahedra) > 10);
    assert.ok(await page.isDisabled('#field option[value="stress"]') || await page.$eval('#field option[value="stress"]', (option) => option.hidden));
  });

  onPage('a square in the plane, from one point and at random, in every energy it has', { query: `${SQUARE}&start=point`, viewport: WIDE }, async (page) => {
    assert.ok(await inverted(page) > 300);
    await toTheEnd(page);
    assert.equal(await inverted(page), 0);
    assert.ok(await page.isDisabled('#cut'));
    await page.selectOption('#untangle-start', 'random');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.start === 'random' && globalThis.foldfreePage.shown === 0);
    for (const [energy, { planar }] of Object.entries(ENERGIES)) {
      assert.equal(await page.$eval(`#untangle-energy option[value="${energy}"]`, (option) => option.disabled), !planar);
      if (!planar) continue;
      await page.selectOption('#untangle-energy', energy);
      await page.waitForFunction((e) => globalThis.foldfreePage.session.problem.settings.energy === e && globalThis.foldfreePage.shown === 0, energy);
      assert.ok(await inverted(page) > 100);
      await toTheEnd(page);
      assert.equal(await inverted(page), 0, energy);
    }
    const { certificate } = await page.evaluate(() => globalThis.foldfreePage.session.result);
    assert.ok(certificate.globallyInjective);
    const { name, bytes } = await download(page, '#export-solid');
    assert.equal(name, 'square-untangled.obj');
    const map = core.mesh(bytes, 'obj');
    const rest = core.mesh(FIGURES.square.make(400));
    assert.equal(invertedOf(rest, map.positions), 0);
    const trace = JSON.parse((await download(page, '#export-trace')).bytes);
    assert.equal(trace.iterations.at(-1).status, 'converged');
    assert.ok(trace.iterations.every(({ gini }) => gini.qpIterations <= 50));
  });

  onPage('bodies, what is held, and links', { query: '?mode=untangle&body=box&size=500&held=ends&start=point&energy=stable-neo-hookean&steps=3&state=result&cut=x&at=0.4', viewport: WIDE }, async (page) => {
    await shownIs(page, 3);
    const values = await page.evaluate(() => ['body', 'held', 'untangle-start', 'untangle-energy', 'cut', 'cut-at'].map((id) => document.getElementById(id).value));
    assert.deepEqual(values, ['box', 'ends', 'point', 'stable-neo-hookean', 'x', '40']);
    await page.selectOption('#body', 'gingerbread');
    await page.waitForFunction(() => globalThis.foldfreePage.session.planar);
    assert.equal(await page.inputValue('#untangle-energy'), 'arap');
    assert.match(page.url(), /body=gingerbread/);
    await page.selectOption('#held', 'nothing');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.pins.length === 0);
    await toTheEnd(page);
    assert.equal(await inverted(page), 0);
    await page.keyboard.press('m');
    assert.equal(await page.getAttribute('body', 'data-mode'), 'compare');
    assert.doesNotMatch(page.url(), /held=/);
    await page.click('[data-mode-button="untangle"]');
    assert.match(page.url(), /held=nothing/);
    assert.equal(await inverted(page), 0, 'what lay on the bench still does');
    await page.click('[data-mode-button="deform"]');
    await page.waitForFunction(() => globalThis.foldfreePage.session?.ready);
    assert.equal(await page.inputValue('#field'), 'stretch');
    assert.ok(await page.isHidden('#states') && await page.isVisible('#presets'));
  });

  onPage('files: a body, its tangled start, a list of pins; and what is wrong with them', { query: SQUARE, viewport: WIDE }, async (page) => {
    const solid = core.generateSolid('box', 400);
    let state = 5;
    const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32 - 0.5;
    const start = solid.positions.map((x) => x + 0.8 * random());
    const text = (bytes) => new TextDecoder().decode(bytes);
    const files = [
      { name: 'init.mesh', mimeType: 'text/plain', buffer: Buffer.from(solid.write('mesh', start)) },
      { name: 'rest.mesh', mimeType: 'text/plain', buffer: Buffer.from(solid.write('mesh')) },
      { name: 'pins.txt', mimeType: 'text/plain', buffer: Buffer.from('0\n1\n2\n') },
    ];
    await page.setInputFiles('#file', files);
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.name === 'rest.mesh');
    assert.equal(await inverted(page), invertedOf(solid, start));
    assert.deepEqual(await page.evaluate(() => [...globalThis.foldfreePage.session.problem.pins]), [0, 1, 2]);
    assert.ok(await page.isDisabled('#held') && await page.isDisabled('#untangle-start') && await page.isDisabled('#size'));
    await toTheEnd(page);
    assert.equal(await inverted(page), 0);
    const { name, bytes } = await download(page, '#export-solid');
    assert.equal(name, 'rest-untangled.mesh');
    assert.equal(invertedOf(solid, core.solid(bytes, 'mesh').positions), 0);
    // one file alone: its outside is held
    await drop(page, 'alone.mesh', text(solid.write('mesh')));
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.name === 'alone.mesh');
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.session.problem.pins.length), outsideOf(solid).length);
    assert.ok(await inverted(page) > 0);
    for (const [file, content, words] of [
      ['bent.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0.5\nv 1 1 0\nf 1 2 3\nf 2 4 3\n', /vertex 2 is not in the plane/],
      ['bad.obj', 'v 0 0 0\nf 1 2 3\n', /line 2/],
      ['pins.txt', '1\n', /needs its body/],
      ['a.png', 'x', /reads MESH/],
    ]) {
      await drop(page, file, content);
      await page.waitForFunction((source) => new RegExp(source, 'i').test(document.getElementById('notice-text').textContent), words.source);
      assert.match(await page.textContent('#notice-title'), /was not opened/);
      assert.equal(await page.evaluate(() => globalThis.foldfreePage.session.problem.source.name), 'alone.mesh');
    }
  });

  onPage('where pins leave no room it says so', { query: SQUARE, viewport: WIDE }, async (page) => {
    const { positions, indices } = FIGURES.square.make(100);
    const obj = (points) => {
      const mesh = core.mesh({ positions: points, indices });
      const bytes = mesh.write('obj');
      mesh.free();
      return Buffer.from(bytes);
    };
    await page.setInputFiles('#file', [
      { name: 'square.obj', mimeType: 'text/plain', buffer: obj(positions) },
      { name: 'start.obj', mimeType: 'text/plain', buffer: obj(positions.map((x, i) => (i % 3 === 0 ? 1 - x : x))) },
    ]);
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.name === 'square.obj');
    await page.waitForSelector('#notice:not([hidden])');
    assert.ok(await page.isHidden('#invite'));
    assert.match(await page.textContent('#notice-title'), /Not everything came free/);
    assert.match(await page.textContent('#notice-text'), /pinned boundary encloses.*Inverted or degenerate elements/s);
    assert.ok(await inverted(page) > 0);
    await page.click('[data-state="result"]');
    assert.ok(await inverted(page) > 0);
  });

  onPage('playing can be stopped, scrubbed and begun anew; views are drawn with a finger', { query: BAR, viewport: WIDE }, async (page) => {
    await page.selectOption('#pace', '30');
    await page.click('#unfold');
    await page.waitForFunction(() => globalThis.foldfreePage.shown > 3);
    await page.keyboard.press(' ');
    await page.waitForSelector('#play:not(.playing)');
    const { length } = await records(page);
    await page.keyboard.press('Home');
    await shownIs(page, 0);
    await page.keyboard.press('End');
    await shownIs(page, length - 1);
    // a click on the plot shows that part
    const box = await page.locator('#canvas').boundingBox();
    await page.mouse.click(box.x + 60, box.y + box.height - 60);
    await page.waitForFunction((k) => globalThis.foldfreePage.shown < k, length - 1);
    // nothing on the body is dragged
    await page.mouse.move(box.x + 250, box.y + 250);
    await page.mouse.down();
    await page.mouse.move(box.x + 300, box.y + 270);
    await page.mouse.up();
    await page.keyboard.press('r');
    await page.waitForFunction(() => globalThis.foldfreePage.session.records.length === 1 && globalThis.foldfreePage.shown === 0);
    assert.ok(await page.isVisible('#invite'));
  });

  test('is accessible, light and dark, on desks and phones, and fits them', async () => {
    const sizes = [[{ width: 1300, height: 800 }, 'light'], [{ width: 390, height: 780 }, 'dark']];
    for (const [viewport, colorScheme] of sizes) {
      for (const query of [`${BAR}&steps=4`, `${SQUARE}&steps=4`]) {
        const opened = await openPage(site, { query, viewport, colorScheme });
        await shownIs(opened.page, 4);
        await audit(opened.page, `${query}, ${viewport.width}, ${colorScheme}`);
        assert.equal(await opened.page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
        if (viewport.width < 720) {
          const tabs = await opened.page.$$eval('#view-tabs [role="tab"]', (list) => list.map((tab) => tab.textContent));
          assert.deepEqual(tabs, ['Cut', 'Body', 'Plot', 'Step']);
          for (const view of ['map', 'plot', 'inspector', 'shape']) await opened.page.click(`#view-tabs [data-view="${view}"]`);
          assert.ok(await opened.page.isVisible('#states'));
        }
        const line = await opened.page.locator('#status').evaluate((status) => [status.scrollWidth, status.clientWidth]);
        assert.ok(line[0] <= line[1] + 1, `${line}`);
        assert.deepEqual(opened.troubles, []);
        await opened.close();
      }
    }
  });
});
