// The types of untangling.
import type { Flowed, Outcome, SolidCertificate, UntangleSettings } from './single/foldfree.js';
import type { Frame, Handles } from './types.js';

export type { Flowed, GiniStep, Outcome, PolishStep, UntangleEnergy, UntangleSettings } from './single/foldfree.js';

/** Options of `untangle`; what is left out has the paper's value. Pins are held where they start, or at their targets. */
export type UntangleOptions = Partial<UntangleSettings> & Handles & {
  /** Send x̄, the primary solver's state, with each step (default false). */
  primary?: boolean;
  /**
   * Send the states that the quadratic problem and the polisher went through with each step (default false); `'polisher'`:
   * only the latter, as up to fifty states of a large body are much memory.
   */
  trace?: boolean | 'polisher';
};

/** Pairs of parts of the boundary that must not pass through each other. */
export interface Contacts {
  /** k × 4: a vertex and those of a face (in the plane those of an edge, the last twice), or those of two edges. */
  vertices: Uint32Array;
  /** 1 of two edges, 0 of a vertex and a face or edge. */
  edges: Uint8Array;
  /**
   * In `quadratic`: 1 where the multiplier is above 0, also of contacts that are proximal. In `trace`: 1 where the two still
   * collide on the way from x to x̂; 0 where they are proximal: they did collide before, and stay among the constraints.
   */
  active: Uint8Array;
  /** In the polisher: the zone of violated constraints that each is in, the first being 1; 0: in none. */
  zones: Uint32Array;
}

/** What is worked on inside a step: x̄ or x̂ of the paper. */
export interface TraceState {
  /** n × 3, interleaved. */
  positions: Float64Array;
  /** Elements that are inverted or flat. */
  inverted: number;
  /** Elements below their η. */
  violated: number;
  /** With `overlap`: pairs of boundary facets that meet, exactly, up to 100 000. */
  meeting?: number;
  /** The contacts among the constraints; there are none without `overlap`. */
  contacts: Contacts;
}

/** What the polisher works on: x̂ of the paper. */
export interface PolishState extends TraceState {
  /** The zone of violated constraints that each element is in, the first being 1; 0: in none. */
  zones: Uint32Array;
}

/** A step of an untangling: `positions` are x, which is handed out. */
export interface UntangleStep extends Frame {
  /** With `primary`: x̄, which may fold, n × 3. */
  primary?: Float64Array | Float32Array;
  /** With `trace`: x̂ before each iteration of the polisher, and after the last. The first is x̄ after the quadratic problem. */
  trace?: PolishState[];
  /**
   * With `trace: true`: x̄ of the quadratic problem with the multipliers of the step before, and after each iteration of L-BFGS-B;
   * the last is the first of the polisher.
   */
  quadratic?: TraceState[];
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
