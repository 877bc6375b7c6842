// Running the two command lines, and the package in a browser.
import { execFileSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { root, say } from '../lib/progress.mjs';

/** The single-thread wasm in this Node, as a command line. */
const WASM = [process.execPath, join(root, 'scripts', 'foldfree-wasm.mjs')];

/** Runs a command that writes a report, without a tolerance, and reads the report. */
export function reportOf([program, ...first], args, { work, iterations }) {
  const report = join(work, 'report.json');
  const all = [...first, ...args, '--iterations', String(iterations), '--tolerance', '0', '--report', report, '--quiet'];
  try {
    execFileSync(program, all, { stdio: ['ignore', 'ignore', 'inherit'] });
  } catch (error) {
    if (error.status !== 2) throw error; // 2: the iterations ran out, as they should
  }
  const { iterations: rows, setup_seconds: setupSeconds } = JSON.parse(readFileSync(report, 'utf8'));
  return { rows, setupSeconds };
}

/** The same command natively with one thread and with `threads`, and in Node. */
export function reportsOf(args, bench) {
  const native = (threads) => reportOf([bench.native], [...args, '--threads', String(threads)], bench);
  return { native: native(1), nativeThreads: native(bench.threads), node: reportOf(WASM, args, bench) };
}

/**
 * Runs `body` in a page that may fetch the files of the work folder from /measured/, once with one thread and once
 * with `threads`. `body` imports /pkg/index.js and returns, beside what it measured, the threads it `used`; where
 * these are not the threads wished for, `wasmThreads` is undefined.
 */
export async function inBrowser({ browser, server, work, threads }, body, argument) {
  const page = await browser.newPage();
  try {
    await page.route('**/measured/*', (route) => route.fulfill({ path: join(work, new URL(route.request().url()).pathname.split('/').pop()) }));
    await page.goto(`${server.url}package.json`); // anything a browser shows
    const wasm = await page.evaluate(body, { ...argument, threads: false });
    const wasmThreads = await page.evaluate(body, { ...argument, threads });
    if (wasmThreads.used === threads) return { wasm, wasmThreads };
    say(`  the browser gave ${wasmThreads.used} threads instead of ${threads}: not counted`);
    return { wasm };
  } finally {
    await page.close();
  }
}

/** Milliseconds an iteration, and where it ended. Seconds of the rows are those of solving, setup apart. */
export function figuresOf({ rows, setupSeconds }) {
  const last = rows.at(-1);
  const each = rows.slice(1).map((row, i) => (row.seconds - rows[i].seconds) * 1000).sort((a, b) => a - b);
  return {
    setup: setupSeconds * 1000,
    mean: (last.seconds / last.iteration) * 1000,
    median: each[each.length >> 1],
    iterations: last.iteration,
    energy: last.energy,
    inverted: last.inverted,
  };
}
