// npm run bench: one table of native, wasm and wasm with threads on the same meshes in the same run, and the
// peers that are installed (libigl by pip, watlas by npm). Means per iteration of the first N, setup apart.
// node scripts/bench.mjs [--iterations 100] [--meshes FOLDER] [--sizes 20000,100000] [--quick] [--json FILE]
import { execFileSync } from 'node:child_process';
import { existsSync, mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { cpus, tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { parseArgs } from 'node:util';
import { gunzipSync } from 'node:zlib';
import { browser as launch } from './lib/browser.mjs';
import { installDependencies } from './lib/dependencies.mjs';
import { ask, main, root, run, say, Unmet } from './lib/progress.mjs';
import { buildPackage } from './build-wasm.mjs';
import { serve } from './serve.mjs';

const { values } = parseArgs({
  options: {
    iterations: { type: 'string', default: '100' },
    meshes: { type: 'string', default: join(root, '..', 'shared', 'data', 'parameterization') },
    sizes: { type: 'string', default: '20000,100000' },
    quick: { type: 'boolean', default: false },
    json: { type: 'string' },
  },
});
const iterations = values.quick ? 20 : Number(values.iterations);
const work = mkdtempSync(join(tmpdir(), 'foldfree-bench-'));
const median = (list) => [...list].sort((a, b) => a - b)[list.length >> 1];

/** The meshes: files of the folder, if there is one, and generated ones of every size. */
function meshes(native) {
  const found = [];
  if (existsSync(values.meshes)) {
    for (const file of readdirSync(values.meshes).filter((name) => /\.obj(\.gz)?$/.test(name)).sort()) {
      const bytes = readFileSync(join(values.meshes, file));
      const name = basename(file).replace(/\.obj(\.gz)?$/, '');
      const path = join(work, `${name}.obj`);
      writeFileSync(path, file.endsWith('.gz') ? gunzipSync(bytes) : bytes);
      found.push({ name, path });
    }
  }
  for (const size of values.sizes.split(',').filter(Boolean)) {
    const name = `bumpy-cap ${size / 1000}k`;
    const path = join(work, `cap-${size}.obj`);
    execFileSync(native, ['generate', 'bumpy-cap', '--triangles', size, '--out', path], { stdio: 'ignore' });
    found.push({ name, path });
  }
  return found;
}

/** What one run took: from the iterations of a report. `to1` is the time to 1 % above the last energy. */
function figures({ iterations: rows, setupSeconds }) {
  const last = rows.at(-1);
  const final = Math.min(...rows.filter((row) => row.inverted === 0).map((row) => row.energy));
  const near = rows.find((row) => row.inverted === 0 && row.energy <= 1.01 * final);
  const each = rows.slice(1).map((row, i) => (row.seconds - rows[i].seconds) * 1000);
  return {
    setup: setupSeconds * 1000,
    mean: (last.seconds / last.iteration) * 1000,
    median: median(each),
    to1: near && (setupSeconds + near.seconds) * 1000,
    energy: last.energy,
    inverted: last.inverted,
  };
}

/** The native program, with so many threads. */
function measureNative(native, path, threads) {
  const report = join(work, 'report.json');
  const args = ['parameterize', path, '--iterations', String(iterations), '--tolerance', '0', '--threads', String(threads), '--report', report, '--quiet'];
  try {
    execFileSync(native, args, { stdio: 'ignore' });
  } catch (error) {
    if (error.status !== 2) throw error; // 2: the iterations ran out, as they should
  }
  const { iterations: rows, setup_seconds: setupSeconds } = JSON.parse(readFileSync(report, 'utf8'));
  return figures({ iterations: rows, setupSeconds });
}

/** The single-thread wasm in this Node, as its command line. */
function measureNode(path) {
  const report = join(work, 'report-wasm.json');
  const args = [join(root, 'scripts', 'foldfree-wasm.mjs'), 'parameterize', path, '--iterations', String(iterations), '--tolerance', '0', '--report', report, '--quiet'];
  try {
    execFileSync(process.execPath, args, { stdio: 'ignore' });
  } catch (error) {
    if (error.status !== 2) throw error;
  }
  const { iterations: rows, setup_seconds: setupSeconds } = JSON.parse(readFileSync(report, 'utf8'));
  return figures({ iterations: rows, setupSeconds });
}

/** The package in headless Chromium. The first run warms the compilers up, the second counts. */
async function measureBrowser(page, path, threads) {
  const result = await page.evaluate(
    async ({ url, threads, iterations }) => {
      const { load } = await import('/pkg/index.js');
      const foldfree = await load({ threads });
      const bytes = new Uint8Array(await (await fetch(url)).arrayBuffer());
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
    },
    { url: `/meshes/${basename(path)}`, threads, iterations },
  );
  return { ...figures({ iterations: result.rows, setupSeconds: result.setupSeconds }), memory: result.memory, threads: result.used };
}

const SLIM = `
import json, sys, time
import igl, numpy as np
v, f = [np.asarray(a) for a in (lambda r: (r[0], r[3]))(igl.readOBJ(sys.argv[1]))]
v = v[:, :3] / np.sqrt(igl.doublearea(v[:, :3], f).sum() / 2)
loop = igl.boundary_loop(f)
circle = np.asarray(igl.map_vertices_to_circle(np.asfortranarray(v), loop.astype(np.int32)))
uv = igl.harmonic(v, f, loop, circle / np.sqrt(np.pi), 1)
fixed, where = np.zeros(0, dtype=np.int32), np.asfortranarray(np.zeros((0, 2)))
data = igl.slim_precompute(np.asfortranarray(v), np.asfortranarray(f.astype(np.int32)), np.asfortranarray(uv),
                           igl.MappingEnergyType.SYMMETRIC_DIRICHLET, fixed, where, 0.0)
igl.slim_solve(data, 1)
count = int(sys.argv[2])
begin = time.perf_counter()
igl.slim_solve(data, count)
print(json.dumps({'mean': (time.perf_counter() - begin) / count * 1000}))
`;

/** SLIM of the PyPI wheel libigl, one thread, or undefined when it is not installed. */
async function measureSlim(path) {
  const script = join(work, 'slim.py');
  writeFileSync(script, SLIM);
  const env = { ...process.env, OMP_NUM_THREADS: '1', OPENBLAS_NUM_THREADS: '1' };
  const output = await ask('python3', [script, path, values.quick ? '3' : '10'], { env, timeout: 300_000 });
  const line = output?.split('\n').findLast((text) => text.startsWith('{'));
  return line && JSON.parse(line);
}

/** xatlas in wasm, where the npm package watlas is installed: whole milliseconds. */
async function measureWatlas(path) {
  let watlas;
  try {
    watlas = await import('watlas');
  } catch {
    return undefined;
  }
  const positions = [];
  const indices = [];
  for (const line of readFileSync(path, 'utf8').split('\n')) {
    const [kind, ...rest] = line.trim().split(/\s+/);
    if (kind === 'v') positions.push(...rest.slice(0, 3).map(Number));
    if (kind === 'f') indices.push(...rest.map((corner) => parseInt(corner, 10) - 1));
  }
  await watlas.Initialize?.();
  const atlas = new watlas.Atlas();
  const start = performance.now();
  atlas.addMesh({ vertexPositionData: new Float32Array(positions), indexData: new Uint32Array(indices), vertexCount: positions.length / 3, indexCount: indices.length });
  atlas.generate();
  return { total: performance.now() - start };
}

const digits = (value, unit = '') => (value === undefined || Number.isNaN(value) ? '–' : `${value < 10 ? value.toFixed(2) : value.toFixed(value < 100 ? 1 : 0)}${unit}`);
const ratio = (a, b) => (a && b ? `${(a / b).toFixed(2)} ×` : '–');

function table(rows) {
  const widths = rows[0].map((_, i) => Math.max(...rows.map((row) => row[i].length)));
  const line = (row) => `| ${row.map((cell, i) => (i ? cell.padStart(widths[i]) : cell.padEnd(widths[i]))).join(' | ')} |`;
  return [line(rows[0]), `|${widths.map((width) => '-'.repeat(width + 2)).join('|')}|`, ...rows.slice(1).map(line)].join('\n');
}

main(async () => {
  if (!(iterations >= 1)) throw new Unmet('--iterations takes a number of iterations');
  await installDependencies();
  await buildPackage();
  await run('cargo', ['build', '--release', '--features', 'cli', '--bin', 'foldfree'], { label: 'building the native program', estimate: '2 minutes' });
  const native = join(process.env.CARGO_TARGET_DIR ?? join(root, 'target'), 'release', 'foldfree');
  const threads = Math.min(cpus().length, 8);
  const server = await serve(root); // pkg/; the meshes are put before it
  const browser = await launch();
  const results = [];
  try {
    for (const { name, path } of meshes(native)) {
      say(`measuring ${name}`);
      const page = await browser.newPage();
      await page.route('**/meshes/*', (route) => route.fulfill({ path: join(work, basename(route.request().url())) }));
      await page.goto(`${server.url}package.json`); // anything a browser shows
      results.push({
        name,
        native: measureNative(native, path, 1),
        nativeThreads: measureNative(native, path, threads),
        node: measureNode(path),
        wasm: await measureBrowser(page, path, false),
        wasmThreads: await measureBrowser(page, path, threads),
        slim: await measureSlim(path),
        watlas: values.quick ? undefined : await measureWatlas(path),
      });
      await page.close();
    }
  } finally {
    await browser.close();
    await server.close();
    rmSync(work, { recursive: true, force: true });
  }
  console.log(`\nmilliseconds an iteration: mean of the first ${iterations}, setup apart; ${threads} threads where not 1\n`);
  console.log(table([
    ['mesh', 'native', `native ${threads}t`, 'wasm Node', 'wasm Chromium', `wasm ${threads}t`, 'Node : native', 'Chromium : native', `${threads}t : 1t native`, `${threads}t : 1t wasm`, 'SLIM (libigl)', 'native : SLIM'],
    ...results.map((r) => [
      r.name, digits(r.native.mean), digits(r.nativeThreads.mean), digits(r.node.mean), digits(r.wasm.mean), digits(r.wasmThreads.mean),
      ratio(r.node.mean, r.native.mean), ratio(r.wasm.mean, r.native.mean),
      ratio(r.native.mean, r.nativeThreads.mean), ratio(r.wasm.mean, r.wasmThreads.mean),
      digits(r.slim?.mean), ratio(r.native.mean, r.slim?.mean),
    ]),
  ]));
  console.log('\nmilliseconds from the file’s bytes (native: from the mesh) to 1 % above the best energy of the run; memory; watlas: a whole atlas\n');
  console.log(table([
    ['mesh', 'native', 'wasm Chromium', `wasm ${threads}t`, 'of it setup', 'wasm memory', 'energy', 'inverted', 'watlas'],
    ...results.map((r) => [
      r.name, digits(r.native.to1), digits(r.wasm.to1), digits(r.wasmThreads.to1), digits(r.wasmThreads.setup),
      digits(r.wasm.memory / 1e6, ' MB'), r.native.energy.toFixed(9), String(r.native.inverted), digits(r.watlas?.total),
    ]),
  ]));
  if (values.json) writeFileSync(values.json, `${JSON.stringify({ iterations, threads, results }, null, 2)}\n`);
});
