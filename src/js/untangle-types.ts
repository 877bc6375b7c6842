// The types of untangling.
import type { Flowed, Outcome, SolidCertificate, UntangleSettings } from './single/foldfree.js';
import type { Frame, Handles } from './types.js';

export type { Flowed, GiniStep, Outcome, PolishStep, UntangleEnergy, UntangleSettings } from './single/foldfree.js';

/** Options of `untangle`; what is left out has the paper's value. Pins are held where they start, or at their targets. */
export type UntangleOptions = Partial<UntangleSettings> & Handles & {
  /** Send x̄, the primary solver's state, with each step (default false). */
  primary?: boolean;
  /** Send the states that the polisher went through with each step (default false). */
  trace?: boolean;
};

/** What the polisher works on: x̂ of the paper. */
export interface PolishState {
  /** n × 3, interleaved. */
  positions: Float64Array;
  /** Elements that are inverted or flat. */
  inverted: number;
  /** Constraints below their η. */
  violated: number;
  /** The zone of violated constraints that each element is in, the first being 1; 0: in none. */
  zones: Uint32Array;
}

/** A step of an untangling: `positions` are x, which is handed out. */
export interface UntangleStep extends Frame {
  /** With `primary`: x̄, which may fold, n × 3. */
  primary?: Float64Array | Float32Array;
  /** With `trace`: x̂ before each iteration of the polisher, and after the last. The first is x̄ after the quadratic problem. */
  trace?: PolishState[];
}

/** What is known of an untangling before its first step. */
export interface UntangleInfo {
  /** Iteration 0. */
  start: UntangleStep;
  /** What was mended or chosen, in words. */
  notes: string[];
  /** With `flow`: how the start's boundary was parted; `pairs` of facets met before the first step, and after each. */
  flowed: Flowed | undefined;
  /** Seconds that the checks and the factorisation took. */
  setupSeconds: number;
}

/** An untangled solid, or (with `Certificate`) triangles in their plane; or the best that was found. */
export interface UntangleResult<C = SolidCertificate> {
  /** x, n × 3, interleaved. */
  positions: Float64Array;
  /** The exact checks of these positions. */
  certificate: C;
  /** What is inverted, and whether pins make it impossible that nothing is. */
  outcome: Outcome;
  /** The same in plain sentences; empty when nothing is inverted. */
  obstacles: string[];
}
