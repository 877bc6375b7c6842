// `foldfree`, as installed from the packed package: in Node it runs in a worker thread.
import assert from 'node:assert/strict';
import { after, describe, it } from 'node:test';
import { gzipSync } from 'node:zlib';
import { importPacked, installPacked } from './packed.mjs';

const { folder } = installPacked();
const { FoldfreeError, load } = await importPacked(folder, 'foldfree');

const rejects = async (code, work) => {
  const error = await work.then(() => assert.fail(`${code} expected`), (caught) => caught);
  assert.ok(error instanceof FoldfreeError, `${error?.stack}`);
  assert.equal(error.code, code, error.message);
  return error;
};

describe('load', async () => {
  const foldfree = await load();
  after(() => foldfree.terminate());

  it('runs the example of the README', async () => {
    const mesh = await foldfree.generate('bumpy-cap', 1000);
    const solver = await foldfree.parameterize(mesh, { method: 'wrapd', energy: 'symmetric-dirichlet' });
    let steps = 0;
    let last;
    for await (const step of solver) {
      steps++;
      last = step;
      if (step.inverted === 0 && step.converged) break;
    }
    assert.equal(last.iteration, steps);
    assert.equal(last.converged, true);
    const { uv, certificate } = await solver.result();
    assert.equal(uv.length, 2 * mesh.vertexCount);
    assert.equal(certificate.locallyInjective, true);
    solver.free();
    await rejects('freed', solver.step());
    mesh.free();
    await rejects('freed', foldfree.parameterize(mesh));
  });

  it('reads files, gzipped too, and names the line of an error', async () => {
    const text = 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n';
    const mesh = await foldfree.mesh(gzipSync(text), 'obj');
    assert.equal(mesh.triangleCount, 1);
    assert.equal((await foldfree.mesh(text, 'obj')).vertexCount, 3);
    const error = await rejects('parse', foldfree.mesh(`${text}f 1 2 9\n`, 'obj'));
    assert.equal(error.line, 5);
    await rejects('parse', foldfree.mesh(gzipSync(text).subarray(0, 20), 'obj'));
    await rejects('invalid-argument', foldfree.mesh(text));
    await rejects('invalid-argument', foldfree.mesh({ positions: [0], indices: [0] }));
  });

  it('does not take the caller’s arrays away', async () => {
    const positions = new Float64Array([0, 0, 0, 1, 0, 0, 0, 1, 0]);
    const indices = new Uint32Array([0, 1, 2]);
    const mesh = await foldfree.mesh({ positions, indices });
    assert.equal(positions.length, 9);
    assert.notEqual(mesh.positions, positions);
    const uv = new Float64Array([0, 0, 1, 0, 0, 1]);
    assert.equal((await foldfree.check(mesh, uv)).globallyInjective, true);
    assert.equal(uv.length, 6);
  });

  it('runs by itself: every report arrives once and in order, frames wait to be taken', async () => {
    const mesh = await foldfree.generate('terrain', 2000);
    const solver = await foldfree.parameterize(mesh, { frames: 'f32' });
    const iterations = [];
    let taking = 0;
    const last = await solver.run({
      maxIterations: 25,
      onFrame: async (frame, reports) => {
        assert.equal(taking++, 0, 'a frame came before the last was taken');
        iterations.push(...reports.map((report) => report.iteration));
        assert.equal(frame.iteration, iterations.at(-1));
        await new Promise((resolve) => setTimeout(resolve, 5));
        taking--;
      },
    });
    assert.deepEqual(iterations, Array.from({ length: last.iteration }, (_, i) => i + 1));
    assert.ok(last.positions instanceof Float32Array);
  });

  it('cancels between steps', async () => {
    const mesh = await foldfree.generate('bumpy-cap', 4000);
    const solver = await foldfree.parameterize(mesh, { tolerance: 1e-300 });
    const running = solver.run({ onFrame: (frame) => frame.iteration >= 3 && solver.cancel() });
    const last = await running;
    assert.equal(last.status, 'cancelled');
    assert.equal(solver.status, 'running');
    assert.equal((await solver.step()).iteration, last.iteration + 1);
    let steps = 0;
    for await (const step of solver) {
      assert.ok(step);
      if (++steps === 2) solver.cancel();
    }
    assert.equal(steps, 2);
  });

  it('obeys an AbortSignal', async () => {
    const mesh = await foldfree.generate('bumpy-cap', 1000);
    const controller = new AbortController();
    const solver = await foldfree.parameterize(mesh, { tolerance: 1e-300, signal: controller.signal });
    const running = solver.run({ onFrame: () => controller.abort() });
    await assert.rejects(running, { name: 'AbortError' });
    await assert.rejects(solver.step(), { name: 'AbortError' });
    await assert.rejects(foldfree.parameterize(mesh, { signal: AbortSignal.abort() }), { name: 'AbortError' });
    await assert.rejects(load({ signal: AbortSignal.abort() }), { name: 'AbortError' });
  });

  it('ends its worker when an abort asks for it, and starts another on the next call', async () => {
    const mesh = await foldfree.generate('bumpy-cap', 1000);
    const other = await foldfree.parameterize(mesh);
    const controller = new AbortController();
    const doomed = await foldfree.parameterize(mesh, { tolerance: 1e-300, signal: controller.signal, terminateOnAbort: true });
    const running = doomed.run({ onFrame: () => controller.abort() });
    await assert.rejects(running, { name: 'AbortError' });
    await rejects('worker-lost', other.step());
    const again = await foldfree.parameterize(mesh); // the mesh is sent again
    assert.equal((await again.step()).iteration, 1);
  });

  it('validates options', async () => {
    const mesh = await foldfree.generate('bumpy-cap', 100);
    const error = await rejects('invalid-option', foldfree.parameterize(mesh, { iterations: 7 }));
    assert.equal(error.details.option, 'iterations');
    await rejects('not-a-disk', foldfree.parameterize(await foldfree.generate('sphere', 200), { cut: 'refuse' }));
  });

  it('falls back to one thread where there are no threads', async () => {
    const single = await load({ threads: 4 });
    assert.equal(single.threads, 1);
    single.terminate();
    await rejects('terminated', single.generate('torus', 100));
  });

  it('says so when the wasm or the worker is not there', async () => {
    await rejects('worker-lost', load({ workerUrl: new URL('file:///nowhere/worker.js') }));
  });
});
