// Locally injective mappings: the drag of the corner of a square against the figures of the authors' code, and steps a
// second in wasm while a hand of a flat figure is dragged.
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { performance } from 'node:perf_hooks';
import { FIGURES } from '../../www/page/figures.js';
import { scene } from '../../www/page/presets.js';
import { root, run, say } from '../lib/progress.mjs';
import { digits, table } from './table.mjs';

/** The authors' code, one thread on another machine: cited, not measured here. */
const PUBLISHED = {
  41: {
    dirichlet: { iterations: 95, energy: 1.8794, least: 0.152, seconds: 0.51, without: 88 },
    arap: { iterations: 155, energy: 0.985288, least: 0.18, seconds: 0.95 },
    'green-strain': { iterations: 39, energy: 17858, least: 0.071, seconds: 0.24, without: 807 },
  },
  161: { 'green-strain': { iterations: 70, seconds: 32 } },
};

/** n×n vertices of the unit square; the left and bottom edges are held, the corner (1, 1) goes to (0.2, 0.2). */
function writeProblem(n, work) {
  const path = (name) => join(work, `${name}-${n}`);
  const lines = [];
  const pins = [n * n - 1];
  for (let v = 0; v < n * n; v += 1) {
    const [i, j] = [v % n, Math.floor(v / n)];
    lines.push(`v ${i / (n - 1)} ${j / (n - 1)} 0`);
    if (i === 0 || j === 0) pins.push(v);
  }
  for (let j = 0; j + 1 < n; j += 1) {
    for (let i = 0; i + 1 < n; i += 1) {
      const a = j * n + i + 1;
      lines.push(`f ${a} ${a + 1} ${a + n + 1}`, `f ${a} ${a + n + 1} ${a + n}`);
    }
  }
  const files = { init: `${path('square')}.obj`, pins: path('pins'), targets: path('targets') };
  writeFileSync(files.init, `${lines.join('\n')}\n`);
  writeFileSync(files.pins, `${pins.join('\n')}\n`);
  writeFileSync(files.targets, `${n * n - 1} 0.2 0.2 0\n`);
  return files;
}

/** The least area over rest area of a deformed square in an OBJ file. */
function leastArea(file, n) {
  const points = readFileSync(file, 'utf8').split('\n').filter((line) => line.startsWith('v ')).map((line) => line.split(' ').slice(1, 3).map(Number));
  let least = Infinity;
  for (let j = 0; j + 1 < n; j += 1) {
    for (let i = 0; i + 1 < n; i += 1) {
      const a = j * n + i;
      for (const corners of [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]) {
        const [p, q, r] = corners.map((v) => points[v]);
        least = Math.min(least, (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]));
      }
    }
  }
  return least * (n - 1) ** 2;
}

async function drag(n, energy, { native, work }, { hessian = 'projected', barrier = true, repeats = 1 } = {}) {
  const { init, pins, targets } = writeProblem(n, work);
  const [out, report] = [join(work, 'dragged.obj'), join(work, 'report.json')];
  const args = ['deform', '--method', 'lim', '--init', init, '--pins', pins, '--targets', targets, '--energy', energy, '--hessian', hessian];
  if (!barrier) args.push('--no-barrier');
  const times = [];
  let last;
  for (let k = 0; k < repeats; k += 1) {
    await run(native, [...args, '--threads', '1', '--quiet', '--out', out, '--report', report], { check: false });
    const measured = JSON.parse(readFileSync(report, 'utf8'));
    last = { status: measured.status, ...measured.iterations.at(-1) };
    times.push(measured.setup_seconds + last.seconds);
  }
  times.sort((a, b) => a - b);
  return {
    n, energy, hessian, barrier, status: last.status, iterations: last.iteration, value: last.energy, barrierEnergy: last.lim.barrier,
    gradient: last.gradient_norm, inverted: last.inverted, least: leastArea(out, n), seconds: times[times.length >> 1],
    published: PUBLISHED[n]?.[energy],
  };
}

/** Steps a second of the single-thread wasm in this Node: 80 targets along the path of the figure, a frame a step. */
function figure(core, name, hessian, barrier) {
  const mesh = FIGURES[name].make(2000);
  const { held, motion } = scene('drag', mesh.positions, undefined, FIGURES[name]);
  const at = (part) => held.flatMap((vertices, i) => (i === motion.handle ? [...motion.at(part)] : [...vertices].flatMap((v) => [...mesh.positions.subarray(3 * v, 3 * v + 3)])));
  const pins = Uint32Array.from(held.flatMap((vertices) => [...vertices]));
  const solver = core.deform(core.mesh(mesh), { pins, hessian, barrier, frames: 'f32' });
  const times = [];
  let inverted = 0;
  for (let step = 1; step <= 160; step += 1) {
    const begun = performance.now();
    solver.setTargets({ vertices: pins, positions: Float64Array.from(at(Math.min(1, step / 80))) });
    inverted = Math.max(inverted, solver.step().inverted);
    times.push(performance.now() - begun);
  }
  solver.free();
  times.sort((a, b) => a - b);
  const mean = times.reduce((a, b) => a + b) / times.length;
  return { name, triangles: mesh.indices.length / 3, hessian, barrier, rate: 1000 / mean, slow: times[Math.floor(0.95 * times.length)], inverted };
}

/** Measures all of it. */
export async function measureLim(bench, { quick }) {
  const drags = [];
  for (const energy of ['dirichlet', 'arap', 'green-strain']) {
    say(`measuring the square, ${energy}`);
    for (const hessian of ['projected', 'frozen']) drags.push(await drag(41, energy, bench, { hessian, repeats: quick ? 1 : 5 }));
    drags.push(await drag(41, energy, bench, { barrier: false }));
  }
  if (!quick) drags.push(await drag(161, 'green-strain', bench));
  const { initSync } = await import('../../pkg/core.js');
  const core = initSync(readFileSync(join(root, 'pkg/single/foldfree_bg.wasm')));
  const figures = [['projected', true], ['frozen', true], ['projected', false]].map(([hessian, barrier]) => figure(core, 'gingerbread', hessian, barrier));
  return { drags, figures };
}

/** The results as text. */
export function limTables({ drags, figures }) {
  const cited = (published, key) => (published?.[key] === undefined ? '–' : String(published[key]));
  return [
    'the corner of a square dragged in, native, one thread, setup included; behind the bar the authors’ code *',
    table([
      ['n', 'energy', 'Hessian', 'barrier', 'ended', 'iterations', 'E', 'βΣφ', '|∇|', 'inverted', 'least area', 'seconds', '| iterations', 'E', 'least area', 'seconds', 'inverted'],
      ...drags.map((d) => [
        String(d.n), d.energy, d.hessian, d.barrier ? 'on' : 'off', d.status, String(d.iterations), d.value.toPrecision(8), d.barrierEnergy.toPrecision(6),
        d.gradient.toExponential(1), String(d.inverted), d.least.toFixed(3), d.seconds.toFixed(3),
        ...(d.barrier
          ? [cited(d.published, 'iterations'), cited(d.published, 'energy'), cited(d.published, 'least'), cited(d.published, 'seconds'), '0']
          : ['–', '–', '–', '–', cited(d.published, 'without')]),
      ]),
    ]),
    '* cited, another machine. Dirichlet and ARAP have many local minima with a barrier: which of them a run ends in depends on its path.',
    'a hand of a flat figure dragged, single-thread wasm in Node: a target and a frame a step',
    table([
      ['figure', 'triangles', 'Hessian', 'barrier', 'steps a second', '95th percentile of a step', 'most inverted'],
      ...figures.map((f) => [f.name, String(f.triangles), f.hessian, f.barrier ? 'on' : 'off', digits(f.rate), `${digits(f.slow)} ms`, String(f.inverted)]),
    ]),
  ];
}
