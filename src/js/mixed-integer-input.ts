// What people hand in as a mixed-integer problem.
import { FoldfreeError } from './error.js';
import { fileBytes } from './input.js';
import type { MixedIntegerArrays, MixedIntegerChange, MixedIntegerData, SparseMatrix, SparseTriplets } from './mixed-integer-types.js';

/** A problem of which every list is there, and every matrix is triplets. */
export interface MixedIntegerTriplets {
  matrix: SparseTriplets;
  linear: Float64Array;
  constraints: SparseTriplets & { constants: Float64Array };
  integers: Uint32Array;
}

/** A `.sys` file's bytes, or a checked problem. */
export type MixedIntegerInput = { bytes: Uint8Array } | { problem: MixedIntegerTriplets };

const wrong = (what: string) => new FoldfreeError('invalid-argument', what);

function needLength(name: string, found: number, expected: number): void {
  if (found !== expected) throw wrong(`${name}: the length is ${found}, expected ${expected}`);
}

/** The entries of a matrix of so many columns one by one. */
function triplets(name: string, matrix: SparseMatrix, width: number): SparseTriplets {
  const { rows, values } = matrix;
  const places = 'columnPointers' in matrix ? matrix.columnPointers : matrix.columns;
  if (!(rows instanceof Uint32Array && places instanceof Uint32Array && values instanceof Float64Array)) {
    throw wrong(`${name}: { rows, columns or columnPointers: Uint32Array, values: Float64Array } is needed`);
  }
  needLength(`${name}.values`, values.length, rows.length);
  if (!('columnPointers' in matrix)) {
    needLength(`${name}.columns`, places.length, rows.length);
    return { rows, columns: places, values };
  }
  needLength(`${name}.columnPointers`, places.length, width + 1);
  if (places[0] !== 0) throw wrong(`${name}.columnPointers: the first is ${places[0]}, expected 0`);
  const columns = new Uint32Array(rows.length);
  for (let column = 0; column < width; column++) {
    const [begin, end] = [places[column] as number, places[column + 1] as number];
    if (end < begin || end > rows.length) {
      throw wrong(`${name}.columnPointers: number ${column + 1} is ${end}, expected ${begin} to ${rows.length}`);
    }
    columns.fill(column, begin, end);
  }
  needLength(`${name}.rows`, rows.length, places[width] as number);
  return { rows, columns, values };
}

/** Checks the kinds and the lengths of what describes a problem. */
export function needProblem(data: MixedIntegerData): MixedIntegerInput {
  if (typeof data === 'string' || data instanceof Uint8Array || data instanceof ArrayBuffer) return { bytes: fileBytes(data) };
  const { matrix, linear, constraints, integers = [] } = (data ?? {}) as MixedIntegerArrays;
  if (!(linear instanceof Float64Array) || typeof matrix !== 'object' || matrix === null) {
    throw wrong('problem: bytes or text of a .sys file, or { matrix, linear: Float64Array } is needed');
  }
  const whole = (v: unknown) => Number.isInteger(v) && (v as number) >= 0 && (v as number) < 2 ** 32;
  if (!(integers instanceof Uint32Array) && !(Array.isArray(integers) && integers.every(whole))) {
    throw wrong('integers: a Uint32Array, or an array of indices of unknowns, is needed');
  }
  const none = { rows: new Uint32Array(), columns: new Uint32Array(), values: new Float64Array(), constants: new Float64Array() };
  const { constants } = constraints ?? none;
  if (!(constants instanceof Float64Array)) throw wrong('constraints.constants: a Float64Array is needed');
  return {
    problem: {
      matrix: triplets('matrix', matrix, linear.length),
      linear,
      constraints: { ...triplets('constraints', constraints ?? none, linear.length), constants },
      integers: Uint32Array.from(integers),
    },
  };
}

/** Checks the kinds of what `resolve` gets. */
export function needChange({ linear, constants }: MixedIntegerChange = {}): MixedIntegerChange {
  if (linear !== undefined && !(linear instanceof Float64Array)) throw wrong('linear: a Float64Array is needed');
  if (constants !== undefined && !(constants instanceof Float64Array)) throw wrong('constants: a Float64Array is needed');
  return { ...(linear && { linear }), ...(constants && { constants }) };
}
