// Mixed-integer problems over one instance of the wasm module.
import type { WasmBindings } from './engine.js';
import { guard } from './guard.js';
import { needChange, type MixedIntegerInput } from './mixed-integer-input.js';
import type {
  MixedIntegerChange, MixedIntegerInfo, MixedIntegerOptions, MixedIntegerReport, MixedIntegerResult, MixedIntegerStep, MixedIntegerStepReport,
} from './mixed-integer-types.js';
import type * as Bindings from './single/foldfree.js';
import { dispose } from './types.js';

/** A mixed-integer problem being solved: a step is a rounding, an improvement, a part of a search. */
export class CoreMixedInteger implements MixedIntegerInfo, Iterable<MixedIntegerStep> {
  readonly start: MixedIntegerStep;
  readonly integerUnknowns: Uint32Array;
  readonly setupSeconds: number;
  readonly #handle: Bindings.WasmMixedInteger;

  /** @internal */
  static make({ WasmMixedInteger, WasmProblem }: WasmBindings, input: MixedIntegerInput, options: Partial<MixedIntegerOptions>): CoreMixedInteger {
    return guard(() => {
      if ('bytes' in input) return new CoreMixedInteger(WasmMixedInteger.fromSys(input.bytes, options));
      const { matrix, linear, integers, constraints: c } = input.problem;
      const problem = new WasmProblem(matrix.rows, matrix.columns, matrix.values, linear, integers);
      return new CoreMixedInteger(new WasmMixedInteger(problem.constrained(c.rows, c.columns, c.values, c.constants), options));
    });
  }

  private constructor(handle: Bindings.WasmMixedInteger) {
    this.#handle = handle;
    this.integerUnknowns = handle.integers;
    this.setupSeconds = this.report().setupSeconds;
    this.start = this.frame();
  }

  /** One step. */
  step(): MixedIntegerStep {
    return guard(() => this.#withUnknowns(this.#handle.step()));
  }

  /** One step, without the unknowns: with few integers they take longer than the step. */
  advance(): MixedIntegerStepReport {
    return guard(() => this.#handle.step());
  }

  /** The newest step again. */
  frame(): MixedIntegerStep {
    return guard(() => this.#withUnknowns(this.#handle.lastStep()));
  }

  /**
   * The same matrix and constraints with another b, other constants, or both: nothing is eliminated or factored
   * again. The solver goes back to the relaxed solution, which is returned. On an error nothing has changed.
   */
  resolve(change: MixedIntegerChange): MixedIntegerStep {
    const { linear, constants } = needChange(change);
    guard(() => this.#handle.resolve(linear, constants));
    return this.frame();
  }

  /** What is known so far. */
  report(): MixedIntegerReport {
    return guard(() => this.#handle.report());
  }

  /** Steps until the status is no longer `running`. */
  *[Symbol.iterator](): Iterator<MixedIntegerStep> {
    let { status } = guard(() => this.#handle.lastStep());
    while (status === 'running') {
      const step = this.step();
      yield step;
      status = step.status;
    }
  }

  /** Steps to the end. */
  run(): MixedIntegerResult {
    while (guard(() => this.#handle.lastStep()).status === 'running') this.advance();
    return this.result();
  }

  /** The solution; before the end, the newest iterate. */
  result(): MixedIntegerResult {
    const { status, x } = this.frame();
    const report = this.report();
    const { energy, lowerBound, proven } = report;
    return {
      status, x, energy, proven, report,
      integers: Float64Array.from(this.integerUnknowns, (unknown) => x[unknown] as number),
      ...(lowerBound !== undefined && { lowerBound, gap: energy - lowerBound }),
    };
  }

  /** Gives its wasm memory back. */
  free(): void {
    this.#handle.free();
  }

  [dispose](): void {
    this.free();
  }

  #withUnknowns(report: MixedIntegerStepReport): MixedIntegerStep {
    return { ...report, x: this.#handle.iterate() };
  }
}
