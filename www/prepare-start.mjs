// Writes www/assets/start.bin: the problem the page opens on, as the solver itself would start it, so
// that the first frame can be drawn before the solver has come. Run after `npm run build`, whenever
// the sample or the random start changes: node www/prepare-start.mjs
import { readFileSync, writeFileSync } from 'node:fs';
import { DEFAULTS } from './page/address.js';
import { initSync } from '../pkg/core.js';

const here = (path) => new URL(path, import.meta.url);

/** The bytes of the prepared start (read by page/canvas.js). */
export function preparedStart(wasm = readFileSync(here('../pkg/single/foldfree_bg.wasm'))) {
  const foldfree = initSync(wasm);
  const mesh = foldfree.generate(DEFAULTS.sample, DEFAULTS.triangles);
  const { start, method, energy } = DEFAULTS;
  const solver = foldfree.parameterize(mesh, { start, method, energy, frames: 'f32' });
  const { positions, indices } = solver.mesh;
  const record = solver.start;
  const numbers = [record.energy, record.inverted, record.gradientNorm, record.smallestSigma, record.largestSigma];
  const parts = [
    Uint32Array.of(0x444c4f46, positions.length / 3, indices.length / 3, 0), // "FOLD", vertices, triangles
    Float64Array.from([...numbers, 0]),
    Float32Array.from(positions), indices, Float32Array.from(record.positions),
  ];
  return Buffer.concat(parts.map((part) => Buffer.from(part.buffer, part.byteOffset, part.byteLength)));
}

if (process.argv[1] === new URL(import.meta.url).pathname) {
  const bytes = preparedStart();
  writeFileSync(here('assets/start.bin'), bytes);
  console.log(`www/assets/start.bin: ${bytes.length} bytes`);
}
