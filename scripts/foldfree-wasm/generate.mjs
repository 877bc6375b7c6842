// foldfree generate.
import { text, whole } from './arguments.mjs';
import { core } from './core.mjs';
import { Failure, of, told } from './failure.mjs';
import { checkWritable, formatOf, unknownFormat, write } from './files.mjs';
import { checkSolidFormat, writeSolid } from './solids.mjs';

export const options = { triangles: text, tetrahedra: text, out: text };

/** Makes the mesh and writes it. */
export function run(shape, values) {
  const { out, triangles, tetrahedra } = values;
  if (out === undefined) throw new Failure('--out is needed');
  if (triangles !== undefined && tetrahedra !== undefined) throw new Failure('--triangles and --tetrahedra are the same: give one');
  const [name, wanted] = tetrahedra === undefined ? ['triangles', triangles] : ['tetrahedra', tetrahedra];
  const count = whole(name, wanted, 1, 20_000_000) ?? 10_000;
  const solid = core.solidShapes.some((known) => known.name === shape);
  console.error(solid ? makeSolid(shape, count, out) : makeSurface(shape, count, out));
  return 0;
}

function makeSolid(shape, tetrahedra, out) {
  checkSolidFormat(out);
  checkWritable(out);
  const solid = told(() => core.generateSolid(shape, tetrahedra));
  return `${writeSolid(out, solid)}: ${solid.vertexCount} vertices, ${solid.tetrahedronCount} tetrahedra`;
}

function makeSurface(shape, triangles, out) {
  if (!core.shapes.some((known) => known.name === shape)) {
    const known = [...core.shapes, ...core.solidShapes].map(({ name }) => name).join(', ');
    throw new Failure(`there is no shape ${shape} (there are ${known})`);
  }
  if (formatOf(out) !== 'obj') throw unknownFormat(out, ['obj']);
  checkWritable(out);
  const mesh = of(shape, () => core.generate(shape, triangles));
  const { positions, indices } = mesh;
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  for (let i = 0; i < indices.length; i += 3) lines.push(`f ${indices[i] + 1} ${indices[i + 1] + 1} ${indices[i + 2] + 1}`);
  write(out, `${lines.join('\n')}\n`);
  return `${out}: ${mesh.vertexCount} vertices, ${mesh.triangleCount} triangles`;
}
