// Solids in and out: .node with its .ele beside it, or one file that holds both.
import { existsSync } from 'node:fs';
import { core } from './core.mjs';
import { Failure, of } from './failure.mjs';
import { FORMATS, formatOf, readBytes, unknownFormat, write } from './files.mjs';

/** Formats that hold tetrahedra in one file. */
const SOLIDS = ['mesh', 'msh', 'vtk'];
const KNOWN = ['node', 'ele', ...SOLIDS];

/** The .node and the .ele file that a name of either stands for, or undefined. */
function pair(path) {
  const [, stem, packed = ''] = /^(.*)\.(?:node|ele)(\.gz)?$/.exec(path) ?? [];
  return stem === undefined ? undefined : { node: `${stem}.node${packed}`, ele: `${stem}.ele${packed}`, stem };
}

/** The same pair as files to read: each the one that exists, compressed or not. */
function existingPair(path) {
  const { stem } = pair(path) ?? {};
  if (stem === undefined) return undefined;
  const existing = (name) => (!existsSync(name) && existsSync(`${name}.gz`) ? `${name}.gz` : name);
  return { node: existing(`${stem}.node`), ele: existing(`${stem}.ele`) };
}

/** Reads a solid, by the ending of the file's name. */
export function readSolid(path) {
  const files = existingPair(path);
  if (files) {
    const nodes = readBytes(files.node);
    of(files.node, () => nodesAlone(nodes));
    const elements = readBytes(files.ele);
    return of(files.ele, () => core.solid(nodes, 'node', elements));
  }
  const format = formatOf(path, SOLIDS);
  if (!format) throw unknownFormat(path, KNOWN);
  const bytes = readBytes(path);
  return of(path, () => core.solid(bytes, format));
}

/** Reads the vertices of a solid, n × 3; no .ele file is needed. */
export function readPositions(path) {
  const files = existingPair(path);
  if (!files) return readSolid(path).positions;
  const nodes = readBytes(files.node);
  return of(files.node, () => nodesAlone(nodes));
}

/** The vertices of another file of the same body; `read` reads them. */
export function positionsLike(path, vertices, whose, read = readPositions) {
  const positions = read(path);
  if (positions.length === 3 * vertices) return positions;
  throw new Failure(`${path}: has ${positions.length / 3} vertices, ${whose} ${vertices}`);
}

/**
 * The vertices of a .node file alone. The library reads it together with its elements, so one tetrahedron stands
 * in for these; indices count from 0 or from 1, whichever the first vertex has.
 */
function nodesAlone(bytes) {
  const lines = new TextDecoder().decode(bytes).split('\n').map((line) => line.split('#')[0].trim());
  const [, line = ''] = lines.filter((one) => one !== '');
  const first = /^0*1(\s|$)/.test(line) ? 1 : 0;
  const solid = core.solid(bytes, 'node', `1 4 0\n0 ${first} ${first + 1} ${first + 2} ${first + 3}\n`);
  const { positions } = solid;
  solid.free();
  return positions;
}

/** Does this file hold tetrahedra? */
export function isSolid(path) {
  if (pair(path)) return true;
  const format = formatOf(path, SOLIDS);
  if (!format) return false;
  const bytes = readBytes(path);
  try {
    core.solid(bytes, format).free();
    return true;
  } catch {
    return false;
  }
}

/** Fails when a solid cannot be written under this name: said before the work rather than after. */
export function checkSolidFormat(path) {
  if (!pair(path) && !formatOf(path)) throw unknownFormat(path, ['node', 'ele', ...FORMATS]);
}

/**
 * Writes a deformed solid: its vertices (.node), vertices and elements, or, in a format of surfaces, the boundary.
 */
export function writeDeformed(path, solid, positions) {
  write(path, pair(path) ? nodeFile(positions) : of(path, () => solid.write(formatOf(path), positions)));
}

/** Writes a solid: .node with .ele beside it, or one file as above. Returns the names of the files. */
export function writeSolid(path, solid) {
  const files = pair(path);
  if (!files) {
    writeDeformed(path, solid, solid.positions);
    return path;
  }
  write(files.node, nodeFile(solid.positions));
  write(files.ele, eleFile(solid.tetrahedra));
  return `${files.node}, ${files.ele}`;
}

/** A .node file, indices from 0; reading it gives the same bits back. */
function nodeFile(positions) {
  const lines = [`${positions.length / 3} 3 0 0`];
  for (let i = 0; i < positions.length; i += 3) lines.push(`${i / 3} ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  return `${lines.join('\n')}\n`;
}

/** An .ele file, indices from 0. */
function eleFile(tetrahedra) {
  const lines = [`${tetrahedra.length / 4} 4 0`];
  for (let i = 0; i < tetrahedra.length; i += 4) lines.push(`${i / 4} ${tetrahedra.subarray(i, i + 4).join(' ')}`);
  return `${lines.join('\n')}\n`;
}
