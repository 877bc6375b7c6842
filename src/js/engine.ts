// The synchronous API over one instance of the wasm module. The worker and `foldfree/core` share it.
import type * as Bindings from './single/foldfree.js';
import { FoldfreeError } from './error.js';
import { cornerImages, fileBytes, isArrays, isSolidArrays, needFormat, needLandmarks, needSolidFormat } from './input.js';
import { CoreDeformation, CoreSolid } from './solid-engine.js';
import { guard } from './guard.js';
import { CoreMixedInteger } from './mixed-integer-engine.js';
import { needProblem } from './mixed-integer-input.js';
import { CoreUntangling } from './untangle-engine.js';
import {
  dispose,
  type Certificate, type DeformationSettings, type DeformOptions, type FramePrecision, type LimDeformOptions, type LimOptions, type MeshArrays, type MeshData, type MeshFormat, type MeshInfo,
  type MixedIntegerData, type MixedIntegerOptions, type MixedIntegerResult, type ParameterizeOptions, type Result, type ShapeInfo, type SolidCertificate, type SolidData, type SolidFormat, type SolverInfo,
  type Step, type StepReport, type Texture, type UntangleOptions, type UntangleSettings,
} from './types.js';

/** The exports of one of the two wasm builds. */
export type WasmBindings = typeof Bindings;

/** A mesh in wasm memory, with copies of its arrays. */
export class CoreMesh implements MeshInfo {
  readonly positions: Float64Array;
  readonly indices: Uint32Array;
  readonly notes: string[];
  readonly texture?: Texture;
  /** @internal */
  readonly handle: Bindings.WasmMesh;

  /** @internal */
  constructor(handle: Bindings.WasmMesh) {
    this.handle = handle;
    this.positions = handle.positions;
    this.indices = handle.indices;
    this.notes = handle.notes;
    const coordinates = handle.textureCoordinates;
    const corners = handle.textureCorners;
    if (coordinates && corners) this.texture = { coordinates, corners };
  }

  get vertexCount(): number {
    return this.positions.length / 3;
  }

  get triangleCount(): number {
    return this.indices.length / 3;
  }

  /** A file of the mesh with its vertices elsewhere (n × 3; left out: where they are). */
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

/** A map being computed, one `step()` an iteration. */
export class CoreSolver implements SolverInfo, Iterable<Step> {
  readonly start: Step;
  readonly mesh: MeshArrays;
  readonly inputVertices: Uint32Array;
  readonly seamEdges: number;
  readonly startKind: SolverInfo['startKind'];
  readonly notes: string[];
  readonly setupSeconds: number;
  /** Precision of the positions of every step. */
  frames: FramePrecision;
  readonly #handle: Bindings.WasmParameterization;

  /** @internal */
  constructor(handle: Bindings.WasmParameterization, frames: FramePrecision) {
    this.#handle = handle;
    this.frames = frames;
    this.mesh = { positions: handle.positions, indices: handle.indices };
    this.inputVertices = handle.inputVertices;
    this.seamEdges = handle.seamEdges;
    this.startKind = handle.startKind;
    this.notes = handle.notes;
    this.setupSeconds = handle.setupSeconds;
    this.start = guard(() => this.frame());
  }

  /** One iteration of the method. */
  step(): Step {
    return guard(() => this.#withMap(this.#handle.step()));
  }

  /** One iteration, without copying the map out. */
  advance(): StepReport {
    return guard(() => this.#handle.step());
  }

  /** The newest iterate again. */
  frame(): Step {
    return this.#withMap(this.#handle.report());
  }

  /** Weight over rest weight a triangle; empty where the method has no weights. */
  weights(): Float32Array {
    return this.#handle.weights();
  }

  /** Steps until the status is no longer `running`. */
  *[Symbol.iterator](): Iterator<Step> {
    let status = guard(() => this.#handle.report()).status;
    while (status === 'running') {
      const step = this.step();
      yield step;
      status = step.status;
    }
  }

  /** The newest map with its certificate. */
  result(): Result {
    return guard(() => ({
      uv: this.#handle.uv(),
      certificate: this.#handle.certificate(),
      inputVertices: this.inputVertices.slice(),
    }));
  }

  /** The input surface as an OBJ file with the map as texture coordinates. */
  exportObj(): Uint8Array {
    return guard(() => this.#handle.exportObj());
  }

  /** Gives its wasm memory back. */
  free(): void {
    this.#handle.free();
  }

  [dispose](): void {
    this.free();
  }

  #withMap(report: StepReport): Step {
    const positions = this.frames === 'f32' ? this.#handle.uvSingle() : this.#handle.uv();
    return { ...report, positions, distortion: this.#handle.distortion() };
  }
}

/** One instance of the library. */
export class Core {
  /** Version of the library. */
  readonly version: string;
  /** Threads that parallel loops use. */
  readonly threads: number;
  /** The sample shapes `generate` makes. */
  readonly shapes: ShapeInfo[];
  /** The sample solids `generateSolid` makes. */
  readonly solidShapes: ShapeInfo[];
  readonly #bindings: WasmBindings;

  /** @internal */
  constructor(bindings: WasmBindings) {
    this.#bindings = bindings;
    this.version = bindings.version();
    this.threads = bindings.threadCount();
    this.shapes = bindings.shapes();
    this.solidShapes = bindings.solidShapes();
  }

  /** Reads a mesh file (bytes or text; a format is needed), or takes arrays. */
  mesh(data: MeshData, format?: MeshFormat): CoreMesh {
    const { WasmMesh } = this.#bindings;
    if (isArrays(data)) return guard(() => new CoreMesh(WasmMesh.fromArrays(data.positions, data.indices)));
    const known = needFormat(format);
    return guard(() => new CoreMesh(WasmMesh.fromBytes(fileBytes(data), known)));
  }

  /** Generates a sample shape of about so many triangles. */
  generate(name: string, triangles: number): CoreMesh {
    if (!(triangles >= 1 && triangles <= 0xffff_ffff)) {
      throw new FoldfreeError('invalid-argument', `triangles: ${triangles} is not a number of triangles`);
    }
    return guard(() => new CoreMesh(this.#bindings.WasmMesh.generate(name, triangles)));
  }

  /** Validates, cuts, computes the start and builds the solver: all that comes before the first step. */
  parameterize(mesh: CoreMesh, options: ParameterizeOptions & { frames?: FramePrecision } = {}): CoreSolver {
    const { frames = 'f64', landmarks: given, ...rest } = options;
    const { vertices, places, hard } = needLandmarks(given ?? []);
    const { WasmParameterization } = this.#bindings;
    return guard(() => new CoreSolver(new WasmParameterization(mesh.handle, rest, vertices, places, hard), frames));
  }

  /**
   * Checks a map that came from anywhere: `uv` is n × 2, interleaved, one a vertex of `mesh`; left out, it is
   * the texture coordinates `mesh` came with.
   */
  check(mesh: CoreMesh, uv?: Float64Array): Certificate {
    if (uv === undefined) return this.checkCorners(mesh, cornerImages(mesh));
    return guard(() => this.#bindings.checkMap(mesh.handle, uv));
  }

  /** Checks a map with seams: the image of every corner of every triangle, m × 3 × 2. */
  checkCorners(mesh: CoreMesh, corners: Float64Array): Certificate {
    return guard(() => this.#bindings.checkCorners(mesh.handle, corners));
  }

  /** Reads a solid's file (bytes or text; a format is needed; `node` takes the .ele file, too), or takes arrays. */
  solid(data: SolidData, format?: SolidFormat, elements?: Uint8Array | ArrayBuffer | string): CoreSolid {
    const { WasmSolid } = this.#bindings;
    if (isSolidArrays(data)) return guard(() => new CoreSolid(WasmSolid.fromArrays(data.positions, data.tetrahedra)));
    const known = needSolidFormat(format, elements);
    return guard(() => new CoreSolid(
      elements === undefined
        ? WasmSolid.fromBytes(fileBytes(data), known)
        : WasmSolid.fromNodeAndEle(fileBytes(data), fileBytes(elements)),
    ));
  }

  /** Generates a sample solid of about so many tetrahedra; the names are those of `solidShapes`. */
  generateSolid(name: string, tetrahedra: number): CoreSolid {
    if (!(tetrahedra >= 1 && tetrahedra <= 0xffff_ffff)) {
      throw new FoldfreeError('invalid-argument', `tetrahedra: ${tetrahedra} is not a number of tetrahedra`);
    }
    return guard(() => new CoreSolid(this.#bindings.WasmSolid.generate(name, tetrahedra)));
  }

  /**
   * Checks rest shape, start and handles, and builds the solver: of a solid, or, by locally injective mappings, of
   * the triangles of a mesh in a plane z = constant.
   */
  deform(body: CoreSolid, options?: DeformOptions & { frames?: FramePrecision }): CoreDeformation;
  deform(body: CoreMesh, options?: LimDeformOptions & { frames?: FramePrecision }): CoreDeformation<Certificate>;
  deform(
    body: CoreSolid | CoreMesh, options: (DeformOptions | LimDeformOptions) & { frames?: FramePrecision } = {},
  ): CoreDeformation | CoreDeformation<Certificate> {
    if (body instanceof CoreMesh) return CoreDeformation.make<Certificate>(this.#bindings, { mesh: body }, options);
    return CoreDeformation.make<SolidCertificate>(this.#bindings, { solid: body }, options);
  }

  /**
   * Checks rest shape, start and handles, and builds the solver that leads from any start to a map without inverted
   * elements: of a solid, or of the triangles of a mesh in a plane z = constant.
   */
  untangle(body: CoreSolid, options?: UntangleOptions & { frames?: FramePrecision }): CoreUntangling;
  untangle(body: CoreMesh, options?: UntangleOptions & { frames?: FramePrecision }): CoreUntangling<Certificate>;
  untangle(
    body: CoreSolid | CoreMesh, options: UntangleOptions & { frames?: FramePrecision } = {},
  ): CoreUntangling | CoreUntangling<Certificate> {
    if (body instanceof CoreMesh) return CoreUntangling.make<Certificate>(this.#bindings, { mesh: body }, options);
    return CoreUntangling.make<SolidCertificate>(this.#bindings, { solid: body }, options);
  }

  /** Checks a deformation that came from anywhere: `positions` is n × 3, interleaved; `solid` is the rest shape. */
  checkSolid(solid: CoreSolid, positions: Float64Array): SolidCertificate {
    return guard(() => this.#bindings.checkSolid(solid.handle, positions));
  }

  /** Checks a mixed-integer problem, eliminates its constraints, factors, and solves it without integrality. */
  mixedInteger(data: MixedIntegerData, options: Partial<MixedIntegerOptions> = {}): CoreMixedInteger {
    return CoreMixedInteger.make(this.#bindings, needProblem(data), options);
  }

  /** Solves a mixed-integer problem. */
  solveMixedInteger(data: MixedIntegerData, options: Partial<MixedIntegerOptions> = {}): MixedIntegerResult {
    const solver = this.mixedInteger(data, options);
    try {
      return solver.run();
    } finally {
      solver.free();
    }
  }

  /** The options of a mixed-integer problem with the values they have when left out. */
  defaultMixedIntegerOptions(): MixedIntegerOptions {
    return guard(() => this.#bindings.defaultMixedIntegerOptions());
  }

  /** The options of a deformation with the values they have when left out. */
  defaultDeformationOptions(): DeformationSettings {
    return guard(() => this.#bindings.defaultDeformationOptions());
  }

  /** The options of locally injective mappings with the values they have when left out. */
  defaultLimOptions(): LimOptions {
    return guard(() => this.#bindings.defaultLimOptions());
  }

  /** The options of untangling with the values they have when left out; with `overlap` some are others. */
  defaultUntangleOptions(overlap = false): UntangleSettings {
    return guard(() => this.#bindings.defaultUntangleOptions(overlap));
  }

  /** All options with the values they have when left out. */
  defaultOptions(): Required<ParameterizeOptions> {
    return guard(() => this.#bindings.defaultOptions() as Required<ParameterizeOptions>);
  }

  /** Bytes of wasm memory; it never shrinks, so this is also its peak. */
  get memoryBytes(): number {
    return this.#bindings.memoryBytes();
  }
}
