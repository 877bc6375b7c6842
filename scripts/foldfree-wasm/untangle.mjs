// foldfree untangle, of solids and of triangles in a plane.
import { flag, given, number, quiet, text, whole } from './arguments.mjs';
import { core, program } from './core.mjs';
import { Failure, told } from './failure.mjs';
import { FORMATS, checkWritable, formatOf, readMesh, unknownFormat, write } from './files.mjs';
import { needTargets, readHandles } from './handles.mjs';
import { iterationOf, sayer, timed, writeReport } from './report.mjs';
import { checkSolidFormat, isSolid, positionsLike, readSolid, writeDeformed } from './solids.mjs';

export const operands = 0;
export const options = {
  rest: text, init: text, pins: text, targets: text, hard: flag, overlap: flag, minimize: flag, tolerance: text, flow: flag, 'target-stiffness': text, energy: text, young: text,
  poisson: text, iterations: text, threads: text, out: text, report: text, quiet,
};

function settingsOf(values) {
  whole('threads', values.threads); // taken, but this build has one
  return {
    ...core.defaultUntangleOptions(values.overlap ?? false),
    flow: values.flow ?? false,
    ...given({
      energy: values.energy,
      young: number('young', values.young),
      poisson: number('poisson', values.poisson),
      targetStiffness: number('target-stiffness', values['target-stiffness']),
      minimize: values.minimize || undefined,
      tolerance: number('tolerance', values.tolerance),
      maxIterations: whole('iterations', values.iterations),
    }),
  };
}

/** How a solid is read and written. */
const SOLIDS = {
  check: checkSolidFormat,
  read: readSolid,
  elements: (body) => body.tetrahedronCount,
  write: writeDeformed,
};

/** The same of triangles. */
const TRIANGLES = {
  check(path) {
    if (!formatOf(path)) throw unknownFormat(path, FORMATS);
  },
  read: readMesh,
  elements: (body) => body.triangleCount,
  write: (path, body, positions) => write(path, body.write(formatOf(path), positions)),
  positions: (path) => readMesh(path).positions,
};

/** Steps until the status is no longer `running`. */
function solve(solver, { maxIterations }) {
  let step = solver.start;
  let status = maxIterations === 0 ? 'max-iterations' : step.status;
  const iterations = [iterationOf(step)];
  while (status === 'running') {
    step = told(() => solver.advance());
    ({ status } = step);
    iterations.push(iterationOf(step));
  }
  return { status, criterion: step.criterion, iterations };
}

/** Reads, untangles, writes, reports. */
export function run(_operand, values) {
  const { init, rest = init, out } = values;
  if (init === undefined) throw new Failure('--init is needed');
  needTargets(values);
  if (values.flow && !values.overlap) throw new Failure('--flow needs --overlap');
  if (values.tolerance !== undefined && !values.minimize) throw new Failure('--tolerance needs --minimize');
  const settings = settingsOf(values);
  const kind = isSolid(rest) ? SOLIDS : TRIANGLES;
  if (out !== undefined) kind.check(out);
  checkWritable(out, values.report);
  const body = kind.read(rest);
  const { vertexCount } = body;
  const start = positionsLike(init, vertexCount, 'the rest shape', kind.positions);
  const { pins, targets } = readHandles(values, vertexCount);
  const solver = told(() => core.untangle(body, { ...settings, pins, start, targets }));
  const notes = [...body.notes, ...solver.notes];
  const say = sayer(values.quiet);
  notes.forEach(say);

  const { status, criterion, iterations } = solve(solver, settings);
  const [{ positions, certificate, outcome, obstacles }, certificateSeconds] = timed(() => told(() => solver.result()));
  if (out !== undefined) kind.write(out, body, positions);
  const last = iterations.at(-1);
  say(`${status} after ${last.iteration} steps: ${solver.setupSeconds.toFixed(3)} s to set up, ${last.seconds.toFixed(3)} s to solve; ${outcome.notPositive.length} inverted or degenerate, smallest measure ${outcome.smallestMeasure.toExponential(3)} of that at rest.`);
  obstacles.forEach(say);
  const { energy, young, poisson, flow, minimize, tolerance, ...reported } = settings;
  writeReport(values.report, {
    program, rest, init, status, criterion, energy, options: reported,
    ...(minimize && { minimizedTo: tolerance }),
    threads: core.threads,
    vertices: vertexCount,
    elements: kind.elements(body),
    pins: pins.length,
    targets: targets.vertices.length,
    notes,
    ...(flow && { flow: solver.flowed }),
    setupSeconds: solver.setupSeconds,
    seconds: last.seconds,
    iterations, outcome, certificate, certificateSeconds,
    memoryBytes: core.memoryBytes,
  });
  return status === 'converged' ? 0 : 2;
}
