// npm run bench: native, wasm and wasm with threads on the same problems in the same run. Surfaces are flattened, also
// by the peers that are installed (libigl by pip, watlas by npm); solids are deformed; mixed-integer problems are solved
// natively only, and so is the way to the minimum of second-order methods. Locally injective mappings: natively, and in
// wasm in Node. Folded bodies are untangled.
// node scripts/bench.mjs [--only surfaces|solids|miqp|minimum|lim|untangle] [--iterations N] [--threads N] [--quick]
//   [--json FILE] [--meshes FOLDER] [--sizes 20000,100000] [--solids FOLDER] [--tetrahedra 10000] [--systems FOLDER]
//   [--tangles FOLDER] [--growth 10000,30000,100000,300000,1000000]
import { mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { join } from 'node:path';
import { parseArgs } from 'node:util';
import { browser as launch } from './lib/browser.mjs';
import { installDependencies } from './lib/dependencies.mjs';
import { main, root, run, Unmet } from './lib/progress.mjs';
import { buildPackage } from './build-wasm.mjs';
import { serve } from './serve.mjs';

const data = join(root, '..', 'shared', 'data');
const { values } = parseArgs({
  options: {
    only: { type: 'string' },
    iterations: { type: 'string' },
    threads: { type: 'string', default: String(Math.min(cpus().length, 8)) },
    quick: { type: 'boolean', default: false },
    json: { type: 'string' },
    meshes: { type: 'string', default: join(data, 'parameterization') },
    sizes: { type: 'string', default: '20000,100000' },
    solids: { type: 'string', default: join(data, 'quasistatic') },
    systems: { type: 'string', default: join(data, 'miqp') },
    tetrahedra: { type: 'string', default: '10000' },
    tangles: { type: 'string', default: join(data, 'untangle') },
    growth: { type: 'string', default: '10000,30000,100000,300000,1000000' },
  },
});
const { quick } = values;

/** A number of something, at least 1. */
function count(option, text) {
  const number = Number(text);
  if (!Number.isInteger(number) || number < 1) throw new Unmet(`--${option} takes a whole number from 1 on`);
  return number;
}

/** Each kind of problem: its usual iterations, and what it measures and shows. Loaded once the package is built. */
const KINDS = {
  surfaces: async (bench) => {
    const { measureSurfaces, surfaceTables } = await import('./bench/surfaces.mjs');
    const all = { ...bench, iterations: count('iterations', values.iterations ?? (quick ? 20 : 100)) };
    const sizes = values.sizes.split(',').filter(Boolean);
    const results = await measureSurfaces(all, { folder: values.meshes, sizes, quick });
    return { iterations: all.iterations, results, text: surfaceTables(results, all) };
  },
  solids: async (bench) => {
    const { measureSolids, solidTables } = await import('./bench/solids.mjs');
    const all = { ...bench, iterations: count('iterations', values.iterations ?? (quick ? 20 : 60)) };
    const tetrahedra = count('tetrahedra', values.tetrahedra);
    const measured = await measureSolids(all, { folder: values.solids, tetrahedra, quick });
    return { iterations: all.iterations, ...measured, text: solidTables(measured, all) };
  },
  miqp: async (bench) => {
    const { measureMiqp, miqpTables } = await import('./bench/miqp.mjs');
    const measured = measureMiqp(bench, { folder: values.systems, quick });
    return { ...measured, text: miqpTables(measured) };
  },
  minimum: async (bench) => {
    const { measureMinimum, minimumTables } = await import('./bench/minimum.mjs');
    const sizes = values.sizes.split(',').filter(Boolean);
    const measured = await measureMinimum(bench, { folder: values.meshes, sizes, quick });
    return { ...measured, text: minimumTables(measured) };
  },
  lim: async (bench) => {
    const { measureLim, limTables } = await import('./bench/lim.mjs');
    const measured = await measureLim(bench, { quick });
    return { ...measured, text: limTables(measured) };
  },
  untangle: async (bench) => {
    const { measureUntangle, untangleTables } = await import('./bench/untangle.mjs');
    const sizes = quick ? '10000' : values.growth;
    const scale = sizes.split(',').filter(Boolean).map((size) => count('growth', size));
    const measured = await measureUntangle(bench, { folder: values.tangles, tetrahedra: quick ? 10000 : 30000, scale, quick });
    return { ...measured, text: untangleTables(measured, bench) };
  },
};

/** Kinds that need neither the package nor a browser, and those that need no browser. */
const NATIVE = new Set(['miqp', 'minimum']);
const IN_NODE = new Set(['lim']);

main(async () => {
  const { only } = values;
  if (only !== undefined && !Object.hasOwn(KINDS, only)) throw new Unmet(`--only takes one of ${Object.keys(KINDS).join(', ')}`);
  count('iterations', values.iterations ?? 1);
  const threads = count('threads', values.threads);
  const kinds = only ? [only] : Object.keys(KINDS);
  const inBrowser = kinds.some((kind) => !NATIVE.has(kind) && !IN_NODE.has(kind));
  if (kinds.some((kind) => !NATIVE.has(kind))) {
    await installDependencies();
    await buildPackage();
  }
  await run('cargo', ['build', '--release', '--features', 'cli', '--bin', 'foldfree'], { label: 'building the native program', estimate: '2 minutes' });
  const native = join(process.env.CARGO_TARGET_DIR ?? join(root, 'target'), 'release', 'foldfree');
  const server = inBrowser ? await serve(root) : undefined;
  const browser = inBrowser ? await launch() : undefined;
  const work = mkdtempSync(join(tmpdir(), 'foldfree-bench-'));
  const measured = {};
  try {
    for (const kind of kinds) {
      const { text, ...results } = await KINDS[kind]({ native, threads, server, browser, work });
      measured[kind] = results;
      console.log(`\n${text.join('\n\n')}\n`);
    }
  } finally {
    await browser?.close();
    await server?.close();
    rmSync(work, { recursive: true, force: true });
  }
  if (values.json) writeFileSync(values.json, `${JSON.stringify({ threads, ...measured }, null, 2)}\n`);
});
