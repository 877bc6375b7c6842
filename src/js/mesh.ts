// Meshes: their arrays here, and their copies in the worker, which are made anew after a restart.
import type { Client } from './client.js';
import { FoldfreeError } from './error.js';
import { dispose, type MeshFormat, type MeshInfo, type SolidInfo, type Texture } from './types.js';

/** What surfaces and solids have in common: a copy in the worker. */
abstract class InWorker {
  protected readonly client: Client;
  #id: number;
  #generation: number;
  #freed = false;

  constructor(client: Client, id: number) {
    this.client = client;
    this.#id = id;
    this.#generation = client.generation;
  }

  protected abstract upload(id: number): Promise<unknown>;

  /** @internal The mesh's number in the worker that runs now. */
  async inWorker(): Promise<number> {
    if (this.#freed) throw new FoldfreeError('freed', 'this mesh was freed');
    await this.client.start();
    if (this.#generation !== this.client.generation) {
      this.#id = this.client.newId();
      this.#generation = this.client.generation;
      await this.upload(this.#id);
    }
    return this.#id;
  }

  /** Gives its memory in the worker back. */
  free(): void {
    if (this.#freed) return;
    this.#freed = true;
    if (this.#generation === this.client.generation) {
      this.client.callIn(this.#generation, 'freeMesh', { mesh: this.#id }).catch(() => {});
    }
  }

  [dispose](): void {
    this.free();
  }
}

/** A surface. */
export class Mesh extends InWorker implements MeshInfo {
  readonly positions: Float64Array;
  readonly indices: Uint32Array;
  readonly notes: string[];
  readonly texture?: Texture;

  /** @internal */
  constructor(client: Client, id: number, info: MeshInfo) {
    super(client, id);
    this.positions = info.positions;
    this.indices = info.indices;
    this.notes = info.notes;
    if (info.texture) this.texture = info.texture;
  }

  get vertexCount(): number {
    return this.positions.length / 3;
  }

  get triangleCount(): number {
    return this.indices.length / 3;
  }

  /** A file of the mesh with its vertices elsewhere (n × 3; left out: where they are). */
  async write(format: MeshFormat, positions?: Float64Array): Promise<Uint8Array> {
    return this.client.call('write', { mesh: await this.inWorker(), format, positions });
  }

  protected upload(mesh: number): Promise<unknown> {
    const { positions, indices } = this;
    return this.client.call('upload', { mesh, arrays: { positions, indices } });
  }
}

/** A solid. */
export class Solid extends InWorker implements SolidInfo {
  readonly positions: Float64Array;
  readonly tetrahedra: Uint32Array;
  readonly surface: Uint32Array;
  readonly notes: string[];

  /** @internal */
  constructor(client: Client, id: number, info: SolidInfo) {
    super(client, id);
    this.positions = info.positions;
    this.tetrahedra = info.tetrahedra;
    this.surface = info.surface;
    this.notes = info.notes;
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
  async write(format: MeshFormat, positions?: Float64Array): Promise<Uint8Array> {
    return this.client.call('write', { mesh: await this.inWorker(), format, positions });
  }

  protected upload(mesh: number): Promise<unknown> {
    const { positions, tetrahedra } = this;
    return this.client.call('uploadSolid', { mesh, arrays: { positions, tetrahedra } });
  }
}
