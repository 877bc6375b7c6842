// Files in and out, gzipped or not.
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { dirname } from 'node:path';
import { gunzipSync, gzipSync } from 'node:zlib';
import { core } from './core.mjs';
import { Failure, of } from './failure.mjs';

/** Formats of one file; a solid's boundary can be written in all of them. */
export const FORMATS = ['obj', 'off', 'ply', 'stl', 'mesh', 'msh', 'vtk'];

/** The format that a name stands for, of those in `known`, or undefined. */
export function formatOf(path, known = FORMATS) {
  const ending = /\.([^./\\]+?)(\.gz)?$/i.exec(path)?.[1].toLowerCase();
  return known.find((format) => format === ending);
}

/** Fails for a name whose format is not known. */
export function unknownFormat(path, known) {
  const names = known.map((format) => `.${format}`).join(', ');
  return new Failure(`${path}: the format is not known by this name (known: ${names}, also with .gz)`);
}

/** All bytes of a file, decompressed if they begin as gzip does. */
export function readBytes(path) {
  return of(path, () => {
    const bytes = readFileSync(path);
    return bytes[0] === 0x1f && bytes[1] === 0x8b ? gunzipSync(bytes) : bytes;
  });
}

/** Reads a mesh, by the ending of the file's name. */
export function readMesh(path) {
  const format = formatOf(path);
  if (!format) throw unknownFormat(path, FORMATS);
  const bytes = readBytes(path);
  return of(path, () => core.mesh(bytes, format));
}

const isFolder = (path) => statSync(path, { throwIfNoEntry: false })?.isDirectory() ?? false;

/** Fails when one of these files, where there is one, cannot be written: said before the work rather than after. */
export function checkWritable(...paths) {
  for (const path of paths.filter((one) => one !== undefined)) {
    if (isFolder(path)) throw new Failure(`${path}: is a folder`);
    if (!isFolder(dirname(path))) throw new Failure(`${path}: its folder does not exist`);
  }
}

/** Writes a file, compressed if its name ends in .gz. */
export function write(path, bytes) {
  of(path, () => writeFileSync(path, /\.gz$/i.test(path) ? gzipSync(bytes) : bytes));
}
