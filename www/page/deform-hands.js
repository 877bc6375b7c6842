// What people do with handles, on the canvas and with keys.
import { Handles } from './handles.js';
import { landmarks } from './landmarks.js';
import { describe } from './notice.js';
import { whole } from './words.js';

/** How far a key moves a handle, in radii of the solid. */
const NUDGE = 0.04;

/** How far a key turns one. */
const TURN = Math.PI / 6;

/** The hands of the Deform mode. It says what `may` be done, builds anew (`rebuild`), and goes on (`hurry`). */
export class Hands {
  #mode;
  #landmarks; // places keys can pin, and the one they are at
  handles = new Handles();
  /** Whether a person has changed what is held, or where. */
  used = false;

  constructor(mode) {
    this.#mode = mode;
  }

  /** Other handles, of a scene that begins. */
  take(handles) {
    this.handles = handles;
    this.handles.selected = -1;
    this.#landmarks = undefined;
    this.used = false;
    this.draw();
  }

  /** What people do on the canvas. */
  listen(name, value) {
    const { handles } = this;
    const mode = this.#mode;
    if (!mode.mayHold) return;
    switch (name) {
      case 'pin': return void this.pin(value);
      case 'select': return this.select(value);
      case 'grab-handle':
      case 'grab-vertex':
        mode.showNewest();
        if (name === 'grab-handle') handles.grab(value);
        else if (handles.groups.length > 0) handles.pull(value, mode.session.positions);
        if (name === 'grab-handle') mode.endMotion(value);
        return this.draw();
      case 'drag':
        if (!handles.dragging) return;
        handles.drag(value);
        return void this.#aim();
      case 'turn':
        if (!handles.dragging) return;
        handles.turn(mode.axis, value);
        return void this.#aim();
      case 'drop': return void this.drop();
      default:
    }
  }

  /** What is dragged is let go. */
  drop() {
    if (!this.handles.dragging) return undefined;
    this.handles.drop();
    return this.#aim();
  }

  /** Holds vertices where they are. */
  async pin(vertices) {
    const mode = this.#mode;
    mode.showNewest();
    if (!this.handles.add(vertices, mode.session.positions)) return mode.say('It is held already');
    this.used = true;
    this.draw();
    mode.say(`Pinned: ${this.#words()}`);
    await mode.rebuild();
  }

  /** Lets the selected handle go; or all, if none is and `all` says so. */
  async release(all = true) {
    const mode = this.#mode;
    if (!mode.mayHold || (!all && this.handles.selected < 0) || !this.handles.release()) return;
    this.used = true;
    mode.endMotion();
    this.draw();
    mode.say(`Released; ${this.handles.groups.length} handles are left`);
    await mode.rebuild();
  }

  /** Moves the selected handle by steps to the right and up in the view. */
  nudge(right, up) {
    const axes = this.#mode.bench?.cameraAxes(NUDGE);
    if (axes) this.#move(() => this.handles.move([0, 1, 2].map((k) => right * axes[k] + up * axes[3 + k])));
  }

  /** Turns the selected handle about the longest axis of the solid, a twelfth of a turn times `times`. */
  twist(times) {
    this.#move(() => this.handles.twist(this.#mode.axis, times * TURN));
  }

  #move(act) {
    const mode = this.#mode;
    if (!mode.mayHold) return;
    if (this.handles.selected < 0) return mode.say('No handle is selected: H selects the next');
    mode.endMotion(this.handles.selected);
    mode.showNewest();
    if (act()) void this.#aim();
  }

  /** Selects a handle, or none (-1). */
  select(index) {
    this.handles.selected = index;
    this.draw();
    this.#mode.say(index < 0 ? 'No handle is selected' : `Selected: ${this.#words()}`);
  }

  /** Selects the next handle. */
  next() {
    const count = this.handles.groups.length;
    if (count > 0) this.select((this.handles.selected + 1) % count);
    else this.#mode.say('Nothing is held: B goes to a vertex, N pins it');
  }

  /** Goes to the next vertex that keys can pin. */
  nextPlace() {
    const mode = this.#mode;
    if (!mode.mayHold) return;
    mode.showNewest();
    this.#landmarks ??= { list: landmarks(mode.session.positions, mode.session.solid.surface ?? mode.session.solid.indices), at: -1 };
    const { list } = this.#landmarks;
    this.#landmarks.at = (this.#landmarks.at + 1) % list.length;
    const { vertex, words } = list[this.#landmarks.at];
    mode.bench.cursor(vertex);
    mode.say(`Vertex at ${words}; N pins it`);
  }

  /** Pins the vertex keys are at. */
  async pinPlace() {
    const mode = this.#mode;
    if (!mode.mayHold) return;
    if (!this.#landmarks) return this.nextPlace();
    await this.pin([this.#landmarks.list[this.#landmarks.at].vertex]);
  }

  #words() {
    const { groups, selected } = this.handles;
    return `handle ${selected + 1} of ${groups.length}, ${whole(groups[selected].vertices.length)} vertices`;
  }

  async #aim() {
    const mode = this.#mode;
    this.used = true;
    this.drawTargets();
    try {
      await mode.session.aim(this.handles.targets());
      if (!mode.session.finished) mode.hurry();
    } catch (error) {
      mode.notice('It cannot go there', describe(error));
    }
  }

  draw() {
    const { bench, controls } = this.#mode;
    bench?.handles(this.handles);
    bench?.cursor(this.#landmarks?.list[this.#landmarks.at].vertex);
    this.drawTargets();
    controls.reflectHandles();
  }

  drawTargets() {
    this.#mode.bench?.targets(this.handles.targets());
  }
}
