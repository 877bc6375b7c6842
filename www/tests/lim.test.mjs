// Locally injective mappings in the Deform mode of the built page, end to end.
import assert from 'node:assert/strict';
import { after, before, describe, test } from 'node:test';
import { FIGURES, along, isFigure } from '../page/figures.js';
import { areaOf } from '../page/relative.js';
import { scene } from '../page/presets.js';
import { audit, download, launch, onPageOf, status } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());
const onPage = onPageOf(() => site);

const WIDE = { width: 1300, height: 820 };
const MAN = '?mode=deform&solid=gingerbread&tetrahedra=600';

const rest = (page) => page.waitForFunction(
  () => globalThis.foldfreePage.session.finished && !globalThis.foldfreePage.mode.restless && !globalThis.foldfreePage.mode.playing,
  null, { timeout: 120_000 },
);
const records = (page) => page.evaluate(() => globalThis.foldfreePage.session.records);
const place = (page, vertex) => page.evaluate((v) => {
  const { left, top } = document.getElementById('canvas').getBoundingClientRect();
  const [x, y] = globalThis.foldfreePage.bench.placeOf(v);
  return [left + x, top + y];
}, vertex);

describe('figures', () => {
  for (const [name, figure] of Object.entries(FIGURES)) {
    test(`${name} is a disk of well-shaped triangles, as many as were asked for`, () => {
      for (const wanted of [500, 2000, 8000]) {
        const { positions, indices } = figure.make(wanted);
        const [vertices, triangles] = [positions.length / 3, indices.length / 3];
        assert.ok(Math.abs(triangles / wanted - 1) < 0.06, `${triangles} of ${wanted}`);
        const edges = new Map();
        for (let t = 0; t < indices.length; t += 3) {
          const corners = indices.subarray(t, t + 3);
          const [a, b, c] = [...corners].map((v) => positions.subarray(3 * v, 3 * v + 2));
          const twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
          const squares = [[a, b], [b, c], [c, a]].reduce((sum, [p, q]) => sum + (p[0] - q[0]) ** 2 + (p[1] - q[1]) ** 2, 0);
          assert.ok((2 * Math.sqrt(3) * twice) / squares > 0.3, `triangle ${t / 3} of ${wanted}`);
          for (let k = 0; k < 3; k += 1) {
            const key = [corners[k], corners[(k + 1) % 3]].sort((p, q) => p - q).join();
            edges.set(key, (edges.get(key) ?? 0) + 1);
          }
        }
        assert.ok([...edges.values()].every((count) => count <= 2));
        assert.equal(vertices - edges.size + triangles, 1);
        assert.ok(areaOf(positions, indices) > 0.9);
        assert.ok(figure.held.every((find) => find(positions).length > 0));
      }
    });
  }

  test('a drag begins where the handle is and ends at the end of its path', () => {
    const figure = FIGURES.square;
    const { positions } = figure.make(200);
    const { motion, held, start } = scene('drag', positions, undefined, figure);
    assert.equal(motion.handle, held.length - 1);
    assert.deepEqual([...start], [...positions]);
    assert.deepEqual([...motion.at(0)], [1, 1, 0]);
    [0.2, 0.2, 0].forEach((x, k) => assert.ok(Math.abs(motion.at(1)[k] - x) < 1e-12));
    assert.deepEqual([...along(Float64Array.of(0, 0, 5), [[0, 0], [2, 0], [2, 4]], 0.75)], [2, 2, 5]);
    assert.equal(scene('held', positions, undefined, figure).motion, undefined);
    assert.ok(isFigure('square') && !isFigure('bar') && !isFigure('toString'));
  });
});

describe('the page', () => {
  onPage('a hand is drawn where it hardly goes: nothing inverts, and without the barrier something does', { query: MAN, viewport: WIDE }, async (page) => {
    assert.equal(await page.inputValue('#deform-method'), 'lim');
    assert.match(await page.textContent('#invite'), /Drag/);
    assert.ok(await page.isHidden('#young') && await page.isVisible('#lim-barrier'));
    await page.selectOption('#pace', '0');
    await page.click('#unfold');
    await rest(page);
    const kept = await records(page);
    assert.ok(kept.length > 20 && kept.every(({ inverted, lim }) => inverted === 0 && lim.handles > 0));
    assert.equal(kept.at(-1).status, 'converged');
    assert.equal(kept.at(-1).lim.positionalError, 0);
    assert.match((await status(page)).text, /0 inverted/);
    const facts = await page.evaluate(() => globalThis.foldfreePage.session.certificate);
    assert.equal(facts.inverted.length, 0);
    // On the boundary a figure may lap over itself beside a vertex; inside, nothing winds twice.
    assert.equal(facts.overwoundInside, 0);
    await page.click('#lim-barrier');
    assert.equal(await page.textContent('#lim-barrier'), 'Barrier off');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.barrier === false);
    await rest(page);
    const without = await records(page);
    assert.ok(Math.max(...without.map(({ inverted }) => inverted)) > 0);
    assert.ok(await page.isHidden('#notice'));
    assert.match(page.url(), /barrier=off/);
  });

  onPage('the handle of a square is dragged with the mouse, at any Hessian and energy; sub-targets are drawn', { query: '?mode=deform&solid=square&tetrahedra=400&preset=held&hessian=frozen&energy=green-strain', viewport: WIDE }, async (page) => {
    const corner = await page.evaluate(() => globalThis.foldfreePage.session.solid.positions.length / 3 - 1);
    const [from, low] = [await place(page, corner), await place(page, 0)];
    await page.mouse.move(...from);
    await page.mouse.down();
    for (let i = 1; i <= 6; i += 1) {
      const to = from.map((x, k) => x + ((low[k] - x) * 0.75 * i) / 6);
      await page.mouse.move(...to);
      await page.waitForTimeout(40);
    }
    await page.mouse.up();
    await rest(page);
    const steps = await records(page);
    assert.ok(steps.length > 5 && steps.every(({ inverted }) => inverted === 0));
    assert.ok(steps.some(({ lim }) => lim.mu > 0 && lim.subStep < 1), 'there were sub-steps');
    const [x, y] = await page.evaluate((v) => [...globalThis.foldfreePage.session.positions.slice(3 * v, 3 * v + 3)], corner);
    assert.ok(Math.abs(x - 0.25) < 0.06 && Math.abs(y - 0.25) < 0.06, `${x} ${y}`);
    await page.selectOption('#lim-hessian', 'projected');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.hessian === 'projected');
    await rest(page);
    const again = await records(page);
    assert.ok(again.every(({ inverted, lim }) => inverted === 0 && lim.mu === 0));
    const moved = await page.evaluate((v) => [...globalThis.foldfreePage.session.positions.slice(3 * v, 3 * v + 2)], corner);
    assert.ok(Math.abs(moved[0] - x) < 1e-6 && Math.abs(moved[1] - y) < 1e-6, 'the same drag again');
    for (const energy of ['dirichlet', 'lscm', 'laplacian', 'uniform-laplacian', 'arap']) {
      await page.selectOption('#lim-energy', energy);
      await page.waitForFunction((e) => globalThis.foldfreePage.session.problem.settings.energy === e, energy);
      await rest(page);
      assert.ok((await records(page)).every(({ inverted }) => inverted === 0), energy);
    }
    const { name, bytes } = await download(page, '#export-solid');
    assert.equal(name, 'square-lim.obj');
    assert.match(bytes.toString(), /^v [^\n]+\n(v [^\n]+\n)+(f \d+ \d+ \d+\n)+$/);
  });

  onPage('a solid is twisted, and nothing inverts', { query: '?mode=deform&tetrahedra=1000&preset=twist&method=lim', viewport: WIDE }, async (page) => {
    await page.selectOption('#pace', '0');
    await page.click('#unfold');
    await rest(page);
    const steps = await records(page);
    assert.ok(steps.length > 20 && steps.every(({ inverted }) => inverted === 0));
  });

  onPage('from an inverted iterate the method says what to do, and nothing changes', { query: '?mode=deform&tetrahedra=1000&preset=random', viewport: WIDE }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 1);
    assert.ok((await status(page)).inverted > 0);
    await page.selectOption('#deform-method', 'lim');
    await page.waitForSelector('#notice:not([hidden])');
    assert.match(await page.textContent('#notice'), /inverted or degenerate elements, the first of them element \d+.*untangle the start first/s);
    assert.equal(await page.inputValue('#deform-method'), 'wrapd');
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.session.newest.iteration >= 2);
  });

  onPage('between figures and solids methods and presets follow', { query: '?mode=deform&tetrahedra=1000&preset=held', viewport: WIDE }, async (page) => {
    await page.selectOption('#solid', 'square');
    await page.waitForFunction(() => globalThis.foldfreePage.session.planar);
    assert.equal(await page.inputValue('#deform-method'), 'lim');
    assert.deepEqual(await page.$$eval('#presets button:not([hidden])', (list) => list.map((b) => b.textContent)), ['At rest', 'Drag']);
    await audit(page, 'a figure');
    await page.selectOption('#solid', 'bar');
    await page.waitForFunction(() => !globalThis.foldfreePage.session.planar);
    assert.ok(await page.isHidden('[data-preset="drag"]'));
    assert.equal(await page.inputValue('#deform-method'), 'lim');
    await page.selectOption('#deform-method', 'wrapd');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.method === 'wrapd');
    assert.ok(await page.isVisible('#young') && await page.isHidden('#lim-barrier'));
  });

  onPage('a figure of 2 000 triangles follows at 30 steps a second', { query: '?mode=deform&solid=gingerbread&preset=drag', viewport: WIDE }, async (page) => {
    await page.selectOption('#pace', '0');
    await page.click('#unfold');
    await rest(page);
    const steps = await records(page);
    const seconds = steps.at(-1).seconds / steps.at(-1).iteration;
    assert.ok(steps.every(({ inverted }) => inverted === 0));
    assert.ok(seconds < 1 / 30, `${(1000 * seconds).toFixed(1)} ms a step`);
  });
});
