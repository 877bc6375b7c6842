// What people hand in as a mesh.
import { FoldfreeError } from './error.js';
import type {
  Handles, Landmark, MeshArrays, MeshData, MeshFormat, MeshInfo, SolidArrays, SolidData, SolidFormat, Targets,
} from './types.js';

/** Arrays, rather than a file's bytes or text? Anything else is an error. */
export function isArrays(data: MeshData): data is MeshArrays {
  if (typeof data === 'string' || data instanceof Uint8Array || data instanceof ArrayBuffer) return false;
  if (data?.positions instanceof Float64Array && data.indices instanceof Uint32Array) return true;
  throw new FoldfreeError(
    'invalid-argument',
    'mesh: bytes, text, or { positions: Float64Array, indices: Uint32Array } is needed',
  );
}

/** The same of a solid. */
export function isSolidArrays(data: SolidData): data is SolidArrays {
  if (typeof data === 'string' || data instanceof Uint8Array || data instanceof ArrayBuffer) return false;
  if (data?.positions instanceof Float64Array && data.tetrahedra instanceof Uint32Array) return true;
  throw new FoldfreeError(
    'invalid-argument',
    'solid: bytes, text, or { positions: Float64Array, tetrahedra: Uint32Array } is needed',
  );
}

/** The format of a solid's file, and the bytes that go with it. */
export function needSolidFormat(format: SolidFormat | undefined, elements: unknown): SolidFormat {
  if (format === undefined) throw new FoldfreeError('invalid-argument', 'format: "mesh", "msh", "vtk" or "node" is needed');
  if ((format === 'node') !== (elements !== undefined)) {
    throw new FoldfreeError('invalid-argument', 'elements: the .ele file goes with format "node", and with no other');
  }
  return format;
}

/** Checks the kinds of handles, and fills in what is left out. */
export function needHandles({ pins = [], start, targets }: Handles): { pins: Uint32Array; start?: Float64Array; targets: Targets } {
  const wrong = (what: string) => new FoldfreeError('invalid-argument', what);
  const whole = (v: unknown) => Number.isInteger(v) && (v as number) >= 0 && (v as number) < 2 ** 32;
  if (!(pins instanceof Uint32Array) && !(Array.isArray(pins) && pins.every(whole))) {
    throw wrong('pins: a Uint32Array, or an array of vertex indices, is needed');
  }
  if (start !== undefined && !(start instanceof Float64Array)) throw wrong('start: a Float64Array is needed');
  return {
    pins: Uint32Array.from(pins),
    ...(start && { start }),
    targets: needTargets(targets ?? { vertices: new Uint32Array(), positions: new Float64Array() }),
  };
}

/** Checks the kinds of landmarks, and takes them apart. */
export function needLandmarks(landmarks: readonly Landmark[]): { vertices: Uint32Array; places: Float64Array; hard: Uint8Array } {
  const whole = (v: unknown) => Number.isInteger(v) && (v as number) >= 0 && (v as number) < 2 ** 32;
  const number = (x: unknown) => typeof x === 'number';
  if (!Array.isArray(landmarks)) {
    throw new FoldfreeError('invalid-argument', 'landmarks: an array of { vertex, uv: [u, v], hard } is needed');
  }
  landmarks.forEach((landmark: Landmark, i) => {
    const fits = whole(landmark?.vertex) && Array.isArray(landmark.uv) && landmark.uv.length === 2 && landmark.uv.every(number);
    if (!fits) throw new FoldfreeError('invalid-argument', `landmarks: number ${i} is not { vertex, uv: [u, v], hard }`);
  });
  return {
    vertices: Uint32Array.from(landmarks, ({ vertex }) => vertex),
    places: Float64Array.from(landmarks.flatMap(({ uv }) => [...uv])),
    hard: Uint8Array.from(landmarks, ({ hard }) => (hard ? 1 : 0)),
  };
}

/** Checks the kinds of targets. */
export function needTargets(targets: Targets): Targets {
  if (targets?.vertices instanceof Uint32Array && targets.positions instanceof Float64Array) {
    return { vertices: targets.vertices, positions: targets.positions };
  }
  throw new FoldfreeError('invalid-argument', 'targets: { vertices: Uint32Array, positions: Float64Array } is needed');
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
