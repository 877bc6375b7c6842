// What the client and the worker say to each other.
import type { PlainError } from './error.js';
import type {
  Certificate, FramePrecision, MeshArrays, MeshFormat, MeshInfo, ParameterizeOptions, Result, ShapeInfo, SolverInfo, Step, StepReport,
} from './types.js';

/** The calls a worker answers: arguments and result. */
export interface Calls {
  init: [{ threads: number; wasmUrl?: string | undefined; instance: number }, { threads: number; version: string; shapes: ShapeInfo[] }];
  /** Keeps a file's mesh under `mesh` and sends its arrays. */
  read: [{ mesh: number; bytes: Uint8Array; format: MeshFormat }, MeshInfo];
  /** Keeps a mesh given as arrays under `mesh`. */
  upload: [{ mesh: number; arrays: MeshArrays }, undefined];
  generate: [{ mesh: number; name: string; triangles: number }, MeshInfo];
  freeMesh: [{ mesh: number }, undefined];
  parameterize: [{ mesh: number; solver: number; options: ParameterizeOptions; frames: FramePrecision }, SolverInfo];
  step: [{ solver: number }, Step];
  run: [{ solver: number; run: number; maxIterations: number; minInterval: number }, Step];
  weights: [{ solver: number }, Float32Array];
  result: [{ solver: number }, Result];
  exportObj: [{ solver: number }, Uint8Array];
  freeSolver: [{ solver: number }, undefined];
  check: [{ mesh: number; uv: Float64Array }, Certificate];
  checkCorners: [{ mesh: number; corners: Float64Array }, Certificate];
  memory: [Record<string, never>, number];
}

export type CallName = keyof Calls;

/** Client → worker. */
export type ToWorker =
  | { [K in CallName]: { id: number; call: K; args: Calls[K][0] } }[CallName]
  /** The frame of a run was taken: the next may be sent. */
  | { acknowledge: number }
  /** End a run after its current step. */
  | { cancel: number };

/** Worker → client. */
export type FromWorker =
  | { id: number; value: unknown }
  | { id: number; error: PlainError }
  | { progress: { loaded: number; total: number } }
  /** The wasm is there, the pool of threads starts: from here on the time-out counts. */
  | { starting: true }
  | { run: number; frame: Step; reports: StepReport[] };
