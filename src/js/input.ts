// What people hand in as a mesh.
import { FoldfreeError } from './error.js';
import type { MeshArrays, MeshData, MeshFormat, MeshInfo } from './types.js';

/** Arrays, rather than a file's bytes or text? Anything else is an error. */
export function isArrays(data: MeshData): data is MeshArrays {
  if (typeof data === 'string' || data instanceof Uint8Array || data instanceof ArrayBuffer) return false;
  if (data?.positions instanceof Float64Array && data.indices instanceof Uint32Array) return true;
  throw new FoldfreeError(
    'invalid-argument',
    'mesh: bytes, text, or { positions: Float64Array, indices: Uint32Array } is needed',
  );
}

/** The format, which a file's bytes or text need. */
export function needFormat(format: MeshFormat | undefined): MeshFormat {
  if (format === undefined) throw new FoldfreeError('invalid-argument', 'format: "obj", "off", "ply", "stl", "mesh", "msh" or "vtk" is needed');
  return format;
}

/** A file's bytes, of bytes or text. */
export function fileBytes(data: Uint8Array | ArrayBuffer | string): Uint8Array {
  if (typeof data === 'string') return new TextEncoder().encode(data);
  return data instanceof Uint8Array ? data : new Uint8Array(data);
}

/** The image of every corner of every triangle (m × 3 × 2) by the texture coordinates of a mesh. */
export function cornerImages({ texture }: MeshInfo): Float64Array {
  if (!texture) throw new FoldfreeError('invalid-argument', 'uv: the mesh has no texture coordinates, so a map is needed');
  const { coordinates, corners } = texture;
  const images = new Float64Array(2 * corners.length);
  corners.forEach((index, corner) => images.set(coordinates.subarray(2 * index, 2 * index + 2), 2 * corner));
  return images;
}
