// The Round mode of the built page, end to end.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { initSync } from '../../pkg/core.js';
import { arraysOf, makeProblem, sysOf } from '../page/round-problems.js';
import { ROUNDINGS, RoundSession } from '../page/round-session.js';
import { audit, download, drop, launch, onPageOf, openPage, root } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());
const onPage = onPageOf(() => site);

const core = initSync(readFileSync(join(root, 'pkg/single/foldfree_bg.wasm')));
const LATTICE = { problem: 'lattice', condition: 8, turn: 30, x: 0.4, y: 0.55 };
const CHAIN = { problem: 'chain', points: 16, coupling: 10, seed: 3 };

/** What the package says of a problem of the page. */
const solved = (wanted) => Object.fromEntries(ROUNDINGS.map((rounding) => {
  const { energy, report, x } = core.solveMixedInteger(arraysOf(makeProblem(wanted)), { rounding });
  return [rounding, { above: energy - report.relaxedEnergy, x: [...x] }];
}));
const state = (page) => page.evaluate(() => {
  const { mode, session, shown } = globalThis.foldfreePage;
  return {
    shown, finished: session.finished, steps: session.path.length - 1, minimum: [...session.minimum], rounding: session.rounding,
    x: [...session.path[shown].x], records: mode.records.length, wanted: mode.wanted,
    above: Object.fromEntries([...session.results].map(([name, { energy, report }]) => [name, energy - report.relaxedEnergy])),
  };
});
/** Waits until an iterate is shown, and drawn: that is with the next frame. */
const shownIs = async (page, index) => {
  await page.waitForFunction((i) => globalThis.foldfreePage.shown === i, index);
  await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }));
};
const cells = (page, name) => page.$$eval('#round-table tr', (rows, cell) => rows.map((row) => row.querySelector(cell).textContent), name);

describe('the session', () => {
  /** The package without a worker, in the shape the session takes. */
  const here = () => {
    const made = [];
    const mixedInteger = async (data, options) => {
      const solver = core.mixedInteger(data, options);
      made.push(options);
      return { start: solver.start, step: async () => solver.step(), resolve: async (change) => solver.resolve(change), result: async () => solver.result(), free: () => solver.free() };
    };
    return { session: new RoundSession({ mixedInteger }), made };
  };

  test('steps along what the solver did; a new minimum keeps how far one is', async () => {
    const { session, made } = here();
    assert.equal((await session.open(makeProblem(CHAIN), 'three-level')).length, 1);
    assert.deepEqual(made.map(({ engine }) => engine), ['three-level', 'three-level', 'dense', 'dense']);
    for (let k = 1; k <= 5; k++) assert.equal((await session.step()).iteration, k);
    const moved = session.minimum.map((m) => m + 0.2);
    assert.equal((await session.move(moved)).length, 6);
    assert.ok(session.path[0].x.every((x, i) => Math.abs(x - moved[i]) < 1e-9));
    while (await session.step());
    assert.ok(session.finished && session.records.length === 17);
    assert.ok(session.records.at(-1).x.every(Number.isInteger));
    assert.equal((await session.move(session.minimum.map((m) => m - 0.3))).length, 17, 'who was at the end stays there');
    assert.equal(session.choose('direct').length, 1);
  });

  test('what is overtaken ends early and changes nothing', async () => {
    const { session } = here();
    const [first, second] = await Promise.all([session.open(makeProblem(CHAIN), 'exact'), session.open(makeProblem(LATTICE), 'exact')]);
    assert.equal(first, undefined);
    assert.equal(second.length, 1);
    assert.equal(session.problem.kind, 'lattice');
    const [, last] = await Promise.all([session.move([0.1, 0.2]), session.move([0.7, 0.2])]);
    assert.equal(last.length, 1);
    assert.deepEqual(session.minimum, [0.7, 0.2]);
  });

  test('a problem as .sys is the same problem', () => {
    for (const wanted of [LATTICE, CHAIN]) {
      const problem = makeProblem(wanted);
      const [a, b] = [arraysOf(problem), sysOf(problem, problem.minimum)].map((data) => core.solveMixedInteger(data, { rounding: 'lattice' }));
      assert.deepEqual(a.x, b.x);
    }
  });
});

describe('two integers', () => {
  onPage('the four roundings are those of the package; steps go to the optimum and say how', { query: '?mode=round&rounding=two-opt' }, async (page) => {
    const expected = solved(LATTICE);
    assert.ok(expected.direct.above > expected.greedy.above && expected.greedy.above > expected.lattice.above + 0.1, 'a telling first picture');
    const { above, steps } = await state(page);
    for (const name of ROUNDINGS) assert.ok(Math.abs(above[name] - expected[name].above) < 1e-9);
    assert.deepEqual(await cells(page, '.energy'), ROUNDINGS.map((name) => expected[name].above.toPrecision(3)));
    assert.equal((await cells(page, '.more')).at(-1), 'proven');
    assert.match(await page.textContent('#status'), /step 0 of \d · energy \+0 · 0 of 2 rounded/);
    await page.click('#unfold');
    await page.waitForFunction(() => globalThis.foldfreePage.session.finished);
    await page.waitForSelector('#play:not(.playing)');
    const end = await state(page);
    assert.deepEqual(end.x, expected['two-opt'].x);
    assert.equal(end.shown, steps);
    assert.match(await page.textContent('#status'), /2 of 2 rounded/);
    await page.keyboard.press('Home');
    assert.match(await page.textContent('#round-head'), /minimum without integrality/);
    await page.keyboard.press('ArrowRight');
    assert.match(await page.textContent('#round-text'), /^x 0.400 → 0\. The exact update made the others follow: 1 of 1 moved/);
    assert.equal(await page.locator('.fixed').count(), 1, 'the line on which x is fixed');
    await page.keyboard.press('ArrowRight');
    await page.keyboard.press('ArrowRight');
    assert.match(await page.textContent('#round-text'), /lowers the energy by 0\.189/);
  });

  onPage('the minimum follows the pointer, and every number with it', { query: '?mode=round', viewport: { width: 1200, height: 760 } }, async (page) => {
    const box = await page.locator('.picture .handle .halo').boundingBox();
    const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    for (let k = 1; k <= 12; k++) await page.mouse.move(x + 9 * k, y - 5 * k);
    await page.mouse.up();
    await page.waitForFunction(() => globalThis.foldfreePage.mode.wanted.x > 1);
    // drawn when the worker has answered
    let [there, away] = [];
    for (let wait = 0; wait < 100 && !(away < 3); wait++) {
      await page.waitForTimeout(50);
      there = await page.locator('.picture .handle .halo').boundingBox();
      away = Math.hypot(there.x - box.x - 108, there.y - box.y + 60);
    }
    assert.ok(away < 3, `the cross is under the pointer: ${away}`);
    const moved = await state(page);
    const expected = solved({ ...LATTICE, x: moved.minimum[0], y: moved.minimum[1] });
    for (const name of ROUNDINGS) assert.ok(Math.abs(moved.above[name] - expected[name].above) < 1e-9, name);
    assert.match(page.url(), /x=1\.\d+/);
    // far outside: it stays where it can be seen
    await page.mouse.move(there.x + there.width / 2, there.y + there.height / 2);
    await page.mouse.down();
    await page.mouse.move(1190, 20);
    await page.mouse.up();
    await page.waitForFunction(() => globalThis.foldfreePage.session.minimum[0] > 3.1);
    assert.deepEqual((await state(page)).minimum.map((m) => Math.round(100 * m) / 100), [3.15, 2.75]);
  });

  onPage('a wide valley makes direct rounding right; keys do all of it', { query: '?mode=round&x=0.3&y=0.2' }, async (page) => {
    await page.fill('#condition', '0');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.wanted.condition === 1 && /^0.0650$/.test(document.querySelector('#round-table .energy').textContent));
    assert.deepEqual(new Set((await cells(page, '.more')).slice(0, 3)), new Set(['the same']));
    await page.focus('.picture .handle');
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => Math.abs(globalThis.foldfreePage.session.minimum[0] - 0.35) < 1e-9);
    assert.equal((await state(page)).shown, 0, 'no step was made');
    await page.evaluate(() => document.activeElement.blur());
    await page.keyboard.press('i');
    await page.waitForFunction(() => Math.abs(globalThis.foldfreePage.session.minimum[1] - 0.25) < 1e-9);
    await page.keyboard.press('1');
    assert.equal(await page.inputValue('#rounding'), 'direct');
    await page.keyboard.press('y');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.wanted.turn === 25);
  });
});

describe('a chain', () => {
  onPage('shows the order of the roundings and how far each step spreads', { query: '?mode=round&problem=chain&updates=three-level', viewport: { width: 1200, height: 760 } }, async (page) => {
    const expected = solved(CHAIN);
    assert.deepEqual(await cells(page, '.energy'), ROUNDINGS.map((name) => expected[name].above.toPrecision(3)));
    assert.equal(await page.locator('.column').count(), 0);
    for (let k = 1; k <= 3; k++) {
      await page.click('#step');
      await shownIs(page, k);
      assert.equal(await page.locator('rect.value').count(), k + 1, 'with the one of the legend');
      assert.deepEqual(await page.$$eval('.rank', (ranks) => ranks.map((rank) => rank.textContent).toSorted()), Array.from({ length: k }, (_, i) => String(i + 1)));
      assert.match(await page.textContent('#round-text'), /point \d+: [\d.]+ → \d+\. (Local Gauss–Seidel|Conjugate gradients|Sparse Cholesky) made the others follow/);
    }
    const { x } = await state(page);
    assert.equal(x.filter((v) => Math.abs(v - Math.round(v)) < 1e-9).length, 3);
    assert.ok(await page.locator('.column').count() >= 1);
    await page.fill('#history', '1');
    assert.match(await page.textContent('#status'), /step 1 of 16/);
    assert.match(await page.textContent('#spoken'), /greedy, step 1 of 16, energy \+[\d.e-]+, 1 of 16 rounded/);
  });

  onPage('a point is dragged; another chain, other points, more coupling', { query: '?mode=round&problem=chain&steps=16', viewport: { width: 1200, height: 760 } }, async (page) => {
    await shownIs(page, 16);
    const before = await state(page);
    const box = await page.locator('.picture .handle .halo').nth(4).boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2 - 120, { steps: 6 });
    await page.mouse.up();
    await page.waitForFunction((m) => globalThis.foldfreePage.session.minimum[4] > m + 1, before.minimum[4]);
    const after = await state(page);
    assert.deepEqual(after.minimum.filter((m, i) => m !== before.minimum[i]).length, 1);
    assert.equal(after.shown, 16, 'the end stays on show');
    await page.click('#share');
    // The notice comes when the clipboard has answered.
    await page.waitForFunction(() => /dragged are not in it/.test(document.getElementById('notice-text').textContent));
    await page.click('#another');
    await page.waitForFunction(() => globalThis.foldfreePage.session.minimum[0] && /seed=4/.test(location.search));
    await page.selectOption('#points', '8');
    await page.waitForFunction(() => globalThis.foldfreePage.session.minimum.length === 8);
    const loose = (await state(page)).above.direct;
    await page.fill('#coupling', '40');
    await page.waitForFunction((above) => globalThis.foldfreePage.session.results.get('direct').energy - globalThis.foldfreePage.session.results.get('direct').report.relaxedEnergy > above, loose);
  });
});

describe('among the other modes', () => {
  onPage('comes after the others, leaves them as they were, and has its own exports', { query: '?triangles=1000' }, async (page) => {
    await page.click('#step');
    await shownIs(page, 1);
    await page.click('[data-mode-button="round"]');
    await page.waitForFunction(() => globalThis.foldfreePage.session?.ready);
    assert.ok(await page.isHidden('#open'));
    assert.equal(await page.inputValue('#pace'), '4');
    assert.equal(await page.locator('#canvas').evaluate((canvas) => getComputedStyle(canvas).visibility), 'hidden');
    const sys = await download(page, '#export-sys');
    assert.equal(sys.name, 'lattice.sys');
    const { x } = core.solveMixedInteger(sys.bytes, { rounding: 'lattice' });
    assert.deepEqual([...x], solved(LATTICE).lattice.x);
    const trace = JSON.parse((await download(page, '#export-trace')).bytes);
    assert.deepEqual(trace.roundings.map(({ rounding }) => rounding), ROUNDINGS);
    assert.deepEqual(trace.roundings[1].steps.at(-1).x, solved(LATTICE).greedy.x);
    await drop(page, 'teapot.obj', 'v 0 0 0');
    assert.match(await page.textContent('#notice-text'), /own two problems/);
    await page.keyboard.press('m');
    assert.equal(await page.getAttribute('body', 'data-mode'), 'flatten');
    assert.equal(await page.inputValue('#pace'), '12');
    assert.match(await page.textContent('#status'), /iteration 1/);
  });

  test('is accessible, light and dark, on desks and phones, and fits them', async () => {
    const sizes = [[{ width: 1280, height: 800 }, 'light'], [{ width: 390, height: 780 }, 'dark']];
    for (const [viewport, colorScheme] of sizes) {
      for (const problem of ['lattice', 'chain']) {
        const opened = await openPage(site, { query: `?mode=round&problem=${problem}&steps=2`, viewport, colorScheme });
        await shownIs(opened.page, 2);
        await audit(opened.page, `${problem}, ${viewport.width}, ${colorScheme}`);
        assert.equal(await opened.page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
        const status = await opened.page.locator('#status').boundingBox();
        assert.ok(await opened.page.locator('#status').evaluate((line) => line.scrollWidth <= line.clientWidth + 1), `${status.width}`);
        assert.deepEqual(opened.troubles, []);
        await opened.close();
      }
    }
  });
});
