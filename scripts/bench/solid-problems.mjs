// The solids that are measured: the quasi-static problems of a folder, if there is one, and a generated bar.
import { existsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { readPins } from '../foldfree-wasm/handles.mjs';
import { core } from '../foldfree-wasm/core.mjs';
import { readPositions, readSolid, writeDeformed, writeSolid } from '../foldfree-wasm/solids.mjs';

/** The folder's problems; `authors` are milliseconds an iteration of the authors' C++ program, one thread, as published with the problems: cited, for the order of magnitude. */
const AUTHORS = [
  { name: 'shear', authors: 49 },
  { name: 'untwist', authors: 101 },
  { name: 'homer', authors: 183 },
];

/** How far along x every vertex is: 0 at one end of the solid, 1 at the other. */
function alongX(positions) {
  const xs = positions.filter((_, i) => i % 3 === 0);
  const low = xs.reduce((a, b) => Math.min(a, b));
  const high = xs.reduce((a, b) => Math.max(a, b));
  return Array.from(xs, (x) => (x - low) / (high - low));
}

/**
 * A bar that lies as at rest with both ends, which are held, and is turned between them by up to a turn and a half
 * about its axis: its solution is its rest shape.
 */
function twistedBar(work, tetrahedra) {
  const bar = core.generateSolid('bar', tetrahedra);
  const path = (name) => join(work, `bar-${tetrahedra}-${name}`);
  const along = alongX(bar.positions);
  const ends = [...along.keys()].filter((v) => along[v] < 1e-9 || along[v] > 1 - 1e-9);
  const start = bar.positions.slice();
  along.forEach((t, v) => {
    const angle = 3 * Math.PI * Math.sin(Math.PI * t) ** 2;
    const [, y, z] = bar.positions.subarray(3 * v, 3 * v + 3);
    start[3 * v + 1] = Math.cos(angle) * y - Math.sin(angle) * z;
    start[3 * v + 2] = Math.sin(angle) * y + Math.cos(angle) * z;
  });
  writeSolid(path('rest.node'), bar);
  writeDeformed(path('init.node'), bar, start);
  writeFileSync(path('pins.txt'), `${ends.join('\n')}\n`);
  return {
    name: `twisted bar ${tetrahedra / 1000}k`,
    rest: path('rest.node'), init: path('init.node'), pins: path('pins.txt'), reference: path('rest.node'),
  };
}

/** All problems, as the command line takes them. */
export function solidProblems({ work }, folder, tetrahedra) {
  const found = AUTHORS.filter(({ name }) => existsSync(join(folder, name)));
  return [
    ...found.map(({ name, authors }) => {
      const path = (file) => join(folder, name, file);
      return { name, authors, rest: path('rest.node'), init: path('init.node'), pins: path('handles.txt'), reference: path('nh_soln.node') };
    }),
    twistedBar(work, tetrahedra),
  ];
}

/** The same problem for a page: its arrays as files of the work folder, by name. */
export function filesForPage({ work }, { name, rest, init, pins }) {
  const solid = readSolid(rest);
  const arrays = {
    positions: solid.positions,
    tetrahedra: solid.tetrahedra,
    start: readPositions(init),
    pins: Uint32Array.from(readPins(pins, solid.vertexCount)),
  };
  solid.free();
  return Object.fromEntries(Object.entries(arrays).map(([key, array]) => {
    const file = `${name.replace(/\W+/g, '-')}-${key}.bin`;
    writeFileSync(join(work, file), new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
    return [key, file];
  }));
}
