// The session of the Compare mode: whose turn it is, what the clock shows, and what is lowest; then with the real library.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { describe, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { initSync } from '../../pkg/core.js';
import { DEFAULTS, modeOf, readAddress } from '../page/address.js';
import { COMPARABLE, CompareSession } from '../page/compare-session.js';

const root = join(fileURLToPath(import.meta.url), '../../..');

const report = (iteration, energy, seconds, status = 'running', inverted = 0) => ({
  iteration, energy, seconds, status, inverted, gradientNorm: 1, smallestSigma: 1, largestSigma: 1, lbfgsIterations: 0, reweighted: false,
  phases: [], positions: new Float32Array(2), distortion: Float32Array.of(1),
});

/**
 * A library whose solvers take the energies and seconds a test gives: `{ method: { energies, pace, fails } }`; the last
 * energy is that of the minimum. `order` is who stepped when.
 */
function library(plans) {
  const order = [];
  const freed = [];
  const parameterize = async (mesh, { method }) => {
    const { energies, pace = 1, refused, fails, inverted = [] } = plans[method];
    if (refused) throw refused;
    let at = 0;
    const step = () => report(at, energies[at], at * pace, at + 1 === energies.length ? 'converged' : 'running', inverted[at] ?? 0);
    return {
      start: step(), startKind: 'tutte', notes: [], setupSeconds: 0.5, mesh: { positions: new Float64Array(9), indices: Uint32Array.of(0, 1, 2) },
      async step() {
        order.push(method);
        at += 1;
        if (at === fails) throw new Error(`${method} broke down`);
        return step();
      },
      free() { freed.push(method); },
    };
  };
  const generate = async () => ({ notes: [], free() { freed.push('mesh'); } });
  return { order, freed, generate, parameterize, version: '0', threads: 1 };
}

const settings = { start: 'tutte', energy: 'symmetric-dirichlet' };
const source = { sample: 'cap', triangles: 1 };

async function begun(plans, clock = 'iterations') {
  const made = library(plans);
  const session = new CompareSession(made);
  session.clock = clock;
  await session.open({ source, settings, methods: Object.keys(plans) });
  return { session, ...made };
}

const times = (session) => session.moments.map(({ at }) => at);
async function toTheEnd(session) {
  while (await session.step());
}

describe('the clock', () => {
  test('by iterations the solvers take turns, and one that has ended waits for the others', async () => {
    const { session, order } = await begun({ wrapd: { energies: [9, 5, 3, 2] }, cm: { energies: [9, 2] } });
    assert.deepEqual(times(session), [0]);
    await session.step();
    assert.deepEqual([times(session), order], [[0, 1], ['wrapd', 'cm']]);
    await session.step();
    assert.deepEqual(order, ['wrapd', 'cm', 'wrapd']);
    await toTheEnd(session);
    assert.deepEqual(times(session), [0, 1, 2, 3]);
    assert.deepEqual(session.shownAt({ at: 3 }), [3, 1]);
    assert.ok(session.finished);
    assert.equal(await session.step(), undefined);
  });

  test('by seconds it is the turn of the one that is behind, and a moment is known when all have come so far', async () => {
    const { session, order } = await begun({ wrapd: { energies: [9, 8, 7, 6, 5, 4, 3], pace: 1 }, cm: { energies: [9, 5, 3], pace: 2.5 } }, 'seconds');
    await session.step();
    // both stand at 0; WRAPD comes to 1, then CM is behind and comes to 2.5: known is what happened until 1
    assert.deepEqual([order, times(session)], [['wrapd', 'cm'], [0, 1]]);
    assert.deepEqual(session.shownAt({ at: 1 }), [1, 0], 'at one second CM still shows its start');
    await session.step();
    await session.step();
    assert.deepEqual([order, times(session)], [['wrapd', 'cm', 'wrapd', 'wrapd'], [0, 1, 2, 2.5]]);
    await toTheEnd(session);
    assert.deepEqual(times(session), [0, 1, 2, 2.5, 3, 4, 5, 6]);
    assert.deepEqual(session.shownAt({ at: 2.5 }), [2, 1]);
    assert.deepEqual(session.shownAt({ at: 4 }), [4, 1]);
    assert.deepEqual([session.momentAt(2.7), session.momentAt(-1), session.momentAt(99)], [3, 0, 7]);
  });

  test('it can be changed at any time: the steps stay, the moments are counted anew', async () => {
    const { session } = await begun({ wrapd: { energies: [9, 8, 7, 6], pace: 1 }, cm: { energies: [9, 5, 3], pace: 10 } });
    await session.step();
    await session.step();
    session.clock = 'seconds';
    assert.deepEqual(times(session), [0, 1, 2], 'up to where the one that still runs has come');
    await session.step();
    assert.deepEqual(times(session), [0, 1, 2, 3, 10, 20], 'and when none runs any more, to the end');
    session.clock = 'iterations';
    assert.deepEqual(times(session), [0, 1, 2, 3]);
  });
});

describe('what is lowest', () => {
  test('until it has converged it is lowered by the gain of its last step; inverted maps do not count', async () => {
    const { session } = await begun({ wrapd: { energies: [9, 1, 4, 3], inverted: [0, 7, 0, 0] }, cm: { energies: [9, 6, 5.5, 5] } });
    await session.step();
    assert.deepEqual([session.best.energy, session.best.settled, session.best.lane.method], [6 - 3, false, 'cm']);
    await session.step();
    assert.equal(session.best.lane.method, 'wrapd');
    assert.ok(session.best.energy < 4);
    await toTheEnd(session);
    assert.deepEqual([session.best.energy, session.best.settled], [3, true]);
  });
});

describe('failures', () => {
  test('a solver that cannot start, or breaks down, keeps its place and stops no other', async () => {
    const refused = new Error('the start has 3 inverted triangles');
    const { session, freed } = await begun({ cm: { refused }, wrapd: { energies: [9, 4, 3] }, slim: { energies: [9, 6, 5, 4], fails: 2 } });
    const ended = [];
    while (await session.step(() => {}, (lane) => ended.push(lane)));
    assert.deepEqual(session.lanes.map((lane) => lane.error?.message), [refused.message, undefined, 'slim broke down']);
    assert.deepEqual(session.lanes.map((lane) => lane.records.length), [0, 3, 2]);
    assert.deepEqual(ended.sort(), [1, 2]);
    assert.deepEqual(times(session), [0, 1, 2]);
    assert.deepEqual(session.shownAt({ at: 2 }), [0, 2, 1]);
    assert.ok(session.finished && freed.length === 0);
    const { solvers } = session.trace();
    assert.equal(solvers[2].error, 'slim broke down');
  });

  test('where none can start the last problem stays', async () => {
    const plans = { wrapd: { energies: [9, 4] }, cm: { energies: [9, 5] } };
    const { session } = await begun(plans);
    const before = session.lanes;
    for (const plan of Object.values(plans)) plan.refused = new Error('no');
    await assert.rejects(session.open({ source: { ...source }, settings, methods: ['wrapd', 'cm'] }), /no/);
    assert.equal(session.lanes, before);
    assert.ok(await session.step());
  });

  test('of two openings the later one stays', async () => {
    const { session, freed } = await begun({ wrapd: { energies: [9, 4] }, cm: { energies: [9, 5] } });
    const [a, b] = await Promise.all([
      session.open({ source: { ...source }, settings, methods: ['wrapd', 'cm'] }),
      session.open({ source: { ...source }, settings, methods: ['cm', 'wrapd'] }),
    ]);
    assert.equal(a, undefined);
    assert.ok(b);
    assert.deepEqual(session.lanes.map(({ method }) => method), ['cm', 'wrapd']);
    assert.equal(freed.filter((what) => what === 'mesh').length, 2, 'the mesh before, and that of the opening that was overtaken');
  });
});

describe('with the library', () => {
  const core = initSync(readFileSync(join(root, 'pkg/single/foldfree_bg.wasm')));
  // what the session knows of the package, on the synchronous half of it
  const foldfree = {
    version: core.version, threads: 1,
    generate: async (name, triangles) => core.generate(name, triangles),
    parameterize: async (mesh, options) => {
      const solver = core.parameterize(mesh, options);
      return { ...solver, start: solver.start, step: async () => solver.step(), free: () => solver.free() };
    },
  };
  const open = async (energy, methods, start = 'tutte') => {
    const session = new CompareSession(foldfree);
    await session.open({ source: { sample: 'bumpy-cap', triangles: 500 }, settings: { start, energy }, methods });
    return session;
  };

  test('all of an energy begin at the same energy, and those that minimise it end at the same', async () => {
    for (const [energy, methods] of Object.entries(COMPARABLE)) {
      const session = await open(energy, methods);
      const starts = session.lanes.map(({ records }) => records[0].energy);
      assert.ok(starts.every((e) => Math.abs(e / starts[0] - 1) < 1e-5), `${energy}: ${starts}`);
      for (let k = 0; k < 60; k += 1) await session.step();
      for (const lane of session.lanes) assert.equal(lane.error, undefined, lane.method);
      const { energy: lowest } = session.best;
      for (const { method, newest } of session.lanes) {
        assert.ok(newest.energy >= lowest - 1e-6, `${method} is not below the lowest: ${newest.energy}, ${lowest}`);
        if (['wrapd', 'wrapd+cm', 'cm', 'slim'].includes(method)) {
          assert.ok(newest.energy - lowest < 2e-3 * Math.max(1, lowest), `${energy}, ${method}: ${newest.energy}, lowest ${lowest}`);
        }
      }
    }
  });

  test('the gap of composite majorization closes to rounding, and the table has every iterate', async () => {
    const session = await open('symmetric-dirichlet', ['wrapd', 'wrapd+cm', 'cm']);
    for (let k = 0; k < 60; k += 1) await session.step();
    const [wrapd, hybrid, cm] = session.lanes;
    const { energy, settled } = session.best;
    assert.ok(settled && hybrid.converged && cm.converged);
    for (const lane of [hybrid, cm]) assert.ok(lane.newest.energy - energy < 1e-9, `${lane.method}: ${lane.newest.energy - energy}`);
    assert.ok(hybrid.newest.switchedAt >= 1);
    for (const { records } of session.lanes) {
      assert.ok(records.every((record, i) => i === 0 || record.seconds > records[i - 1].seconds), 'time goes on');
    }
    const lines = session.csv().trim().split('\n');
    assert.equal(lines.length, 1 + wrapd.records.length + hybrid.records.length + cm.records.length);
    const columns = lines[0].split(',');
    assert.deepEqual(columns, ['method', 'iteration', 'seconds', 'energy', 'inverted', 'gradient_norm', 'smallest_sigma', 'largest_sigma', 'switched_at', 'energy_above_lowest']);
    assert.ok(lines.every((line) => line.split(',').length === columns.length));
    const last = lines.at(-1).split(',');
    assert.deepEqual([last[0], Number(last[3])], ['cm', cm.newest.energy]);
  });

  test('from a random start CM and SLIM say that they cannot, and the others run', async () => {
    const session = await open('symmetric-dirichlet', ['wrapd', 'cm', 'slim'], 'random');
    for (let k = 0; k < 3; k += 1) await session.step();
    assert.deepEqual(session.lanes.map(({ error }) => error?.code), [undefined, 'not-injective-start', 'not-injective-start']);
    assert.equal(session.moments.length, 4);
    assert.ok(session.problem.startInverted > 0);
  });
});

describe('the address', () => {
  test('says what is compared; that alone asks for the mode', () => {
    assert.equal(modeOf('?compare=cm,wrapd'), 'compare');
    assert.equal(modeOf('?mode=deform&compare=cm,wrapd'), 'deform');
    const read = (search) => readAddress('compare', search).methods;
    assert.equal(read('?compare=slim,wrapd%2Bcm'), 'wrapd+cm,slim', 'in the order of the buttons');
    assert.equal(read('?compare=slim,wrapd+cm'), 'wrapd+cm,slim', 'a plus sign may be typed');
    assert.equal(read('?compare=wrapd,wrapd+cm,cm,slim,admm-pd').split(',').length, 4);
    for (const wrong of ['', 'cm', 'magic,cm', '1']) assert.equal(read(`?compare=${wrong}`), DEFAULTS.compare.methods, wrong);
    assert.equal(read('?compare=wrapd,cm&energy=arap'), 'wrapd,slim', 'CM has no ARAP energy');
    assert.equal(readAddress('compare', '?compare=cm,slim&clock=seconds').clock, 'seconds');
    assert.equal(readAddress('flatten', '?method=wrapd+cm').method, 'wrapd+cm');
  });
});
