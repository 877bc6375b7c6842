// To the minimum: first- and second-order methods on one thread, libigl's SLIM beside them, and growth with the mesh.
import { execFileSync } from 'node:child_process';
import { join } from 'node:path';
import { say } from '../lib/progress.mjs';
import { measureSlim } from './peers.mjs';
import { reportOf } from './programs.mjs';
import { meshes } from './surfaces.mjs';
import { digits, ratio, table } from './table.mjs';

/** The methods, and iterations enough for 1e-6 on most meshes. */
const METHODS = { cm: 150, slim: 200, wrapd: 600, 'wrapd+cm': 100 };

/** The surface whose growth is measured: curved everywhere, and a disk at every size. */
const GROWING = 'bumpy-cap';

const lowest = (rows) => Math.min(...rows.filter((row) => !row.inverted).map((row) => row.energy));

/** The first row without inverted triangles that is as near as that to the minimum: iterations, milliseconds without setup. */
function reach({ rows }, minimum, part) {
  const at = rows.findIndex((row) => !row.inverted && row.energy <= minimum * (1 + part));
  return at < 0 ? undefined : { iterations: rows[at].iteration, ms: 1000 * rows[at].seconds };
}

/** One mesh by every method. The minimum is the lowest energy that any of them found. */
async function toMinimum(bench, { name, path }, quick) {
  const runs = {};
  for (const [method, iterations] of Object.entries(METHODS)) {
    say(`measuring ${name}: ${method}`);
    const args = ['parameterize', path, '--method', method, '--threads', '1'];
    runs[method] = reportOf([bench.native], args, { work: bench.work, iterations });
  }
  say(`measuring ${name}: SLIM of libigl`);
  const libigl = await measureSlim(path, { work: bench.work, iterations: quick ? 5 : 50 });
  if (libigl) runs['slim (libigl)'] = libigl;
  const minimum = Math.min(...Object.values(runs).map((run) => lowest(run.rows)));
  const brief = ([method, run]) => {
    const [percent, millionth] = [reach(run, minimum, 1e-2), reach(run, minimum, 1e-6)];
    // at the minimum iterations cost more, in vain
    const all = millionth ?? { iterations: run.rows.at(-1).iteration, ms: 1000 * run.rows.at(-1).seconds };
    const mean = run.mean ?? all.ms / all.iterations;
    return [method, { setup: 1000 * run.setupSeconds, mean, percent, millionth, energy: lowest(run.rows) }];
  };
  return { name, minimum, methods: Object.fromEntries(Object.entries(runs).map(brief)) };
}

/** The exponent p of the power law t = c nᵖ nearest to the points, in logarithms. */
function exponent(points) {
  const logs = points.filter(([n, t]) => n > 0 && t > 0).map((point) => point.map(Math.log));
  const mean = (k) => logs.reduce((sum, point) => sum + point[k], 0) / logs.length;
  const [n, t] = [mean(0), mean(1)];
  return logs.reduce((sum, [a, b]) => sum + (a - n) * (b - t), 0) / logs.reduce((sum, [a]) => sum + (a - n) ** 2, 0);
}

/** WRAPD+CM on one shape at growing sizes, to 1 % of where the run ends. */
function growth(bench, quick) {
  const sizes = quick ? [10_000, 30_000, 100_000] : [10_000, 30_000, 100_000, 300_000, 1_000_000];
  return sizes.map((size) => {
    say(`measuring ${size} triangles`);
    const path = join(bench.work, 'growing.obj');
    execFileSync(bench.native, ['generate', GROWING, '--triangles', String(size), '--out', path], { stdio: 'ignore' });
    const args = ['parameterize', path, '--method', 'wrapd+cm', '--threads', '1'];
    const run = reportOf([bench.native], args, { work: bench.work, iterations: 14 });
    const energy = lowest(run.rows);
    return { triangles: size, setup: 1000 * run.setupSeconds, energy, ...reach(run, energy, 1e-2) };
  });
}

/** Measures everything. */
export async function measureMinimum(bench, { folder, sizes, quick }) {
  const results = [];
  for (const mesh of meshes(bench, folder, sizes)) results.push(await toMinimum(bench, mesh, quick));
  const grown = growth(bench, quick);
  const exponents = {
    solving: exponent(grown.map((r) => [r.triangles, r.ms])),
    withSetup: exponent(grown.map((r) => [r.triangles, r.ms + r.setup])),
  };
  return { results, growth: grown, exponents };
}

/** The results as text. */
export function minimumTables({ results, growth: grown, exponents }) {
  const there = (reached) => [reached ? String(reached.iterations) : '–', digits(reached?.ms)];
  const against = (r, at, other) => ratio(r.methods['wrapd+cm'][at]?.ms, r.methods[other]?.[at]?.ms);
  return [
    'to the minimum E*, natively on one thread: iterations and milliseconds without setup to 1 % and to 1e-6 above it',
    table([
      ['mesh', 'method', 'setup', 'ms an iteration', 'iterations to 1 %', 'ms', 'iterations to 1e-6', 'ms', 'energy / E* − 1'],
      ...results.flatMap((r) => Object.entries(r.methods).map(([method, m]) => [
        r.name, method, digits(m.setup), digits(m.mean), ...there(m.percent), ...there(m.millionth),
        (m.energy / r.minimum - 1).toExponential(1),
      ])),
    ]),
    'wrapd+cm beside the others; cm and our slim beside libigl’s SLIM, an iteration',
    table([
      ['mesh', 'E*', 'to 1e-6 : cm', 'to 1e-6 : wrapd', 'to 1 % : SLIM (libigl)', 'cm : SLIM (libigl)', 'slim : SLIM (libigl)'],
      ...results.map((r) => [
        r.name, r.minimum.toFixed(9), against(r, 'millionth', 'cm'), against(r, 'millionth', 'wrapd'),
        against(r, 'percent', 'slim (libigl)'), ratio(r.methods.cm.mean, r.methods['slim (libigl)']?.mean),
        ratio(r.methods.slim.mean, r.methods['slim (libigl)']?.mean),
      ]),
    ]),
    `growth: ${GROWING}, wrapd+cm on one thread, seconds to 1 % above where the run ends; `
      + `exponents ${exponents.solving.toFixed(2)} of solving, ${exponents.withSetup.toFixed(2)} with setup`,
    table([
      ['triangles', 'iterations', 'seconds', 'with setup', 'energy'],
      ...grown.map((r) => [
        String(r.triangles), String(r.iterations), (r.ms / 1000).toFixed(2), ((r.ms + r.setup) / 1000).toFixed(2), r.energy.toFixed(9),
      ]),
    ]),
  ];
}
