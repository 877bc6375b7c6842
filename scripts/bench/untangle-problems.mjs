// The folded bodies that are measured: the problems of a folder, if there is one, and generated boxes, twisted.
import { existsSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { HELD, problemOf } from '../../www/page/untangle-problems.js';
import { readPins } from '../foldfree-wasm/handles.mjs';
import { core } from '../foldfree-wasm/core.mjs';
import { readMesh } from '../foldfree-wasm/files.mjs';
import { isSolid, readPositions, readSolid, writeDeformed, writeSolid } from '../foldfree-wasm/solids.mjs';

/** Seconds to injectivity in the paper (table 3: 8 cores, another machine): cited, not measured here. */
const PUBLISHED = { elephant_2k: 0.051, elephant_30k: 0.173, bar12k: 0.179, bar30k: 0.444, wrench: 0.669 };

/** A box, all of its outside held where a twist takes it, the inside at random. */
export function twistedBox(work, tetrahedra) {
  const box = core.generateSolid('box', tetrahedra);
  const { pins, start } = problemOf(box, { held: 'twisted', start: 'random' });
  const path = (name) => join(work, `box-${tetrahedra}-${name}`);
  writeSolid(path('rest.node'), box);
  writeDeformed(path('init.node'), box, start);
  writeFileSync(path('pins.txt'), `${pins.join('\n')}\n`);
  const name = `${tetrahedra >= 1e6 ? `${tetrahedra / 1e6}M` : `${tetrahedra / 1000}k`} twisted box`;
  return { name, tetrahedra: box.tetrahedronCount, held: HELD.twisted.title, rest: path('rest.node'), init: path('init.node'), pins: path('pins.txt') };
}

/** The problems of the folder, as the command line takes them. */
export function givenProblems(folder) {
  return Object.keys(PUBLISHED).filter((name) => existsSync(join(folder, name))).map((name) => {
    const path = (file) => join(folder, name, file);
    return { name, published: PUBLISHED[name], rest: path('rest.mesh.gz'), init: path('init.mesh.gz'), pins: path('pins.txt') };
  });
}

/** The same problem for a page: its arrays as files of the work folder, by name. */
export function filesForPage({ work }, { name, rest, init, pins }) {
  const solid = isSolid(rest);
  const body = solid ? readSolid(rest) : readMesh(rest);
  const arrays = {
    positions: body.positions,
    elements: solid ? body.tetrahedra : body.indices,
    start: solid ? readPositions(init) : readMesh(init).positions,
    pins: Uint32Array.from(readPins(pins, body.vertexCount)),
  };
  body.free();
  return {
    solid,
    ...Object.fromEntries(Object.entries(arrays).map(([key, array]) => {
      const file = `${name.replace(/\W+/g, '-')}-${key}.bin`;
      writeFileSync(join(work, file), new Uint8Array(array.buffer, array.byteOffset, array.byteLength));
      return [key, file];
    })),
  };
}
