// Mixed-integer problems, as installed from the packed package: in this thread, and in a worker.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, describe, it } from 'node:test';
import { gzipSync } from 'node:zlib';
import { importPacked, installPacked } from './packed.mjs';

const { folder } = installPacked();
const { initSync, wasm } = await importPacked(folder, 'foldfree/core');
const { load } = await importPacked(folder, 'foldfree');
const core = initSync(readFileSync(new URL(wasm)));
const foldfree = await load({ threads: false });
after(() => foldfree.terminate());

const ROUNDINGS = ['direct', 'greedy', 'two-opt', 'lattice'];
const u32 = (...values) => Uint32Array.from(values);
const f64 = (...values) => Float64Array.from(values);

/** The entries of a dense matrix that are not 0, one by one. */
function triplets(dense) {
  const entries = dense.flatMap((row, i) => row.map((value, j) => [i, j, value])).filter(([, , value]) => value !== 0);
  const [rows, columns, values] = [0, 1, 2].map((k) => entries.map((entry) => entry[k]));
  return { rows: u32(...rows), columns: u32(...columns), values: f64(...values) };
}

/** The same by columns. */
function byColumns(dense, width) {
  const columnPointers = [0];
  const [rows, values] = [[], []];
  for (let j = 0; j < width; j++) {
    dense.forEach((row, i) => { if (row[j] !== 0) { rows.push(i); values.push(row[j]); } });
    columnPointers.push(rows.length);
  }
  return { columnPointers: u32(...columnPointers), rows: u32(...rows), values: f64(...values) };
}

/** The integers nearest to `places` where rows · x + constants = 0. */
const nearest = (places, rows = [], constants = [], integers = places.map((_, i) => i)) => ({
  matrix: triplets(places.map((_, i) => places.map((_, j) => (i === j ? 1 : 0)))),
  linear: f64(...places),
  constraints: { ...triplets(rows), constants: f64(...constants) },
  integers,
});

/** A full matrix with a minimum between the integers: products of all pairs are in it. */
function coupled(n, seed = 1) {
  let state = seed;
  const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
  const root = Array.from({ length: n }, () => Array.from({ length: n }, () => random() - 0.5));
  const dense = root.map((_, i) => root.map((_, j) => root.reduce((sum, row) => sum + row[i] * row[j], i === j ? 0.05 : 0)));
  const minimum = root.map(() => 6 * random() - 3);
  const linear = Float64Array.from(dense, (row) => row.reduce((sum, a, j) => sum + a * minimum[j], 0));
  return { dense, problem: { matrix: triplets(dense), linear, integers: minimum.map((_, i) => i) } };
}

/** The least energy of all integers in a box, found by trying. */
function bruteForce({ dense, problem: { linear } }, reach) {
  const n = dense.length;
  let least = Infinity;
  for (let code = 0; code < (2 * reach + 1) ** n; code++) {
    const x = dense.map((_, k) => (Math.floor(code / (2 * reach + 1) ** k) % (2 * reach + 1)) - reach);
    const energy = x.reduce((sum, xi, i) => sum + xi * (0.5 * dense[i].reduce((s, a, j) => s + a * x[j], 0) - linear[i]), 0);
    least = Math.min(least, energy);
  }
  return least;
}

/** Asserts that `call` throws a FoldfreeError with this code and these words, and gives it back. */
function thrown(code, call, words = '') {
  try {
    call();
  } catch (error) {
    assert.equal(error.code, code, error.message);
    assert.ok(error.message.includes(words), error.message);
    return error;
  }
  assert.fail(`nothing was thrown, expected ${code}`);
}

describe('solveMixedInteger', () => {
  it('finds the optimum that brute force finds, and proves it', () => {
    for (let seed = 1; seed <= 8; seed++) {
      const made = coupled(4, 7919 * seed);
      const least = bruteForce(made, 6);
      const energies = Object.fromEntries(ROUNDINGS.map((rounding) => {
        const { x, energy, integers, report, status, proven, gap } = core.solveMixedInteger(made.problem, { rounding });
        assert.equal(status, 'converged');
        assert.ok(x.every(Number.isInteger));
        assert.deepEqual(integers, x);
        assert.ok(report.relaxedEnergy <= energy && energy >= least - 1e-9);
        assert.equal(proven, rounding === 'lattice');
        assert.equal(gap === undefined, rounding !== 'lattice');
        if (proven) assert.ok(gap >= 0 && gap < 1e-9);
        return [rounding, energy];
      }));
      assert.ok(Math.abs(energies.lattice - least) < 1e-9, `${energies.lattice}, ${least}`);
      assert.ok(energies['two-opt'] <= energies.greedy + 1e-12);
    }
  });

  it('keeps what integer rows allow, and says what became of them', () => {
    const { x, integers, report } = core.solveMixedInteger(nearest([0.3, 0.4], [[2, 3]], [-1]));
    assert.deepEqual([...x], [-1, 1]);
    assert.deepEqual(integers, x);
    assert.equal(report.violation, 0);
    assert.ok(report.changesOfIntegers > 0);
    const twice = core.solveMixedInteger(nearest([0.3, 0.4, 1.2], [[1, 1, 0], [2, 2, 0]], [-1, -2], [0]));
    assert.deepEqual([...twice.report.redundantRows], [1]);
    assert.deepEqual(twice.report.rows.map(({ outcome }) => outcome), ['eliminates', 'redundant']);
    assert.deepEqual([...twice.integers], [0]);
    assert.equal(twice.x[2], 1.2);
  });

  it('takes a matrix by columns, a .sys file as text or bytes, and arrays alike', () => {
    const { dense, problem } = coupled(4, 5);
    const rows = [[1, 0, -2, 0]];
    const constants = f64(1);
    const columns = { ...problem, matrix: byColumns(dense, 4), constraints: { ...byColumns(rows, 4), constants } };
    const entries = { ...problem, constraints: { ...triplets(rows), constants } };
    const { rows: i, columns: j, values } = problem.matrix;
    const sys = [
      `4 1 4 ${values.length} 3`, ...[...values].map((value, t) => `${i[t]} ${j[t]} ${value}`), [...problem.linear].join('\n'),
      '0 0 1', '0 2 -2', '0 4 1', '0 1 2 3',
    ].join('\n');
    const [a, b, c, d] = [columns, entries, sys, new TextEncoder().encode(sys)].map((data) => core.solveMixedInteger(data, { rounding: 'lattice' }).x);
    assert.deepEqual(b, a);
    assert.deepEqual(c, a);
    assert.deepEqual(d, a);
    assert.equal(a[0] - 2 * a[2] + 1, 0);
  });

  it('has its options, and refuses others', () => {
    const { problem } = coupled(6, 3);
    const defaults = core.defaultMixedIntegerOptions();
    assert.equal(defaults.rounding, 'greedy');
    assert.deepEqual([defaults.gaussSeidel, defaults.conjugateGradients, defaults.cholesky], [100_000, 50, true]);
    const levels = (options) => core.solveMixedInteger(problem, { engine: 'three-level', budget: 0, ...options }).report.levels;
    assert.equal(levels({ gaussSeidel: 0, conjugateGradients: 0 }).cholesky, 5, 'the last integer has nothing to follow it');
    const iterative = levels({ cholesky: false });
    assert.ok(iterative.cholesky === 0 && iterative.gaussSeidel + iterative.conjugateGradients + iterative.none >= 5);
    assert.equal(core.solveMixedInteger(problem, { engine: 'dense' }).report.levels.dense, 6);
    thrown('invalid-option', () => core.solveMixedInteger(problem, { rounding: 'magic' }), 'rounding');
    thrown('invalid-option', () => core.solveMixedInteger(problem, { method: 'greedy' }), 'there is no such option');
    thrown('invalid-option', () => core.solveMixedInteger(problem, { budget: 0.7 }), 'budget');
    thrown('invalid-option', () => core.solveMixedInteger(problem, { rounding: 'lattice', engine: 'three-level' }), 'engine');
  });

  it('leaves a gap where it may not look at enough points', () => {
    const { problem } = coupled(24, 11);
    const { status, proven, gap, lowerBound, energy } = core.solveMixedInteger(problem, { rounding: 'lattice', nodes: 30 });
    assert.equal(status, 'max-iterations');
    assert.equal(proven, false);
    assert.ok(gap > 1e-6 && Math.abs(energy - lowerBound - gap) < 1e-12);
  });
});

describe('what is wrong with a mixed-integer problem', () => {
  const good = nearest([0.3, 0.4]);

  it('is named by the row', () => {
    const infeasible = thrown('infeasible-row', () => core.solveMixedInteger(nearest([0.3, 0.4], [[1, -1], [2, 4]], [0, -3])), 'constraint row');
    assert.ok([0, 1].includes(infeasible.details.row));
    const contradictory = thrown('contradictory-row', () => core.solveMixedInteger(nearest([0.3, 0.4], [[1, 1], [1, 1]], [-1, -2])));
    assert.ok([0, 1].includes(contradictory.details.row) && Math.abs(contradictory.details.residual) === 1);
    const { details } = thrown('index-out-of-range', () => core.solveMixedInteger({ ...good, constraints: { rows: u32(0, 3), columns: u32(0, 1), values: f64(1, 1), constants: f64(0, 0) } }));
    assert.deepEqual(details, { position: 1, row: 3, rows: 2 });
    thrown('non-finite', () => core.solveMixedInteger(nearest([0.3, 0.4], [[1, 1], [1, NaN]], [0, 0])), 'constraint row 1');
  });

  it('is named by the entry, the unknown, the line', () => {
    const matrix = (rows, columns, values) => ({ ...good, matrix: { rows: u32(...rows), columns: u32(...columns), values: f64(...values) } });
    const { details } = thrown('not-symmetric', () => core.solveMixedInteger(matrix([0, 1, 1], [0, 1, 0], [1, 1, 0.5])), '(1, 0)');
    assert.deepEqual([details.row, details.column], [1, 0]);
    assert.equal(thrown('not-positive-definite', () => core.solveMixedInteger(matrix([0, 1], [0, 1], [1, -1]))).details.pivot, 1);
    assert.equal(thrown('index-out-of-range', () => core.solveMixedInteger(matrix([0, 2], [0, 1], [1, 1]))).details.position, 1);
    assert.equal(thrown('non-finite', () => core.solveMixedInteger(matrix([0, 1], [0, 1], [1, Infinity]))).details.position, 1);
    assert.equal(thrown('integer-twice', () => core.solveMixedInteger({ ...good, integers: [1, 0, 1] })).details.index, 1);
    assert.equal(thrown('index-out-of-range', () => core.solveMixedInteger({ ...good, integers: u32(2) })).details.index, 2);
    assert.equal(thrown('parse', () => core.solveMixedInteger('2 0 1 2 0\n0 0 1\n1 x 1\n0.5 0.5\n1\n')).line, 3);
  });

  it('is named by the argument', () => {
    thrown('invalid-argument', () => core.solveMixedInteger(undefined), 'problem');
    thrown('invalid-argument', () => core.solveMixedInteger({ ...good, linear: [0, 0] }), 'linear');
    thrown('invalid-argument', () => core.solveMixedInteger({ ...good, integers: [0.5] }), 'integers');
    thrown('invalid-argument', () => core.solveMixedInteger({ ...good, matrix: { rows: u32(0), columns: u32(0, 1), values: f64(1) } }), 'matrix.columns: the length is 2, expected 1');
    thrown('invalid-argument', () => core.solveMixedInteger({ ...good, matrix: { rows: [0], columns: [0], values: [1] } }), 'matrix');
    thrown('invalid-argument', () => core.solveMixedInteger({ ...good, constraints: { ...good.constraints, constants: [] } }), 'constraints.constants');
    const csc = (columnPointers) => () => core.solveMixedInteger({ ...good, matrix: { columnPointers, rows: u32(0, 1), values: f64(1, 1) } });
    thrown('invalid-argument', csc(u32(0, 2)), 'matrix.columnPointers: the length is 2, expected 3');
    thrown('invalid-argument', csc(u32(1, 1, 2)), 'the first is 1');
    thrown('invalid-argument', csc(u32(0, 2, 1)), 'number 2 is 1, expected 2 to 2');
    thrown('invalid-argument', csc(u32(0, 1, 3)), 'number 2 is 3');
    thrown('invalid-argument', csc(u32(0, 1, 1)), 'matrix.rows: the length is 2, expected 1');
  });
});

describe('step by step', () => {
  it('greedy says which unknown was rounded to what', () => {
    const { problem } = coupled(5, 17);
    const solver = core.mixedInteger(problem, { rounding: 'greedy' });
    assert.deepEqual([solver.start.iteration, solver.start.action.kind, solver.start.remaining], [0, 'relax', 5]);
    assert.deepEqual([...solver.integerUnknowns], [0, 1, 2, 3, 4]);
    assert.ok(!solver.start.x.some(Number.isInteger));
    const fixed = new Map();
    let before = solver.start;
    for (const step of solver) {
      assert.equal(step.action.kind, 'round');
      const [{ unknown, from, to }] = step.action.rounded;
      assert.ok(Math.abs(from - before.x[unknown]) < 1e-9 && Number.isInteger(to) && Math.abs(from - to) <= 0.5 + 1e-6);
      fixed.set(unknown, to);
      for (const [known, value] of fixed) assert.ok(Math.abs(step.x[known] - value) < 1e-9);
      assert.ok(step.energy >= before.energy - 1e-12, 'every rounding costs');
      assert.equal(step.remaining, 5 - fixed.size);
      before = step;
    }
    assert.equal(before.status, 'converged');
    assert.deepEqual(solver.result().x, before.x);
    solver.free();
  });

  it('resolve takes another b and other constants, and keeps what it was on an error', () => {
    const { dense, problem } = coupled(4, 23);
    const rows = [[1, 1, 0, 0]];
    const whole = { ...problem, constraints: { ...triplets(rows), constants: f64(-1) } };
    const solver = core.mixedInteger(whole, { rounding: 'lattice' });
    const first = solver.run();
    const linear = problem.linear.map((b) => b + 0.3);
    const start = solver.resolve({ linear, constants: f64(2) });
    assert.deepEqual([start.iteration, start.status], [0, 'running']);
    const again = solver.run();
    const anew = core.solveMixedInteger({ ...whole, linear, constraints: { ...whole.constraints, constants: f64(2) } }, { rounding: 'lattice' });
    assert.deepEqual(again.x, anew.x);
    assert.ok(Math.abs(again.energy - anew.energy) < 1e-9 && again.proven);
    assert.equal(again.x[0] + again.x[1], -2);
    thrown('wrong-length', () => solver.resolve({ linear: f64(1) }), 'linear');
    thrown('non-finite', () => solver.resolve({ constants: f64(NaN) }), 'constants');
    thrown('infeasible-row', () => solver.resolve({ constants: f64(0.5) }), 'constraint row 0');
    thrown('invalid-argument', () => solver.resolve({ linear: [1, 2, 3, 4] }), 'linear');
    assert.deepEqual(solver.result().x, again.x);
    solver.resolve({ linear: problem.linear, constants: f64(-1) });
    assert.deepEqual(solver.run().x, first.x);
    assert.equal(dense.length, 4);
  });
});

describe('in a worker', () => {
  it('gives the same as in this thread, from arrays and from a gzipped file', async () => {
    const { problem } = coupled(8, 29);
    const here = core.solveMixedInteger(problem, { rounding: 'lattice' });
    const there = await foldfree.solveMixedInteger(problem, { rounding: 'lattice' });
    assert.deepEqual(there.x, here.x);
    assert.deepEqual([there.energy, there.proven, there.gap], [here.energy, here.proven, here.gap]);
    const { rows, columns, values } = problem.matrix;
    const sys = `8 0 8 ${values.length} 0 ${[...values].map((v, t) => `${rows[t]} ${columns[t]} ${v}`).join(' ')} ${problem.linear.join(' ')} 0 1 2 3 4 5 6 7`;
    assert.deepEqual((await foldfree.solveMixedInteger(gzipSync(sys), { rounding: 'lattice' })).x, here.x);
  });

  it('steps, resolves, runs', async () => {
    const { problem } = coupled(6, 31);
    const solver = await foldfree.mixedInteger(problem, { rounding: 'greedy' });
    assert.equal(solver.start.remaining, 6);
    assert.equal((await solver.step()).remaining, 5);
    const start = await solver.resolve({ linear: problem.linear.map((b) => -b) });
    assert.equal(start.iteration, 0);
    assert.ok(start.x.every((x, i) => Math.abs(x + solver.start.x[i]) < 1e-9));
    const rounded = [];
    for await (const step of solver) rounded.push(...step.action.rounded.map(({ unknown }) => unknown));
    assert.deepEqual(rounded.toSorted(), [0, 1, 2, 3, 4, 5]);
    assert.equal(solver.status, 'converged');
    await solver.resolve({ linear: problem.linear });
    assert.equal(solver.status, 'running');
    const reports = [];
    const last = await solver.run({ onFrame: (frame, since) => reports.push(...since) });
    assert.deepEqual(reports.map(({ iteration }) => iteration), [1, 2, 3, 4, 5, 6]);
    const { x, report } = await solver.result();
    assert.deepEqual(x, last.x);
    assert.deepEqual(await solver.report(), report);
    await assert.rejects(solver.resolve({ linear: f64(1) }), { code: 'wrong-length' });
    solver.free();
    await assert.rejects(solver.step(), { code: 'freed' });
    await assert.rejects(foldfree.solveMixedInteger(nearest([0.5], [[2]], [-1])), { code: 'infeasible-row' });
  });

  it('can be cancelled in a long search', async () => {
    const { problem } = coupled(60, 37);
    const solver = await foldfree.mixedInteger(problem, { rounding: 'lattice', nodes: 1e12 });
    const running = solver.run({ minInterval: 50 });
    setTimeout(() => solver.cancel(), 300);
    const last = await running;
    assert.equal(last.status, 'cancelled');
    const { energy, report } = await solver.result();
    assert.ok(energy >= report.relaxedEnergy);
    const controller = new AbortController();
    const aborted = foldfree.solveMixedInteger(problem, { rounding: 'lattice', nodes: 1e12, signal: controller.signal });
    setTimeout(() => controller.abort(), 100);
    await assert.rejects(aborted, { name: 'AbortError' });
    assert.equal((await foldfree.solveMixedInteger(nearest([0.6]))).x[0], 1, 'the worker is free again');
  });
});
