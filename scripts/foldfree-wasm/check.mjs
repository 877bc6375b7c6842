// foldfree check.
import { flag, quiet, text } from './arguments.mjs';
import { core, program } from './core.mjs';
import { Failure, of } from './failure.mjs';
import { checkWritable, readMesh } from './files.mjs';
import { sayer, timed, writeReport } from './report.mjs';
import { isSolid, readPositions, readSolid } from './solids.mjs';

export const options = { rest: text, global: flag, report: text, quiet };

/** Reads the map, examines it and says what was found. */
export function run(map, values) {
  checkWritable(values.report);
  const examine = isSolid(map) ? examineSolid : examineSurface;
  const { notes, certificate, certificateSeconds, fine, injective } = examine(map, values);
  const folds = certificate.inverted.length + certificate.degenerate.length;
  sayer(values.quiet)(`${folds} inverted or degenerate, ${injective}`);
  writeReport(values.report, { program, map, notes, certificate, certificateSeconds });
  return fine ? 0 : 2;
}

function examineSurface(map, { rest: restPath, global }) {
  const mesh = readMesh(map);
  const rest = restPath === undefined ? mesh : readMesh(restPath);
  if (rest.triangleCount !== mesh.triangleCount) {
    throw new Failure(`${restPath}: has ${rest.triangleCount} triangles, but ${map} has ${mesh.triangleCount}`);
  }
  const [certificate, certificateSeconds] = timed(() => of(map, () => core.checkCorners(rest, cornersOf(mesh, rest))));
  const { inverted, degenerate, mirrored, irregularEdges, globallyInjective } = certificate;
  const free = (mirrored || inverted.length === 0) && degenerate.length === 0 && irregularEdges === 0;
  return {
    notes: mesh.notes, certificate, certificateSeconds,
    fine: global ? globallyInjective : free,
    injective: globallyInjective ? 'injective' : 'not injective',
  };
}

/** Image of every corner: the texture coordinates of a file, or the positions of a flat mesh. */
function cornersOf(mesh, rest) {
  if (mesh.texture) return images(mesh.texture.coordinates, 2, mesh.texture.corners);
  if (rest === mesh) throw new Failure('there are no texture coordinates; give the surface with --rest');
  const tall = mesh.positions.findIndex((value, i) => i % 3 === 2 && value !== 0);
  if (tall >= 0) throw new Failure(`there are no texture coordinates, and vertex ${(tall - 2) / 3} is not in the plane z = 0`);
  return images(mesh.positions, 3, mesh.indices);
}

/** Two coordinates for every corner. */
function images(points, stride, corners) {
  const flat = new Float64Array(2 * corners.length);
  corners.forEach((index, corner) => {
    flat[2 * corner] = points[stride * index];
    flat[2 * corner + 1] = points[stride * index + 1];
  });
  return flat;
}

/** The same for the deformed vertices of a solid. */
function examineSolid(map, { rest: restPath, global }) {
  if (restPath === undefined) throw new Failure(`${map}: a solid is deformed from its rest shape: give it with --rest`);
  if (global) throw new Failure('--global is not known for solids: only what is around every point is examined');
  const rest = readSolid(restPath);
  const positions = readPositions(map);
  if (positions.length !== rest.positions.length) {
    throw new Failure(`${map}: has ${positions.length / 3} vertices, the rest shape ${rest.vertexCount}`);
  }
  const [certificate, certificateSeconds] = timed(() => of(restPath, () => core.checkSolid(rest, positions)));
  const { elements, inverted, degenerate, flatAtRest, irregularFaces, locallyInjective } = certificate;
  return {
    notes: rest.notes, certificate, certificateSeconds,
    fine: elements > 0 && [inverted, degenerate, flatAtRest, irregularFaces].every((list) => list.length === 0),
    injective: locallyInjective ? 'injective around every point' : 'not proven to be injective around every point',
  };
}
