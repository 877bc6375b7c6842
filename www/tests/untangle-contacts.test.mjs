// The Untangle mode's bodies that are kept apart, and what its steps go through, on the built page.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, before, describe, test } from 'node:test';
import { initSync } from '../../pkg/core.js';
import { readAddress } from '../page/address.js';
import { CONTACTS, MOST_ELEMENTS, handlesOf, moved } from '../page/contact-problems.js';
import { pick } from '../page/presets.js';
import { apartOf, generate, invertedOf } from '../page/untangle-problems.js';
import { UntangleSession } from '../page/untangle-session.js';
import { ending } from '../page/words.js';
import { audit, launch, onPageOf, openPage } from './harness.mjs';

let site;
before(async () => { site = await launch(); });
after(() => site?.close());
const onPage = onPageOf(() => site);

const core = initSync(readFileSync(new URL('../../pkg/single/foldfree_bg.wasm', import.meta.url)));
/** The library without a worker, as the session uses it. */
const library = {
  version: core.version, threads: 1,
  generateSolid: async (...args) => core.generateSolid(...args),
  mesh: async (...args) => core.mesh(...args),
  solid: async (...args) => core.solid(...args),
  untangle: async (body, options) => core.untangle(body, options),
};
const WIDE = { width: 1300, height: 820 };
const HOOKS = '?mode=untangle&body=hooks&size=30000'; // 3000 are made
const FLAT = '?mode=untangle&body=flat-hooks&size=1000';
const CUSHION = '?mode=untangle&body=cushion&size=1000';

const statusText = async (page) => {
  await page.evaluate(() => new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); }));
  return (await page.textContent('#status')).replaceAll('\u00a0', '');
};
const records = (page) => page.evaluate(() => globalThis.foldfreePage.session.records);
const shownIs = (page, index) => page.waitForFunction((k) => globalThis.foldfreePage.shown === k, index);
const atRest = async (page) => {
  await page.waitForFunction(() => globalThis.foldfreePage.session.finished, null, { timeout: 120_000 });
  await page.waitForSelector('#play:not(.playing)');
};
const toTheEnd = async (page) => {
  await page.evaluate(() => { document.getElementById('pace').value = '0'; }); // phones do not show it
  await page.click('#unfold');
  await atRest(page);
};
const outcome = (page) => page.evaluate(() => globalThis.foldfreePage.session.result.outcome);

describe('bodies that are kept apart', () => {
  test('are small, start free, and come to rest after every move', () => {
    for (const [name, problem] of Object.entries(CONTACTS)) {
      for (const size of [2, 1000, 30_000]) {
        const body = generate(core, { body: name, size });
        const elements = body.indices ? body.indices.length / 3 : body.tetrahedra.length / 4;
        assert.ok(elements > (size > 2 ? 500 : 29) && elements < 1.15 * MOST_ELEMENTS, `${name}: ${elements}`);
        assert.equal(problem.planar === true, body.indices !== undefined);
        const { pins, start, groups, targets } = apartOf(body, name);
        assert.deepEqual([...start], [...body.positions]);
        assert.equal(invertedOf(body, start), 0);
        assert.equal(new Set(pins).size, pins.length, 'no vertex is held twice');
        assert.ok(groups.every(({ vertices, at }) => vertices.length > 0 && at.length === 3 * vertices.length));
        const solver = core.untangle(body, { pins, overlap: true, settle: 0 });
        assert.equal(solver.start.status, 'converged', `${name} starts free`);
        if (size > 1000) continue;
        let [points, most] = [pick(body.positions, groups[problem.moved].vertices), 0];
        for (const count of [1, 2]) {
          points = moved(problem, points, count);
          solver.movePins({ vertices: groups[problem.moved].vertices, positions: Float64Array.from(points) });
          for (const step of solver) most = Math.max(most, step.gini.contacts);
          const { outcome: end } = solver.result();
          assert.deepEqual([end.globallyInjective, end.intersections], [true, 0], `${name}, move ${count}`);
        }
        assert.ok(most > 0 || size === 2, `${name}: nothing was in the way`);
        assert.equal(targets.vertices.length, pins.length);
        solver.free();
      }
    }
    const arrays = CONTACTS.cushion.make(1000);
    const [walls] = handlesOf(CONTACTS.cushion, arrays);
    assert.equal(walls.length, 64, 'the walls are held, the cushion is not');
    const asked = (body) => readAddress('untangle', `?mode=untangle&body=${body}&size=30000`).size;
    assert.deepEqual([asked('hooks'), asked('bar')], [MOST_ELEMENTS, 30_000]);
  });
});

describe('the session', () => {
  test('shows every iteration of the quadratic problem and the polisher, and goes on when what is held moves', async () => {
    const session = new UntangleSession(library);
    const first = await session.open({ source: { body: 'hooks', size: 3000 }, held: 'twisted', start: 'random', energy: 'arap' });
    assert.ok(session.keepsApart && !session.finished);
    assert.deepEqual([first.record.meeting, first.record.contacts, first.record.counts], [0, { all: 0, active: 0 }, [0, 0, 0]]);
    const { groups, targets } = session.problem;
    let [steps, reached] = [0, 0];
    for (const count of [1, 2]) {
      if (count > 1) {
        const [held, pulled] = groups;
        const at = moved(CONTACTS.hooks, pulled.at, count);
        await session.aim({ vertices: targets.vertices, positions: Float64Array.of(...held.at, ...at) });
        assert.ok(!session.finished && session.result === undefined);
      }
      while (!session.finished) {
        const part = await session.step();
        const { record } = part;
        if (part.contacts) {
          assert.equal(record.contacts.all, part.contacts.edges.length);
          assert.equal(record.contacts.active, part.contacts.active.filter((one) => one === 1).length);
        }
        assert.deepEqual(record.counts[0], invertedOf(session.body, part.trial), `${record.part} ${record.k}`);
        if (record.part !== 'outcome') continue;
        steps += 1;
        // where the polisher fails x may go a part of the way
        if (!record.gini.reached) continue;
        reached += 1;
        assert.deepEqual(part.result, part.trial);
        assert.equal(record.meeting, 0, 'nothing that is handed out crosses');
      }
      assert.equal(session.newest.iteration, steps, 'steps are counted on');
      assert.equal(session.newest.status, 'converged');
      assert.deepEqual([session.result.outcome.globallyInjective, session.result.outcome.intersections], [true, 0]);
    }
    assert.ok(reached > 0);
    const { records: all } = session;
    for (let i = 1; i <= steps; i += 1) {
      const own = all.filter(({ iteration, part }) => iteration === i && part === 'quadratic');
      const { gini: { qpIterations } } = own[0];
      assert.deepEqual(own.map(({ k, of }) => [k, of]), Array.from({ length: qpIterations + 1 }, (_, k) => [k, qpIterations]));
    }
    assert.ok(all.some(({ part, k }) => part === 'quadratic' && k > 5), 'the second move takes iterations');
    assert.ok(Math.max(...all.map(({ meeting = 0 }) => meeting)) > 10);
    assert.ok(Math.max(...all.map(({ contacts }) => contacts?.active ?? 0)) > 0);
  });

  test('of several places to go only the newest waits, and what cannot be is told', async () => {
    const told = [];
    let free;
    const gate = new Promise((resolve) => { free = resolve; });
    const slow = {
      ...library,
      untangle: async (body, options) => {
        const solver = core.untangle(body, options);
        const { movePins } = solver;
        solver.movePins = async (targets) => { told.push(targets.positions[0]); await gate; return movePins.call(solver, targets); };
        return solver;
      },
    };
    const session = new UntangleSession(slow);
    await session.open({ source: { body: 'flat-hooks', size: 1000 }, held: 'twisted', start: 'random', energy: 'arap' });
    const { vertices, at } = session.problem.groups[1];
    const further = (by) => ({ vertices, positions: at.map((x, i) => (i % 3 === 0 ? x + by : x)) });
    const sent = [0.01, 0.02, 0.03].map((by) => session.aim(further(by)));
    free();
    await Promise.all(sent);
    assert.deepEqual(told, [0.01, 0.03].map((by) => at[0] + by));
    await assert.rejects(session.aim({ vertices: Uint32Array.of(99_999), positions: new Float64Array(3) }), { code: 'invalid-option' });
    while (!session.finished) await session.step();
    assert.equal(session.newest.status, 'converged');
  });
});

/** A session in which every step waits for `gate` from when it is closed. */
async function gated(options = {}) {
  const gate = { open: Promise.resolve() };
  const session = new UntangleSession({
    ...library,
    untangle: async (body, given) => {
      const solver = core.untangle(body, { ...given, ...options });
      const { step } = solver;
      solver.step = async () => { await gate.open; return step.call(solver); };
      return solver;
    },
  });
  await session.open({ source: { body: 'flat-hooks', size: 1000 }, held: 'twisted', start: 'random', energy: 'arap' });
  return { session, gate };
}

describe('a session that goes on', () => {
  test('is not finished while the first step after a move is made', async () => {
    const { session, gate } = await gated();
    while (!session.finished) await session.step();
    const { targets: { vertices }, groups: [held, pulled] } = session.problem;
    let free;
    gate.open = new Promise((resolve) => { free = resolve; });
    await session.aim({ vertices, positions: Float64Array.of(...held.at, ...moved(CONTACTS['flat-hooks'], pulled.at, 2)) });
    assert.ok(!session.finished);
    const going = session.step();
    await new Promise((resolve) => { setTimeout(resolve, 0); });
    assert.ok(!session.finished, 'the step has begun, and is not done');
    free();
    assert.equal((await going).record.part, 'local');
    while (!session.finished) await session.step();
    assert.equal(session.newest.status, 'converged');
    assert.ok(session.stepsOfMove < session.newest.iteration);
  });

  test('of a large body shows where the quadratic problem leads, and no more', async () => {
    const { session } = await gated({ trace: 'polisher' });
    while (!session.finished) await session.step();
    const quadratic = session.records.filter(({ part }) => part === 'quadratic');
    assert.deepEqual(quadratic.map(({ iteration }) => iteration), Array.from({ length: session.newest.iteration }, (_, i) => i + 1));
    assert.ok(quadratic.every(({ k, of, gini }) => k === of && of === gini.qpIterations));
  });

  test('how it ended is said in words of its method', () => {
    assert.equal(ending({ status: 'stalled', gini: {} }), 'stalled: no better state found');
    assert.equal(ending({ status: 'stalled' }), 'stalled: no step lowers the energy');
  });
});

describe('the page', () => {
  onPage('hooks are pulled, further and further, with their contacts drawn and counted', { query: HOOKS, viewport: WIDE }, async (page) => {
    assert.match(await page.textContent('#invite-text'), /Two hooks, one in the other/);
    assert.ok(await page.isVisible('#further') && await page.isHidden('#held') && await page.isHidden('#untangle-start'));
    assert.ok(await page.isDisabled('#size option[value="10000"]'));
    assert.equal(await page.inputValue('#size'), '3000', 'what is built');
    assert.match(await statusText(page), /the start.*0 inverted · 0 pairs cross · 0 contacts, 0 active/);
    await toTheEnd(page);
    const first = (await records(page)).length;
    assert.match(await statusText(page), /handed out · \d+ below η · 0 inverted · 0 pairs cross · \d+ contacts?, \d+ active/);
    assert.deepEqual(await outcome(page).then(({ globallyInjective, intersections }) => [globallyInjective, intersections]), [true, 0]);
    await page.click('#further');
    await page.waitForFunction((k) => globalThis.foldfreePage.session.records.length > k, first);
    await atRest(page);
    const pulled = () => page.evaluate(() => globalThis.foldfreePage.mode.hands.handles.groups[1].at[0]);
    const from = await pulled();
    for (let k = 0; k < 3; k += 1) await page.keyboard.down('g'); // held down it repeats
    await page.keyboard.up('g');
    assert.equal(await pulled(), from + 0.75, 'one move');
    await page.waitForFunction(() => globalThis.foldfreePage.mode.playing);
    await atRest(page);
    assert.deepEqual(await outcome(page).then(({ globallyInjective, intersections }) => [globallyInjective, intersections]), [true, 0]);
    assert.ok(await page.isHidden('#notice'));
    // every contact of a part is drawn, by its kind
    const all = await records(page);
    const most = all.reduce((best, { contacts }, i) => ((contacts?.active ?? 0) > (all[best].contacts?.active ?? 0) ? i : best), 0);
    assert.ok(most > 0);
    await page.fill('#history', String(most));
    assert.match(await statusText(page), new RegExp(`${all[most].contacts.all} contacts, ${all[most].contacts.active} active`));
    const drawn = () => page.evaluate(() => [...globalThis.foldfreePage.bench.drawnContacts]);
    const [corners, edges, diamonds, crosses] = await drawn();
    assert.equal(corners + edges, all[most].contacts.all);
    assert.ok(diamonds > 0 && diamonds <= corners && crosses > 0 && crosses <= edges, `${await drawn()}`);
    // from nearer fewer are in one place
    const board = await page.locator('#canvas').boundingBox();
    await page.mouse.move(board.x + 0.2 * board.width, board.y + 0.3 * board.height);
    await page.mouse.wheel(0, -600);
    await statusText(page);
    const nearer = await drawn();
    assert.deepEqual(nearer.slice(0, 2), [corners, edges]);
    assert.ok(nearer[2] + nearer[3] > diamonds + crosses, `${nearer}`);
    // what is handed out has none, and asks for no room; once it is polished, so has the primary solver's
    const outcomeOf = all.findIndex(({ part }, i) => part === 'outcome' && i > most);
    for (const [state, part] of [['result', most], ['primary', outcomeOf]]) {
      await page.fill('#history', String(part));
      await page.click(`[data-state="${state}"]`);
      assert.doesNotMatch(await statusText(page), /cross|contact|below/);
      assert.deepEqual(await drawn(), [0, 0, 0, 0]);
    }
    await page.click('[data-state="trial"]');
    await page.fill('#history', String(most));
    await statusText(page);
    assert.deepEqual(await drawn(), nearer);
    // iterations of the quadratic problem, one by one
    const at = all.findIndex(({ part, k, of }) => part === 'quadratic' && of > 5 && k === 3);
    await page.fill('#history', String(at));
    assert.match(await statusText(page), new RegExp(`step \\d+ · QP 3 of ${all[at].of} · `));
    await page.keyboard.press('ArrowRight');
    assert.match(await statusText(page), /QP 4 of /);
    // x never crosses: what is handed out is the same until the outcome
    for (const state of ['result', 'primary', 'trial']) {
      await page.click(`[data-state="${state}"]`);
      assert.equal(await page.evaluate(() => globalThis.foldfreePage.board.drawnInverted), all[at + 1].counts[['trial', 'result', 'primary'].indexOf(state)]);
    }
    // another body has none of that
    await page.selectOption('#body', 'box');
    await page.waitForFunction(() => globalThis.foldfreePage.session.problem.source.body === 'box');
    assert.ok(await page.isHidden('#further') && await page.isVisible('#held'));
    assert.doesNotMatch(await statusText(page), /cross|contact/);
  });

  onPage('what is held is dragged elsewhere, and the run goes on', { query: FLAT, viewport: WIDE }, async (page) => {
    await toTheEnd(page);
    const before = await page.evaluate(() => {
      const { session, mode: { hands } } = globalThis.foldfreePage;
      return { count: session.records.length, at: [...hands.handles.groups[1].at], vertex: hands.handles.groups[1].vertices[3] };
    });
    const box = await page.locator('#canvas').boundingBox();
    const [x, y] = await page.evaluate((v) => [...globalThis.foldfreePage.bench.placeOf(v)], before.vertex);
    await page.mouse.move(box.x + x, box.y + y);
    await page.mouse.down();
    for (let k = 1; k <= 5; k += 1) await page.mouse.move(box.x + x - 4 * k, box.y + y - 6 * k);
    await page.mouse.up();
    await page.waitForFunction((count) => globalThis.foldfreePage.session.records.length > count, before.count);
    await atRest(page);
    const now = await page.evaluate(() => {
      const { session, mode: { hands } } = globalThis.foldfreePage;
      const { vertices, at } = hands.handles.groups[1];
      return { at: [...at], is: [...vertices].flatMap((v) => [...session.result.positions.subarray(3 * v, 3 * v + 3)]), outcome: session.result.outcome };
    });
    assert.ok(now.at.every((p, i) => (i % 3 === 0 ? p < before.at[i] - 0.02 : i % 3 === 1 ? p > before.at[i] + 0.02 : p === before.at[i])));
    assert.deepEqual(now.is, now.at, 'it got there');
    assert.deepEqual([now.outcome.globallyInjective, now.outcome.intersections], [true, 0]);
    // keys do the same, and pin nothing
    await page.keyboard.press('h');
    await page.keyboard.press('h');
    await page.keyboard.press('n');
    const { length } = await records(page);
    await page.keyboard.press('i');
    await page.waitForFunction((count) => globalThis.foldfreePage.session.records.length > count, length);
    await atRest(page);
    assert.equal(await page.evaluate(() => globalThis.foldfreePage.mode.hands.handles.groups.length), 2);
    // reset begins anew
    await page.keyboard.press('r');
    await page.waitForFunction(() => globalThis.foldfreePage.session.records.length === 1 && globalThis.foldfreePage.shown === 0);
    assert.deepEqual(await page.evaluate(() => [...globalThis.foldfreePage.mode.hands.handles.groups[1].at]), before.at);
  });

  onPage('where there is no way what is held stays', { query: FLAT, viewport: WIDE }, async (page) => {
    await toTheEnd(page);
    // one end right through the other body, and beside it
    await page.evaluate(() => {
      const { mode } = globalThis.foldfreePage;
      const { hands } = mode;
      const [held, pulled] = hands.handles.groups;
      pulled.at = pulled.at.map((x, i) => held.at[i % held.at.length] + [-3, -0.5, 0][i % 3]);
      return mode.aim().then(() => mode.hurry());
    });
    const title = async () => {
      await page.waitForSelector('#notice:not([hidden])', { timeout: 120_000 });
      return page.textContent('#notice-title');
    };
    // should it come to the limit of steps it may try on
    for (let k = 0; k < 4 && await title() === 'It has not arrived'; k += 1) {
      await page.click('#notice-close');
      await page.click('#play');
    }
    assert.equal(await title(), 'No way was found');
    assert.equal((await outcome(page)).intersections, 0, 'whatever happens');
    const { at, is } = await page.evaluate(() => {
      const { session, mode: { hands } } = globalThis.foldfreePage;
      const { vertices, at: list } = hands.handles.groups[1];
      return { at: [...list], is: [...vertices].flatMap((v) => [...session.positions.subarray(3 * v, 3 * v + 3)]) };
    });
    assert.deepEqual(at, is, 'it stays where it got to');
  });

  onPage('at the limit of steps it has not arrived, and Play goes on', { query: CUSHION, viewport: WIDE }, async (page) => {
    await page.evaluate(() => {
      const { mode } = globalThis.foldfreePage;
      const { foldfree } = mode.page;
      const untangle = foldfree.untangle.bind(foldfree);
      foldfree.untangle = (body, options) => untangle(body, { ...options, maxIterations: 1 });
      return mode.reset();
    });
    await toTheEnd(page);
    assert.ok(await page.isHidden('#notice'), 'the first move takes one step');
    await page.click('#further');
    await page.waitForFunction(() => globalThis.foldfreePage.session.newest.iteration === 2);
    await atRest(page);
    assert.equal(await page.textContent('#notice-title'), 'It has not arrived');
    assert.match(await page.textContent('#notice-text'), /after 1 step\b/);
    const targets = () => page.evaluate(() => [...globalThis.foldfreePage.mode.hands.handles.groups[0].at]);
    const before = await targets();
    for (let k = 3; await page.evaluate(() => globalThis.foldfreePage.session.newest.status !== 'converged'); k += 1) {
      assert.ok(k < 60);
      await page.click('#play');
      await page.waitForFunction((count) => globalThis.foldfreePage.session.finished && globalThis.foldfreePage.session.newest.iteration === count, k);
      await page.waitForSelector('#play:not(.playing)');
      assert.deepEqual(await targets(), before);
    }
    assert.ok(await page.isHidden('#notice'));
    assert.deepEqual(await outcome(page).then(({ globallyInjective, intersections }) => [globallyInjective, intersections]), [true, 0]);
  });

  onPage('a drag beside the squares turns the view, and moves nothing', { query: CUSHION, viewport: WIDE }, async (page) => {
    const places = () => page.evaluate(() => {
      const { bench, session } = globalThis.foldfreePage;
      return Array.from({ length: session.body.positions.length / 3 }, (_, v) => [...bench.placeOf(v)]);
    });
    const [box, before] = [await page.locator('#canvas').boundingBox(), await places()];
    const [x, y] = before[0];
    await page.mouse.move(box.x + x, box.y + y);
    await page.mouse.down();
    for (let k = 1; k <= 4; k += 1) {
      await page.mouse.move(box.x + x + 12 * k, box.y + y + 5 * k);
      await statusText(page); // the view is turned frame by frame
    }
    await page.mouse.up();
    await statusText(page);
    const far = Math.max(...(await places()).map((p, v) => Math.hypot(p[0] - before[v][0], p[1] - before[v][1])));
    assert.ok(far > 15, `${far}`);
    assert.equal((await records(page)).length, 1);
    assert.ok(await page.isHidden('#notice'));
    const { length, pulled } = await page.evaluate(() => {
      const { handles } = globalThis.foldfreePage.mode.hands;
      return { length: handles.groups.length, pulled: handles.dragging };
    });
    assert.deepEqual([length, Boolean(pulled)], [1, false]);
  });

  onPage('colours on the outside are those a person chose, while bodies are of one kind', { query: CUSHION, viewport: WIDE }, async (page) => {
    const tinted = () => page.evaluate(() => globalThis.foldfreePage.bench.tinted);
    const open = async (body) => {
      await page.selectOption('#body', body);
      await page.waitForFunction((name) => globalThis.foldfreePage.session.problem.source.body === name, body);
    };
    assert.equal(await tinted(), true);
    await page.keyboard.press('c');
    await open('boxes');
    assert.equal(await tinted(), false);
    await open('bar');
    await page.keyboard.press('c');
    await open('box');
    assert.equal(await tinted(), true);
  });

  test('is accessible, light and dark, on desks and phones, and fits them', async () => {
    for (const [viewport, colorScheme] of [[{ width: 1300, height: 800 }, 'dark'], [{ width: 390, height: 780 }, 'light']]) {
      const opened = await openPage(site, { query: CUSHION, viewport, colorScheme });
      await toTheEnd(opened.page);
      // where most is to be said
      const widest = (await records(opened.page)).reduce((best, { meeting = 0 }, i, all) => (meeting > (all[best].meeting ?? 0) ? i : best), 0);
      await opened.page.evaluate((i) => globalThis.foldfreePage.mode.scrub(i), widest);
      await shownIs(opened.page, widest);
      assert.match(await statusText(opened.page), /[1-9]\d* pairs? cross/);
      await audit(opened.page, `cushion, ${viewport.width}, ${colorScheme}`);
      assert.equal(await opened.page.evaluate(() => document.documentElement.scrollWidth), viewport.width);
      const line = await opened.page.locator('#status').evaluate((status) => [status.scrollWidth, status.clientWidth]);
      assert.ok(line[0] <= line[1] + 1, `${line}`);
      assert.ok(await opened.page.isVisible('#further'));
      assert.deepEqual(opened.troubles, []);
      await opened.close();
    }
  });
});
