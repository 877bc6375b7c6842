// Locally injective mappings, as installed from the packed package: triangles in the plane and solids.
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

/** Left and bottom edges held, the corner (1, 1) to go to (x, x). */
function corner(n, x = 0.2, z = 0) {
  const pins = [...Array(n * n).keys()].filter((v) => v % n === 0 || v < n).concat(n * n - 1);
  return { pins, targets: { vertices: Uint32Array.of(n * n - 1), positions: Float64Array.of(x, x, z) } };
}

const fails = (code, call) => assert.throws(call, (error) => {
  assert.equal(error.code, code, error.message);
  return true;
});

describe('lim in this thread', () => {
  it('drags the corner of a square in, and nothing inverts at any step', () => {
    const n = 21;
    const rest = square(n, { z: 3 });
    const solver = core.deform(core.mesh(rest), { ...corner(n, 0.2, 3), energy: 'dirichlet' });
    let last = solver.start;
    for (const step of solver) {
      assert.equal(inverted(rest, step.positions), 0, `iteration ${step.iteration}`);
      const { alpha, mu, sigma, subStep, barrier, positionalError, arrived, handles } = step.lim;
      for (const value of [alpha, sigma, barrier, subStep]) assert.ok(value >= 0 && Number.isFinite(value));
      assert.ok(mu === 0 && subStep === 1, 'projected Hessians need no shift');
      assert.ok(handles === 2 * n && arrived <= handles);
      assert.equal(positionalError === 0, arrived === handles);
      assert.equal(step.subTargets.vertices.length <= 1, true);
      last = step;
    }
    assert.ok(last.converged);
    assert.deepEqual([...last.positions.subarray(3 * (n * n - 1))], [0.2, 0.2, 3]);
    const { positions, certificate } = solver.result();
    assert.deepEqual([certificate.elements, certificate.inverted.length, certificate.degenerate.length], [2 * (n - 1) ** 2, 0, 0]);
    assert.ok(certificate.locallyInjective && certificate.globallyInjective);
    assert.ok(positions.every((x, i) => i % 3 < 2 || x === 3), 'it stays in its plane');
    solver.free();
  });

  it('inverts triangles without the barrier, and says how many', () => {
    const n = 21;
    const rest = square(n);
    const solver = core.deform(core.mesh(rest), { ...corner(n), energy: 'dirichlet', barrier: false });
    const last = [...solver].at(-1);
    const wrong = inverted(rest, last.positions);
    assert.ok(wrong > 0);
    assert.equal(last.inverted, wrong);
    const { certificate } = solver.result();
    assert.equal(certificate.inverted.length + certificate.degenerate.length, wrong);
    assert.ok(!certificate.locallyInjective);
    assert.equal(last.lim.barrier, 0);
  });

  it('leads handles by sub-steps where a shift is needed, and says where to', () => {
    const n = 11;
    const solver = core.deform(core.mesh(square(n)), { ...corner(n), energy: 'green-strain', hessian: 'frozen' });
    const steps = [...solver];
    const short = steps.filter((step) => step.lim.mu > 0);
    assert.ok(short.length > 0);
    for (const { lim, subTargets } of short) {
      assert.ok(Math.abs(lim.subStep - 1 / (1 + lim.mu ** 2)) < 1e-12);
      if (lim.arrived === lim.handles) continue;
      const [x, y] = subTargets.positions;
      assert.ok(x >= 0.2 && x <= 1 && Math.abs(x - y) < 0.5);
    }
    assert.ok(short.some(({ subTargets }) => subTargets.positions[0] > 0.2 + 1e-6), 'a sub-target is on the way');
    assert.ok(steps.at(-1).converged);
  });

  it('moves handles while it runs, there and back', () => {
    const n = 11;
    const rest = square(n);
    const solver = core.deform(core.mesh(rest), corner(n, 1));
    for (const x of [0.5, 0.1, 1]) {
      solver.setTargets(corner(n, x).targets);
      for (const step of solver) assert.equal(inverted(rest, step.positions), 0);
    }
    const { positions } = solver.result();
    assert.ok(positions.every((x, i) => Math.abs(x - rest.positions[i]) < 1e-5), 'it springs back');
    // a free vertex is pulled
    solver.setTargets({ vertices: Uint32Array.of(60), positions: Float64Array.of(0.8, 0.8, 0) });
    const pulled = [...solver].at(-1);
    assert.ok(Math.hypot(pulled.positions[180] - 0.5, pulled.positions[181] - 0.5) > 0.1);
  });

  it('turns a clockwise mesh and says so', () => {
    const n = 6;
    const rest = square(n, { clockwise: true });
    const solver = core.deform(core.mesh(rest), corner(n, 0.6));
    assert.match(solver.notes.join(), /clockwise: all triangles were turned/);
    const last = [...solver].at(-1);
    assert.equal(inverted(rest, last.positions), 0);
    const { certificate } = solver.result();
    assert.ok(certificate.locallyInjective && !certificate.mirrored);
  });

  it('refuses what it cannot begin with, by name', () => {
    const n = 6;
    const mesh = core.mesh(square(n));
    const folded = square(n).positions;
    folded.set([-0.5, -0.5], 3 * 14);
    assert.throws(() => core.deform(mesh, { ...corner(n), start: folded }), ({ code, message, details }) => {
      assert.equal(code, 'not-injective-start');
      assert.match(message, /untangle the start first/);
      assert.ok(details.inverted > 0 && details.first >= 0 && details.first < 50);
      return true;
    });
    core.deform(mesh, { ...corner(n), start: folded, barrier: false }).free();
    const twice = { vertices: Uint32Array.of(35, 35), positions: Float64Array.of(0, 0, 0, 1, 1, 0) };
    assert.throws(() => core.deform(mesh, { ...corner(n), targets: twice }), /vertex 35 has two targets/);
    fails('invalid-option', () => core.deform(mesh, { ...corner(n), method: 'wrapd' }));
    fails('invalid-option', () => core.deform(mesh, { ...corner(n), energy: 'neo-hookean' }));
    fails('invalid-option', () => core.deform(mesh, { ...corner(n), young: 1 }));
    fails('invalid-option', () => core.deform(mesh, { ...corner(n), barrierWeight: -1 }));
    fails('invalid-option', () => core.deform(mesh, { ...corner(n), hessian: 'exact' }));
    fails('invalid-option', () => core.deform(mesh, {}));
    const bent = square(n);
    bent.positions[3 * 8 + 2] = 0.1;
    assert.throws(() => core.deform(core.mesh(bent), corner(n)), /vertex 8 is not in the plane/);
  });

  it('twists a solid, in every energy', () => {
    const solid = core.generateSolid('bar', 300);
    const xs = solid.positions.filter((_, i) => i % 3 === 0);
    const [low, high] = [Math.min(...xs), Math.max(...xs)];
    const end = (test) => [...xs.keys()].filter((v) => test((xs[v] - low) / (high - low)));
    const [left, right] = [end((t) => t < 0.1), end((t) => t > 0.9)];
    const targets = {
      vertices: Uint32Array.from(right),
      positions: Float64Array.from(right.flatMap((v) => {
        const [x, y, z] = solid.positions.subarray(3 * v, 3 * v + 3);
        return [x, -z, y];
      })),
    };
    for (const energy of ['arap', 'lscm', 'dirichlet', 'laplacian', 'uniform-laplacian', 'green-strain']) {
      const solver = core.deform(solid, { method: 'lim', energy, pins: [...left, ...right], targets, maxIterations: 400 });
      const steps = [...solver];
      assert.ok(steps.every((step) => step.inverted === 0), energy);
      const { certificate } = solver.result();
      assert.equal(certificate.inverted.length + certificate.degenerate.length, 0, energy);
      assert.equal(steps.at(-1).lim.arrived, left.length + right.length, energy);
      solver.free();
    }
  });

  it('has defaults that can be read', () => {
    const { energy, barrier, barrierReach, hessian, tolerance } = core.defaultLimOptions();
    assert.deepEqual([energy, barrier, barrierReach, hessian, tolerance], ['arap', true, 1, 'projected', 1e-8]);
  });
});

describe('lim in a worker', () => {
  it('takes new targets while it runs', async () => {
    const n = 11;
    const rest = square(n);
    const mesh = await foldfree.mesh(rest);
    const solver = await foldfree.deform(mesh, { ...corner(n, 1), method: 'lim' });
    let frames = 0;
    const onFrame = (step) => {
      assert.equal(inverted(rest, step.positions), 0);
      assert.ok(step.lim && step.subTargets);
      frames += 1;
    };
    for (const x of [0.3, 0.7]) {
      await solver.setTargets(corner(n, x).targets);
      await solver.run({ onFrame });
    }
    assert.ok(frames > 2);
    const { positions, certificate } = await solver.result();
    assert.ok(certificate.globallyInjective);
    assert.deepEqual([...positions.subarray(3 * (n * n - 1))], [0.7, 0.7, 0]);
  });

  it('refuses the same', async () => {
    const mesh = await foldfree.mesh(square(4));
    await assert.rejects(foldfree.deform(mesh, { pins: [0], method: 'wrapd' }), { code: 'invalid-option' });
    await assert.rejects(foldfree.deform(mesh, { pins: [0], start: new Float64Array(48) }), { code: 'not-injective-start' });
  });
});
