// The Deform mode: a solid, what is held of it, and the solver that finds its rest.
import { isDefault, readAddress, writeAddress } from './address.js';
import { preparedSolid } from './canvas.js';
import { DeformControls } from './deform-controls.js';
import { DeformSession } from './deform-session.js';
import { medit, readSolidFiles, save } from './files.js';
import { Handles } from './handles.js';
import { Mode, nextFrame } from './mode.js';
import { describe } from './notice.js';
import { PRESETS, collapsed, scattered, scene } from './presets.js';
import { METHODS, ending, number, whole } from './words.js';

/** How far a key moves a handle, in radii of the solid. */
const NUDGE = 0.04;

/** Title of a notice. */
const NOTHING_HELD = 'Nothing is held';

/** Materials that have moduli. */
const ELASTIC = ['neo-hookean', 'stable-neo-hookean', 'st-venant-kirchhoff'];

export class Deform extends Mode {
  static accepts = '.mesh,.msh,.vtk,.node,.ele,.gz';
  static dropHere = 'Drop a MESH, MSH or VTK file, or a NODE file with its ELE file, to deform it';
  static first = 'shape'; // the view a phone shows
  static views = { map: 'Cut', shape: 'Solid', plot: 'Plot', inspector: 'Step' };
  wanted = readAddress('deform');
  source = { solid: this.wanted.solid, tetrahedra: this.wanted.tetrahedra };
  handles = new Handles();
  #good = { ...this.wanted };
  #rest; // positions at rest
  #scene; // where things start, and what moves by itself
  #moved = 0; // iterations the motion of the scene has made
  #ticks = []; // when iterations came, for their rate
  #controls = new DeformControls(this);
  #opening; // what is being opened, and how
  #held = []; // the handles the solver knows

  constructor(page) {
    super(page, 'deform');
  }

  // ——— opening ———

  async prepare() {
    if (this.records.length || !isDefault('deform', { ...this.wanted, ...this.source })) return this.records.length > 0;
    const drawn = await preparedSolid().catch(() => undefined);
    if (!drawn || this.records.length) return this.records.length > 0;
    const { method, preset, material } = this.wanted;
    this.bench.solid(drawn);
    this.#look();
    this.bench.begin(method, preset, material);
    this.bench.push(drawn.start);
    this.handles = new Handles();
    for (const vertices of scene(preset, Float64Array.from(drawn.positions)).held) this.handles.add(vertices, drawn.start.positions);
    this.handles.selected = -1;
    this.#drawHandles();
    this.records = [drawn.start];
    this.show(0);
    this.invite();
    return true;
  }

  async arrive(foldfree) {
    this.session ??= new DeformSession(foldfree);
    this.#controls.list(foldfree.solidShapes);
    if (this.session.ready) return true;
    const opened = await this.open(this.source);
    if (opened && this.waiting) await this.catchUp();
    else if (opened && this.wanted.steps) await this.steps(this.wanted.steps);
    return opened;
  }

  invitation() {
    const start = this.records[0];
    const { preset } = this.wanted;
    const wrong = `${whole(start.inverted)} of ${whole(this.bench.tetrahedra)} tetrahedra are inside out`;
    if (preset === 'random') return { button: 'Untangle', text: `Both ends are held; every other vertex was put at random. ${wrong}.` };
    if (preset === 'collapse') return { button: 'Unfold', text: `Both ends are held; every other vertex is in one point. ${wrong}.` };
    if (this.#scene?.motion) return { button: PRESETS[preset].title, text: `${PRESETS[preset].hint}.` };
    return start.inverted > 0 ? { button: 'Untangle', text: `${wrong}.` } : undefined;
  }

  get #settings() {
    const { method, material, young, poisson } = this.wanted;
    return { method, energy: material, ...(ELASTIC.includes(material) && { young, poisson }) };
  }

  /** Puts `next` on the bench in the scene of the preset; on failure the bench stays as it is. */
  async open(next = this.source, { busy = '', keep = false } = {}) {
    this.pause();
    const { session } = this;
    const asked = { ...this.wanted };
    const mine = { next, busy, keep };
    this.#opening = mine;
    const overtaken = () => this.#opening !== mine;
    if (busy) this.busy(busy);
    let solid;
    const same = session.solid !== undefined && session.problem?.source === next;
    try {
      solid = same ? session.solid : await session.read(next);
      if (overtaken()) {
        if (!same) solid.free();
        return false;
      }
      const made = scene(asked.preset, solid.positions, keep ? this.handles.groups.map(({ vertices }) => vertices) : undefined);
      const handles = new Handles();
      for (const vertices of made.held) handles.add(vertices, made.start);
      handles.selected = -1;
      // From here on the solid is the session's, except when it fails.
      const start = await session.build({
        source: next, solid, settings: this.#settings, pins: handles.pins(), start: () => made.start, fresh: true,
      });
      if (!start) return false;
      this.source = next;
      [this.handles, this.#scene, this.#rest, this.#moved] = [handles, made, solid.positions, 0];
      if (!same) this.bench.solid({ positions: solid.positions, tetrahedra: solid.tetrahedra, surface: solid.surface });
      this.#look();
      this.#begin(start, asked.preset);
      this.remember();
      this.clearNotice();
      this.#settled(asked);
      return true;
    } catch (error) {
      if (overtaken()) return false;
      if (!same) solid?.free();
      const name = next.name ?? next.solid;
      this.notice(next === this.source && session.ready ? 'The solver could not start' : `${name} was not opened`, describe(error));
      this.#takeBack();
      if (this.records.length) this.show(this.shown, { quietly: true });
      return false;
    } finally {
      if (!overtaken()) {
        this.#opening = undefined;
        this.busy('');
        this.reflect();
      }
    }
  }

  /** What the controls say, and what is held, is what the solver has. */
  #settled(wanted) {
    this.#good = wanted;
    this.#held = [...this.handles.groups];
  }

  /** The controls and the handles go back to what the solver has. */
  #takeBack() {
    Object.assign(this.wanted, this.#good);
    this.handles.keepOnly(this.#held);
    this.#drawHandles();
    this.reflect();
  }

  /** A run begins on the canvas. */
  #begin(start, name) {
    this.bench.begin(this.wanted.method, name, this.wanted.material);
    this.push(start);
    this.records = this.session.records;
    this.#drawHandles();
    this.show(0);
    this.#facts();
    this.invite();
  }

  /**
   * A new solver from where the solid is now, for other pins, another material or another method; says how that ended:
   * `done`, `failed` (controls and handles are back at what they were), `overtaken` by something asked for later, or
   * `suspended` while nothing is held.
   */
  async #rebuild({ fresh = false, start = (positions) => positions, go = true } = {}) {
    if (this.#opening) return (await this.open(this.#opening.next, this.#opening)) ? 'done' : 'failed';
    const { session } = this;
    const pins = this.handles.pins();
    const asked = { ...this.wanted };
    this.pause();
    if (pins.length === 0) {
      session.suspend();
      this.notice(NOTHING_HELD, 'Pin something before it can go on: click a vertex, or drag a box around some with Shift.', { plain: true });
      this.#settled(asked);
      return 'suspended';
    }
    this.clearNotice(NOTHING_HELD);
    // Pins that were released or added have to be known before anything moves.
    const begun = this.records.length > 1;
    try {
      const made = await session.build({
        source: this.source, settings: this.#settings, pins, targets: this.handles.targets(), fresh: fresh || !begun,
        start: () => this.handles.applied(start(session.positions)),
      });
      if (!made) return 'overtaken';
      if (fresh || !begun) this.#begin(made, begun ? 'here' : this.wanted.preset);
      this.#facts();
      this.#settled(asked);
      if (go && begun) this.#hurry();
      return 'done';
    } catch (error) {
      this.notice('The solver could not go on', describe(error));
      this.#takeBack();
      return 'failed';
    }
  }

  push(step) {
    const { energy, young } = this.#settings;
    const unit = young ?? 1;
    this.bench.pushSolid(step, ELASTIC.includes(energy) && step.field ? step.field.map((x) => x / unit) : step.field);
  }

  // ——— playing ———

  get restless() {
    const { motion } = this.#scene ?? {};
    return motion !== undefined && this.#moved < motion.steps && this.handles.groups[motion.handle] !== undefined;
  }

  /** The scene's motion, one iteration on. */
  async beforeStep() {
    if (!this.restless) return;
    const { motion } = this.#scene;
    this.#moved += 1;
    this.handles.groups[motion.handle].at = motion.at(this.#moved);
    this.#drawTargets();
    await this.session.aim(this.handles.targets());
  }

  async runFreely(mayGo) {
    try {
      if (mayGo()) await this.beforeStep();
      if (!mayGo()) return false;
      await this.session.run(async (step, skipped) => {
        skipped.forEach((record) => this.bench.pushNumbers(record));
        this.#tick(skipped.length);
        this.took(step);
        // One step of the motion a frame: what is inside has time to follow what is held.
        await Promise.all([mayGo() && this.beforeStep(), nextFrame()]);
        if (!mayGo()) this.session.stop();
      });
      // A target that moved while the last step was being made keeps it going.
      await nextFrame();
      return !this.session.finished || this.restless;
    } catch (error) {
      this.notice('The solver stopped', describe(error));
      return false;
    }
  }

  took(step) {
    if (this.records !== this.session.records) this.records = this.session.records;
    this.#tick(1);
    super.took(step);
  }

  #tick(count) {
    const now = performance.now();
    this.#ticks.push([now, count]);
    while (this.#ticks.length > 2 && this.#ticks[0][0] < now - 1000) this.#ticks.shift();
  }

  /** Iterations a second, lately. */
  get rate() {
    if (this.#ticks.length < 3) return undefined;
    const [first] = this.#ticks[0];
    const [last] = this.#ticks.at(-1);
    const count = this.#ticks.slice(1).reduce((sum, [, n]) => sum + n, 0);
    return last - first > 100 ? (1000 * count) / (last - first) : undefined;
  }

  pause() {
    super.pause();
    this.#ticks = [];
  }

  /** Goes on at full speed until it rests. */
  #hurry() {
    if (!this.active) return;
    if (this.playing && !this.solving) this.pause();
    this.hurried = true;
    if (!this.playing) this.keepGoing();
  }

  finish() {
    this.#facts();
  }

  /** Back to the start of the scene, with what is held now. */
  async reset() {
    if (!this.whenReady(() => this.reset())) return;
    await this.open(this.source, { keep: this.handles.groups.length > 0 });
  }

  // ——— what people do ———

  /** Plays a preset: scenes with a motion begin at rest, the others spoil what is on the bench. */
  async preset(name) {
    if (!this.whenReady(() => this.preset(name))) return;
    this.wanted.preset = name;
    const spoil = { random: scattered, collapse: collapsed }[name];
    if (spoil && this.records.length > 1 && this.handles.groups.length > 0) {
      this.pause();
      if (this.#scene) this.#scene.motion = undefined;
      const pins = this.handles.pins();
      const start = (positions) => spoil(this.#rest, positions, pins);
      if ((await this.#rebuild({ fresh: true, start, go: false })) !== 'done') return;
      this.remember();
    } else if (!(await this.open())) return;
    if (!this.solving) await this.play();
  }

  /** Whether there is a solid with handles, and not another one on its way. */
  get #mayHold() {
    return this.session?.ready && this.#rest !== undefined && !this.#opening;
  }

  /** What people do on the canvas. */
  listen(name, value) {
    if (!this.#mayHold) return;
    switch (name) {
      case 'pin': return void this.pin(value);
      case 'select':
        this.handles.selected = value;
        return this.#drawHandles();
      case 'grab-handle':
      case 'grab-vertex':
        if (this.shown < this.records.length - 1) this.show(this.records.length - 1);
        if (name === 'grab-handle') this.handles.grab(value);
        else if (this.handles.groups.length > 0) this.handles.pull(value, this.session.positions);
        // A hand on a handle ends its own motion.
        if (this.#scene && name === 'grab-handle' && this.#scene.motion?.handle === value) this.#scene.motion = undefined;
        return this.#drawHandles();
      case 'drag':
        if (!this.handles.dragging) return;
        this.handles.drag(value);
        return void this.#aim();
      case 'turn':
        this.handles.turn(this.#scene.axis, value);
        return void this.#aim();
      case 'drop':
        if (!this.handles.dragging) return;
        this.handles.drop();
        return void this.#aim();
      default:
    }
  }

  /** Holds vertices where they are. */
  async pin(vertices) {
    if (!this.handles.add(vertices, this.session.positions)) return;
    this.#drawHandles();
    await this.#rebuild();
  }

  /** Lets the selected handle go, or all. */
  async release() {
    if (!this.whenReady(() => this.release()) || this.#opening || !this.handles.release()) return;
    if (this.#scene) this.#scene.motion = undefined;
    this.#drawHandles();
    await this.#rebuild();
  }

  /** Moves the selected handle by steps to the right and up in the view. */
  nudge(right, up) {
    const axes = this.bench.cameraAxes(NUDGE);
    const delta = [0, 1, 2].map((k) => right * axes[k] + up * axes[3 + k]);
    if (this.#mayHold && this.handles.move(delta)) this.#aim();
  }

  /** Turns the selected handle about the longest axis of the solid, a twelfth of a turn times `times`. */
  twist(times) {
    if (this.#mayHold && this.handles.twist(this.#scene.axis, (times * Math.PI) / 6)) this.#aim();
  }

  /** Selects the next handle. */
  nextHandle() {
    const count = this.handles.groups.length;
    if (count === 0) return;
    this.handles.selected = (this.handles.selected + 1) % count;
    this.#drawHandles();
  }

  async #aim() {
    this.#drawTargets();
    try {
      await this.session.aim(this.handles.targets());
      if (!this.session.finished) this.#hurry();
    } catch (error) {
      this.notice('It cannot go there', describe(error));
    }
  }

  // ——— what is shown ———

  #drawHandles() {
    this.bench?.handles(this.handles);
    this.#drawTargets();
    this.#controls.reflectHandles();
  }

  #drawTargets() {
    this.bench?.targets(this.handles.targets());
  }

  /** Colours, cut and tool, as the controls say. */
  #look() {
    const { field, cut, at } = this.wanted;
    this.bench.field(field);
    this.bench.cut('xyz'.indexOf(cut), at);
    this.#controls.look();
  }

  /** How the solid is looked at: `field`, `cut`, `at`. */
  look(key, value) {
    this.wanted[key] = value;
    this.#good[key] = value;
    if (this.page.canvas) this.#look();
    this.remember();
  }

  /** A parameter of the solver. */
  async change(key, value) {
    this.wanted[key] = value;
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    this.remember();
    if (this.records.length < 2 && this.handles.groups.length > 0) await this.open(this.source, { keep: true });
    else await this.#rebuild({ fresh: true });
    this.remember();
  }

  async changeSolid(solid, tetrahedra) {
    const next = { solid, tetrahedra };
    Object.assign(this.wanted, next);
    if (!this.whenReady(() => this.open(next))) return;
    await this.open(next, { busy: 'Building the solid' });
  }

  async openFiles(files) {
    if (!this.whenReady(() => this.openFiles(files))) return;
    const [file] = files;
    this.busy(`Reading ${file.name}`);
    let next;
    try {
      next = await readSolidFiles(files);
    } catch (error) {
      this.busy('');
      return this.notice(`${file.name} was not opened`, describe(error));
    }
    const before = this.wanted.preset;
    this.wanted.preset = 'held';
    if (!(await this.open(next, { busy: `Reading ${file.name}` }))) this.wanted.preset = before;
  }

  #facts() {
    const { problem, certificate } = this.session;
    if (!problem) return;
    const { setupSeconds, notes, pins } = problem;
    const pairs = [
      ['solid', this.source.name ?? this.#controls.solidTitle],
      ['vertices', whole(this.#rest.length / 3)],
      ['held', `${whole(pins)} vertices`],
      ['setup', `${number(1000 * setupSeconds, 3)} ms`],
      ['threads', String(this.page.foldfree.threads)],
      ...notes.map((text, i) => [i === 0 ? 'notes' : '', text]),
    ];
    if (this.session.finished && this.session.newest.iteration > 0) pairs.push(['ended', `${ending(this.session.newest)} after ${this.session.newest.iteration}`]);
    if (certificate) {
      const wrong = certificate.inverted.length + certificate.degenerate.length;
      pairs.push(['certificate', wrong === 0 ? 'no tetrahedron inverted (exact)' : `${whole(wrong)} inverted (exact)`]);
      if (wrong === 0) pairs.push(['', certificate.locallyInjective ? 'injective around every vertex (exact)' : 'it overlaps around an edge or a vertex (exact)']);
    }
    this.bench.facts(pairs);
  }

  reflect() {
    this.#controls.reflect();
  }

  remember(extra = {}) {
    if (!this.active) return;
    const { wanted, source } = this;
    const { field, cut, at } = wanted;
    if (source.bytes) writeAddress('deform', { field, cut, at });
    else writeAddress('deform', { ...wanted, steps: undefined, solid: source.solid, tetrahedra: source.tetrahedra, ...extra });
  }

  get exports() {
    const name = (this.source.name ?? this.source.solid).replace(/\.(mesh|msh|vtk|node)(\.gz)?$/i, '');
    return {
      'export-solid': async () => save(medit(await this.session.result(), this.session.solid.tetrahedra), `${name}-${this.wanted.method}.mesh`, 'text/plain'),
      'export-trace': async () => save(`${JSON.stringify(await this.session.trace(), null, 1)}\n`, `${name}-${this.wanted.method}.json`, 'application/json'),
    };
  }

  connect() {
    this.#controls.connect();
  }

  pickMethod(index) {
    const method = this.#controls.methods[index];
    if (method && METHODS[method]) this.change('method', method);
  }
}
