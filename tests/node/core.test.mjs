// `foldfree/core`, as installed from the packed package: synchronous, in this thread.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { describe, it } from 'node:test';
import { importPacked, installPacked } from './packed.mjs';

const { folder } = installPacked();
const { FoldfreeError, initSync, wasm } = await importPacked(folder, 'foldfree/core');
const core = initSync(readFileSync(new URL(wasm)));

const square = {
  positions: new Float64Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]),
  indices: new Uint32Array([0, 1, 2, 0, 2, 3]),
};

/** Asserts that `call` throws a FoldfreeError with this code, and gives it back. */
function thrown(code, call) {
  let error;
  assert.throws(call, (caught) => {
    error = caught;
    return true;
  });
  assert.ok(error instanceof FoldfreeError, `${error?.stack}`);
  assert.ok(error instanceof Error);
  assert.equal(error.code, code, error.message);
  return error;
}

describe('core', () => {
  it('knows its version, threads and shapes', () => {
    assert.match(core.version, /^\d+\.\d+\.\d+/);
    assert.equal(core.threads, 1);
    assert.ok(core.shapes.length >= 7);
    for (const shape of core.shapes) assert.ok(shape.name && shape.title && shape.description);
  });

  it('has every method of parameterization, to the same minimum where the energy is the same', () => {
    using_(core.generate('bumpy-cap', 600), (mesh) => {
      const ends = {};
      for (const method of ['wrapd', 'wrapd+cm', 'cm', 'slim', 'r-admm', 'w-admm', 'admm-pd', 'arap', 'lscm', 'harmonic', 'tutte']) {
        using_(core.parameterize(mesh, { method, start: 'tutte', tolerance: 1e-8 }), (solver) => {
          let last = solver.start;
          for (let k = 0; k < 400 && last.status === 'running'; k++) last = solver.step();
          ends[method] = last;
          assert.ok(last.iteration >= 1 && Number.isFinite(last.energy), `${method}: ${last.energy}`);
          // once it has switched every report says when
          assert.equal(last.switchedAt !== undefined, method === 'wrapd+cm', method);
        });
      }
      const { iteration, switchedAt, energy: least } = ends['wrapd+cm'];
      assert.ok(switchedAt >= 1 && switchedAt < iteration, `${switchedAt} of ${iteration}`);
      for (const method of ['wrapd', 'cm', 'slim']) {
        assert.ok(Math.abs(ends[method].energy / least - 1) < 1e-5, `${method}: ${ends[method].energy}, ${least}`);
      }
      assert.ok(iteration < ends.wrapd.iteration, 'the second order is worth its while');
    });
  });

  it('makes maps that do not overlap, where the others do', () => {
    const spiral = core.generate('spiral-ramp', 1000);
    const certified = (method) => {
      const solver = core.parameterize(spiral, { method, start: 'lscm', maxIterations: 500 });
      for (const step of solver) void step;
      const { certificate } = solver.result();
      solver.free();
      return certificate;
    };
    assert.ok(certified('wrapd').boundaryCrossings.length > 0);
    for (const method of ['gini', 'gini+cm']) {
      const certificate = certified(method);
      assert.equal(certificate.inverted.length, 0);
      assert.equal(certificate.boundaryCrossings.length, 0);
      assert.equal(certificate.globallyInjective, true);
    }
  });

  it('says which methods need a start without inversions', () => {
    using_(core.generate('bumpy-cap', 300), (mesh) => {
      for (const method of ['cm', 'slim']) {
        const error = thrown('not-injective-start', () => core.parameterize(mesh, { method, start: 'random' }));
        assert.ok(error.details.inverted > 0 && /inverted/.test(error.message), error.message);
      }
      core.parameterize(mesh, { method: 'slim', start: 'random', energy: 'arap' }).free();
      core.parameterize(mesh, { method: 'wrapd+cm', start: 'random' }).free();
      thrown('invalid-option', () => core.parameterize(mesh, { method: 'cm', energy: 'arap' }));
    });
  });

  it('flattens a bumpy cap without a fold, and certifies it', () => {
    using_(core.generate('bumpy-cap', 2000), (mesh) => {
      assert.ok(mesh.triangleCount > 1000 && mesh.triangleCount < 4000);
      using_(core.parameterize(mesh, { maxIterations: 300 }), (solver) => {
        assert.equal(solver.start.iteration, 0);
        let last = solver.start;
        for (const step of solver) {
          assert.equal(step.iteration, last.iteration + 1);
          assert.equal(step.positions.length, (solver.mesh.positions.length / 3) * 2);
          assert.equal(step.distortion.length, mesh.triangleCount);
          last = step;
        }
        assert.equal(last.status, 'converged');
        assert.equal(last.inverted, 0);
        assert.ok(last.energy >= 1 && last.energy < solver.start.energy);
        assert.ok(last.phases.some((phase) => phase.kind === 'local' && phase.milliseconds >= 0));
        const { uv, certificate, inputVertices } = solver.result();
        assert.equal(certificate.locallyInjective, true);
        assert.deepEqual(certificate.inverted, []);
        assert.ok(Math.abs(certificate.symmetricDirichlet - last.energy) < 1e-6 * last.energy);
        assert.equal(uv.length, inputVertices.length * 2);
        assert.deepEqual(core.check(mesh, uv).symmetricDirichlet, certificate.symmetricDirichlet);
      });
    });
  });

  it('is deterministic', () => {
    const run = () => using_(core.generate('terrain', 1000), (mesh) =>
      using_(core.parameterize(mesh, { maxIterations: 20 }), (solver) => {
        for (const step of solver) void step;
        return solver.result().uv;
      }));
    assert.deepEqual(run(), run());
  });

  it('cuts a closed surface and keeps the cross-reference to the input vertices', () => {
    using_(core.generate('torus', 1200), (mesh) =>
      using_(core.parameterize(mesh, { maxIterations: 5 }), (solver) => {
        assert.ok(solver.seamEdges > 0);
        assert.ok(solver.inputVertices.length > mesh.vertexCount);
        assert.equal(solver.mesh.indices.length, mesh.indices.length);
        // Triangle i of the cut mesh is triangle i of the input, corner by corner or turned over.
        for (let i = 0; i < mesh.indices.length; i += 3) {
          const cut = [...solver.mesh.indices.subarray(i, i + 3)].map((v) => solver.inputVertices[v]);
          assert.deepEqual(cut.sort(), [...mesh.indices.subarray(i, i + 3)].sort());
        }
        const again = core.mesh(new TextDecoder().decode(solver.exportObj()), 'obj');
        assert.equal(again.vertexCount, mesh.vertexCount);
        assert.equal(again.triangleCount, mesh.triangleCount);
        assert.equal(again.texture.coordinates.length, solver.inputVertices.length * 2);
      }));
    using_(core.generate('torus', 1200), (mesh) => {
      const error = thrown('not-a-disk', () => core.parameterize(mesh, { cut: 'refuse' }));
      assert.equal(error.details.eulerCharacteristic ?? error.details.euler_characteristic, 0);
    });
  });

  it('gives frames in single precision when asked', () => {
    using_(core.generate('bumpy-cap', 200), (mesh) =>
      using_(core.parameterize(mesh, { frames: 'f32' }), (solver) => {
        assert.ok(solver.start.positions instanceof Float32Array);
        assert.ok(solver.result().uv instanceof Float64Array);
      }));
  });

  it('refuses options that do not exist or have a wrong value, by name', () => {
    using_(core.mesh(square), (mesh) => {
      const refused = (options) => thrown('invalid-option', () => core.parameterize(mesh, options));
      assert.match(refused({ methd: 'wrapd' }).message, /methd.*method/);
      assert.equal(refused({ methd: 'wrapd' }).details.option, 'methd');
      assert.match(refused({ method: 'magic' }).message, /method.*magic.*wrapd/);
      assert.equal(refused({ maxIterations: -1 }).details.option, 'maxIterations');
      assert.equal(refused({ maxIterations: 1.5 }).details.option, 'maxIterations');
      assert.equal(refused({ seed: 'one' }).details.option, 'seed');
      assert.match(refused({ tolerance: NaN }).message, /tolerance/);
      assert.match(refused({ tolerance: -1 }).message, /tolerance/);
      core.parameterize(mesh, { method: undefined }).free();
    });
    assert.equal(core.defaultOptions().method, 'wrapd');
  });

  it('names the line of what it cannot read', () => {
    const error = thrown('parse', () => core.mesh('v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 90\n', 'obj'));
    assert.equal(error.line, 4);
    assert.match(error.message, /90/);
    thrown('parse', () => core.mesh('v 0 0 nan\n', 'obj'));
    thrown('parse', () => core.mesh(new Uint8Array(), 'off'));
    thrown('parse', () => core.mesh('OFF\n1000000000 2000000000 0\n0 0 0\n', 'off'));
    thrown('invalid-argument', () => core.mesh('v 0 0 0', 'step'));
    thrown('invalid-argument', () => core.mesh('v 0 0 0'));
    thrown('invalid-argument', () => core.mesh({ positions: [0, 0, 0], indices: [0, 0, 0] }));
    thrown('invalid-argument', () => core.mesh({ positions: new Float64Array(4), indices: new Uint32Array(3) }));
    thrown('index-out-of-range', () => core.mesh({ ...square, indices: new Uint32Array([0, 1, 9]) }));
    thrown('invalid-argument', () => core.generate('klein-bottle', 100));
    thrown('invalid-argument', () => core.generate('torus', NaN));
  });

  it('flattens several pieces, each to a chart of its own', () => {
    const positions = new Float64Array([...square.positions, ...[...square.positions].map((x) => x + 5)]);
    const indices = new Uint32Array([...square.indices, ...[...square.indices].map((v) => v + square.positions.length / 3)]);
    using_(core.mesh({ positions, indices }), (mesh) => using_(core.parameterize(mesh), (solver) => {
      for (let step = solver.start; step.status === 'running';) step = solver.step();
      assert.ok(solver.notes.includes('2 pieces, a chart for each'), solver.notes.join());
      const { certificate } = solver.result();
      assert.ok(certificate.globallyInjective);
      assert.ok(Math.abs(certificate.symmetricDirichlet - 1) < 1e-6);
    }));
  });

  it('holds and pulls landmarks', () => {
    using_(core.generate('bumpy-cap', 400), (mesh) => {
      const places = [[0, [10, 0]], [7, [10.5, 0.2]]];
      const run = (hard) => {
        const landmarks = places.map(([vertex, uv]) => ({ vertex, uv, hard }));
        return using_(core.parameterize(mesh, { method: 'wrapd+cm', landmarks }), (solver) => {
          for (let step = solver.start; step.status === 'running';) step = solver.step();
          const { uv } = solver.result();
          return Math.max(...places.map(([v, [x, y]]) => Math.hypot(uv[2 * v] - x, uv[2 * v + 1] - y)));
        });
      };
      assert.ok(run(true) < 1e-12);
      const pulled = run(false);
      assert.ok(pulled > 1e-12 && pulled < 0.3, `${pulled}`);
      const one = (landmark) => () => core.parameterize(mesh, { landmarks: [landmark] });
      thrown('invalid-option', one({ vertex: 1e6, uv: [0, 0] }));
      thrown('invalid-argument', one({ vertex: 0, uv: [0] }));
      thrown('invalid-argument', one({ vertex: -1, uv: [0, 0] }));
      thrown('invalid-argument', () => core.parameterize(mesh, { landmarks: 5 }));
    });
  });

  it('refuses bad meshes with a typed error and goes on working', () => {
    const bad = (positions, indices) =>
      core.mesh({ positions: new Float64Array(positions), indices: new Uint32Array(indices) });
    const attempt = (code, mesh) => using_(mesh, () => thrown(code, () => core.parameterize(mesh)));
    const corners = [...square.positions];
    attempt('empty-mesh', bad([], []));
    attempt('non-finite-position', bad([0, 0, NaN, 1, 0, 0, 1, 1, 0], [0, 1, 2]));
    attempt('repeated-vertex', bad(corners, [0, 1, 1]));
    attempt('duplicate-face', bad(corners, [0, 1, 2, 1, 2, 0]));
    attempt('zero-area', bad([0, 0, 0, 1, 0, 0, 2, 0, 0], [0, 1, 2]));
    attempt('non-manifold-edge', bad([...corners, 0, 0, 1], [0, 1, 2, 0, 2, 3, 0, 2, 4]));
    thrown('invalid-argument', () => using_(core.mesh(square), (mesh) => core.check(mesh, new Float64Array(3))));
    using_(core.mesh(square), (mesh) => core.parameterize(mesh).free());
  });
});

/** `using` for engines without it. */
function using_(resource, body) {
  const result = body(resource);
  resource[Symbol.dispose ?? Symbol.for('Symbol.dispose')]();
  return result;
}
