// Writes www/assets/start.bin and start-deform.bin: the problems the modes open on, as the solver itself
// would start them, so that the first frame can be drawn before the solver has come. Run after `npm run
// build`, whenever a sample or a start changes: node www/prepare-start.mjs
import { readFileSync, writeFileSync } from 'node:fs';
import { DEFAULTS } from './page/address.js';
import { scene } from './page/presets.js';
import { initSync } from '../pkg/core.js';

const here = (path) => new URL(path, import.meta.url);
const library = () => initSync(readFileSync(here('../pkg/single/foldfree_bg.wasm')));

const numbers = (record) => Float64Array.of(
  record.energy, record.inverted, record.gradientNorm, record.smallestSigma, record.largestSigma, 0,
);

const joined = (parts) => Buffer.concat(parts.map((part) => Buffer.from(part.buffer, part.byteOffset, part.byteLength)));

/** The bytes of the prepared map (read by page/canvas.js). */
export function preparedStart(foldfree = library()) {
  const { sample, triangles, start, method, energy } = DEFAULTS.flatten;
  const mesh = foldfree.generate(sample, triangles);
  const solver = foldfree.parameterize(mesh, { start, method, energy, frames: 'f32' });
  const { positions, indices } = solver.mesh;
  return joined([
    Uint32Array.of(0x444c4f46, positions.length / 3, indices.length / 3, 0), // "FOLD", vertices, triangles
    numbers(solver.start), Float32Array.from(positions), indices, Float32Array.from(solver.start.positions),
  ]);
}

/** The bytes of the prepared solid (read by page/canvas.js). */
export function preparedSolid(foldfree = library()) {
  const { solid: name, tetrahedra: about, preset, method, material, young, poisson } = DEFAULTS.deform;
  const solid = foldfree.generateSolid(name, about);
  const { positions, tetrahedra, surface } = solid;
  const { held, start } = scene(preset, positions);
  const pins = held.flatMap((vertices) => [...vertices]);
  const solver = foldfree.deform(solid, { method, energy: material, young, poisson, pins, start, frames: 'f32' });
  return joined([
    Uint32Array.of(0x494c4f53, positions.length / 3, tetrahedra.length / 4, surface.length / 3), // "SOLI"
    numbers(solver.start), Float32Array.from(positions), Float32Array.from(solver.start.positions), tetrahedra, surface,
  ]);
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  for (const [name, bytes] of [['start', preparedStart()], ['start-deform', preparedSolid()]]) {
    writeFileSync(here(`assets/${name}.bin`), bytes);
    console.log(`www/assets/${name}.bin: ${bytes.length} bytes`);
  }
}
