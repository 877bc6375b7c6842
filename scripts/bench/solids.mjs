// Deforming: milliseconds an iteration, and how far the first iterations come.
import { say } from '../lib/progress.mjs';
import { measureDrag } from './drag.mjs';
import { figuresOf, inBrowser, reportsOf } from './programs.mjs';
import { filesForPage, solidProblems } from './solid-problems.mjs';
import { digits, ratio, table } from './table.mjs';

/** In the browser. The first run warms the compilers up, the second counts. */
async function deform({ files, threads, iterations }) {
  const { load } = await import('/pkg/index.js');
  const foldfree = await load({ threads });
  const fetched = async (name, Type) => new Type(await (await fetch(`/measured/${files[name]}`)).arrayBuffer());
  const positions = await fetched('positions', Float64Array);
  const tetrahedra = await fetched('tetrahedra', Uint32Array);
  const start = await fetched('start', Float64Array);
  const pins = await fetched('pins', Uint32Array);
  const solid = await foldfree.solid({ positions, tetrahedra });
  let measured;
  for (const maxIterations of [5, iterations]) {
    const solver = await foldfree.deform(solid, { start, pins, tolerance: 0, maxIterations, frames: 'f32', field: 'stretch' });
    const rows = [solver.start];
    await solver.run({ minInterval: 16, onFrame: (frame, reports) => void rows.push(...reports) });
    measured = {
      setupSeconds: solver.setupSeconds,
      rows: rows.map(({ iteration, seconds, energy, inverted }) => ({ iteration, seconds, energy, inverted })),
    };
    solver.free();
  }
  const memory = await foldfree.memoryBytes();
  const used = foldfree.threads;
  foldfree.terminate();
  return { ...measured, memory, used };
}

async function measure(problem, bench) {
  const { name, rest, init, pins, reference } = problem;
  say(`measuring ${name}`);
  const args = ['deform', '--rest', rest, '--init', init, '--pins', pins];
  const { native, nativeThreads, node } = reportsOf([...args, '--reference', reference], bench);
  const files = filesForPage(bench, problem);
  const { wasm, wasmThreads } = await inBrowser(bench, deform, { files, iterations: bench.iterations });
  const figures = (run) => ({ ...figuresOf(run), memory: run.memory, positionError: run.rows.at(-1).position_error });
  return {
    name,
    authors: problem.authors,
    native: figures(native),
    nativeThreads: figures(nativeThreads),
    node: figures(node),
    wasm: figures(wasm),
    wasmThreads: wasmThreads && figures(wasmThreads),
  };
}

/** Measures all problems: `bench` says with what, and for how many iterations. */
export async function measureSolids(bench, { folder, tetrahedra, quick }) {
  const results = [];
  for (const problem of solidProblems(bench, folder, tetrahedra)) results.push(await measure(problem, bench));
  return { results, drag: await measureDrag(bench, { tetrahedra, steps: quick ? 30 : 120 }) };
}

/** The results as text. */
export function solidTables({ results, drag }, { threads, iterations }) {
  const cited = results.some((r) => r.authors);
  return [
    `deforming, milliseconds an iteration: mean of the first ${iterations}, setup apart; ${threads} threads where not 1`,
    table([
      ['solid', 'native', `native ${threads}t`, 'wasm Node', 'wasm Chromium', `wasm ${threads}t`, 'Node : native', 'Chromium : native', `${threads}t : 1t native`, `${threads}t : 1t wasm`, 'authors’ C++ *'],
      ...results.map((r) => [
        r.name, digits(r.native.mean), digits(r.nativeThreads.mean), digits(r.node.mean), digits(r.wasm.mean), digits(r.wasmThreads?.mean),
        ratio(r.node.mean, r.native.mean), ratio(r.wasm.mean, r.native.mean),
        ratio(r.native.mean, r.nativeThreads.mean), ratio(r.wasm.mean, r.wasmThreads?.mean),
        digits(r.authors),
      ]),
    ]),
    ...(cited ? ['* cited, not measured here: georgbrown/wrapd, one thread, on another machine; not to be divided by'] : []),
    `after ${iterations} iterations; position error: ‖x − x*‖/‖x₀ − x*‖ against the solution; setup in milliseconds`,
    table([
      ['solid', 'energy', 'energy Chromium', 'position error', 'position error Node', 'inverted', 'setup native', 'setup Chromium', 'wasm memory'],
      ...results.map((r) => [
        r.name, r.native.energy.toPrecision(9), r.wasm.energy.toPrecision(9), r.native.positionError.toExponential(2),
        r.node.positionError.toExponential(2), String(r.native.inverted), digits(r.native.setup), digits(r.wasm.setup),
        digits(r.wasm.memory / 1e6, ' MB'),
      ]),
    ]),
    `drag: steps a second in Chromium while one end of a bar of ${drag.tetrahedra} tetrahedra is dragged, with its frames`,
    table([
      ['threads', 'steps a second', '95th percentile of a step', 'inverted'],
      ...[drag.wasm, drag.wasmThreads].filter(Boolean).map((r) => [String(r.used), digits(r.rate), `${digits(r.slow)} ms`, String(r.inverted)]),
    ]),
  ];
}
