// Untangling: seconds to injectivity, natively, in wasm and with threads; and how they grow with the body.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { root, say } from '../lib/progress.mjs';
import { inBrowser } from './programs.mjs';
import { digits, ratio, table } from './table.mjs';
import { filesForPage, givenProblems, twistedBox } from './untangle-problems.mjs';

const WASM = [process.execPath, join(root, 'scripts', 'foldfree-wasm.mjs')];

/** One run of a command line: milliseconds with setup, and how it ended. */
function runOnce([program, ...first], { rest, init, pins }, threads, { work }) {
  const report = join(work, 'report.json');
  const args = ['untangle', '--rest', rest, '--init', init, '--pins', pins, '--threads', String(threads), '--report', report, '--quiet'];
  try {
    execFileSync(program, [...first, ...args], { stdio: ['ignore', 'ignore', 'inherit'] });
  } catch (error) {
    if (error.status !== 2) throw error; // 2: not all is injective; the table says so
  }
  const { iterations, setup_seconds: setup, status, threads: used } = JSON.parse(readFileSync(report, 'utf8'));
  const last = iterations.at(-1);
  return { total: 1000 * (setup + last.seconds), setup: 1000 * setup, status, steps: last.iteration, inverted: last.inverted, before: iterations[0].inverted, used };
}

const best = (runs) => runs.reduce((a, b) => (b.total < a.total ? b : a));
const repeated = (count, run) => best(Array.from({ length: count }, run));

/** In the browser. The first of the runs warms the compilers up; the best of the others counts. */
async function untangle({ files, threads, repeats }) {
  const { load } = await import('/pkg/index.js');
  const foldfree = await load({ threads });
  const fetched = async (name, Type) => new Type(await (await fetch(`/measured/${files[name]}`)).arrayBuffer());
  const positions = await fetched('positions', Float64Array);
  const elements = await fetched('elements', Uint32Array);
  const start = await fetched('start', Float64Array);
  const pins = await fetched('pins', Uint32Array);
  const body = files.solid ? await foldfree.solid({ positions, tetrahedra: elements }) : await foldfree.mesh({ positions, indices: elements });
  let measured;
  for (let k = 0; k <= repeats; k += 1) {
    const solver = await foldfree.untangle(body, { start, pins, frames: 'f32' });
    let last = solver.start;
    await solver.run({ onFrame: (frame, reports) => { last = reports.at(-1) ?? last; } });
    const total = 1000 * (solver.setupSeconds + last.seconds);
    if (k > 0 && !(measured?.total < total)) measured = { total, status: last.status, inverted: last.inverted };
    solver.free();
  }
  const used = foldfree.threads;
  foldfree.terminate();
  return { ...measured, used };
}

/** Measures all of it. */
export async function measureUntangle(bench, { folder, tetrahedra, scale, quick }) {
  const { native, threads } = bench;
  const repeats = quick ? 1 : 5;
  const results = [];
  for (const problem of [...givenProblems(folder), twistedBox(bench.work, tetrahedra)]) {
    say(`measuring ${problem.name}`);
    const files = filesForPage(bench, problem);
    const run = (command, count) => repeated(repeats, () => runOnce(command, problem, count, bench));
    results.push({
      ...problem,
      native: run([native], 1),
      nativeThreads: run([native], threads),
      node: run(WASM, 1),
      ...await inBrowser(bench, untangle, { files, repeats }),
    });
  }
  const growth = [];
  for (const size of scale) {
    say(`measuring a twisted box of ${size} tetrahedra`);
    const problem = twistedBox(bench.work, size);
    const run = (count) => repeated(size > 2e5 ? 1 : repeats, () => runOnce([native], problem, count, bench));
    growth.push({ ...problem, native: run(1), nativeThreads: run(threads) });
  }
  return { results, growth };
}

/** The results as text. */
export function untangleTables({ results, growth }, { threads }) {
  return [
    'untangling: milliseconds from the arrays to the last state, setup included; best of the runs',
    table([
      ['problem', 'inverted', 'left', 'steps', 'native', `native ${threads}t`, 'wasm Node', 'wasm Chromium', `wasm ${threads}t`, 'Chromium : native', `${threads}t : 1t native`, `${threads}t : 1t wasm`, 'paper *'],
      ...results.map((r) => [
        r.name, String(r.native.before), String(r.native.inverted), String(r.native.steps),
        digits(r.native.total), digits(r.nativeThreads.total), digits(r.node.total), digits(r.wasm.total), digits(r.wasmThreads?.total),
        ratio(r.wasm.total, r.native.total), ratio(r.native.total, r.nativeThreads.total), ratio(r.wasm.total, r.wasmThreads?.total),
        digits(r.published && 1000 * r.published),
      ]),
    ]),
    '* cited, not measured here: 8 cores, another machine',
    'growth: boxes twisted by their outside, the inside at random; milliseconds, native',
    table([
      ['tetrahedra', 'inverted', 'left', 'steps', 'setup', 'in all', 'µs a tetrahedron', `${threads} threads`],
      ...growth.map((r) => [
        String(r.tetrahedra), String(r.native.before), String(r.native.inverted), String(r.native.steps), digits(r.native.setup),
        digits(r.native.total), digits(1000 * r.native.total / r.tetrahedra), digits(r.nativeThreads.total),
      ]),
    ]),
  ];
}
