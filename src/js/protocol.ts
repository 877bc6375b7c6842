// What the client and the worker say to each other.
import type { PlainError } from './error.js';
import type { MixedIntegerInput } from './mixed-integer-input.js';
import type {
  Certificate, DeformInfo, DeformOptions, DeformResult, Field, Frame, FramePrecision, LimDeformOptions, MeshArrays, MeshFormat, MeshInfo, MixedIntegerChange,
  MixedIntegerInfo, MixedIntegerOptions, MixedIntegerReport, MixedIntegerResult, MixedIntegerStep, MixedIntegerStepReport, ParameterizeOptions, Result, ShapeInfo, SolidArrays,
  SolidCertificate, SolidFormat, SolidInfo, SolverInfo, StepReport, Targets, UntangleInfo, UntangleOptions, UntangleResult,
} from './types.js';

/** What is known of the library once it is loaded. */
export interface Loaded {
  threads: number;
  version: string;
  shapes: ShapeInfo[];
  solidShapes: ShapeInfo[];
}

/** What a step leads to. */
export type AnyFrame = Frame | MixedIntegerStep;
/** The same without positions or unknowns. */
export type AnyReport = StepReport | MixedIntegerStepReport;

/** The calls a worker answers: arguments and result. */
export interface Calls {
  init: [{ threads: number; wasmUrl?: string | undefined; instance: number }, Loaded];
  /** Keeps a file's mesh under `mesh` and sends its arrays. */
  read: [{ mesh: number; bytes: Uint8Array; format: MeshFormat }, MeshInfo];
  /** Keeps a mesh given as arrays under `mesh`. */
  upload: [{ mesh: number; arrays: MeshArrays }, undefined];
  generate: [{ mesh: number; name: string; triangles: number }, MeshInfo];
  freeMesh: [{ mesh: number }, undefined];
  parameterize: [{ mesh: number; solver: number; options: ParameterizeOptions; frames: FramePrecision }, SolverInfo];
  /** Keeps a solid's file under `mesh` and sends its arrays. */
  readSolid: [{ mesh: number; bytes: Uint8Array; format: SolidFormat; elements?: Uint8Array }, SolidInfo];
  /** Keeps a solid given as arrays under `mesh`. */
  uploadSolid: [{ mesh: number; arrays: SolidArrays }, SolidInfo];
  generateSolid: [{ mesh: number; name: string; tetrahedra: number }, SolidInfo];
  /** A file of a mesh or solid with its vertices elsewhere. */
  write: [{ mesh: number; format: MeshFormat; positions: Float64Array | undefined }, Uint8Array];
  /** `mesh` is a solid, or a surface that lies in a plane. */
  deform: [{ mesh: number; solver: number; options: DeformOptions | LimDeformOptions; frames: FramePrecision }, DeformInfo];
  setTargets: [{ solver: number; targets: Targets }, undefined];
  setField: [{ solver: number; field: Field }, undefined];
  checkSolid: [{ mesh: number; positions: Float64Array }, SolidCertificate];
  deformed: [{ solver: number }, DeformResult<SolidCertificate | Certificate>];
  /** `mesh` is a solid, or a surface that lies in a plane. */
  untangle: [{ mesh: number; solver: number; options: UntangleOptions; frames: FramePrecision }, UntangleInfo];
  movePins: [{ solver: number; targets: Targets }, undefined];
  primaryPositions: [{ solver: number }, Float64Array];
  untangled: [{ solver: number }, UntangleResult<SolidCertificate | Certificate>];
  mixedInteger: [{ solver: number; input: MixedIntegerInput; options: Partial<MixedIntegerOptions> }, MixedIntegerInfo];
  resolve: [{ solver: number; change: MixedIntegerChange }, MixedIntegerStep];
  solved: [{ solver: number }, MixedIntegerResult];
  mixedIntegerReport: [{ solver: number }, MixedIntegerReport];
  step: [{ solver: number }, AnyFrame];
  run: [{ solver: number; run: number; maxIterations: number; minInterval: number }, AnyFrame];
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
  | { run: number; frame: AnyFrame; reports: AnyReport[] };
