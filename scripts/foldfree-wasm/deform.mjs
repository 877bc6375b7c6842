// foldfree deform, of solids.
import { flag, given, number, quiet, text, whole } from './arguments.mjs';
import { core, program } from './core.mjs';
import { Failure, told } from './failure.mjs';
import { checkWritable } from './files.mjs';
import { needTargets, readHandles } from './handles.mjs';
import { iterationOf, sayer, timed, writeReport } from './report.mjs';
import { checkSolidFormat, positionsLike, readSolid, writeDeformed } from './solids.mjs';

export const operands = 0;
export const options = {
  rest: text, init: text, pins: text, targets: text, hard: flag, 'target-stiffness': text, energy: text, young: text,
  poisson: text, 'no-barrier': flag, 'barrier-weight': text, hessian: text, method: text, iterations: text, tolerance: text, threads: text, out: text, report: text,
  reference: text, quiet,
};

/** Materials that have Young's modulus and Poisson's ratio. */
const ELASTIC = ['neo-hookean', 'stable-neo-hookean', 'st-venant-kirchhoff'];

function settingsOf(values) {
  whole('threads', values.threads); // taken, but this build has one
  if (values.method === 'lim') return limSettingsOf(values);
  if (values['no-barrier'] || values['barrier-weight'] !== undefined) throw new Failure('--no-barrier and --barrier-weight go with --method lim');
  return {
    ...core.defaultDeformationOptions(),
    ...given({
      energy: values.energy,
      young: number('young', values.young),
      poisson: number('poisson', values.poisson),
      method: values.method,
      targetStiffness: number('target-stiffness', values['target-stiffness']),
      tolerance: number('tolerance', values.tolerance),
      maxIterations: whole('iterations', values.iterations),
    }),
  };
}

/** Of locally injective mappings. */
function limSettingsOf(values) {
  return {
    method: 'lim',
    ...core.defaultLimOptions(),
    ...given({
      energy: values.energy,
      barrier: values['no-barrier'] ? false : undefined,
      barrierWeight: number('barrier-weight', values['barrier-weight']),
      hessian: values.hessian,
      targetStiffness: number('target-stiffness', values['target-stiffness']),
      tolerance: number('tolerance', values.tolerance),
      maxIterations: whole('iterations', values.iterations),
    }),
  };
}

/** The settings as the library's own options nest them. */
function reported({ energy, young, poisson, ...rest }) {
  if (rest.method === 'lim') {
    const { method, ...options } = rest;
    return { energy, ...options };
  }
  return { material: ELASTIC.includes(energy) ? { energy, young, poisson } : { energy }, ...rest };
}

function distance(a, b) {
  return Math.sqrt(a.reduce((sum, x, i) => sum + (x - b[i]) ** 2, 0));
}

/** Steps until the status is no longer `running`; `reference`: n × 3, or undefined. */
function solve(solver, { maxIterations }, reference) {
  const first = reference && distance(solver.start.positions, reference);
  const iterations = [];
  let step = solver.start;
  let status = maxIterations === 0 ? 'max-iterations' : step.status;
  const record = () => {
    const error = reference && { positionError: distance(step.positions, reference) / first };
    iterations.push({ ...iterationOf(step), ...error });
  };
  record();
  while (status === 'running') {
    step = told(() => (reference ? solver.step() : solver.advance()));
    ({ status } = step);
    record();
  }
  return { status, criterion: step.criterion, iterations };
}

/** Reads, deforms, writes, reports. */
export function run(_operand, values) {
  const { init, rest = init, out } = values;
  if (init === undefined) throw new Failure('--init is needed');
  needTargets(values);
  const settings = settingsOf(values);
  if (out !== undefined) checkSolidFormat(out);
  checkWritable(out, values.report);
  const solid = readSolid(rest);
  const start = positionsLike(init, solid.vertexCount, 'the rest shape');
  const { pins, targets } = readHandles(values, solid.vertexCount);
  const reference = values.reference && positionsLike(values.reference, solid.vertexCount, 'the start');
  const solver = told(() => core.deform(solid, { ...settings, pins, start, targets }));
  const notes = [...solid.notes, ...solver.notes];
  const say = sayer(values.quiet);
  notes.forEach(say);

  const { status, criterion, iterations } = solve(solver, settings, reference);
  const [{ positions, certificate }, certificateSeconds] = timed(() => told(() => solver.result()));
  if (out !== undefined) writeDeformed(out, solid, positions);
  const last = iterations.at(-1);
  say(`${status} after ${last.iteration} iterations: ${solver.setupSeconds.toFixed(3)} s to set up, ${last.seconds.toFixed(3)} s to solve; energy ${last.energy}, ${last.inverted} inverted.`);
  if (reference) say(`position error against the reference: ${last.positionError.toExponential()}`);
  writeReport(values.report, {
    program, rest, init, status, criterion, options: reported(settings),
    threads: core.threads,
    vertices: solid.vertexCount,
    tetrahedra: solid.tetrahedronCount,
    pins: pins.length,
    targets: targets.vertices.length,
    notes,
    setupSeconds: solver.setupSeconds,
    seconds: last.seconds,
    iterations, certificate, certificateSeconds,
    memoryBytes: core.memoryBytes,
  });
  return status === 'converged' ? 0 : 2;
}
