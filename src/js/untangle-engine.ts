// Untangling over one instance of the wasm module.
import type { WasmBindings } from './engine.js';
import { guard } from './guard.js';
import { needHandles, needTargets } from './input.js';
import type * as Bindings from './single/foldfree.js';
import type { CoreSolid } from './solid-engine.js';
import { dispose, type Certificate, type FramePrecision, type SolidCertificate, type StepReport, type Targets } from './types.js';
import type { Contacts, Flowed, PolishState, TraceState, UntangleInfo, UntangleOptions, UntangleResult, UntangleStep } from './untangle-types.js';

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
  readonly #trace: boolean | 'polisher';

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

  private constructor(handle: Bindings.WasmUntangling, frames: FramePrecision, primary: boolean, trace: boolean | 'polisher') {
    this.#handle = handle;
    this.frames = frames;
    this.#primary = primary;
    this.#trace = trace;
    handle.setTrace(Boolean(trace));
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

  /**
   * With `overlap`, between two steps: has pinned vertices move to other places, and the run go on, as soon as the way
   * there is free. On an error nothing has changed.
   */
  movePins(targets: Targets): void {
    const { vertices, positions } = needTargets(targets);
    guard(() => this.#handle.movePins(vertices, positions));
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
      ...(this.#trace && this.#states()),
    };
  }

  #states(): { trace: PolishState[]; quadratic?: TraceState[] } {
    const handle = this.#handle;
    const [first = 0, second = 0] = handle.traceLengths;
    const state = (k: number): TraceState => {
      const [inverted = 0, violated = 0, meeting] = handle.traceCounts(k);
      return {
        positions: handle.tracePositions(k), inverted, violated, ...(meeting !== undefined && { meeting }), contacts: contactsOf(handle.traceContacts(k)),
      };
    };
    return {
      ...(this.#trace === true && { quadratic: Array.from({ length: first }, (_, k) => state(k)) }),
      trace: Array.from({ length: second }, (_, k) => ({ ...state(first + k), zones: handle.traceZones(first + k) })),
    };
  }
}

/** From seven numbers each. */
function contactsOf(numbers: Uint32Array): Contacts {
  const column = (j: number) => numbers.filter((_, i) => i % 7 === j);
  return {
    vertices: numbers.filter((_, i) => i % 7 < 4), edges: Uint8Array.from(column(4)), active: Uint8Array.from(column(5)), zones: column(6),
  };
}
