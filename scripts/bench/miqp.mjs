// Mixed-integer problems, natively and on one thread: the dumped parametrizations, the order of constraint rows, growth.
import { execFileSync } from 'node:child_process';
import { existsSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { say } from '../lib/progress.mjs';
import { features, gear, torus } from './miqp-problems.mjs';
import { table } from './table.mjs';

/** The report of a run at the lower quartile of the times; of one that is refused: what it said. */
function reportOf(bench, file, args, repeat) {
  const report = join(bench.work, 'miqp.json');
  const all = ['miqp', file, ...args, '--threads', '1', '--repeat', String(repeat), '--report', report, '--quiet'];
  try {
    execFileSync(bench.native, all, { stdio: ['ignore', 'ignore', 'pipe'] });
  } catch (error) {
    if (error.status === 1) return { refused: String(error.stderr).trim().split(': ').slice(2).join(': ') };
    if (error.status !== 2) throw error; // 2: a gap is left
  }
  return JSON.parse(readFileSync(report, 'utf8'));
}

/** A generated problem as a file of the work folder. */
function written(bench, name, text) {
  const file = join(bench.work, `${name}.sys`);
  writeFileSync(file, text);
  return file;
}

/** The settings of the paper for parametrizations (§4). */
const PAPER = ['--engine', 'three-level', '--gauss-seidel', '0', '--conjugate-gradients', '20', '--no-cholesky'];

const ROUNDINGS = [
  ['direct', ['--rounding', 'direct']],
  ['greedy, paper’s settings', PAPER],
  ['greedy, three levels', ['--engine', 'three-level']],
  ['greedy', ['--rounding', 'greedy']],
  ['two-opt', ['--rounding', 'two-opt']],
  ['lattice', ['--rounding', 'lattice']],
];

/** Measures everything. */
export function measureMiqp(bench, { folder, quick }) {
  const repeat = quick ? 5 : 25;
  const systems = [];
  for (const name of ['torus_4k', 'double_torus']) {
    const file = join(folder, `${name}.sys.gz`);
    if (!existsSync(file)) continue;
    say(`measuring ${name}`);
    for (const [rounding, args] of ROUNDINGS) systems.push({ name, rounding, ...reportOf(bench, file, args, repeat) });
  }
  say('measuring the order of constraint rows');
  const many = [
    ...[30, 150].map((times) => [`${times} rows a junction`, features({ size: 100, length: 12, terms: 20, times, seed: 1 })]),
    ['gear, 3 teeth a row', gear({ teeth: 60, width: 4, depth: 60, span: 3, times: 60, seed: 3 })],
    ['gear, 2 teeth a row', gear({ teeth: 60, width: 3, depth: 60, span: 2, times: 100, seed: 3 })],
  ];
  const order = many.flatMap(([problem, text]) => {
    const file = written(bench, 'features', text);
    return [['shortest first', []], ['as given', ['--no-reordering']]].map(([name, args]) => ({
      name: `${problem}, ${name}`,
      ...reportOf(bench, file, args, quick ? 3 : 11),
    }));
  });
  const growth = (quick ? [10_000, 50_000] : [10_000, 50_000, 100_000, 200_000, 400_000]).map((n) => {
    say(`measuring ${n} unknowns`);
    return reportOf(bench, written(bench, 'torus', torus(n, 8)), ['--rounding', 'lattice'], n > 100_000 ? 5 : 11);
  });
  const brief = ({ iterations, rows, redundant_rows: redundant, ...rest }) => ({ ...rest, steps: iterations?.length, redundant_rows: redundant?.length });
  return { systems: systems.map(brief), order: order.map(brief), growth: growth.map(brief) };
}

const ms = (seconds) => (1000 * seconds).toFixed(1);

/** The results as text. */
export function miqpTables({ systems, order, growth }) {
  return [
    'dumped parametrizations: milliseconds with elimination, lower quartile; E − E_relaxed',
    table([
      ['system', 'rounding', 'ms', 'of it setup', 'E − E_relaxed', 'proven to', 'integers', 'nodes', 'GS / CG / Cholesky / none', 'violation'],
      ...systems.map((r) => [
        r.name, r.rounding, ms(r.seconds), ms(r.setup_seconds), (r.energy - r.relaxed_energy).toFixed(4),
        r.proven ? r.gap.toExponential(1) : '–', String(r.reduced_integers), String(r.nodes),
        [r.levels.gauss_seidel, r.levels.conjugate_gradients, r.levels.cholesky, r.levels.none].join(' / '),
        r.violation.toExponential(1),
      ]),
    ]),
    'many features: the order of constraint rows (greedy)',
    table([
      ['rows', 'constraint rows', 'redundant', 'ms', 'of it setup', 'non-zeros', 'of the factor', 'integers'],
      ...order.map((r) => r.refused ? [r.name, r.refused, ...Array(6).fill('–')] : [
        r.name, String(r.constraint_rows), String(r.redundant_rows), ms(r.seconds), ms(r.setup_seconds),
        String(r.reduced_entries), String(r.factor_entries), String(r.reduced_integers),
      ]),
    ]),
    'growth with n at a constant number of integers (lattice, proven)',
    table([
      ['unknowns', 'integers', 'ms', 'µs an unknown', 'factor entries an unknown', 'proven'],
      ...growth.map((r) => [
        String(r.unknowns), String(r.reduced_integers), ms(r.seconds), ((1e6 * r.seconds) / r.unknowns).toFixed(2),
        (r.factor_entries / r.unknowns).toFixed(1), String(r.proven),
      ]),
    ]),
  ];
}
