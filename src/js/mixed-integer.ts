// A mixed-integer problem that is solved in the worker.
import type { Client } from './client.js';
import { needChange } from './mixed-integer-input.js';
import { Stepper, type Wait } from './solver.js';
import type {
  MixedIntegerChange, MixedIntegerInfo, MixedIntegerReport, MixedIntegerResult, MixedIntegerStep, MixedIntegerStepReport,
} from './types.js';

/** A mixed-integer problem being solved in the worker: a step is a rounding, an improvement, a part of a search. */
export class MixedInteger extends Stepper<MixedIntegerStep, MixedIntegerStepReport> implements MixedIntegerInfo {
  readonly integerUnknowns: Uint32Array;

  /** @internal */
  constructor(client: Client, generation: number, id: number, info: MixedIntegerInfo, wait: Wait, signal: AbortSignal | undefined) {
    super(client, generation, id, info, wait, signal);
    this.integerUnknowns = info.integerUnknowns;
  }

  /**
   * The same matrix and constraints with another b, other constants, or both: nothing is eliminated or factored
   * again. The solver goes back to the relaxed solution, with which the promise resolves. On an error nothing has
   * changed. What is given is copied.
   */
  async resolve(change: MixedIntegerChange): Promise<MixedIntegerStep> {
    const start = await this.callWith('resolve', { change: needChange(change) });
    this.awake(start.status);
    return start;
  }

  /** What is known so far. */
  report(): Promise<MixedIntegerReport> {
    return this.call('mixedIntegerReport');
  }

  /** The solution; before the end, the newest iterate. */
  result(): Promise<MixedIntegerResult> {
    return this.call('solved');
  }
}
