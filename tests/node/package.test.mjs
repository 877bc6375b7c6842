// What is packed: the right files, and exports that bundlers and TypeScript resolve.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { describe, it } from 'node:test';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { publint } from 'publint';
import { installPacked, top } from './packed.mjs';

const { folder, tarball, home, files } = installPacked();
const tool = (path, args, options) =>
  execFileSync(process.execPath, [fileURLToPath(new URL(`node_modules/${path}`, top)), ...args], { encoding: 'utf8', ...options });

describe('the packed package', () => {
  it('has what it exports and nothing else', () => {
    for (const file of ['pkg/index.js', 'pkg/core.d.ts', 'pkg/worker.js', 'pkg/single/foldfree_bg.wasm', 'pkg/threads/foldfree_bg.wasm', 'LICENSE-MIT', 'README.md']) {
      assert.ok(files.includes(file), file);
    }
    assert.deepEqual(files.filter((file) => /\.(rs|ts|mjs|stamp|toml)$/.test(file) && !file.endsWith('.d.ts')), []);
  });

  // Flattening alone took 570 KB (230 KB); solids with six materials, their generators and the readers of seven
  // formats make it 950 KB (360 KB). Two registers side by side, not one, are 60 KB (20 KB) of that, and a fifth of the
  // time. Second-order methods, which share all that does not depend on the energy, are 85 KB (35 KB), mixed-integer
  // problems 133 KB (58 KB): elimination, three engines, lattice reduction and enumeration; untangling 134 KB (52 KB),
  // with the element loops of five energies, and what keeps boundaries from meeting, in two dimensions each, 115 KB
  // (43 KB). What shows the inside of a step, parts boundaries by a flow, and has Newton's method go on after GINI is
  // another 124 KB (50 KB). That the compiler unrolls and interleaves no loops is 73 KB (25 KB) less of all, and costs no time.
  it('has a small single-thread wasm', () => {
    const wasm = readFileSync(join(home, 'pkg/single/foldfree_bg.wasm'));
    assert.ok(statSync(join(home, 'pkg/single/foldfree_bg.wasm')).size <= 1_680_000, `${wasm.length} bytes`);
    assert.ok(gzipSync(wasm, { level: 9 }).length <= 665_000);
  });

  it('pleases publint', async () => {
    const { messages } = await publint({ pkgDir: home, strict: true });
    assert.deepEqual(messages, []);
  });

  it('pleases attw', () => {
    tool('@arethetypeswrong/cli/dist/index.js', [tarball, '--profile', 'esm-only', '--exclude-entrypoints', './foldfree.wasm', './foldfree-threads.wasm']);
  });

  it('has types that fit its use', () => {
    writeFileSync(join(folder, 'use.ts'), `
      import { load, type Step } from 'foldfree';
      import { initSync, type FoldfreeError } from 'foldfree/core';
      const foldfree = await load({ threads: 'auto', onProgress: (loaded, total) => void (loaded / total) });
      const mesh = await foldfree.mesh(new Uint8Array(), 'obj');
      const solver = await foldfree.parameterize(mesh, { method: 'wrapd', energy: 'symmetric-dirichlet', start: 'tutte' });
      for await (const step of solver) { const energy: number = step.energy; void energy; }
      const { uv, certificate } = await solver.result();
      const sure: boolean = certificate.globallyInjective;
      const map: Float64Array = uv;
      // @ts-expect-error there is no such option
      await foldfree.parameterize(mesh, { iterations: 5 });
      // @ts-expect-error there is no such method
      await foldfree.parameterize(mesh, { method: 'magic' });
      const solid = await foldfree.solid(new Uint8Array(), 'node', new Uint8Array());
      const body = await foldfree.deform(solid, { energy: 'arap', pins: [1, 2], targets: { vertices: new Uint32Array(), positions: new Float64Array() }, frames: 'f32' });
      await body.setTargets({ vertices: Uint32Array.of(1), positions: new Float64Array(3) });
      for await (const step of body) { const field: Float32Array = step.field; void field; }
      const tight: boolean = (await body.result()).certificate.locallyInjective;
      // @ts-expect-error there is no such material
      await foldfree.deform(solid, { energy: 'rubber' });
      const freed = await foldfree.untangle(solid, { energy: 'stable-neo-hookean', pins: [1, 2], start: new Float64Array(), primary: true, trace: true });
      for await (const { gini, trace, primary } of freed) { const zones: Uint32Array | undefined = trace?.[0]?.zones; void [gini?.polish[0]?.violated, zones, primary]; }
      for await (const { quadratic } of freed) { const [state] = quadratic ?? []; const held: Uint8Array | undefined = state?.contacts.active; const crossing: number | undefined = state?.meeting; void [held, crossing]; }
      await freed.movePins({ vertices: Uint32Array.of(1), positions: new Float64Array(3) });
      const stuck: number[] = (await freed.result()).outcome.notPositive;
      const flat: boolean = (await (await foldfree.untangle(mesh, { pins: [0] })).result()).certificate.globallyInjective;
      // @ts-expect-error there is no such energy
      await foldfree.untangle(solid, { energy: 'st-venant-kirchhoff' });
      const integers = await foldfree.solveMixedInteger({
        matrix: { columnPointers: Uint32Array.of(0, 1), rows: Uint32Array.of(0), values: Float64Array.of(1) }, linear: Float64Array.of(0.4), integers: [0],
      }, { rounding: 'lattice', nodes: 1e6 });
      const gap: number | undefined = integers.gap;
      const rounding = await foldfree.mixedInteger(new Uint8Array(), { engine: 'three-level', gaussSeidel: 0 });
      for await (const { action } of rounding) if (action.kind === 'round') { const to: number | undefined = action.rounded[0]?.to; void to; }
      const relaxed: number = (await rounding.resolve({ constants: new Float64Array() })).energy;
      // @ts-expect-error there is no such rounding
      await foldfree.solveMixedInteger(new Uint8Array(), { rounding: 'magic' });
      const core = initSync(new Uint8Array());
      const first: Step = core.parameterize(core.generate('torus', 100)).start;
      export { sure, stuck, flat, tight, map, first, gap, relaxed, type FoldfreeError };
    `);
    const options = ['--noEmit', '--strict', '--target', 'ES2022', '--module', 'NodeNext', '--lib', 'ES2022,ESNext.Disposable,DOM', '--types', '', '--exactOptionalPropertyTypes'];
    try {
      tool('typescript/bin/tsc', [...options, 'use.ts'], { cwd: folder });
    } catch (error) {
      assert.fail(error.stdout);
    }
  });
});
