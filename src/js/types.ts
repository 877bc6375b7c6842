// The types that the synchronous core and the worker client share.
import type {
  Certificate, DeformationSettings, Field, LimOptions, LimSettings, ParameterizationOptions, ShapeInfo, SolidCertificate, Start,
  StepReport,
} from './single/foldfree.js';

export type {
  Certificate, DeformationSettings, Field, LimOptions, LimSettings, ParameterizationOptions, ShapeInfo, SolidCertificate, Start,
  StepReport,
};
export type {
  BoundaryCrossing, Criterion, CutPolicy, DeformationMethod, EnergyKind, LimEnergy, LimHessian, LimStep, Material, Method, Phase,
  PhaseKind,
} from './single/foldfree.js';

export type * from './mixed-integer-types.js';
export type * from './untangle-types.js';

/** What all methods say of a step. */
export interface Progress {
  /** 0 is the start, before any step. */
  iteration: number;
  /** Where the solver stands after the step. */
  status: StepReport['status'];
}

/** Options of `parameterize`; what is left out has the paper's value. */
export interface ParameterizeOptions extends ParameterizationOptions {
  /** Places for some vertices, each at most once. */
  landmarks?: readonly Landmark[];
}

/** A vertex and where its image is to be. */
export interface Landmark {
  /** The vertex, as the mesh numbers them; not one on a seam. */
  vertex: number;
  /** Where to, in the units of the mesh. */
  uv: readonly [number, number];
  /** Held there, instead of pulled (with `landmarkStiffness`). */
  hard?: boolean;
}

/** File formats that can be read. */
export type MeshFormat = 'obj' | 'off' | 'ply' | 'stl' | 'mesh' | 'msh' | 'vtk';

/** A triangle mesh as arrays. */
export interface MeshArrays {
  /** n × 3, interleaved. */
  positions: Float64Array;
  /** m × 3, 0-based; counter-clockwise seen from outside. */
  indices: Uint32Array;
}

/** Texture coordinates a file came with. */
export interface Texture {
  /** k × 2, interleaved. */
  coordinates: Float64Array;
  /** For every corner of every triangle (m × 3) the index of its coordinate. */
  corners: Uint32Array;
}

/** Everything JavaScript keeps of a mesh. */
export interface MeshInfo extends MeshArrays {
  /** What reading mended or noticed, in words. */
  notes: string[];
  /** Texture coordinates the file came with. */
  texture?: Texture;
}

/** What a mesh can be made of: a file's bytes or text, or arrays. */
export type MeshData = Uint8Array | ArrayBuffer | string | MeshArrays;

/** Precision of the positions that come with a step. */
export type FramePrecision = 'f32' | 'f64';

/** A step's report with the positions it led to. */
export interface Frame extends StepReport {
  /** The map, n × 2, or the deformed body, n × 3; interleaved, in the units of the input. */
  positions: Float64Array | Float32Array;
}

/** A step of a parameterization. */
export interface Step extends Frame {
  /** Symmetric Dirichlet density a triangle: 1 where isometric, infinite where inverted. */
  distortion: Float32Array;
}

/** What is known of a parameterization before its first step. */
export interface SolverInfo {
  /** Iteration 0. */
  start: Step;
  /** The disk that is flattened: the input, cut if it had to be; triangle i is the input's triangle i. */
  mesh: MeshArrays;
  /** For every vertex of that disk its index in the input mesh. */
  inputVertices: Uint32Array;
  /** Number of edges that were cut, 0 for a disk. */
  seamEdges: number;
  /** The start that was used: what `automatic` became. */
  startKind: Start;
  /** What was mended or chosen, in words. */
  notes: string[];
  /** Seconds that validation, cutting, the start and the factorisation took. */
  setupSeconds: number;
}

/** A finished map. */
export interface Result {
  /** The map, n × 2, interleaved, in the units of the input, one a vertex of the flattened disk. */
  uv: Float64Array;
  /** The exact checks of that map. */
  certificate: Certificate;
  /** For every vertex of the flattened disk its index in the input mesh. */
  inputVertices: Uint32Array;
}

/** File formats that hold tetrahedra. `node` takes the .ele file, too. */
export type SolidFormat = 'mesh' | 'msh' | 'vtk' | 'node';

/** A tetrahedral mesh as arrays. */
export interface SolidArrays {
  /** n × 3, interleaved. */
  positions: Float64Array;
  /** m × 4, 0-based. */
  tetrahedra: Uint32Array;
}

/** Everything JavaScript keeps of a solid. */
export interface SolidInfo extends SolidArrays {
  /** The triangles of its boundary, k × 3, counter-clockwise seen from outside. */
  surface: Uint32Array;
  /** What reading mended or noticed, in words. */
  notes: string[];
}

/** What a solid can be made of: a file's bytes or text, or arrays. */
export type SolidData = Uint8Array | ArrayBuffer | string | SolidArrays;

/** Where vertices are wanted: pinned ones are moved there, free ones pulled. */
export interface Targets {
  /** The vertices, k, each once. */
  vertices: Uint32Array;
  /** A point for each, k × 3, interleaved. */
  positions: Float64Array;
}

/** Handles and start of a deformation. */
export interface Handles {
  /** Vertices held where they start. */
  pins?: Uint32Array | readonly number[];
  /** Where it starts, n × 3, perhaps inverted; left out: at rest. */
  start?: Float64Array;
  /** Targets from the beginning. */
  targets?: Targets;
}

/** What options of every method have in common. */
interface Deforming extends Handles {
  /** The field that comes with each step (default `'distortion'`). */
  field?: Field;
}

/** Options of a solid of some material; what is left out has the paper's value. */
export type ElasticOptions = Partial<DeformationSettings> & Deforming;

/**
 * Options of locally injective mappings. The start must have no inverted elements, unless `barrier` is false; pinned
 * vertices are led to their targets step by step.
 */
export type LimDeformOptions = LimSettings & Deforming;

/** Options of `deform` for a solid: of a material, or, with `method: 'lim'`, of locally injective mappings. */
export type DeformOptions = ElasticOptions | (LimDeformOptions & { method: 'lim' });

/** A step of a deformation. */
export interface DeformStep extends Frame {
  /** The field that was asked for, one value an element; infinite where inverted. */
  field: Float32Array;
  /** Of locally injective mappings: where the step led the handles that have not arrived yet. */
  subTargets?: Targets;
}

/** What is known of a deformation before its first step. */
export interface DeformInfo {
  /** Iteration 0. */
  start: DeformStep;
  /** What was mended or chosen, in words. */
  notes: string[];
  /** Seconds that the checks and the factorisation took. */
  setupSeconds: number;
}

/** A deformed solid, or (with `Certificate`) triangles deformed in their plane. */
export interface DeformResult<C = SolidCertificate> {
  /** n × 3, interleaved. */
  positions: Float64Array;
  /** The exact checks of these positions. */
  certificate: C;
}

/** `Symbol.dispose`, also where the engine does not have it yet (`using` needs it). */
export const dispose: typeof Symbol.dispose = Symbol.dispose ?? Symbol.for('Symbol.dispose');
