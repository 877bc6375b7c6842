// The package's front door: everything runs in a worker, with threads where the page may have them.
import { Client, type FrameListener, type LoadOptions } from './client.js';
import { FoldfreeError } from './error.js';
import { cornerImages, fileBytes, isArrays, needFormat } from './input.js';
import {
  dispose,
  type Certificate, type FramePrecision, type MeshArrays, type MeshData, type MeshFormat, type MeshInfo,
  type ParameterizeOptions, type Result, type ShapeInfo, type SolverInfo, type Step, type Texture,
} from './types.js';

export { FoldfreeError } from './error.js';
export type { FrameListener, LoadOptions } from './client.js';
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

/** What `Solver.run` takes. */
export interface RunOptions {
  /** Gets the newest iterate and the reports of all iterations since the last frame. */
  onFrame?: FrameListener;
  /** Stop after so many iterations more. */
  maxIterations?: number;
  /** Milliseconds between frames, at least (default 0: as fast as they are taken). */
  minInterval?: number;
}

/** Loads the library into a worker. */
export async function load(options: LoadOptions = {}): Promise<Foldfree> {
  const client = new Client(options);
  try {
    const { threads, version, shapes } = await client.start();
    return new Foldfree(client, threads, version, shapes);
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
   * Checks a map that came from anywhere: `uv` is n × 2, interleaved, one a vertex of `mesh`; left out, it is
   * the texture coordinates `mesh` came with.
   */
  async check(mesh: Mesh, uv?: Float64Array): Promise<Certificate> {
    const id = await mesh.inWorker();
    if (uv === undefined) return this.#client.call('checkCorners', { mesh: id, corners: cornerImages(mesh) });
    return this.#client.call('check', { mesh: id, uv });
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

/** A mesh: its arrays here, and its copy in the worker, which is made anew after a restart. */
export class Mesh implements MeshInfo {
  readonly positions: Float64Array;
  readonly indices: Uint32Array;
  readonly notes: string[];
  readonly texture?: Texture;
  readonly #client: Client;
  #id: number;
  #generation: number;
  #freed = false;

  /** @internal */
  constructor(client: Client, id: number, info: MeshInfo) {
    this.#client = client;
    this.#id = id;
    this.#generation = client.generation;
    this.positions = info.positions;
    this.indices = info.indices;
    this.notes = info.notes;
    if (info.texture) this.texture = info.texture;
  }

  get vertexCount(): number {
    return this.positions.length / 3;
  }

  get triangleCount(): number {
    return this.indices.length / 3;
  }

  /** @internal The mesh's number in the worker that runs now. */
  async inWorker(): Promise<number> {
    if (this.#freed) throw new FoldfreeError('freed', 'this mesh was freed');
    await this.#client.start();
    if (this.#generation !== this.#client.generation) {
      this.#id = this.#client.newId();
      this.#generation = this.#client.generation;
      const { positions, indices } = this;
      await this.#client.call('upload', { mesh: this.#id, arrays: { positions, indices } });
    }
    return this.#id;
  }

  /** Gives its memory in the worker back. */
  free(): void {
    if (this.#freed) return;
    this.#freed = true;
    if (this.#generation === this.#client.generation) {
      this.#client.callIn(this.#generation, 'freeMesh', { mesh: this.#id }).catch(() => {});
    }
  }

  [dispose](): void {
    this.free();
  }
}

type Wait = <T>(work: Promise<T>) => Promise<T>;

/** A map being computed in the worker. */
export class Solver implements SolverInfo, AsyncIterable<Step> {
  readonly start: Step;
  readonly mesh: MeshArrays;
  readonly inputVertices: Uint32Array;
  readonly seamEdges: number;
  readonly startKind: SolverInfo['startKind'];
  readonly notes: string[];
  readonly setupSeconds: number;
  readonly #client: Client;
  readonly #generation: number;
  readonly #id: number;
  readonly #wait: Wait;
  readonly #signal: AbortSignal | undefined;
  #run: number | undefined;
  #status: Step['status'];
  #cancelled = false;
  #freed = false;

  /** @internal */
  constructor(client: Client, generation: number, id: number, info: SolverInfo, wait: Wait, signal: AbortSignal | undefined) {
    this.#client = client;
    this.#generation = generation;
    this.#id = id;
    this.#wait = wait;
    this.#signal = signal;
    this.start = info.start;
    this.mesh = info.mesh;
    this.inputVertices = info.inputVertices;
    this.seamEdges = info.seamEdges;
    this.startKind = info.startKind;
    this.notes = info.notes;
    this.setupSeconds = info.setupSeconds;
    this.#status = info.start.status;
  }

  /** The status after the newest step. */
  get status(): Step['status'] {
    return this.#status;
  }

  /** One iteration of the method. */
  async step(): Promise<Step> {
    const step = await this.#call('step');
    this.#status = step.status;
    return step;
  }

  /**
   * Steps until the status is no longer `running`, without waiting for this thread: frames come as fast
   * as `onFrame` takes them, iterations as fast as they can be computed. Resolves with the last step.
   */
  async run({ onFrame, maxIterations = Infinity, minInterval = 0 }: RunOptions = {}): Promise<Step> {
    if (this.#run !== undefined) throw new FoldfreeError('busy', 'this solver is running already');
    this.#mustLive();
    const run = this.#client.newId();
    this.#run = run;
    this.#cancelled = false;
    const stop = () => this.#client.cancel(run);
    this.#signal?.addEventListener('abort', stop, { once: true });
    try {
      const args = { solver: this.#id, run, maxIterations, minInterval };
      const last = await this.#wait(this.#client.run(args, this.#generation, onFrame));
      this.#status = last.status === 'cancelled' ? 'running' : last.status;
      return last;
    } finally {
      this.#run = undefined;
      this.#signal?.removeEventListener('abort', stop);
    }
  }

  /** Steps, one at a time, until the status is no longer `running`, or `cancel()` is called. */
  async *[Symbol.asyncIterator](): AsyncGenerator<Step, void, undefined> {
    this.#cancelled = false;
    while (this.#status === 'running' && !this.#cancelled) yield await this.step();
  }

  /** The newest map with its certificate. */
  result(): Promise<Result> {
    return this.#call('result');
  }

  /** Weight over rest weight a triangle; empty where the method has no weights. */
  weights(): Promise<Float32Array> {
    return this.#call('weights');
  }

  /** The input surface as an OBJ file with the map as texture coordinates. */
  exportObj(): Promise<Uint8Array> {
    return this.#call('exportObj');
  }

  /** Ends a run or an iteration after the current step. The solver stays usable. */
  cancel(): void {
    this.#cancelled = true;
    if (this.#run !== undefined) this.#client.cancel(this.#run);
  }

  /** Gives its memory in the worker back. */
  free(): void {
    if (this.#freed) return;
    this.#freed = true;
    this.cancel();
    this.#client.callIn(this.#generation, 'freeSolver', { solver: this.#id }).catch(() => {});
  }

  [dispose](): void {
    this.free();
  }

  #mustLive(): void {
    if (this.#freed) throw new FoldfreeError('freed', 'this solver was freed');
    this.#signal?.throwIfAborted();
  }

  async #call<K extends 'step' | 'result' | 'weights' | 'exportObj'>(call: K) {
    this.#mustLive();
    return this.#wait(this.#client.callIn(this.#generation, call, { solver: this.#id }));
  }
}

/** Makes waits reject with the signal's reason as soon as it aborts, and ends the worker if asked. */
function abortable(client: Client, signal: AbortSignal | undefined, terminate: boolean): Wait {
  if (!signal) return (work) => work;
  return (work) =>
    new Promise((resolve, reject) => {
      const abort = () => {
        reject(signal.reason);
        if (terminate) client.restart(new FoldfreeError('worker-lost', 'the worker was ended by an abort'));
      };
      signal.addEventListener('abort', abort, { once: true });
      work.then(resolve, reject).finally(() => signal.removeEventListener('abort', abort));
    });
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
