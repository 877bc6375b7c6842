// Solids and deformations, as installed from the packed package: in this thread, and in a worker.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, describe, it } from 'node:test';
import { importPacked, installPacked } from './packed.mjs';

const { folder } = installPacked();
const { initSync, wasm } = await importPacked(folder, 'foldfree/core');
const { load } = await importPacked(folder, 'foldfree');
const core = initSync(readFileSync(new URL(wasm)));
const foldfree = await load({ threads: false });
after(() => foldfree.terminate());

/** Vertices in the first and last tenth of the longest extent along x. */
function ends({ positions }) {
  const xs = positions.filter((_, i) => i % 3 === 0);
  const [low, high] = [xs.reduce((a, b) => Math.min(a, b)), xs.reduce((a, b) => Math.max(a, b))];
  const near = (test) => Uint32Array.from([...xs.keys()].filter((v) => test((xs[v] - low) / (high - low))));
  return { left: near((t) => t < 0.1), right: near((t) => t > 0.9) };
}

/** Targets that turn these vertices about x. */
function turned({ positions }, vertices, angle) {
  const [c, s] = [Math.cos(angle), Math.sin(angle)];
  const points = new Float64Array(3 * vertices.length);
  vertices.forEach((v, k) => {
    const [x, y, z] = positions.subarray(3 * v, 3 * v + 3);
    points.set([x, c * y - s * z, s * y + c * z], 3 * k);
  });
  return { vertices, positions: points };
}

const rejected = (code, call) => assert.rejects(call, (error) => error.code === code || assert.fail(`${error.code}: ${error.message}`));
const thrown = (code, call, words = '') =>
  assert.throws(call, (error) => (error.code === code && error.message.includes(words)) || assert.fail(`${error.code}: ${error.message}`));

describe('solids', () => {
  it('are generated with their boundary', () => {
    assert.ok(core.solidShapes.length >= 7);
    for (const { name, title, description } of core.solidShapes) {
      assert.ok(title && description);
      const solid = core.generateSolid(name, 1000);
      assert.ok(solid.tetrahedronCount > 500 && solid.tetrahedronCount < 2000, `${name}: ${solid.tetrahedronCount}`);
      assert.ok(solid.surface.length % 3 === 0 && Math.max(...solid.surface) < solid.vertexCount);
      // every edge of a closed surface once in each direction
      const edges = new Set();
      for (let i = 0; i < solid.surface.length; i += 3) {
        for (let k = 0; k < 3; k++) edges.add(solid.surface[i + k] * solid.vertexCount + solid.surface[i + ((k + 1) % 3)]);
      }
      for (const edge of edges) assert.ok(edges.has((edge % solid.vertexCount) * solid.vertexCount + Math.floor(edge / solid.vertexCount)));
      solid.free();
    }
  });

  it('are written and read again, in every format', () => {
    const solid = core.generateSolid('bar', 300);
    for (const format of ['mesh', 'msh', 'vtk']) {
      const again = core.solid(solid.write(format), format);
      assert.deepEqual(again.positions, solid.positions);
      assert.deepEqual(again.tetrahedra, solid.tetrahedra);
    }
    for (const format of ['obj', 'ply', 'stl', 'off']) {
      assert.equal(core.mesh(solid.write(format), format).triangleCount, solid.surface.length / 3);
    }
    const node = '4 3 0 0\n0 0 0 0\n1 1 0 0\n2 0 1 0\n3 0 0 1\n';
    assert.deepEqual([...core.solid(node, 'node', '1 4 0\n0 0 1 2 3\n').tetrahedra], [0, 1, 2, 3]);
  });

  it('that are none are refused', () => {
    thrown('index-out-of-range', () => core.solid({ positions: new Float64Array(12), tetrahedra: new Uint32Array([0, 1, 2, 4]) }));
    thrown('invalid-argument', () => core.solid({ positions: new Float64Array(12), indices: new Uint32Array(4) }));
    thrown('invalid-argument', () => core.solid('x', 'obj'), 'mesh, msh, vtk, node');
    thrown('invalid-argument', () => core.solid('x', 'node'), '.ele');
    thrown('invalid-argument', () => core.generateSolid('teapot', 100), 'teapot');
    thrown('parse', () => core.solid('nonsense', 'vtk'));
  });
});

describe('deform', () => {
  it('untwists a bar, in this thread', () => {
    const bar = core.generateSolid('bar', 1000);
    const { left, right } = ends(bar);
    const solver = core.deform(bar, { pins: [...left, ...right], field: 'stretch' });
    let step = solver.start;
    assert.ok(step.energy < 1e-6 && step.inverted === 0);
    assert.equal(step.field.length, bar.tetrahedronCount);
    for (let k = 1; k <= 30; k++) {
      solver.setTargets(turned(bar, right, k * 0.05));
      step = solver.step();
      assert.equal(step.iteration, k);
    }
    for (step of solver);
    assert.equal(step.status, 'converged');
    assert.equal(step.inverted, 0);
    assert.ok(Math.max(...step.field) > 1.01 && Math.max(...step.field) < 10);
    const { positions, certificate } = solver.result();
    assert.equal(certificate.locallyInjective, true);
    assert.deepEqual(core.checkSolid(bar, positions), certificate);
    const moved = turned(bar, right, 1.5);
    moved.vertices.forEach((v, k) => assert.deepEqual(positions.slice(3 * v, 3 * v + 3), moved.positions.slice(3 * k, 3 * k + 3)));
    // and back, without the targets the pins stay
    solver.setTargets(turned(bar, right, 0));
    for (step of solver);
    assert.ok(step.energy < 1e-3);
    assert.ok(solver.result().positions.every((x, i) => Math.abs(x - bar.positions[i]) < 1e-3));
  });

  it('takes every material and method', () => {
    const bar = core.generateSolid('bar', 300);
    const { left, right } = ends(bar);
    const defaults = core.defaultDeformationOptions();
    assert.equal(defaults.energy, 'neo-hookean');
    for (const energy of ['neo-hookean', 'stable-neo-hookean', 'st-venant-kirchhoff', 'arap', 'symmetric-dirichlet', 'dirichlet']) {
      for (const method of ['wrapd', 'r-admm', 'w-admm', 'admm-pd', 'l-bfgs', 'newton', 'wrapd+newton']) {
        const solver = core.deform(bar, { energy, method, pins: left, targets: turned(bar, right, 0.3), maxIterations: 20 });
        let step;
        for (let k = 0; k < 20; k++) step = solver.step();
        assert.ok(Number.isFinite(step.energy) && step.inverted === 0, `${energy}, ${method}: ${step.energy}`);
        solver.free();
      }
    }
  });

  it('refuses bad input and changes nothing', () => {
    const bar = core.generateSolid('bar', 300);
    const { left } = ends(bar);
    const none = new Float64Array();
    thrown('invalid-option', () => core.deform(bar, { pins: [] }), 'float away');
    thrown('invalid-option', () => core.deform(bar, { pins: [99999] }), '99999');
    thrown('invalid-option', () => core.deform(bar, { pins: left, poisson: 0.5 }), 'poisson');
    thrown('invalid-option', () => core.deform(bar, { pins: left, energy: 'rubber' }), 'neo-hookean');
    thrown('invalid-option', () => core.deform(bar, { pins: left, colour: 'red' }), 'colour');
    thrown('invalid-argument', () => core.deform(bar, { pins: [-1] }), 'pins');
    thrown('invalid-argument', () => core.deform(bar, { pins: left, start: [1, 2] }), 'start');
    thrown('wrong-length', () => core.deform(bar, { pins: left, start: none }), 'start');
    const solver = core.deform(bar, { pins: left });
    const before = solver.frame().positions;
    thrown('invalid-option', () => solver.setTargets({ vertices: new Uint32Array([3]), positions: new Float64Array([0, NaN, 0]) }), 'vertex 3');
    thrown('invalid-argument', () => solver.setTargets({ vertices: new Uint32Array([3]), positions: none }), 'expected 3');
    thrown('invalid-argument', () => solver.setTargets({ vertices: [3], positions: none }), 'targets');
    thrown('invalid-argument', () => solver.setField('colour'), 'field');
    assert.deepEqual(solver.frame().positions, before);
  });

  it('runs in a worker while its targets move', async () => {
    const bar = await foldfree.generateSolid('bar', 1000);
    const { left, right } = ends(bar);
    const solver = await foldfree.deform(bar, { pins: [...left, ...right], frames: 'f32', maxIterations: 100_000, tolerance: 0 });
    let newest = 0;
    let reached;
    const there = new Promise((resolve) => (reached = resolve));
    const running = solver.run({
      onFrame(frame) {
        assert.ok(frame.positions instanceof Float32Array && frame.iteration >= newest);
        newest = frame.iteration;
        const v = right[0];
        const wanted = turned(bar, right, 0.8).positions;
        if ([0, 1, 2].every((i) => Math.abs(frame.positions[3 * v + i] - wanted[i]) < 1e-6) && frame.iteration > 60) reached();
      },
    });
    for (let k = 1; k <= 8; k++) await solver.setTargets(turned(bar, right, 0.1 * k));
    await there;
    solver.cancel();
    const last = await running;
    assert.equal(last.status, 'cancelled');
    const { certificate } = await solver.result();
    assert.equal(certificate.locallyInjective, true);
    await rejected('invalid-option', () => solver.setTargets({ vertices: new Uint32Array([5, 5]), positions: new Float64Array(6) }));
    await solver.setField('stress');
    assert.ok((await solver.step()).field.every((x) => x >= 0 && Number.isFinite(x)));
    await rejected('invalid-argument', () => foldfree.deform(bar, { pins: 3 }));
  });
});
