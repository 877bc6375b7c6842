// Mixed-integer quadratic problems: what goes in and what comes out.
import type { MixedIntegerOptions, MixedIntegerReport, MixedIntegerStepReport } from './single/foldfree.js';
import type { StepReport } from './types.js';

export type { MixedIntegerOptions, MixedIntegerReport, MixedIntegerStepReport };
export type {
  Action as MixedIntegerAction, Engine as MixedIntegerEngine, Level as MixedIntegerLevel, LevelCounts, Rounded, Rounding, RowOutcome,
} from './single/foldfree.js';

/** A sparse matrix, entry by entry: `values[t]` stands at (`rows[t]`, `columns[t]`); values at the same place add up. */
export interface SparseTriplets {
  rows: Uint32Array;
  columns: Uint32Array;
  values: Float64Array;
}

/** A sparse matrix by columns (CSC): column j holds `rows` and `values` from `columnPointers[j]` to before `columnPointers[j + 1]`. */
export interface SparseColumns {
  /** Length: number of columns + 1. */
  columnPointers: Uint32Array;
  rows: Uint32Array;
  values: Float64Array;
}

/** Either of the two. */
export type SparseMatrix = SparseTriplets | SparseColumns;

/** Minimise ½ xᵀA x − bᵀx where C x + c = 0 and some unknowns are integers; indices begin at 0. */
export interface MixedIntegerArrays {
  /** A, n × n, symmetric (both triangles are given), positive definite where C x = 0. */
  matrix: SparseMatrix;
  /** b, length n. */
  linear: Float64Array;
  /** C, m × n, and c, length m; left out: none. */
  constraints?: SparseMatrix & { constants: Float64Array };
  /** The unknowns that have to be integers, each once; left out: none. */
  integers?: Uint32Array | readonly number[];
}

/** What a problem can be made of: the bytes or the text of a `.sys` file, or arrays. */
export type MixedIntegerData = Uint8Array | ArrayBuffer | string | MixedIntegerArrays;

/** A step with the unknowns it led to. */
export interface MixedIntegerStep extends MixedIntegerStepReport {
  /** All unknowns, length n: integers that have no value yet at their estimates, everything else at its best for that. */
  x: Float64Array;
}

/** What is known before the first step. */
export interface MixedIntegerInfo {
  /** Iteration 0: the relaxed solution, without integrality. */
  start: MixedIntegerStep;
  /** The unknowns that have to be integers, ascending. */
  integerUnknowns: Uint32Array;
  /** Seconds that elimination, ordering and factorisation took. */
  setupSeconds: number;
}

/** What `resolve` takes: what is left out stays. */
export interface MixedIntegerChange {
  /** Another b, length n. */
  linear?: Float64Array;
  /** Another c, length m. */
  constants?: Float64Array;
}

/** The solution; before the solver has ended, the newest iterate. */
export interface MixedIntegerResult {
  /** `max-iterations`: out of nodes before there was a proof. `stalled`: double precision does not carry the problem. */
  status: StepReport['status'];
  /** All unknowns, length n. */
  x: Float64Array;
  /** ½ xᵀA x − bᵀx. */
  energy: number;
  /** The values of the integer unknowns, in ascending order of the unknowns. */
  integers: Float64Array;
  /** Rounding `lattice`: no feasible point has less energy than this. */
  lowerBound?: number;
  /** `energy` − `lowerBound`. */
  gap?: number;
  /** Was every point excluded that would be better by more than rounding errors (`gap`)? */
  proven: boolean;
  /** What became of each constraint row, what each level of the solver did, sizes, times. */
  report: MixedIntegerReport;
}
