// foldfree parameterize.
import { flag, given, number, quiet, text, whole } from './arguments.mjs';
import { core, program } from './core.mjs';
import { Failure, of } from './failure.mjs';
import { checkWritable, readMesh, write } from './files.mjs';
import { readTargets } from './handles.mjs';
import { iterationOf, sayer, timed, writeReport } from './report.mjs';

export const options = {
  method: text, energy: text, start: text, iterations: text, tolerance: text, threads: text, seed: text, out: text,
  report: text, quiet, 'no-cut': flag, 'keep-holes': flag, 'no-rotation-aware': flag, 'no-reweighting': flag,
  landmarks: text, hard: flag, 'landmark-stiffness': text,
};

function methodOf({ method = 'wrapd', 'no-rotation-aware': linear, 'no-reweighting': fixed }) {
  if (!linear && !fixed) return method;
  if (method !== 'wrapd') throw new Failure('--no-rotation-aware and --no-reweighting go with --method wrapd');
  return linear ? (fixed ? 'admm-pd' : 'w-admm') : 'r-admm';
}

function cutOf({ 'no-cut': refuse, 'keep-holes': keep }) {
  if (refuse && keep) throw new Failure('--keep-holes does not go with --no-cut');
  return keep ? 'keep-holes' : refuse ? 'refuse' : 'cut';
}

/** Places for vertices of a mesh of so many. */
function readLandmarks({ landmarks: path, hard = false }, vertices) {
  if (path === undefined) return [];
  return readTargets(path, vertices).map(({ vertex, position: [u, v, z] }) => {
    if (z !== 0) throw new Failure(`${path}: vertex ${vertex}: a place in the plane has two coordinates`);
    return { vertex, uv: [u, v], hard };
  });
}

/** Reads, flattens, writes, reports. */
export function run(input, values) {
  whole('threads', values.threads); // taken, but this build has one
  const settings = {
    ...core.defaultOptions(),
    ...given({
      method: methodOf(values),
      cut: cutOf(values),
      energy: values.energy,
      start: values.start,
      maxIterations: whole('iterations', values.iterations),
      tolerance: number('tolerance', values.tolerance),
      seed: whole('seed', values.seed),
      landmarkStiffness: number('landmark-stiffness', values['landmark-stiffness']),
    }),
  };
  if (values.hard && values.landmarks === undefined) throw new Failure('--hard goes with --landmarks');
  checkWritable(values.out, values.report);
  const [mesh, readSeconds] = timed(() => readMesh(input));
  const landmarks = readLandmarks(values, mesh.positions.length / 3);
  const solver = of(input, () => core.parameterize(mesh, { ...settings, landmarks }));
  const notes = [...mesh.notes, ...solver.notes];
  const say = sayer(values.quiet);
  notes.forEach(say);

  const iterations = [iterationOf(solver.start)];
  let { status, criterion } = solver.start;
  if (settings.maxIterations === 0) status = 'max-iterations';
  while (status === 'running') {
    const step = of(input, () => solver.advance());
    ({ status, criterion } = step);
    iterations.push(iterationOf(step));
  }
  if (values.out !== undefined) write(values.out, solver.exportObj());
  const [{ certificate }, certificateSeconds] = timed(() => solver.result());
  const last = iterations.at(-1);
  say(`${status} after ${last.iteration} iterations: ${solver.setupSeconds.toFixed(3)} s to set up, ${last.seconds.toFixed(3)} s to solve.`);
  say(`energy ${certificate.symmetricDirichlet}, ${certificate.inverted.length} inverted`);
  writeReport(values.report, {
    program, input, status, criterion, options: settings,
    threads: core.threads,
    start: solver.startKind,
    vertices: solver.mesh.positions.length / 3,
    triangles: solver.mesh.indices.length / 3,
    seamEdges: solver.seamEdges,
    notes, readSeconds,
    setupSeconds: solver.setupSeconds,
    seconds: last.seconds,
    iterations, certificate, certificateSeconds,
    memoryBytes: core.memoryBytes,
  });
  return status === 'converged' ? 0 : 2;
}
