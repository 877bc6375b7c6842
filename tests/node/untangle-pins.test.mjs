// Bodies that are kept apart while what holds them moves, and what a step goes through; here and in a worker.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, describe, it } from 'node:test';
import { importPacked, installPacked } from './packed.mjs';
import { inverted, square } from './plane.mjs';

const { folder } = installPacked();
const { initSync, wasm } = await importPacked(folder, 'foldfree/core');
const { load } = await importPacked(folder, 'foldfree');
const core = initSync(readFileSync(new URL(wasm)));
const foldfree = await load({ threads: false });
after(() => foldfree.terminate());

const n = 8;

/** Two squares, the second 0.1 above the first; the lowest row of vertices is held, and the highest. */
function squares() {
  const { positions, indices } = square(n);
  const above = positions.map((x, i) => x + [0.02, 1.1, 0][i % 3]);
  const rest = {
    positions: Float64Array.of(...positions, ...above),
    indices: Uint32Array.of(...indices, ...indices.map((v) => v + n * n)),
  };
  const row = (first) => Uint32Array.from({ length: n }, (_, i) => first + i);
  return { rest, low: row(0), high: row(2 * n * n - n) };
}

/** The highest row, this far down. */
const pressed = ({ rest, high }, by) => ({
  vertices: high,
  positions: Float64Array.from([...high].flatMap((v) => [rest.positions[3 * v], rest.positions[3 * v + 1] - by, 0])),
});

const { rest, low, high } = squares();
const pins = Uint32Array.of(...low, ...high);
const options = { pins, overlap: true, settle: 0 };

describe('pins that move', () => {
  it('lead to states in which nothing crosses, again and again', () => {
    const solver = core.untangle(core.mesh(rest), { ...options, trace: true });
    assert.equal(solver.start.status, 'converged', 'nothing is to be done yet');
    let most = 0;
    for (const by of [0.3, 0.5, 0.1]) {
      const targets = pressed({ rest, high }, by);
      solver.movePins(targets);
      let steps = 0;
      for (const step of solver) {
        steps += 1;
        assert.equal(step.iteration, steps, 'counted anew');
        most = Math.max(most, step.gini.contacts);
      }
      const { outcome, certificate, positions } = solver.result();
      assert.deepEqual([outcome.globallyInjective, outcome.intersections, certificate.globallyInjective], [true, 0, true]);
      high.forEach((v, i) => assert.deepEqual(positions.subarray(3 * v, 3 * v + 3), targets.positions.subarray(3 * i, 3 * i + 3)));
    }
    assert.ok(most > 0, 'they meet');
  });

  it('every state inside a step comes with what is wrong in it', () => {
    const solver = core.untangle(core.mesh(rest), { ...options, targets: pressed({ rest, high }, 0.4), trace: true });
    assert.deepEqual([solver.start.trace, solver.start.quadratic, solver.start.status], [[], [], 'running']);
    let [crossed, active, zoned] = [0, 0, 0];
    for (const { gini, trace, quadratic } of solver) {
      assert.equal(quadratic.length, gini.qpIterations + 1);
      assert.deepEqual(quadratic.at(-1).positions, trace[0].positions);
      assert.ok(quadratic.every((state) => !('zones' in state)));
      for (const state of [...quadratic, ...trace]) {
        assert.equal(inverted(rest, state.positions), state.inverted);
        assert.ok(state.violated >= state.inverted);
        crossed = Math.max(crossed, state.meeting);
        const { vertices, edges, active: holds, zones } = state.contacts;
        assert.equal(zones.length, edges.length);
        assert.ok(state.zones || zones.every((zone) => zone === 0), 'zones are the polisher’s');
        zoned = Math.max(zoned, ...zones);
        assert.deepEqual([vertices.length, holds.length], [4 * edges.length, edges.length]);
        assert.ok(edges.every((edge) => edge === 0), 'in the plane a vertex meets an edge');
        assert.ok(vertices.every((v, i) => v < 2 * n * n && (i % 4 < 3 || v === vertices[i - 1])));
        active = Math.max(active, holds.reduce((sum, one) => sum + one, 0));
      }
      assert.equal(trace[0].zones.length, rest.indices.length / 3);
    }
    assert.ok(crossed > 0 && active > 0 && zoned > 0);
    // without overlap nothing of that is looked for
    const free = core.untangle(core.mesh(rest), { pins, targets: pressed({ rest, high }, 0.4), trace: true });
    const step = free.step();
    assert.ok([...step.quadratic, ...step.trace].every(({ meeting, contacts }) => meeting === undefined && contacts.edges.length === 0));
  });

  it('are refused by name where that makes no sense', () => {
    const solver = core.untangle(core.mesh(rest), options);
    const fails = (code, targets, words) => assert.throws(() => solver.movePins(targets), (error) => error.code === code && error.message.includes(words));
    const point = new Float64Array(3);
    fails('invalid-argument', [1, 2], 'targets');
    fails('invalid-argument', { vertices: Uint32Array.of(0), positions: new Float64Array(2) }, 'expected 3');
    fails('invalid-option', { vertices: Uint32Array.of(n + 1), positions: point }, `vertex ${n + 1}`);
    fails('invalid-option', { vertices: Uint32Array.of(9999), positions: point }, '9999');
    fails('invalid-option', { vertices: Uint32Array.of(0), positions: Float64Array.of(NaN, 0, 0) }, 'finite');
    assert.equal(solver.frame().status, 'converged', 'nothing has changed');
    const free = core.untangle(core.mesh(rest), { pins });
    assert.throws(() => free.movePins({ vertices: Uint32Array.of(0), positions: point }), { code: 'invalid-option' });
  });

  it('go on in a worker, also while it runs', async () => {
    const mesh = await foldfree.mesh(rest);
    const solver = await foldfree.untangle(mesh, options);
    assert.equal(solver.status, 'converged');
    await solver.movePins(pressed({ rest, high }, 0.3));
    assert.equal(solver.status, 'running');
    const running = solver.run();
    const last = pressed({ rest, high }, 0.35);
    await solver.movePins(last);
    await running;
    const { status } = await solver.run();
    assert.equal(status, 'converged');
    const { positions, outcome } = await solver.result();
    assert.ok(outcome.globallyInjective);
    assert.equal(positions[3 * high[0] + 1], last.positions[1]);
    await assert.rejects(solver.movePins({ vertices: Uint32Array.of(n + 1), positions: new Float64Array(3) }), { code: 'invalid-option' });
    solver.free();
  });

  it('that move while the last frame waits to be taken have the run go on', async () => {
    const [first, last] = [pressed({ rest, high }, 0.9), pressed({ rest, high }, 0.1)];
    const solver = await foldfree.untangle(await foldfree.mesh(rest), { ...options, targets: first });
    const there = async ({ positions }) => {
      const result = await solver.result();
      return result.outcome.globallyInjective && [...high].every((v, i) => result.positions[3 * v + 1] === positions[3 * i + 1]);
    };
    let frames = 0;
    const end = await solver.run({
      onFrame: async () => {
        frames += 1;
        if (frames > 1) return;
        // no other frame is sent until this one was taken: the solver comes to its end, and is told to go on
        while (!(await there(first))) await new Promise((resolve) => { setTimeout(resolve, 5); });
        await solver.movePins(last);
      },
    });
    assert.ok(frames > 1, 'the end is a frame of its own');
    assert.deepEqual([end.status, solver.status], ['converged', 'converged']);
    assert.ok(await there(last));
    // and those that move while the last one is taken wake the solver, whose run is over
    await solver.movePins(pressed({ rest, high }, 0.12));
    let told = false;
    await solver.run({ onFrame: async ({ status }) => { if (status === 'converged') told = (await solver.movePins(first), true); } });
    assert.deepEqual([told, solver.status], [true, 'running']);
    await solver.run();
    assert.ok(await there(first));
    solver.free();
  });

  it('come from a worker with all states of a step as they are here', async () => {
    const solver = await foldfree.untangle(await foldfree.mesh(rest), { ...options, targets: pressed({ rest, high }, 0.4), primary: true, trace: true });
    const here = core.untangle(core.mesh(rest), { ...options, targets: pressed({ rest, high }, 0.4), primary: true, trace: true });
    for await (const step of solver) {
      const same = here.step();
      assert.deepEqual(step.trace, same.trace);
      assert.deepEqual(step.quadratic, same.quadratic);
      assert.deepEqual(step.positions, same.positions);
    }
    assert.ok((await solver.result()).outcome.globallyInjective);
    solver.free();
  });
});
