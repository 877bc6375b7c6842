// Flattening: milliseconds an iteration, and how long until the map is good, beside other programs.
import { execFileSync } from 'node:child_process';
import { existsSync, readdirSync, readFileSync, writeFileSync } from 'node:fs';
import { basename, join } from 'node:path';
import { gunzipSync } from 'node:zlib';
import { say } from '../lib/progress.mjs';
import { measureSlim, measureWatlas } from './peers.mjs';
import { figuresOf, inBrowser, reportsOf } from './programs.mjs';
import { digits, ratio, table } from './table.mjs';

/** The meshes: files of the folder, if there is one, and generated ones of every size. */
export function meshes({ native, work }, folder, sizes) {
  const found = [];
  if (existsSync(folder)) {
    for (const file of readdirSync(folder).filter((name) => /\.obj(\.gz)?$/.test(name)).sort()) {
      const bytes = readFileSync(join(folder, file));
      const name = basename(file).replace(/\.obj(\.gz)?$/, '');
      const path = join(work, `${name}.obj`);
      writeFileSync(path, file.endsWith('.gz') ? gunzipSync(bytes) : bytes);
      found.push({ name, path });
    }
  }
  for (const size of sizes) {
    const path = join(work, `cap-${size}.obj`);
    execFileSync(native, ['generate', 'bumpy-cap', '--triangles', size, '--out', path], { stdio: 'ignore' });
    found.push({ name: `bumpy-cap ${size / 1000}k`, path });
  }
  return found;
}

/** What one run took. `to1` is the time to 1 % above the lowest energy. */
function figures(run) {
  const { rows, setupSeconds } = run;
  const final = Math.min(...rows.filter((row) => row.inverted === 0).map((row) => row.energy));
  const near = rows.find((row) => row.inverted === 0 && row.energy <= 1.01 * final);
  return { ...figuresOf(run), to1: near && (setupSeconds + near.seconds) * 1000 };
}

/** In the browser. The first run warms the compilers up, the second counts. */
async function flatten({ file, threads, iterations }) {
  const { load } = await import('/pkg/index.js');
  const foldfree = await load({ threads });
  const bytes = new Uint8Array(await (await fetch(`/measured/${file}`)).arrayBuffer());
  let measured;
  for (const count of [5, iterations]) {
    const dropped = performance.now();
    const mesh = await foldfree.mesh(bytes, 'obj');
    const solver = await foldfree.parameterize(mesh, { tolerance: 0, maxIterations: count, frames: 'f32' });
    const ready = performance.now();
    const rows = [solver.start];
    await solver.run({ minInterval: 16, onFrame: (frame, reports) => void rows.push(...reports) });
    measured = {
      setupSeconds: (ready - dropped) / 1000, // from the file's bytes on
      rows: rows.map(({ iteration, seconds, energy, inverted }) => ({ iteration, seconds, energy, inverted })),
    };
    solver.free();
    mesh.free();
  }
  const memory = await foldfree.memoryBytes();
  const used = foldfree.threads;
  foldfree.terminate();
  return { ...measured, memory, used };
}

/** Measures all meshes: `bench` says with what, and for how many iterations. */
export async function measureSurfaces(bench, { folder, sizes, quick }) {
  const results = [];
  for (const { name, path } of meshes(bench, folder, sizes)) {
    say(`measuring ${name}`);
    const { native, nativeThreads, node } = reportsOf(['parameterize', path], bench);
    const { wasm, wasmThreads } = await inBrowser(bench, flatten, { file: basename(path), iterations: bench.iterations });
    results.push({
      name,
      native: figures(native),
      nativeThreads: figures(nativeThreads),
      node: figures(node),
      wasm: { ...figures(wasm), memory: wasm.memory },
      wasmThreads: wasmThreads && { ...figures(wasmThreads), memory: wasmThreads.memory },
      slim: await measureSlim(path, { work: bench.work, iterations: quick ? 3 : 10 }),
      watlas: quick ? undefined : await measureWatlas(path),
    });
  }
  return results;
}

/** The results as text. */
export function surfaceTables(results, { threads, iterations }) {
  return [
    `flattening, milliseconds an iteration: mean of the first ${iterations}, setup apart; ${threads} threads where not 1`,
    table([
      ['mesh', 'native', `native ${threads}t`, 'wasm Node', 'wasm Chromium', `wasm ${threads}t`, 'Node : native', 'Chromium : native', `${threads}t : 1t native`, `${threads}t : 1t wasm`, 'SLIM (libigl)', 'native : SLIM'],
      ...results.map((r) => [
        r.name, digits(r.native.mean), digits(r.nativeThreads.mean), digits(r.node.mean), digits(r.wasm.mean), digits(r.wasmThreads?.mean),
        ratio(r.node.mean, r.native.mean), ratio(r.wasm.mean, r.native.mean),
        ratio(r.native.mean, r.nativeThreads.mean), ratio(r.wasm.mean, r.wasmThreads?.mean),
        digits(r.slim?.mean), ratio(r.native.mean, r.slim?.mean),
      ]),
    ]),
    'milliseconds from the file’s bytes (native: from the mesh) to 1 % above the best energy of the run; memory; watlas: a whole atlas',
    table([
      ['mesh', 'native', 'wasm Chromium', `wasm ${threads}t`, 'of it setup', 'wasm memory', 'energy', 'inverted', 'watlas'],
      ...results.map((r) => [
        r.name, digits(r.native.to1), digits(r.wasm.to1), digits(r.wasmThreads?.to1), digits(r.wasmThreads?.setup),
        digits(r.wasm.memory / 1e6, ' MB'), r.native.energy.toFixed(9), String(r.native.inverted), digits(r.watlas?.total),
      ]),
    ]),
  ];
}
