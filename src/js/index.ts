// The package's front door: everything runs in a worker, with threads where the page may have them.
import { Client, type LoadOptions } from './client.js';
import { FoldfreeError } from './error.js';
import { cornerImages, fileBytes, isArrays, isSolidArrays, needFormat, needHandles, needSolidFormat } from './input.js';
import { Mesh, Solid } from './mesh.js';
import type { Calls } from './protocol.js';
import { MixedInteger } from './mixed-integer.js';
import { needProblem } from './mixed-integer-input.js';
import { Deformation, Solver, abortable, type Wait } from './solver.js';
import { Untangling } from './untangling.js';
import {
  dispose,
  type Certificate, type DeformOptions, type FramePrecision, type Handles, type LimDeformOptions, type MeshData, type MeshFormat, type MixedIntegerData,
  type MixedIntegerOptions, type MixedIntegerResult, type ParameterizeOptions,
  type ShapeInfo, type SolidCertificate, type SolidData, type SolidFormat, type UntangleOptions,
} from './types.js';

export { FoldfreeError } from './error.js';
export type { FrameListener, LoadOptions } from './client.js';
export { Mesh, Solid } from './mesh.js';
export { MixedInteger } from './mixed-integer.js';
export { Deformation, Solver } from './solver.js';
export { Untangling } from './untangling.js';
export type { RunOptions } from './solver.js';
export type * from './types.js';

/** What a call to `parameterize` takes besides the options of the method. */
export interface CallOptions {
  /** Precision of the positions of every step: `'f32'` is half the bytes, enough to draw (default `'f64'`). */
  frames?: FramePrecision;
  /** Aborts the building, and every later wait on this solver. The worker ends its current step first. */
  signal?: AbortSignal;
  /** On abort, end the worker at once instead of waiting for its current step. The next call starts another. */
  terminateOnAbort?: boolean;
}

/** What a call to `mixedInteger` takes besides the options of the method. */
export type MixedIntegerCallOptions = Partial<MixedIntegerOptions> & Omit<CallOptions, 'frames'>;

/** Loads the library into a worker. */
export async function load(options: LoadOptions = {}): Promise<Foldfree> {
  const client = new Client(options);
  try {
    const { threads, version, shapes, solidShapes } = await client.start();
    return new Foldfree(client, threads, version, shapes, solidShapes);
  } catch (error) {
    client.close();
    throw error;
  }
}

/** The library in its worker. `using` (or `terminate()`) ends the worker. */
export class Foldfree {
  readonly #client: Client;

  /** @internal */
  constructor(
    client: Client,
    /** Threads that parallel loops use. */
    readonly threads: number,
    /** Version of the library. */
    readonly version: string,
    /** The sample shapes `generate` makes. */
    readonly shapes: ShapeInfo[],
    /** The sample solids `generateSolid` makes. */
    readonly solidShapes: ShapeInfo[],
  ) {
    this.#client = client;
  }

  /**
   * Reads a mesh file (bytes, gzipped or not, or text; a format is needed), or takes arrays. What is
   * given is copied, not transferred.
   */
  async mesh(data: MeshData, format?: MeshFormat): Promise<Mesh> {
    const id = this.#client.newId();
    if (isArrays(data)) {
      const { positions, indices } = data;
      await this.#client.call('upload', { mesh: id, arrays: { positions, indices } });
      return new Mesh(this.#client, id, { positions: positions.slice(), indices: indices.slice(), notes: [] });
    }
    const known = needFormat(format);
    const bytes = await unzipped(fileBytes(data));
    return new Mesh(this.#client, id, await this.#client.call('read', { mesh: id, bytes, format: known }));
  }

  /** Generates a sample shape of about so many triangles; the names are those of `shapes`. */
  async generate(name: string, triangles: number): Promise<Mesh> {
    const id = this.#client.newId();
    return new Mesh(this.#client, id, await this.#client.call('generate', { mesh: id, name, triangles }));
  }

  /** Validates, cuts, computes the start and builds the solver: all that comes before the first step. */
  async parameterize(mesh: Mesh, options: ParameterizeOptions & CallOptions = {}): Promise<Solver> {
    const { frames = 'f64', signal, terminateOnAbort = false, ...rest } = options;
    signal?.throwIfAborted();
    const client = this.#client;
    const wait = abortable(client, signal, terminateOnAbort);
    const solver = client.newId();
    const make = async () => {
      const id = await mesh.inWorker();
      const { generation } = client;
      return { generation, info: await client.call('parameterize', { mesh: id, solver, options: rest, frames }) };
    };
    const { generation, info } = await wait(make());
    return new Solver(client, generation, solver, info, wait, signal);
  }

  /**
   * Reads a solid's file (bytes, gzipped or not, or text; a format is needed; `node` takes the .ele file, too),
   * or takes arrays. What is given is copied, not transferred.
   */
  async solid(data: SolidData, format?: SolidFormat, elements?: Uint8Array | ArrayBuffer | string): Promise<Solid> {
    const id = this.#client.newId();
    if (isSolidArrays(data)) {
      const { positions, tetrahedra } = data;
      return new Solid(this.#client, id, await this.#client.call('uploadSolid', { mesh: id, arrays: { positions, tetrahedra } }));
    }
    const known = needSolidFormat(format, elements);
    const bytes = await unzipped(fileBytes(data));
    const second = elements === undefined ? {} : { elements: await unzipped(fileBytes(elements)) };
    return new Solid(this.#client, id, await this.#client.call('readSolid', { mesh: id, bytes, format: known, ...second }));
  }

  /** Generates a sample solid of about so many tetrahedra; the names are those of `solidShapes`. */
  async generateSolid(name: string, tetrahedra: number): Promise<Solid> {
    const id = this.#client.newId();
    return new Solid(this.#client, id, await this.#client.call('generateSolid', { mesh: id, name, tetrahedra }));
  }

  /**
   * Checks rest shape, start and handles, and builds the solver: all that comes before the first step. Of a solid, or, by
   * locally injective mappings, of the triangles of a mesh in a plane z = constant.
   */
  deform(body: Solid, options?: DeformOptions & CallOptions): Promise<Deformation>;
  deform(body: Mesh, options?: LimDeformOptions & CallOptions): Promise<Deformation<Certificate>>;
  async deform(
    body: Solid | Mesh, options: (DeformOptions | LimDeformOptions) & CallOptions = {},
  ): Promise<Deformation | Deformation<Certificate>> {
    const { signal, generation, solver, info, wait } = await this.#onBody('deform', body, options);
    return new Deformation(this.#client, generation, solver, info, wait, signal) as Deformation | Deformation<Certificate>;
  }

  /**
   * Checks rest shape, start and handles, and builds the solver that leads from any start to a map without inverted
   * elements: of a solid, or of the triangles of a mesh in a plane z = constant. When it has converged nothing is
   * inverted by exact predicates; where pins leave no room it ends with the best it has found, and says why.
   */
  untangle(body: Solid, options?: UntangleOptions & CallOptions): Promise<Untangling>;
  untangle(body: Mesh, options?: UntangleOptions & CallOptions): Promise<Untangling<Certificate>>;
  async untangle(body: Solid | Mesh, options: UntangleOptions & CallOptions = {}): Promise<Untangling | Untangling<Certificate>> {
    const { signal, generation, solver, info, wait } = await this.#onBody('untangle', body, options);
    return new Untangling(this.#client, generation, solver, info, wait, signal) as Untangling | Untangling<Certificate>;
  }

  /** Builds a solver with handles in the worker. */
  async #onBody<K extends 'deform' | 'untangle'>(
    call: K, body: Solid | Mesh, options: Calls[K][0]['options'] & CallOptions,
  ): Promise<{ signal: AbortSignal | undefined; generation: number; solver: number; info: Calls[K][1]; wait: Wait }> {
    const { frames = 'f64', signal, terminateOnAbort = false, ...rest } = options;
    needHandles(rest as Handles);
    signal?.throwIfAborted();
    const client = this.#client;
    const wait = abortable(client, signal, terminateOnAbort);
    const solver = client.newId();
    const make = async () => {
      const mesh = await body.inWorker();
      const { generation } = client;
      const info: Calls[K][1] = await client.call(call, { mesh, solver, options: rest, frames } as Calls[K][0]);
      return { generation, info };
    };
    return { signal, solver, wait, ...await wait(make()) };
  }

  /**
   * Checks a mixed-integer problem (arrays, or a `.sys` file, gzipped or not), eliminates its constraints, factors,
   * and solves it without integrality: all that comes before the first rounding. What is given is copied.
   */
  async mixedInteger(data: MixedIntegerData, options: MixedIntegerCallOptions = {}): Promise<MixedInteger> {
    const { signal, terminateOnAbort = false, ...rest } = options;
    const given = needProblem(data);
    signal?.throwIfAborted();
    const client = this.#client;
    const wait = abortable(client, signal, terminateOnAbort);
    const solver = client.newId();
    const make = async () => {
      const input = 'bytes' in given ? { bytes: await unzipped(given.bytes) } : given;
      await client.start();
      const { generation } = client;
      return { generation, info: await client.call('mixedInteger', { solver, input, options: rest }) };
    };
    const { generation, info } = await wait(make());
    return new MixedInteger(client, generation, solver, info, wait, signal);
  }

  /** Solves a mixed-integer problem; `mixedInteger` is the same step by step. */
  async solveMixedInteger(data: MixedIntegerData, options: MixedIntegerCallOptions = {}): Promise<MixedIntegerResult> {
    const solver = await this.mixedInteger(data, options);
    try {
      await solver.run({ minInterval: Infinity });
      return await solver.result();
    } finally {
      solver.free();
    }
  }

  /**
   * Checks a map that came from anywhere: `uv` is n × 2, interleaved, one a vertex of `mesh`; left out, it is
   * the texture coordinates `mesh` came with.
   */
  async check(mesh: Mesh, uv?: Float64Array): Promise<Certificate> {
    const id = await mesh.inWorker();
    if (uv === undefined) return this.#client.call('checkCorners', { mesh: id, corners: cornerImages(mesh) });
    return this.#client.call('check', { mesh: id, uv });
  }

  /** Checks a deformation that came from anywhere: `positions` is n × 3, interleaved; `solid` is the rest shape. */
  async checkSolid(solid: Solid, positions: Float64Array): Promise<SolidCertificate> {
    return this.#client.call('checkSolid', { mesh: await solid.inWorker(), positions });
  }

  /** Bytes of wasm memory; it never shrinks, so this is also its peak. */
  memoryBytes(): Promise<number> {
    return this.#client.call('memory', {});
  }

  /** Ends the worker, in the middle of a step if need be. */
  terminate(): void {
    this.#client.close();
  }

  [dispose](): void {
    this.terminate();
  }
}

/** The bytes with gzip undone. */
async function unzipped(bytes: Uint8Array): Promise<Uint8Array> {
  if (!(bytes[0] === 0x1f && bytes[1] === 0x8b)) return bytes;
  const stream = new Blob([bytes as Uint8Array<ArrayBuffer>]).stream().pipeThrough(new DecompressionStream('gzip'));
  try {
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch (error) {
    throw new FoldfreeError('parse', 'the gzip stream is damaged or ends early', {}, { cause: error });
  }
}
