// Solids and their deformations over one instance of the wasm module.
import type { WasmBindings } from './engine.js';
import { guard } from './guard.js';
import { needHandles, needTargets } from './input.js';
import type * as Bindings from './single/foldfree.js';
import {
  dispose,
  type Certificate, type DeformInfo, type DeformOptions, type DeformResult, type DeformStep, type Field, type FramePrecision,
  type LimDeformOptions, type MeshFormat, type SolidCertificate, type SolidInfo, type StepReport, type Targets,
} from './types.js';

/** A solid in wasm memory, with copies of its arrays. */
export class CoreSolid implements SolidInfo {
  readonly positions: Float64Array;
  readonly tetrahedra: Uint32Array;
  readonly surface: Uint32Array;
  readonly notes: string[];
  /** @internal */
  readonly handle: Bindings.WasmSolid;

  /** @internal */
  constructor(handle: Bindings.WasmSolid) {
    this.handle = handle;
    this.positions = handle.positions;
    this.tetrahedra = handle.tetrahedra;
    this.surface = handle.surface;
    this.notes = handle.notes;
  }

  get vertexCount(): number {
    return this.positions.length / 3;
  }

  get tetrahedronCount(): number {
    return this.tetrahedra.length / 4;
  }

  /**
   * A file of the solid with its vertices elsewhere (n × 3; left out: where they are). A format that holds no
   * tetrahedra gets the boundary.
   */
  write(format: MeshFormat, positions: Float64Array = this.positions): Uint8Array {
    return guard(() => this.handle.write(positions, format));
  }

  /** Gives its wasm memory back. */
  free(): void {
    this.handle.free();
  }

  [dispose](): void {
    this.free();
  }
}

/** What a deformation can be of. */
type Body = { solid: CoreSolid; mesh?: never } | { mesh: { handle: Bindings.WasmMesh }; solid?: never };

/** A solid, or (with `Certificate`) triangles in their plane, being deformed, one `step()` an iteration. */
export class CoreDeformation<C extends SolidCertificate | Certificate = SolidCertificate> implements DeformInfo, Iterable<DeformStep> {
  readonly start: DeformStep;
  readonly notes: string[];
  readonly setupSeconds: number;
  /** Precision of the positions of every step. */
  frames: FramePrecision;
  readonly #handle: Bindings.WasmDeformation;
  #field: Field;

  /** @internal */
  static make<C extends SolidCertificate | Certificate>(
    bindings: WasmBindings, { solid, mesh }: Body, options: (DeformOptions | LimDeformOptions) & { frames?: FramePrecision },
  ): CoreDeformation<C> {
    const { frames = 'f64', field = 'distortion', pins: givenPins, start: givenStart, targets: givenTargets, ...rest } = options;
    const { pins, start, targets } = needHandles({
      ...(givenPins && { pins: givenPins }),
      ...(givenStart && { start: givenStart }),
      ...(givenTargets && { targets: givenTargets }),
    });
    const { WasmDeformation } = bindings;
    const { vertices, positions } = targets;
    const handle = guard(() => (mesh
      ? WasmDeformation.ofMesh(mesh.handle, rest as Bindings.LimSettings, start, pins, vertices, positions)
      : new WasmDeformation(solid.handle, rest as Bindings.DeformationSettings, start, pins, vertices, positions)));
    return new CoreDeformation(handle, frames, field);
  }

  private constructor(handle: Bindings.WasmDeformation, frames: FramePrecision, field: Field) {
    this.#handle = handle;
    this.frames = frames;
    this.#field = field;
    this.notes = handle.notes;
    this.setupSeconds = handle.setupSeconds;
    this.start = guard(() => this.frame());
  }

  /** One iteration of the method. */
  step(): DeformStep {
    return guard(() => this.#withPositions(this.#handle.step()));
  }

  /** One iteration, without copying the positions out. */
  advance(): StepReport {
    return guard(() => this.#handle.step());
  }

  /** The newest iterate again. */
  frame(): DeformStep {
    return guard(() => this.#withPositions(this.#handle.report()));
  }

  /**
   * Replaces all targets, between two steps: pinned vertices are moved to theirs, free ones pulled. The iterate
   * is kept and the status goes back to `running`. On an error nothing has changed.
   */
  setTargets(targets: Targets): void {
    const { vertices, positions } = needTargets(targets);
    guard(() => this.#handle.setTargets(vertices, positions));
  }

  /** The field that comes with each step from here on. */
  setField(field: Field): void {
    guard(() => this.#handle.field(field));
    this.#field = field;
  }

  /** Weight over rest weight an element; empty where the method has no weights. */
  weights(): Float32Array {
    return this.#handle.weights();
  }

  /** Steps until the status is no longer `running`. */
  *[Symbol.iterator](): Iterator<DeformStep> {
    let status = guard(() => this.#handle.report()).status;
    while (status === 'running') {
      const step = this.step();
      yield step;
      status = step.status;
    }
  }

  /** The newest positions in double precision, with their certificate. */
  result(): DeformResult<C> {
    return guard(() => ({ positions: this.#handle.positions(), certificate: this.#handle.certificate() as C }));
  }

  /** Gives its wasm memory back. */
  free(): void {
    this.#handle.free();
  }

  [dispose](): void {
    this.free();
  }

  #withPositions(report: StepReport): DeformStep {
    const positions = this.frames === 'f32' ? this.#handle.positionsSingle() : this.#handle.positions();
    const subTargets = report.lim && {
      vertices: this.#handle.subTargetVertices(), positions: this.#handle.subTargetPositions(),
    };
    return { ...report, positions, field: this.#handle.field(this.#field), ...(subTargets && { subTargets }) };
  }
}
