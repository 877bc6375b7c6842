// The Deform mode of the built page, end to end.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, describe, test } from 'node:test';
import { initSync } from '../../pkg/core.js';
import { Handles } from '../page/handles.js';
import { landmarks } from '../page/landmarks.js';
import { MATERIALS } from '../page/materials.js';
import { Motion } from '../page/motion.js';
import { bounds, collapsed, ends, scattered, scene, turned } from '../page/presets.js';
import { relativeTo, volumeOf } from '../page/relative.js';
import { preparedSolid } from '../prepare-start.mjs';
import { audit, download, drop, launch, onPageOf, root, status } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());
const onPage = onPageOf(() => site);
const library = () => initSync(readFileSync(join(root, 'pkg/single/foldfree_bg.wasm')));

const SMALL = '?mode=deform&tetrahedra=1500';
const WIDE = { width: 1300, height: 820 };

/** Waits until nothing moves any more. */
const rest = (page) => page.waitForFunction(
  () => globalThis.foldfreePage.session.finished && !globalThis.foldfreePage.mode.restless && !globalThis.foldfreePage.mode.playing,
  null, { timeout: 120_000 },
);

/** Where a vertex is on the screen, in the view of the whole solid. */
const place = (page, vertex) => page.evaluate((v) => {
  const { left, top } = document.getElementById('canvas').getBoundingClientRect();
  const [x, y] = globalThis.foldfreePage.bench.placeOf(v);
  return [left + x, top + y];
}, vertex);

/** A vertex on the skin, in the middle of the solid and on top. */
const topVertex = (page) => page.evaluate(() => {
  const p = globalThis.foldfreePage.session.solid.positions;
  const middle = (k) => p.reduce((sum, x, i) => (i % 3 === k ? sum + x : sum), 0) / (p.length / 3);
  const [mx, my] = [middle(0), middle(1)];
  let best = [0, -Infinity];
  for (let v = 0; v < p.length / 3; v += 1) {
    const score = 5 * p[3 * v + 2] - Math.hypot(p[3 * v] - mx, p[3 * v + 1] - my);
    if (score > best[1]) best = [v, score];
  }
  return best[0];
});

/** Drags with the mouse, slowly enough to be seen on the way. */
async function drag(page, from, to, { during, release = true } = {}) {
  await page.mouse.move(...from);
  await page.mouse.down();
  for (let i = 1; i <= 8; i += 1) {
    await page.mouse.move(from[0] + ((to[0] - from[0]) * i) / 8, from[1] + ((to[1] - from[1]) * i) / 8);
    await page.waitForTimeout(40);
  }
  await during?.();
  if (release) await page.mouse.up();
}

const pinned = (page) => page.evaluate(() => globalThis.foldfreePage.mode.handles.groups.map(({ vertices }) => vertices.length));

/** The position of a vertex in the newest iterate. */
const positionOf = (page, vertex) => page.evaluate((v) => [...globalThis.foldfreePage.session.positions.slice(3 * v, 3 * v + 3)], vertex);

describe('scenes and handles', () => {
  const bar = Float64Array.from({ length: 3 * 44 }, (_, i) => {
    const v = Math.floor(i / 3);
    return [v % 11, Math.floor(v / 11) % 2, Math.floor(v / 22)][i % 3];
  });

  test('ends are the extreme eight per cent of the longest axis', () => {
    const { axis, low, high } = ends(bar);
    assert.equal(axis, 0);
    assert.ok(low.length === 4 && low.every((v) => bar[3 * v] === 0));
    assert.ok(high.length === 4 && high.every((v) => bar[3 * v] === 10));
  });

  test('turning keeps the middle and comes round', () => {
    const points = Float64Array.of(0, 1, 0, 0, -1, 0, 0, 0, 2, 0, 0, -2);
    const back = turned(turned(points, 0, 1.1), 0, -1.1);
    back.forEach((x, i) => assert.ok(Math.abs(x - points[i]) < 1e-12));
    const half = turned(points, 0, Math.PI);
    assert.ok(Math.abs(half[1] + 1) < 1e-12);
  });

  test('noise and collapse spare what is held, and stay in the box', () => {
    for (const spoil of [scattered, collapsed]) {
      const spoilt = spoil(bar, bar, [0, 5]);
      assert.deepEqual([...spoilt.slice(0, 3)], [...bar.slice(0, 3)]);
      assert.deepEqual([...spoilt.slice(15, 18)], [...bar.slice(15, 18)]);
      const moved = Array.from({ length: 44 }, (_, v) => [0, 1, 2].some((k) => spoilt[3 * v + k] !== bar[3 * v + k]));
      assert.deepEqual(moved.flatMap((far, v) => (far ? [] : [v])), [0, 5], 'all but those moved');
      const places = new Set(Array.from({ length: 44 }, (_, v) => spoilt.slice(3 * v, 3 * v + 3).join(' ')));
      assert.equal(places.size, spoil === scattered ? 44 : 3, 'each to a place of its own, or all to one');
      const [{ low, high }, box] = [bounds(spoilt), bounds(bar)];
      assert.ok(low.every((x, k) => x >= box.low[k]) && high.every((x, k) => x <= box.high[k]));
      assert.deepEqual(spoil(bar, bar, [0, 5]), spoilt, 'the same every time');
    }
  });

  test('a twist ends after a whole turn, a squash short of the other end', () => {
    const twist = scene('twist', bar).motion;
    const first = twist.at(0);
    twist.at(1).forEach((x, i) => assert.ok(Math.abs(x - first[i]) < 1e-9));
    assert.ok(Math.abs(twist.at(0.5)[1] - first[1]) > 0.5);
    const squash = scene('squash', bar).motion;
    assert.ok(Math.abs(squash.at(1)[0] - 5.5) < 1e-9);
  });

  test('a motion goes by iterations, or by the clock in turns that are not too large', () => {
    const plan = { handle: 1, seconds: 2, steps: 10, at: (part) => part };
    const stepped = new Motion(plan);
    for (let i = 1; i < 10; i += 1) assert.ok(Math.abs(stepped.advance() - i / 10) < 1e-12);
    assert.equal(stepped.handle, 1);
    assert.equal(stepped.advance(), 1);
    assert.equal(stepped.handle, -1, 'it has come to its end');
    const timed = new Motion(plan);
    timed.advance({ freely: true, now: 0 });
    assert.ok(Math.abs(timed.advance({ freely: true, now: 100 }) - 0.15) < 1e-12, 'a tenth of a second of two');
    assert.ok(timed.advance({ freely: true, now: 60_000 }) < 0.3, 'a minute asleep is no leap');
    timed.end();
    assert.equal(timed.handle, -1);
  });

  test('a scene keeps the handles there are, and puts none of them at random', () => {
    const { high, low } = ends(bar);
    const extra = Uint32Array.of(5, 27);
    const { held, start, motion } = scene('random', bar, [extra, high]);
    assert.deepEqual(held, [extra, high]);
    for (const v of extra) assert.deepEqual([...start.slice(3 * v, 3 * v + 3)], [...bar.slice(3 * v, 3 * v + 3)]);
    assert.ok(low.some((v) => start[3 * v] !== bar[3 * v]), 'what was released is free');
    assert.equal(motion, undefined);
    assert.equal(scene('twist', bar, [extra, high]).motion.handle, 1);
    assert.equal(scene('twist', bar, [extra]).motion, undefined, 'nothing turns when the end is free');
  });

  test('relative numbers know neither the unit of length nor that of pressure', () => {
    const core = library();
    const solid = core.generateSolid('box', 200);
    const solve = (scale, young) => {
      const positions = solid.positions.map((x) => scale * x);
      const start = positions.map((x, i) => (i % 3 === 0 ? 1.2 * x : x));
      const made = core.solid({ positions, tetrahedra: solid.tetrahedra });
      const deformed = core.deform(made, { energy: 'neo-hookean', young, poisson: 0.3, pins: Uint32Array.of(0), start, field: 'stress' });
      return relativeTo(young, volumeOf(positions, made.tetrahedra))(deformed.start);
    };
    const [a, b] = [solve(1, 1), solve(1000, 2e5)];
    assert.ok(a.energy > 1e-3);
    for (const key of ['energy', 'gradientNorm']) assert.ok(Math.abs(a[key] / b[key] - 1) < 1e-9, `${key}: ${a[key]}, ${b[key]}`);
    a.field.forEach((x, i) => assert.ok(Math.abs(x - b.field[i]) < 1e-5 * x));
  });

  test('landmarks are vertices of the skin, each once, the corners among them', () => {
    const solid = library().generateSolid('bar', 1000);
    const found = landmarks(solid.positions, solid.surface);
    const skin = new Set(solid.surface);
    assert.ok(found.length >= 8 && new Set(found.map(({ vertex }) => vertex)).size === found.length);
    assert.ok(found.every(({ vertex }) => skin.has(vertex)));
    const corner = found.find(({ words }) => words === 'x 0 %, y 0 %, z 0 %');
    const { low } = bounds(solid.positions);
    low.forEach((x, k) => assert.ok(Math.abs(solid.positions[3 * corner.vertex + k] - x) < 1e-9));
  });

  test('the materials of the page are those of the library', () => {
    const core = library();
    const solid = core.generateSolid('box', 100);
    for (const [energy, { elastic }] of Object.entries(MATERIALS)) {
      const make = (young) => core.deform(solid, { energy, pins: Uint32Array.of(0), start: solid.positions.map((x, i) => (i % 3 ? x : 1.5 * x)), young, poisson: 0.3 }).start.energy;
      assert.equal(make(1) !== make(1000), elastic, energy);
    }
    // The library names its materials when it is asked for one it does not know.
    assert.throws(() => core.deform(solid, { energy: 'jelly', pins: Uint32Array.of(0) }), ({ message }) => {
      assert.deepEqual(message.split('there are ')[1].split(', '), Object.keys(MATERIALS));
      return true;
    });
  });

  test('handles hold a vertex once, follow a drag, and let go', () => {
    const handles = new Handles();
    assert.ok(handles.add([0, 1, 1], bar));
    assert.ok(!handles.add([1], bar), 'held already');
    assert.ok(handles.add([1, 2], bar));
    assert.deepEqual([...handles.pins()], [0, 1, 2]);
    handles.grab(1);
    handles.drag([1, 0, 0]);
    handles.drag([0, 2, 0]);
    handles.drop();
    assert.deepEqual([...handles.targets().positions.slice(6)], [2, 2, 0]);
    handles.pull(7, bar);
    handles.drag([0, 0, 3]);
    assert.deepEqual([...handles.targets().vertices], [0, 1, 2, 7]);
    handles.drop();
    assert.deepEqual([...handles.targets().vertices], [0, 1, 2]);
    assert.ok(handles.release());
    assert.deepEqual([...handles.pins()], [0, 1]);
  });
});

describe('opening', () => {
  test('the prepared solid is up to date (else: node www/prepare-start.mjs)', () => {
    const read = (bytes) => {
      const counts = [...new Uint32Array(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + 16))];
      const floats = new Float32Array(bytes.buffer.slice(bytes.byteOffset + 64, bytes.byteOffset + 64 + 24 * counts[1]));
      return { counts, floats };
    };
    const [kept, made] = [read(readFileSync(join(root, 'www/assets/start-deform.bin'))), read(preparedSolid())];
    assert.deepEqual(kept.counts, made.counts);
    assert.ok(kept.floats.every((x, i) => Math.abs(x - made.floats[i]) < 1e-5));
  });

  onPage('shows the tangled solid before the solver has come; it unfolds when asked', {
    query: '?mode=deform',
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
    assert.ok(inverted > 1000, 'a tangled start');
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted), inverted);
    await page.click('#unfold');
    await page.waitForFunction(() => globalThis.foldfreePage.shown > 2);
  });

  onPage('the tabs switch modes, and each keeps what lies on its bench', { query: '?triangles=1000' }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    const before = await status(page);
    await page.click('[data-mode-button="deform"]');
    await page.waitForFunction(() => globalThis.foldfreePage.session?.ready);
    assert.match(page.url(), /mode=deform/);
    assert.equal(await page.getAttribute('[data-mode-button="deform"]', 'aria-current'), 'page');
    assert.ok(await page.isVisible('#presets') && await page.isHidden('#sample'));
    assert.equal((await status(page)).iteration, 0);
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.click('[data-mode-button="flatten"]');
    assert.equal((await status(page)).text, before.text);
    assert.doesNotMatch(page.url(), /mode=/);
    assert.ok(await page.isHidden('#presets') && await page.isVisible('#sample'));
    await page.keyboard.press('m');
    assert.equal((await status(page)).iteration, 1);
  });

  onPage('an address opens its bench', { query: '?mode=deform&solid=box&tetrahedra=800&preset=squash&method=admm-pd&field=volume&cut=x&at=0.3&steps=2&poisson=0.25' }, async (page) => {
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 2);
    const values = await page.evaluate(() => ['solid', 'deform-method', 'field', 'cut', 'cut-at', 'poisson'].map((id) => document.getElementById(id).value));
    assert.deepEqual(values, ['box', 'admm-pd', 'volume', 'x', '30', '0.25']);
  });
});

describe('solving', () => {
  onPage('a twist runs to its end without an inverted tetrahedron, and scrubs back', { query: `${SMALL}&preset=held` }, async (page) => {
    await page.selectOption('#pace', '0');
    await page.click('[data-preset="twist"]');
    await rest(page);
    const end = await status(page);
    assert.equal(end.inverted, 0, end.text);
    const turn = await page.evaluate(() => {
      const { session, handles } = globalThis.foldfreePage.mode;
      const { vertices, at } = handles.groups[1];
      const far = (p) => Math.max(...[...vertices].flatMap((v, i) => [0, 1, 2].map((k) => Math.abs(p[3 * v + k] - at[3 * i + k]))));
      return [far(session.positions), far(session.solid.positions), session.certificate];
    });
    assert.ok(turn[0] < 1e-5 && turn[1] < 1e-5, 'a whole turn comes round');
    assert.deepEqual([turn[2].inverted.length, turn[2].degenerate.length], [0, 0], 'by an exact check');
    assert.ok(end.iteration >= 20, 'in more than a leap');
    assert.ok(end.energy > 1e-3 && end.energy < 10, `relative: ${end.text}`);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted), 0);
    const worst = await page.evaluate(() => globalThis.foldfreePage.session.newest.largestSigma);
    assert.ok(worst > 1.2, `it is twisted, not back where it was: ${worst}`);
    await page.fill('#history', '0');
    assert.equal((await status(page)).iteration, 0);
  });

  for (const preset of ['random', 'collapse']) {
    onPage(`${preset}: from everything wrong to nothing inverted`, { query: `${SMALL}&preset=${preset}` }, async (page) => {
      const first = await status(page);
      assert.ok(first.inverted > 500, first.text);
      await page.selectOption('#pace', '0');
      await page.click('#unfold');
      await rest(page);
      assert.equal((await status(page)).inverted, 0);
    });
  }

  onPage('a squash presses one end towards the other; noise in the middle of it keeps the handles', { query: `${SMALL}&preset=squash` }, async (page) => {
    await page.selectOption('#pace', '0');
    await page.click('#unfold');
    await rest(page);
    assert.equal((await status(page)).inverted, 0);
    const width = () => page.evaluate(() => { const p = globalThis.foldfreePage.session.positions; return Math.max(...p.filter((_, i) => i % 3 === 0)) - Math.min(...p.filter((_, i) => i % 3 === 0)); });
    const pressed = await width();
    await page.click('[data-preset="random"]');
    await page.waitForFunction(() => globalThis.foldfreePage.session.records[0].inverted > 100);
    await rest(page);
    assert.equal((await status(page)).inverted, 0);
    assert.ok(Math.abs((await width()) - pressed) < 0.3 * pressed);
  });

  onPage('a hybrid with Newton’s method, from an address: it switches when nothing is inverted, and rests', { query: `${SMALL}&preset=random&method=wrapd%2Bnewton` }, async (page) => {
    assert.equal(await page.inputValue('#deform-method'), 'wrapd+newton');
    await page.click('#unfold');
    await rest(page);
    const records = await page.evaluate(() => globalThis.foldfreePage.session.records);
    const { switchedAt, iteration, inverted, status: ended } = records.at(-1);
    assert.deepEqual([inverted, ended], [0, 'converged']);
    assert.ok(switchedAt >= 1 && switchedAt < iteration, `${switchedAt} of ${iteration}`);
    assert.ok(records[switchedAt - 1].inverted > 0 && records.slice(switchedAt).every((record) => record.inverted === 0));
  });

  onPage('solver, material and moduli change on the way; a bad number is told off in its field', { query: `${SMALL}&preset=twist` }, async (page) => {
    await page.click('#step-ten');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 10);
    await page.fill('#poisson', '0.4');
    await page.press('#poisson', 'Tab');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.poisson === 0.4);
    await page.waitForFunction(() => globalThis.foldfreePage.session.newest.iteration > 12);
    await page.fill('#poisson', '0.7');
    await page.press('#poisson', 'Tab');
    assert.equal(await page.evaluate(() => document.getElementById('poisson').validity.valid), false);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.session.problem.settings.poisson), 0.4);
    for (const method of ['admm-pd', 'w-admm', 'r-admm', 'l-bfgs', 'wrapd']) {
      await page.selectOption('#deform-method', method);
      await page.waitForFunction((m) => globalThis.foldfreePage.session.problem.settings.method === m && (globalThis.foldfreePage.session.finished || globalThis.foldfreePage.session.records.length > 3), method);
    }
    for (const material of ['stable-neo-hookean', 'symmetric-dirichlet', 'st-venant-kirchhoff', 'arap', 'dirichlet']) {
      await page.selectOption('#material', material);
      await page.waitForFunction((m) => globalThis.foldfreePage.session.problem.settings.energy === m, material);
      assert.equal(await page.isDisabled('#young'), !/hook|kirch/.test(material), material);
    }
    assert.ok(await page.isHidden('#notice'));
  });
});

describe('handles', () => {
  onPage('dragging a handle moves it while the solver goes on from where it is', { query: `${SMALL}&preset=held`, viewport: WIDE }, async (page) => {
    await page.click('#step');
    const [vertex, middle] = await page.evaluate(() => {
      const { vertices } = globalThis.foldfreePage.mode.handles.groups[1];
      return [vertices[0], [...vertices]];
    });
    const places = await Promise.all(middle.map((v) => place(page, v)));
    const from = [0, 1].map((k) => places.reduce((sum, p) => sum + p[k] / places.length, 0));
    const [before, first] = [await positionOf(page, vertex), await place(page, vertex)];
    await drag(page, from, [from[0] + 30, from[1] - 90], {
      during: async () => {
        await page.waitForFunction((v) => globalThis.foldfreePage.session.newest.iteration > 4, vertex);
      },
    });
    await rest(page);
    const records = await page.evaluate(() => globalThis.foldfreePage.session.records.map(({ iteration }) => iteration));
    assert.ok(records.length > 4 && records.every((iteration, i) => iteration === i), 'no iteration was lost, none began anew');
    const [after, last] = [await positionOf(page, vertex), await place(page, vertex)];
    assert.ok(Math.hypot(...after.map((x, k) => x - before[k])) > 0.1);
    assert.ok(Math.abs(last[1] - first[1] + 90) < 12, `${first} → ${last}`);
    assert.equal((await status(page)).inverted, 0);
    // With Ctrl the same drag turns the handle about the long axis: it comes no nearer to the other.
    const before2 = await positionOf(page, vertex);
    const now = await Promise.all(middle.map((v) => place(page, v)));
    const there = [0, 1].map((k) => now.reduce((sum, p) => sum + p[k] / now.length, 0));
    await page.keyboard.down('Control');
    await drag(page, there, [there[0] + 50, there[1]]);
    await page.keyboard.up('Control');
    await rest(page);
    const turned = await positionOf(page, vertex);
    assert.ok(Math.abs(turned[0] - before2[0]) < 1e-5 && Math.hypot(turned[1] - before2[1], turned[2] - before2[2]) > 0.05);
  });

  onPage('the skin can be pulled, and springs back', { query: `${SMALL}&preset=held`, viewport: WIDE }, async (page) => {
    const vertex = await topVertex(page);
    const [from, before] = [await place(page, vertex), await positionOf(page, vertex)];
    const moved = async () => Math.hypot(...(await positionOf(page, vertex)).map((x, k) => x - before[k]));
    await drag(page, from, [from[0] + 10, from[1] - 80], {
      during: async () => {
        await page.waitForFunction(() => globalThis.foldfreePage.session.newest.iteration > 10);
        assert.equal(await page.evaluate(() => globalThis.foldfreePage.mode.handles.targets().vertices.length), (await pinned(page)).reduce((a, b) => a + b) + 1);
      },
      release: false,
    });
    const far = await moved();
    assert.ok(far > 0.02, String(far));
    await page.mouse.up();
    await rest(page);
    assert.ok((await moved()) < 0.3 * far);
  });

  onPage('a click pins a vertex, Shift-drag a box, Delete lets go; the iterations go on', { query: `${SMALL}&preset=held`, viewport: WIDE }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown >= 1);
    const [[a, b], vertex] = [await pinned(page), await topVertex(page)];
    await page.mouse.click(...(await place(page, vertex)));
    await page.waitForFunction(() => globalThis.foldfreePage.mode.handles.groups.length === 3);
    assert.deepEqual(await pinned(page), [a, b, 1]);
    await page.keyboard.press('Delete');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.handles.groups.length === 2);
    const [x, y] = await place(page, vertex);
    await page.keyboard.down('Shift');
    await drag(page, [x - 30, y - 60], [x + 30, y + 60]);
    await page.keyboard.up('Shift');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.handles.groups.length === 3);
    assert.ok((await pinned(page))[2] > 2, 'all vertices in the box');
    await rest(page);
    const records = await page.evaluate(() => globalThis.foldfreePage.session.records.map(({ iteration }) => iteration));
    assert.ok(records.every((iteration, i) => iteration === i));
    // The same by keyboard: the next handle, moved, released.
    const last = await page.evaluate(() => [...globalThis.foldfreePage.mode.handles.groups[0].at]);
    await page.keyboard.press('h');
    await page.keyboard.press('i');
    assert.notDeepEqual(await page.evaluate(() => [...globalThis.foldfreePage.mode.handles.groups[0].at]), last);
    await page.keyboard.press('Delete');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.handles.groups.length === 2);
  });

  onPage('when everything is released it says what is missing, until something is pinned: by keyboard, too', { query: `${SMALL}&preset=held` }, async (page) => {
    await page.click('#step');
    await page.click('#release');
    await page.waitForSelector('#notice:visible');
    assert.match(await page.textContent('#notice'), /Nothing is held/);
    await page.keyboard.press('Delete');
    await page.keyboard.press('b');
    const spoken = await page.textContent('#spoken');
    assert.match(spoken, /Vertex at x \d+ %, y \d+ %, z \d+ %/);
    await page.keyboard.press('b');
    assert.notEqual(await page.textContent('#spoken'), spoken);
    await page.keyboard.press('n');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.pins === 1 && document.getElementById('notice').hidden);
    assert.deepEqual(await pinned(page), [1]);
    await rest(page);
    await page.keyboard.press('n');
    assert.match(await page.textContent('#spoken'), /held already/);
    await page.keyboard.press('Backspace');
    await page.waitForSelector('#notice:visible');
  });

  onPage('Delete takes only what is selected; what a handle does is spoken, and its buttons turn it', { query: `${SMALL}&preset=held` }, async (page) => {
    await page.keyboard.press('Delete');
    assert.equal((await pinned(page)).length, 2);
    assert.ok(await page.isDisabled('#turn-on'));
    await page.keyboard.press('h');
    assert.match(await page.textContent('#spoken'), /Selected: handle 1 of 2, \d+ vertices/);
    const before = await page.evaluate(() => [...globalThis.foldfreePage.mode.handles.groups[0].at]);
    await page.click('#turn-on');
    await rest(page);
    const after = await page.evaluate(() => [...globalThis.foldfreePage.mode.handles.groups[0].at]);
    const far = before.map((x, i) => Math.abs(x - after[i]));
    assert.ok(Math.max(...far.filter((_, i) => i % 3 !== 0)) > 0.05 && Math.max(...far.filter((_, i) => i % 3 === 0)) < 1e-12);
    assert.ok((await status(page)).iteration > 0);
  });
});

describe('one thing after the other', () => {
  onPage('two solvers picked at once: the later stays, in the controls too', { query: `${SMALL}&preset=twist` }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.evaluate(() => { for (const key of ['2', '4']) window.dispatchEvent(new KeyboardEvent('keydown', { key })); });
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.method === 'admm-pd');
    assert.equal(await page.inputValue('#deform-method'), 'admm-pd');
    assert.match(page.url(), /method=admm-pd/);
    assert.ok(await page.isHidden('#notice'));
  });

  onPage('a handle that moves while a solver is built arrives', { query: `${SMALL}&preset=held` }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.keyboard.press('h');
    const first = await page.evaluate(() => globalThis.foldfreePage.mode.handles.groups[0].at[1]);
    await page.evaluate(() => { for (const key of ['5', 'i', 'i', 'i']) window.dispatchEvent(new KeyboardEvent('keydown', { key })); });
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.settings.method === 'l-bfgs');
    await rest(page);
    const [there, wish] = await page.evaluate(() => {
      const { handles, session } = globalThis.foldfreePage.mode;
      const { vertices, at } = handles.groups[0];
      return [[...session.positions.slice(3 * vertices[0], 3 * vertices[0] + 3)], [...at.slice(0, 3)]];
    });
    there.forEach((x, k) => assert.ok(Math.abs(x - wish[k]) < 1e-5));
    assert.notEqual(wish[1], first);
  });

  onPage('everything released while it runs: it stays still, and a play says why', { query: `${SMALL}&preset=random` }, async (page) => {
    await page.selectOption('#pace', '0');
    await page.click('#unfold');
    await page.waitForFunction(() => globalThis.foldfreePage.shown > 1);
    await page.click('#release');
    await page.waitForSelector('#play:not(.playing)');
    await page.waitForTimeout(300);
    const { iteration } = await status(page);
    await page.click('#notice-close');
    await page.click('#play');
    await page.waitForSelector('#notice:visible');
    await page.waitForTimeout(300);
    assert.equal((await status(page)).iteration, iteration);
    assert.ok(await page.evaluate(() => globalThis.foldfreePage.session.finished));
  });

  onPage('a solver that is ready when another mode is on show does not play there', { query: `${SMALL}&preset=twist` }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.evaluate(() => {
      globalThis.deformMode = globalThis.foldfreePage.mode;
      for (const key of ['4', 'm']) window.dispatchEvent(new KeyboardEvent('keydown', { key }));
    });
    await page.waitForFunction(() => globalThis.deformMode.session.problem.settings.method === 'admm-pd');
    await page.waitForTimeout(400);
    assert.equal(await page.evaluate(() => globalThis.deformMode.playing), false);
    assert.equal(await page.getAttribute('#play', 'aria-label'), 'Play');
    const count = await page.evaluate(() => globalThis.deformMode.session.records.length);
    await page.waitForTimeout(300);
    assert.equal(await page.evaluate(() => globalThis.deformMode.session.records.length), count);
  });

  onPage('a worker that dies says what to do, and R does it', {
    query: `${SMALL}&preset=twist`,
    prepare: (page) => page.addInitScript(() => {
      const { Worker } = globalThis;
      globalThis.workers = [];
      globalThis.Worker = class extends Worker { constructor(...args) { super(...args); globalThis.workers.push(this); } };
    }),
  }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    await page.evaluate(() => { globalThis.workers[0].terminate(); globalThis.workers[0].dispatchEvent(new ErrorEvent('error', { message: 'gone' })); });
    await page.click('#step');
    await page.waitForSelector('#notice:visible');
    assert.match(await page.textContent('#notice'), /Press R/);
    await page.keyboard.press('r');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 0 && document.getElementById('notice').hidden);
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
  });
});

describe('looking', () => {
  onPage('the slider moves the cut, and the colours have their own legends', { query: `${SMALL}&preset=random`, viewport: WIDE }, async (page) => {
    const canvas = await page.locator('#canvas').boundingBox();
    const half = (canvas.width - 292) / 2;
    // The legend stands at the lower left of the right view, above the plot.
    const right = { x: canvas.x + half, y: canvas.y, width: half, height: canvas.height - 215 };
    const legend = { x: right.x + 10, y: right.y + right.height - 70, width: 250, height: 60 };
    const picture = async (clip) => { await page.waitForTimeout(250); return (await page.screenshot({ clip })).toString('base64'); };
    const [before, met] = [await picture(right), await page.evaluate(() => globalThis.foldfreePage.bench.cutTetrahedra)];
    assert.ok(met > 20);
    await page.fill('#cut-at', '20');
    assert.notEqual(await picture(right), before);
    assert.notEqual(await page.evaluate(() => globalThis.foldfreePage.bench.cutTetrahedra), met);
    await page.selectOption('#cut', 'none');
    await picture(right);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.bench.cutTetrahedra), 0);
    assert.ok(await page.isDisabled('#cut-at'));
    const seen = new Set([await picture(legend)]);
    for (const field of ['volume', 'stress']) {
      await page.selectOption('#field', field);
      seen.add(await picture(legend));
      assert.match(page.url(), new RegExp(`field=${field}`));
    }
    assert.equal(seen.size, 3, 'three legends');
  });
});

describe('files', () => {
  const CUBE = 'MeshVersionFormatted 2\nDimension 3\nVertices\n8\n0 0 0 0\n1 0 0 0\n0 1 0 0\n1 1 0 0\n0 0 1 0\n1 0 1 0\n0 1 1 0\n1 1 1 0\n'
    + 'Tetrahedra\n5\n1 2 3 5 0\n4 3 2 8 0\n6 5 8 2 0\n7 8 5 3 0\n2 3 5 8 0\nEnd\n';

  onPage('a dropped solid is held at an end', { query: SMALL }, async (page) => {
    await drop(page, 'cube.mesh', CUBE);
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.name === 'cube.mesh');
    assert.deepEqual(await pinned(page), [4], 'both ends of a cube are all of it');
    assert.ok(await page.isHidden('#notice'));
    await page.click('[data-preset="collapse"]');
    await rest(page);
    assert.equal((await status(page)).inverted, 0);
  });

  onPage('a bad file is told off where it stands, and the bench stays', { query: `${SMALL}&preset=twist` }, async (page) => {
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
    const before = await status(page);
    await drop(page, 'broken.mesh', CUBE.replace('7 8 5 3 0', '7 8 5 90 0'));
    await page.waitForSelector('#notice:visible');
    const message = await page.textContent('#notice');
    assert.match(message, /broken\.mesh/);
    assert.match(message, /90/);
    assert.equal((await status(page)).text, before.text);
    const bad = { 'empty.mesh': '', 'words.vtk': 'hello', 'surface.obj': 'v 0 0 0\n', 'alone.node': '1 3 0 0\n1 0 0 0\n', 'alone.ele': '1 4 0\n1 1 2 3 4\n' };
    for (const [name, text] of Object.entries(bad)) {
      await page.click('#notice-close').catch(() => {});
      await drop(page, name, text);
      await page.waitForFunction((n) => !document.getElementById('notice').hidden && document.getElementById('notice').textContent.includes(n), name);
    }
    await page.click('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 2);
  });

  onPage('the deformed solid and the steps are exported', { query: `${SMALL}&preset=twist` }, async (page) => {
    await page.click('#step-ten');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 10);
    const { name, bytes } = await download(page, '#export-solid');
    assert.equal(name, 'bar-wrapd.mesh');
    const solid = library().solid(bytes, 'mesh');
    const kept = await page.evaluate(() => [globalThis.foldfreePage.session.solid.tetrahedra.length, [...globalThis.foldfreePage.session.positions.slice(0, 30)]]);
    assert.equal(solid.tetrahedra.length, kept[0]);
    kept[1].forEach((x, i) => assert.ok(Math.abs(x - solid.positions[i]) < 1e-5));
    const trace = JSON.parse((await download(page, '#export-trace')).bytes.toString());
    assert.equal(trace.settings.method, 'wrapd');
    assert.ok(trace.pins > 0 && trace.iterations.at(-1).iteration === 10);
  });
});

describe('for everybody', () => {
  for (const colorScheme of ['light', 'dark']) {
    onPage(`no accessibility violation, ${colorScheme}`, { colorScheme, query: SMALL, viewport: WIDE }, async (page) => {
      await audit(page, 'start');
      const strip = await page.locator('.strip:visible').boundingBox();
      assert.ok(strip.height < 50, `the strip is one row: ${strip.height}`);
      await page.click('#step');
      await page.click('#help');
      await audit(page, 'help');
    });
  }

  onPage('a phone shows the solid first, and the cut with its slider', { query: SMALL, viewport: { width: 390, height: 780 }, hasTouch: true, isMobile: true }, async (page) => {
    await audit(page, 'phone');
    assert.equal(await page.getAttribute('[role="tab"][data-view="shape"]', 'aria-selected'), 'true');
    assert.ok(await page.isVisible('#presets') && await page.isHidden('#cut-at'));
    await page.tap('[role="tab"][data-view="map"]');
    assert.ok(await page.isVisible('#cut-at'));
    const wide = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
    assert.equal(wide, false, 'nothing scrolls sideways');
    await page.tap('#step');
    await page.waitForFunction(() => globalThis.foldfreePage.shown === 1);
  });
});

test('without COOP and COEP it runs on one thread', async () => {
  const bare = await launch({ isolation: false });
  try {
    await onPageOf(() => bare).once({ query: SMALL }, async (page) => {
      assert.equal(await page.evaluate(() => crossOriginIsolated), false);
      await page.selectOption('#pace', '0');
      await page.click('#unfold');
      assert.equal(await page.evaluate(() => globalThis.foldfreePage.mode.page.foldfree.threads), 1);
      await rest(page);
      assert.equal((await status(page)).inverted, 0);
    });
  } finally {
    await bare.close();
  }
});
