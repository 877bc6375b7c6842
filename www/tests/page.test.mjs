// The built page, end to end: node --test www/tests
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { initSync } from '../../pkg/core.js';
import { preparedStart } from '../prepare-start.mjs';
import { audit, download, drop, launch, onPageOf, openPage, playToTheEnd, root, status, wavySheet } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());

const onPage = onPageOf(() => site);

describe('opening', () => {
  test('the prepared start is up to date (else: node www/prepare-start.mjs)', () => {
    const read = (bytes) => {
      const [, vertices, triangles] = new Uint32Array(bytes.buffer, bytes.byteOffset, 3);
      const floats = new Float32Array(bytes.buffer.slice(bytes.byteOffset + 64, bytes.byteOffset + bytes.length));
      return { vertices, triangles, positions: floats.subarray(0, 3 * vertices), map: floats.subarray(-2 * vertices) };
    };
    const [kept, made] = [read(readFileSync(join(root, 'www/assets/start.bin'))), read(preparedStart())];
    assert.deepEqual([kept.vertices, kept.triangles], [made.vertices, made.triangles]);
    for (const part of ['positions', 'map']) {
      assert.ok(kept[part].every((x, i) => Math.abs(x - made[part][i]) < 1e-5), part);
    }
  });

  onPage('shows the folded start before the solver has come', {
    ready: false,
    prepare: (page) => page.route(/\/pkg\/(single|threads)\/.*\.wasm$/, async (route) => {
      await new Promise((done) => { setTimeout(done, 4000); });
      await route.continue();
    }),
  }, async (page) => {
    await page.waitForSelector('body[data-drawn="prepared"]', { state: 'attached' });
    assert.equal(await page.getAttribute('body', 'data-solver'), null);
    const { iteration, inverted } = await status(page);
    assert.equal(iteration, 0);
    assert.ok(inverted > 1000, 'a folded start');
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted), inverted);
    assert.ok(await page.isVisible('#unfold'), 'one obvious button');
    // It works already: what it asks for is done when the solver is there.
    await page.click('#unfold');
    await page.waitForFunction(() => globalThis.foldfreePage.shown > 2);
  });

  onPage('the prepared start is the one the solver makes', {}, async (page) => {
    const first = await status(page);
    assert.ok(first.inverted > 1000 && first.iteration === 0, first.text);
    const drawn = await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted);
    assert.equal(drawn, first.inverted);
  });

  onPage('an address opens its bench', { query: '?sample=torus&triangles=1000&start=tutte&method=r-admm&at=3&theme=dark' }, async (page) => {
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 3);
    assert.equal(await page.inputValue('#sample'), 'torus');
    assert.equal(await page.inputValue('#method'), 'r-admm');
    assert.equal(await page.inputValue('#start'), 'tutte');
    assert.equal(await page.getAttribute('html', 'data-theme'), 'dark');
  });
});

describe('solving', () => {
  onPage('steps, plays until nothing is inverted, and scrubs back', { query: '?triangles=1000' }, async (page) => {
    assert.ok((await status(page)).inverted > 100);
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    assert.equal((await status(page)).iteration, 1);
    await playToTheEnd(page);
    const end = await status(page);
    assert.equal(end.inverted, 0);
    assert.ok(end.energy > 1 && end.energy < 1.5, end.text);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted), 0);
    assert.match(await page.textContent('#spoken'), /^iteration \d+, energy [\d.]+, 0 inverted$/);

    await page.fill('#history', '0');
    const back = await status(page);
    assert.equal(back.iteration, 0);
    assert.ok(back.inverted > 100);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted), back.inverted);
    await page.fill('#history', '2');
    assert.equal((await status(page)).iteration, 2);
  });

  onPage('keyboard: step, ten steps, back, end, reset', { query: '?triangles=1000&start=automatic' }, async (page) => {
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.keyboard.press('Shift+ArrowRight');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 8);
    await page.keyboard.press('Home');
    assert.equal((await status(page)).iteration, 0);
    await page.keyboard.press('End');
    assert.ok((await status(page)).iteration >= 8);
    await page.keyboard.press('r');
    await page.waitForFunction(() => globalThis.foldfreePage.session.records.length === 1);
    await page.keyboard.press('?');
    assert.ok(await page.isVisible('#help-dialog'));
  });

  onPage('projector, theme and switches of the views', { query: '?triangles=1000&start=automatic' }, async (page) => {
    for (const key of ['w', 'c', 'e', 'x', 'f']) await page.keyboard.press(key);
    await page.keyboard.press('p');
    assert.ok(await page.isHidden('#sample'));
    assert.ok(await page.isVisible('#status'));
    await page.keyboard.press('Escape');
    assert.ok(await page.isVisible('#sample'));
    const before = await page.evaluate(() => getComputedStyle(document.body).backgroundColor);
    await page.keyboard.press('t');
    assert.notEqual(await page.evaluate(() => getComputedStyle(document.body).backgroundColor), before);
    assert.match(page.url(), /theme=dark/);
  });

  onPage('every solver runs on the same problem, and its curve stays', { query: '?triangles=1000&start=automatic' }, async (page) => {
    for (const method of ['admm-pd', 'w-admm', 'r-admm', 'slim', 'cm', 'wrapd+cm', 'arap', 'lscm', 'harmonic', 'tutte', 'wrapd']) {
      await page.selectOption('#method', method);
      await page.waitForFunction((m) => globalThis.foldfreePage.session.problem.settings.method === m, method);
      await page.click('#step-ten');
      await page.waitForFunction(() => globalThis.foldfreePage.session.finished || globalThis.foldfreePage.session.records.length > 10);
      assert.ok((await status(page)).iteration >= (['lscm', 'harmonic', 'tutte'].includes(method) ? 0 : 1), method);
    }
    assert.ok(await page.isHidden('#notice'));
  });
});

describe('second-order methods', () => {
  onPage('CM is picked on a folded start: it begins at one without inversions, and says so', { query: '?triangles=1000' }, async (page) => {
    assert.equal(await page.inputValue('#start'), 'random');
    await page.selectOption('#method', 'cm');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem?.settings.method === 'cm');
    assert.equal(await page.inputValue('#start'), 'automatic');
    assert.match(await page.textContent('#notice'), /cannot begin with inverted triangles/);
    await playToTheEnd(page);
    const end = await status(page);
    assert.ok(end.inverted === 0 && end.iteration < 40 && end.energy < 1.2, end.text);
    // but who asks for the impossible is told
    await page.selectOption('#start', 'random');
    await page.waitForFunction(() => /CM could not start/.test(document.getElementById('notice').textContent));
    assert.equal(await page.inputValue('#start'), 'automatic');
  });

  onPage('GINI on a start that overlaps begins in a circle, and says so', { query: '?triangles=1000' }, async (page) => {
    assert.equal(await page.inputValue('#start'), 'random');
    await page.selectOption('#method', 'gini');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem?.settings.method === 'gini');
    assert.equal(await page.textContent('#notice-title'), 'Another start');
    assert.match(await page.textContent('#notice-text'), /^The boundary of the start meets itself.*begins in a circle/);
    assert.ok(await page.isVisible('#notice.plain'));
    await page.selectOption('#start', 'tutte');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem?.settings.start === 'tutte');
    assert.ok(await page.isHidden('#notice'));
  });

  onPage('a hybrid says when it switched, from an address', { query: '?triangles=1000&method=wrapd+cm' }, async (page) => {
    assert.equal(await page.inputValue('#method'), 'wrapd+cm');
    assert.equal(await page.inputValue('#start'), 'random');
    await playToTheEnd(page);
    const records = await page.evaluate(() => globalThis.foldfreePage.session.records);
    const { switchedAt, iteration, inverted } = records.at(-1);
    assert.ok(switchedAt >= 1 && switchedAt < iteration && inverted === 0);
    assert.ok(records[switchedAt - 1].inverted > 0 && records[switchedAt - 1].switchedAt === undefined, 'WRAPD ends when nothing is inverted');
    assert.match(page.url(), /method=wrapd%2Bcm/);
    const trace = JSON.parse((await download(page, '#export-trace')).bytes.toString());
    assert.equal(trace.iterations.at(-1).switchedAt, switchedAt);
  });
});

describe('files', () => {
  const core = () => initSync(readFileSync(join(root, 'pkg/single/foldfree_bg.wasm')));

  onPage('what is exported parses back, with a map that has no fold', { query: '?triangles=1000' }, async (page) => {
    await playToTheEnd(page);
    const { name, bytes } = await download(page, '#export-obj');
    assert.equal(name, 'bumpy-cap-wrapd.obj');
    const foldfree = core();
    const mesh = foldfree.mesh(bytes, 'obj');
    assert.equal(mesh.texture.corners.length, mesh.indices.length);
    const uv = new Float64Array((2 * mesh.positions.length) / 3);
    mesh.indices.forEach((v, corner) => uv.set(mesh.texture.coordinates.subarray(2 * mesh.texture.corners[corner], 2 * mesh.texture.corners[corner] + 2), 2 * v));
    const certificate = foldfree.check(mesh, uv);
    assert.equal(certificate.inverted.length, 0);

    const trace = JSON.parse((await download(page, '#export-trace')).bytes.toString());
    assert.equal(trace.settings.method, 'wrapd');
    assert.equal(trace.iterations[0].iteration, 0);
    assert.equal(trace.iterations.at(-1).inverted, 0);
    assert.equal(trace.certificate.locallyInjective, true);
    assert.ok(trace.iterations[1].phases.some((phase) => phase.kind === 'global'));
  });

  onPage('a bad file is told off by its line, and the bench stays', { query: '?triangles=1000' }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    const before = await status(page);
    await drop(page, 'broken.obj', 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n');
    await page.waitForSelector('#notice:visible');
    const message = await page.textContent('#notice');
    assert.match(message, /broken\.obj/);
    assert.match(message, /line 4/i);
    assert.equal((await status(page)).text, before.text);
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 2);

    const bad = {
      'empty.obj': '', 'words.off': 'hello', 'nan.obj': 'v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n', 'picture.png': 'x',
      'flat.obj': 'v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n',
      'huge.off': 'OFF\n90000000 90000000 0\n0 0 0\n',
    };
    for (const [name, text] of Object.entries(bad)) {
      await page.click('#notice-close').catch(() => {});
      await drop(page, name, text);
      await page.waitForFunction((n) => !document.getElementById('notice').hidden && document.getElementById('notice').textContent.includes(n), name);
    }
    assert.equal((await status(page)).iteration, 2);
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 3);
  });

  onPage('a dropped file is flattened', {}, async (page) => {
    await drop(page, 'sheet.obj', wavySheet(20));
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.name === 'sheet.obj');
    assert.equal(await page.inputValue('#start'), 'automatic');
    await playToTheEnd(page);
    const end = await status(page);
    assert.ok(end.inverted === 0 && end.energy < 1.2, end.text);
    assert.ok(await page.isHidden('#notice'));
  });
});

describe('for everybody', () => {
  for (const colorScheme of ['light', 'dark']) {
    onPage(`no accessibility violation, ${colorScheme}`, { colorScheme, query: '?triangles=1000', viewport: { width: 1300, height: 800 } }, async (page) => {
      await audit(page, 'start');
      await page.click('#step');
      await page.click('#export');
      await audit(page, 'menu');
      await page.keyboard.press('Escape');
      await page.click('#help');
      await audit(page, 'help');
    });
  }

  onPage('a phone shows one view at a time', { query: '?triangles=1000', viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true }, async (page) => {
    await audit(page, 'phone');
    await page.tap('[role="tab"][data-view="plot"]');
    assert.equal(await page.getAttribute('[role="tab"][data-view="plot"]', 'aria-selected'), 'true');
    await page.tap('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.tap('#setup-toggle');
    assert.ok(await page.isVisible('#method'));
    const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
    assert.equal(wide, false, 'nothing scrolls sideways');
  });
});

test('without COOP and COEP it runs on one thread', async () => {
  const bare = await launch({ isolation: false });
  try {
    const { page, troubles } = await openPage(bare, { query: '?triangles=1000' });
    assert.equal(await page.evaluate(() => crossOriginIsolated), false);
    await playToTheEnd(page);
    assert.equal((await status(page)).inverted, 0);
    assert.deepEqual(troubles, []);
  } finally {
    await bare.close();
  }
});
