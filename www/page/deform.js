// The Deform mode: a solid, what is held of it, and the solver that finds its rest.
import { isDefault, readAddress, writeAddress } from './address.js';
import { preparedSolid } from './canvas.js';
import { DeformControls } from './deform-controls.js';
import { factsOf } from './deform-facts.js';
import { Hands } from './deform-hands.js';
import { DeformSession } from './deform-session.js';
import { objOf, readSolidFiles, save } from './files.js';
import { FIGURES, isFigure } from './figures.js';
import { Handles } from './handles.js';
import { LimControls, limName, limSettings } from './lim-controls.js';
import { isElastic } from './materials.js';
import { Mode, nextFrame } from './mode.js';
import { Motion } from './motion.js';
import { describe } from './notice.js';
import { PRESETS, collapsed, presetsOf, scattered, scene } from './presets.js';
import { Rate } from './rate.js';
import { relativeTo, volumeOf } from './relative.js';
import { drawSight } from './sight.js';
import { METHODS, whole } from './words.js';

/** Presets that spoil what they are given. */
const SPOILS = { random: scattered, collapse: collapsed };

/** Title of a notice. */
const NOTHING_HELD = 'Nothing is held';

export class Deform extends Mode {
  static accepts = '.mesh,.msh,.vtk,.node,.ele,.gz';
  static dropHere = 'Drop a MESH, MSH or VTK file, or a NODE file with its ELE file, to deform it';
  static label = 'An elastic solid in 3D with its handles, the solid cut open, the convergence plot and what the step did. Keys select, move, turn, pin and release handles; the help lists them';
  static first = 'shape'; // the view a phone shows
  static views = { map: 'Cut', shape: 'Solid', plot: 'Plot', inspector: 'Step' };
  wanted = readAddress('deform');
  source = { solid: this.wanted.solid, tetrahedra: this.wanted.tetrahedra };
  controls = new DeformControls(this);
  hands = new Hands(this);
  lim = new LimControls(this);
  #good = { ...this.wanted };
  #held = []; // the handles the solver knows
  #rest; // positions at rest
  #scene; // where things start
  #motion = new Motion(); // what moves by itself
  #movedAt; // the iteration after which it moved last
  #relative = (step) => step; // a step without units
  #rate = new Rate();
  #opening; // what is being opened, and how

  constructor(page) {
    super(page, 'deform');
  }

  // ——— opening ———

  async prepare() {
    if (this.records.length || !isDefault('deform', { ...this.wanted, ...this.source })) return this.records.length > 0;
    const drawn = await preparedSolid().catch(() => undefined);
    if (!drawn || this.records.length) return this.records.length > 0;
    const { method, preset, material } = this.wanted;
    this.#relative = relativeTo(this.#stiffness, volumeOf(drawn.positions, drawn.tetrahedra));
    this.bench.solid(drawn);
    this.#look();
    this.bench.begin(method, preset, material);
    this.push(drawn.start);
    const handles = new Handles();
    for (const vertices of scene(preset, Float64Array.from(drawn.positions)).held) handles.add(vertices, drawn.start.positions);
    this.hands.take(handles);
    this.records = [drawn.start];
    this.show(0);
    this.invite();
    return true;
  }

  async arrive(foldfree) {
    this.session ??= new DeformSession(foldfree);
    this.controls.list(foldfree.solidShapes);
    if (this.session.ready) return true;
    const opened = await this.open(this.source);
    if (opened && this.waiting) await this.catchUp();
    else if (opened && this.wanted.steps) await this.steps(this.wanted.steps);
    return opened;
  }

  invitation() {
    const start = this.records[0];
    const { preset } = this.wanted;
    const wrong = `${whole(start.inverted)} of ${whole(this.bench.tetrahedra)} ${this.figure ? 'triangles' : 'tetrahedra'} are inside out`;
    if (preset === 'random') return { button: 'Untangle', text: `Both ends are held; every other vertex was put at random. ${wrong}.` };
    if (preset === 'collapse') return { button: 'Unfold', text: `Both ends are held; every other vertex is in one point. ${wrong}.` };
    if (this.#scene?.motion) return { button: PRESETS[preset].title, text: `${PRESETS[preset].hint}.` };
    return start.inverted > 0 ? { button: 'Untangle', text: `${wrong}.` } : undefined;
  }

  get handles() {
    return this.hands.handles;
  }

  /** The coordinate axis handles are turned about. */
  get axis() {
    return this.#scene?.axis ?? 0;
  }

  /** Whether there is a solid with handles, and not another one on its way. */
  get mayHold() {
    return this.session?.ready === true && this.#rest !== undefined && !this.#opening;
  }

  get #settings() {
    const { method, material, young, poisson } = this.wanted;
    if (this.isLim) return limSettings(this.wanted);
    return { method, energy: material, ...(isElastic(material) && { young, poisson }) };
  }

  /** Whether locally injective mappings are the method. */
  get isLim() {
    return this.wanted.method === 'lim';
  }

  /** The figure in the plane that is on the bench, if one is. */
  get figure() {
    return FIGURES[this.source.solid];
  }

  get #stiffness() {
    return this.#settings.young ?? 1;
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
      const kept = keep ? this.handles.groups.map(({ vertices }) => vertices) : undefined;
      const made = scene(asked.preset, solid.positions, kept, FIGURES[next.solid]);
      const handles = new Handles();
      for (const vertices of made.held) handles.add(vertices, made.start);
      // From here on the solid is the session's, except when it fails.
      const start = await session.build({
        source: next, solid, settings: this.#settings, pins: handles.pins(), start: () => made.start, fresh: true,
      });
      if (!start) return false;
      this.source = next;
      [this.#scene, this.#motion, this.#rest] = [made, new Motion(made.motion), solid.positions];
      this.#movedAt = undefined;
      if (!same && session.planar) this.bench.planar(solid);
      else if (!same) this.bench.solid(solid);
      this.hands.take(handles);
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
    this.hands.draw();
    this.reflect();
  }

  /** A run begins on the canvas. */
  #begin(start, name) {
    const { method, material } = this.wanted;
    // Locally injective mappings count without units.
    this.#relative = this.isLim ? (step) => step : relativeTo(this.#stiffness, this.session.problem.volume);
    if (this.isLim) this.bench.begin(limName(this.wanted), name, `lim:${this.wanted.energy}`);
    else this.bench.begin(method, name, material);
    this.push(start);
    this.records = this.session.records;
    this.hands.draw();
    this.show(0);
    this.#facts();
    this.invite();
  }

  /**
   * A new solver from where the solid is now, for other pins, another material or another method; says how that ended:
   * `done`, `failed` (controls and handles are back at what they were), `overtaken` by something asked for later, or
   * `suspended` while nothing is held.
   */
  async rebuild({ fresh = false, start = (positions) => positions, go = true } = {}) {
    if (this.#opening) return (await this.open(this.#opening.next, this.#opening)) ? 'done' : 'failed';
    const { session } = this;
    const pins = this.handles.pins();
    const asked = { ...this.wanted };
    this.pause();
    if (pins.length === 0) {
      session.suspend();
      this.#tellNothingIsHeld();
      this.#settled(asked);
      return 'suspended';
    }
    this.clearNotice(NOTHING_HELD);
    // Pins that were released or added have to be known before anything moves.
    const begun = this.records.length > 1;
    try {
      const made = await session.build({
        source: this.source, settings: this.#settings, pins, targets: this.handles.targets(), fresh: fresh || !begun,
        // What is held is led to its place, not put there.
        start: () => (this.isLim ? session.result().then(start) : this.handles.applied(start(session.positions))),
      });
      if (!made) return 'overtaken';
      if (fresh || !begun) this.#begin(made, begun ? 'here' : this.wanted.preset);
      this.#facts();
      this.#settled(asked);
      if (go && begun) this.hurry();
      return 'done';
    } catch (error) {
      this.notice('The solver could not go on', describe(error));
      this.#takeBack();
      return 'failed';
    }
  }

  #tellNothingIsHeld() {
    this.notice(NOTHING_HELD, 'Pin something before it can go on: click a vertex, or drag a box around some with Shift.');
  }

  // ——— playing ———

  readout(record) {
    return this.#relative(record);
  }

  push(step) {
    this.bench.pushSolid(this.#relative(step));
    this.bench.subTargets(step.subTargets);
  }

  get restless() {
    return this.handles.groups[this.#motion.handle] !== undefined;
  }

  /** The scene's motion goes on. */
  async beforeStep({ freely = false } = {}) {
    const { iteration } = this.session.newest;
    // What is held and what is inside move by turns.
    if (!this.restless || iteration === this.#movedAt) return;
    this.#movedAt = iteration;
    const group = this.handles.groups[this.#motion.handle];
    group.at = this.#motion.advance({ freely });
    this.hands.drawTargets();
    await this.session.aim(this.handles.targets());
  }

  /** The motion ends, if it is that of a handle; or any. */
  endMotion(handle = this.#motion.handle) {
    if (handle === this.#motion.handle) this.#motion.end();
  }

  async runFreely(mayGo) {
    try {
      await this.beforeStep({ freely: true });
      if (!mayGo()) return false;
      await this.session.run(async (step, skipped) => {
        skipped.forEach((record) => this.bench.pushNumbers(this.#relative(record)));
        this.#rate.tick(skipped.length);
        this.took(step);
        // The motion goes on once a frame: what is inside has time to follow what is held.
        await Promise.all([mayGo() && this.beforeStep({ freely: true }), nextFrame()]);
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
    this.#rate.tick();
    super.took(step);
  }

  get rate() {
    return this.#rate.perSecond;
  }

  pause() {
    super.pause();
    this.#rate.clear();
    this.#motion.pause();
  }

  leave() {
    void this.hands.drop();
    super.leave();
  }

  enter() {
    super.enter();
    this.reflect(); // colours and cut are shared with other modes
  }

  async play() {
    if (this.mayHold && !this.playing && this.handles.groups.length === 0) return this.#tellNothingIsHeld();
    await super.play();
  }

  /** Goes on at full speed until it rests. */
  hurry() {
    if (!this.active) return;
    if (this.playing && !this.solving) this.pause();
    this.hurried = true;
    if (!this.playing) this.keepGoing();
  }

  showNewest() {
    if (this.shown < this.records.length - 1) this.show(this.records.length - 1);
  }

  finish() {
    this.#facts();
  }

  #facts() {
    if (this.session.problem) this.bench.facts(factsOf(this.session, { title: this.source.name ?? this.controls.solidTitle, threads: this.page.foldfree.threads }));
  }

  // ——— what people do ———

  /** Back to the start of the scene, with what is held now. */
  async reset() {
    if (!this.whenReady(() => this.reset())) return;
    await this.open(this.source, { keep: this.handles.groups.length > 0 });
  }

  /** Plays a preset: those that spoil do so to what is on the bench, the others begin at rest. */
  async preset(name) {
    if (!this.whenReady(() => this.preset(name))) return;
    this.wanted.preset = name;
    const spoil = SPOILS[name];
    if (spoil && this.records.length > 1 && this.handles.groups.length > 0) {
      this.endMotion();
      const pins = this.handles.pins();
      const start = (positions) => spoil(this.#rest, positions, pins);
      if ((await this.rebuild({ fresh: true, start, go: false })) !== 'done') return;
      this.remember();
    } else if (!(await this.open())) return;
    if (name !== 'held' && !this.solving) await this.play();
  }

  listen(name, value) {
    this.hands.listen(name, value);
  }

  async release() {
    if (this.whenReady(() => this.release())) await this.hands.release();
  }

  /** A parameter of the solver: another energy or method begins another curve. */
  async change(key, value) {
    this.wanted[key] = value;
    // A start full of inversions is none for this method.
    if (this.isLim && this.records.length < 2 && SPOILS[this.wanted.preset]) this.wanted.preset = 'twist';
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    if (this.records.length < 2 && this.handles.groups.length > 0) await this.open(this.source, { keep: true });
    else await this.rebuild({ fresh: true });
    this.remember();
  }

  /** A parameter of locally injective mappings: the same drag again, from rest. */
  async again(key, value) {
    this.wanted[key] = value;
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    const played = !this.hands.used && this.#scene?.motion && this.records.length > 1;
    if (this.records.length < 2 || played) {
      if ((await this.open(this.source, { keep: true })) && played && !this.solving) await this.play();
    } else await this.rebuild({ fresh: true, start: () => Float64Array.from(this.#rest) });
    this.remember();
  }

  pickMethod(index) {
    const method = this.controls.methods[index];
    if (method && METHODS[method]) this.change('method', method);
  }

  /** How the solid is looked at: `field`, `cut`, `at`. */
  look(key, value, { moving = false } = {}) {
    this.wanted[key] = value;
    this.#good[key] = value;
    if (this.page.canvas) this.#look();
    if (!moving) this.remember();
  }

  #look() {
    drawSight(this.bench, this.wanted);
    this.controls.look();
  }

  async changeSolid(solid, tetrahedra) {
    const other = isFigure(solid) !== Boolean(this.figure);
    const next = { solid, tetrahedra: other ? (isFigure(solid) ? 2000 : 3000) : tetrahedra };
    Object.assign(this.wanted, next);
    // With Dirichlet’s energy a barrier makes the most difference.
    if (isFigure(solid)) Object.assign(this.wanted, { method: 'lim', energy: other ? 'dirichlet' : this.wanted.energy });
    if (!presetsOf(isFigure(solid)).includes(this.wanted.preset)) this.wanted.preset = isFigure(solid) ? 'drag' : 'twist';
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
    this.wanted.preset = 'held';
    if (this.figure) this.wanted.method = 'wrapd';
    await this.open(next, { busy: `Reading ${file.name}` });
  }

  reflect() {
    this.controls.reflect();
    this.lim.reflect();
  }

  /** Writes what is on the bench into the address; of a file only how it is solved and looked at. */
  remember(extra = {}) {
    if (!this.active) return;
    const { wanted, source } = this;
    const solid = source.bytes ? { solid: undefined, tetrahedra: undefined } : { solid: source.solid, tetrahedra: source.tetrahedra };
    writeAddress('deform', { ...wanted, steps: undefined, ...solid, ...(!source.bytes && extra) });
  }

  /** What a link does not carry, besides files. */
  get notShared() {
    return this.hands.used ? 'What you pinned, released and dragged stays here.' : '';
  }

  get exports() {
    const name = (this.source.name ?? this.source.solid).replace(/\.(mesh|msh|vtk|node)(\.gz)?$/i, '');
    const { session } = this;
    const figure = async () => save(objOf(await session.result(), session.solid.indices), `${name}-lim.obj`, 'text/plain');
    return {
      'export-solid': session.planar ? figure : async () => save(await session.solid.write('mesh', await session.result()), `${name}-${this.wanted.method}.mesh`, 'text/plain'),
      'export-trace': async () => save(`${JSON.stringify(await session.trace(), null, 1)}\n`, `${name}-${this.wanted.method}.json`, 'application/json'),
    };
  }

  connect() {
    this.controls.connect();
    this.lim.connect();
  }
}
