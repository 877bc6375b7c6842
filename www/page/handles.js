// What is held of a solid, and where it is to go. No DOM here.
import { pick, turned } from './presets.js';

/** Handles: sets of vertices that are held and moved together; and one vertex that is pulled. */
export class Handles {
  /** `{ vertices, at }`: where (n×3) the vertices are to be. */
  groups = [];
  /** The handle that keys act on, or -1. */
  selected = -1;
  #pulled; // { vertex, at }
  #grabbed; // { target: a group or what is pulled, from: where it was }

  /** Holds `vertices` where they are in `positions` (n×3), as one handle; those held already are left out. */
  add(vertices, positions) {
    const held = new Set(this.pins());
    const fresh = Uint32Array.from(new Set(vertices)).filter((v) => !held.has(v));
    if (fresh.length === 0) return false;
    this.groups.push({ vertices: fresh, at: pick(positions, fresh) });
    this.selected = this.groups.length - 1;
    return true;
  }

  /** Lets the selected handle go, or all when none is selected; says whether there was one. */
  release() {
    if (this.groups.length === 0) return false;
    if (this.selected >= 0) this.groups.splice(this.selected, 1);
    else this.groups = [];
    this.selected = -1;
    this.#grabbed = undefined;
    return true;
  }

  /** All vertices that are held. */
  pins() {
    return Uint32Array.from(this.groups.flatMap(({ vertices }) => [...vertices]));
  }

  /** Where held and pulled vertices are to go, as the solver takes it. */
  targets() {
    const parts = this.groups.map(({ vertices, at }) => [vertices, at]);
    if (this.#pulled) parts.push([[this.#pulled.vertex], this.#pulled.at]);
    return {
      vertices: Uint32Array.from(parts.flatMap(([vertices]) => [...vertices])),
      positions: Float64Array.from(parts.flatMap(([, at]) => [...at])),
    };
  }

  /** `positions` with what is held at its place. */
  applied(positions) {
    const out = Float64Array.from(positions);
    for (const { vertices, at } of this.groups) vertices.forEach((v, i) => out.set(at.subarray(3 * i, 3 * i + 3), 3 * v));
    return out;
  }

  /** Has these handles and no others, where they are now. */
  keepOnly(groups) {
    this.groups = [...groups];
    this.selected = -1;
    this.drop();
  }

  /** A handle is dragged from now on. */
  grab(index) {
    const target = this.groups[index];
    if (!target) return false;
    this.selected = index;
    this.#grabbed = { target, from: target.at };
    return true;
  }

  /** A vertex is pulled from now on, from where it is in `positions`. */
  pull(vertex, positions) {
    this.#pulled = { vertex, at: pick(positions, [vertex]) };
    this.#grabbed = { target: this.#pulled, from: this.#pulled.at };
  }

  /** What is dragged has come this far since it was grabbed. */
  drag(delta) {
    if (!this.#grabbed) return;
    const { target, from } = this.#grabbed;
    target.at = from.map((x, i) => x + delta[i % 3]);
  }

  /** A handle that is dragged is turned by `angle` since it was grabbed, about its middle and a coordinate axis. */
  turn(axis, angle) {
    if (this.#grabbed?.target.vertices) this.#grabbed.target.at = turned(this.#grabbed.from, axis, angle);
  }

  /** It is let go: a handle stays where it is, a vertex springs back. */
  drop() {
    this.#grabbed = undefined;
    this.#pulled = undefined;
  }

  /** Turns the selected handle; says whether there was one. */
  twist(axis, angle) {
    const group = this.groups[this.selected];
    if (group) group.at = turned(group.at, axis, angle);
    return group !== undefined;
  }

  get dragging() {
    return this.#grabbed !== undefined;
  }

  /** Moves the selected handle; says whether there was one. */
  move(delta) {
    const group = this.groups[this.selected];
    if (!group) return false;
    group.at = group.at.map((x, i) => x + delta[i % 3]);
    return true;
  }
}
