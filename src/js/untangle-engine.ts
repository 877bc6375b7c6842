// Untangling over one instance of the wasm module.
import type { WasmBindings } from './engine.js';
import { guard } from './guard.js';
import { needHandles } from './input.js';
import type * as Bindings from './single/foldfree.js';
import type { CoreSolid } from './solid-engine.js';
import { dispose, type Certificate, type FramePrecision, type SolidCertificate, type StepReport } from './types.js';
import type { Flowed, PolishState, UntangleInfo, UntangleOptions, UntangleResult, UntangleStep } from './untangle-types.js';

/** What can be untangled. */
type Body = { solid: CoreSolid; mesh?: never } | { mesh: { handle: Bindings.WasmMesh }; solid?: never };

/** A solid, or (with `Certificate`) triangles in their plane, being untangled, one `step()` an iteration. */
export class CoreUntangling<C extends SolidCertificate | Certificate = SolidCertificate> implements UntangleInfo, Iterable<UntangleStep> {
  readonly start: UntangleStep;
  readonly notes: string[];
  readonly flowed: Flowed | undefined;
  readonly setupSeconds: number;
  /** Precision of the positions of every step. */
  frames: FramePrecision;
  readonly #handle: Bindings.WasmUntangling;
  readonly #primary: boolean;
  readonly #trace: boolean;

  /** @internal */
  static make<C extends SolidCertificate | Certificate>(
    bindings: WasmBindings, { solid, mesh }: Body, options: UntangleOptions & { frames?: FramePrecision },
  ): CoreUntangling<C> {
    const { frames = 'f64', primary = false, trace = false, pins: givenPins, start: givenStart, targets: givenTargets, ...rest } = options;
    const { pins, start, targets } = needHandles({
      ...(givenPins && { pins: givenPins }),
      ...(givenStart && { start: givenStart }),
      ...(givenTargets && { targets: givenTargets }),
    });
    const { WasmUntangling } = bindings;
    const { vertices, positions } = targets;
    const handle = guard(() => (mesh
      ? WasmUntangling.ofMesh(mesh.handle, rest, start, pins, vertices, positions)
      : new WasmUntangling(solid.handle, rest, start, pins, vertices, positions)));
    return new CoreUntangling(handle, frames, primary, trace);
  }

  private constructor(handle: Bindings.WasmUntangling, frames: FramePrecision, primary: boolean, trace: boolean) {
    this.#handle = handle;
    this.frames = frames;
    this.#primary = primary;
    this.#trace = trace;
    handle.setTrace(trace);
    this.notes = handle.notes;
    this.flowed = handle.flowed;
    this.setupSeconds = handle.setupSeconds;
    this.start = this.frame();
  }

  /** One step: local step, quadratic problem, polisher. */
  step(): UntangleStep {
    return guard(() => this.#withPositions(this.#handle.step()));
  }

  /** One step, without copying the positions out. */
  advance(): StepReport {
    return guard(() => this.#handle.step());
  }

  /** The newest state again. */
  frame(): UntangleStep {
    return guard(() => this.#withPositions(this.#handle.report()));
  }

  /** x̄, the primary solver's state, which may fold, n × 3. */
  primaryPositions(): Float64Array {
    return guard(() => this.#handle.primaryPositions());
  }

  /** Steps until the status is no longer `running`. */
  *[Symbol.iterator](): Iterator<UntangleStep> {
    let status = guard(() => this.#handle.report()).status;
    while (status === 'running') {
      const step = this.step();
      yield step;
      status = step.status;
    }
  }

  /** The newest positions in double precision, with their certificate, and what stands in the way where elements are inverted. */
  result(): UntangleResult<C> {
    return guard(() => ({
      positions: this.#handle.positions(),
      certificate: this.#handle.certificate() as C,
      outcome: this.#handle.outcome(),
      obstacles: this.#handle.obstacles(),
    }));
  }

  /** Gives its wasm memory back. */
  free(): void {
    this.#handle.free();
  }

  [dispose](): void {
    this.free();
  }

  #withPositions(report: StepReport): UntangleStep {
    const single = this.frames === 'f32';
    const handle = this.#handle;
    return {
      ...report,
      positions: single ? handle.positionsSingle() : handle.positions(),
      ...(this.#primary && { primary: single ? handle.primaryPositionsSingle() : handle.primaryPositions() }),
      ...(this.#trace && { trace: this.#states() }),
    };
  }

  #states(): PolishState[] {
    const handle = this.#handle;
    return Array.from({ length: handle.traceLength }, (_, k) => {
      const [inverted = 0, violated = 0] = handle.traceCounts(k);
      return { positions: handle.tracePositions(k), inverted, violated, zones: handle.traceZones(k) };
    });
  }
}
