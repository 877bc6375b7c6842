// The Flatten mode: a surface, its map, and the solver that unfolds it.
import { DEFAULTS, isDefault, readAddress, writeAddress } from './address.js';
import { preparedStart } from './canvas.js';
import { readMeshFile, save } from './files.js';
import { Mode } from './mode.js';
import { describe } from './notice.js';
import { Session } from './session.js';
import { chosenSample, listSamples, reflectSource, titleOf } from './surface-controls.js';
import { FOLDED_STARTS, MAJORIZES, METHODS, NEEDS_INJECTIVE, ending, number, whole } from './words.js';

const $ = (id) => document.getElementById(id);
const DIRECT = ['lscm', 'harmonic', 'tutte'];

export class Flatten extends Mode {
  static accepts = '.obj,.off,.ply,.stl,.mesh,.msh,.vtk,.gz';
  static dropHere = 'Drop a surface to flatten it: OBJ, OFF, PLY, STL, MESH, MSH or VTK';
  static label = 'A surface in 3D, its flat map, the convergence plot and what the step did';
  static first = 'map'; // the view a phone shows
  static views = { map: 'Map', shape: 'Surface', plot: 'Plot', inspector: 'Step' };
  wanted = readAddress('flatten'); // what the controls say
  source = { sample: this.wanted.sample, triangles: this.wanted.triangles }; // what is, or will be, on the bench
  #good = { ...this.wanted };

  constructor(page) {
    super(page, 'flatten');
  }

  /** Draws the prepared start, if it is what is wanted; says whether it did. */
  async prepare() {
    if (this.records.length || !isDefault('flatten', { ...this.wanted, ...this.source })) return this.records.length > 0;
    const drawn = await preparedStart().catch(() => undefined);
    if (!drawn || this.records.length) return this.records.length > 0;
    this.bench.surface(drawn);
    this.bench.begin(this.wanted.method, DEFAULTS.flatten.start, this.wanted.energy);
    this.bench.push(drawn.start);
    this.records = [drawn.start];
    this.show(0);
    this.invite();
    return true;
  }

  /** The solver has come. */
  async arrive(foldfree) {
    this.session ??= new Session(foldfree);
    listSamples(foldfree.shapes);
    if (this.session.ready) return true;
    const opened = await this.open(this.source);
    if (opened && this.waiting) await this.catchUp();
    else if (opened && this.wanted.steps) await this.steps(this.wanted.steps);
    return opened;
  }

  invitation() {
    const start = this.records[0];
    const name = METHODS[this.wanted.method];
    if (DIRECT.includes(this.wanted.method)) return { button: 'Flatten', text: `${name} has no iterations: one linear system.` };
    return start.inverted > 0
      ? { button: 'Unfold', text: `${whole(start.inverted)} triangles lie upside down in this map. ${name} will turn them.` }
      : { button: 'Flatten', text: `Nothing is upside down in this map. ${name} will make it less distorted.` };
  }

  finish() {
    this.#facts();
    this.bench.crossings(this.session.certificate?.boundaryCrossings ?? []);
  }

  #facts() {
    if (!this.session?.problem) return;
    const { startKind, setupSeconds, notes } = this.session.problem;
    const pairs = [
      ['surface', titleOf(this.source)],
      ['start', startKind],
      ['setup', `${number(1000 * setupSeconds, 3)} ms`],
      ['threads', String(this.page.foldfree.threads)],
      ...notes.map((text, i) => [i === 0 ? 'notes' : '', text]),
    ];
    const last = this.session.newest;
    if (this.session.finished) pairs.push(['ended', `${ending(last)} after ${last.iteration}`]);
    const proof = this.session.certificate;
    if (proof) {
      pairs.push(['certificate', proof.locallyInjective ? 'no triangle inverted (exact)' : `${proof.inverted.length} inverted (exact)`]);
      if (proof.locallyInjective) pairs.push(['', proof.globallyInjective ? 'nothing overlaps (exact)' : `${proof.boundaryCrossingCount || ''} boundary crossings (exact)`]);
    }
    this.bench.facts(pairs);
  }

  enter() {
    super.enter();
    this.reflect(); // the controls are shared with the comparison
  }

  /** Brings the controls in line with what is wanted. */
  reflect() {
    if (!this.active) return;
    const { wanted, source } = this;
    for (const id of ['start', 'method', 'energy']) $(id).value = wanted[id];
    reflectSource(source);
    const direct = DIRECT.includes(wanted.method);
    $('start').disabled = direct;
    $('energy').disabled = direct || wanted.method === 'arap' || MAJORIZES.includes(wanted.method);
  }

  /** Solves `next` instead of what is on the bench; on failure the bench stays as it is. */
  async open(next = this.source, { busy = '' } = {}) {
    this.pause();
    const { wanted, session } = this;
    const asked = { ...wanted };
    let overtaken = false; // what came later says what is going on
    if (busy) this.busy(busy);
    try {
      const { method, energy, start } = wanted;
      const opened = await session.open({ source: next, settings: { method, energy, start } });
      if (!opened) return (overtaken = true, false);
      this.source = next;
      if (opened.surface) this.bench.surface(opened.surface);
      this.bench.begin(method, session.problem.startKind, energy);
      this.bench.push(opened.start);
      this.records = session.records;
      this.show(0);
      this.#facts();
      this.clearNotice();
      const other = session.problem.notes.find((note) => note.startsWith('the boundary of the start meets itself'));
      if (other) this.notice('Another start', describe(other), { plain: true });
      this.remember();
      this.invite();
      this.#good = { ...asked };
      return true;
    } catch (error) {
      const name = next.name ?? next.sample;
      this.notice(next === this.source ? `${METHODS[wanted.method]} could not start` : `${name} was not opened`, describe(error));
      Object.assign(wanted, this.#good);
      if (this.records.length) this.show(this.shown, { quietly: true });
      return false;
    } finally {
      if (!overtaken) this.busy('');
      this.reflect();
    }
  }

  /** Writes what is on the bench into the address. */
  remember(extra = {}) {
    if (!this.active) return;
    const { wanted, source } = this;
    const sample = source.bytes ? { sample: undefined, triangles: undefined } : { sample: source.sample, triangles: source.triangles };
    writeAddress('flatten', { ...wanted, steps: undefined, ...sample, ...(!source.bytes && extra) });
  }

  async reset() {
    if (!this.whenReady(() => this.reset())) return;
    await this.open();
  }

  async change(key, value) {
    const { wanted } = this;
    wanted[key] = value;
    if (MAJORIZES.includes(wanted.method)) wanted.energy = 'symmetric-dirichlet';
    // Who picks such a method wants to see it run, not to be told off.
    const impossible = NEEDS_INJECTIVE.includes(wanted.method) && wanted.energy === 'symmetric-dirichlet' && FOLDED_STARTS.includes(wanted.start);
    if (impossible && key !== 'start') wanted.start = 'automatic';
    this.reflect();
    const begin = async () => {
      if (!(await this.open()) || !impossible || key === 'start') return;
      this.notice('Another start', `${METHODS[wanted.method]} cannot begin with inverted triangles: it starts from the harmonic map, or from Tutte’s.`, { plain: true });
    };
    if (!this.whenReady(begin)) return;
    await begin();
  }

  async #changeSample() {
    const next = chosenSample();
    if (!next) return;
    [this.wanted.sample, this.wanted.triangles] = [next.sample, next.triangles];
    if (!this.whenReady(() => this.open(next))) return;
    await this.open(next, { busy: next.triangles > 10_000 ? 'Building the surface' : '' });
  }

  async openFiles(files) {
    if (!this.whenReady(() => this.openFiles(files))) return;
    const [file] = files;
    this.busy(`Reading ${file.name}`);
    let next;
    try {
      next = await readMeshFile(file);
    } catch (error) {
      this.busy('');
      return this.notice(`${file.name} was not opened`, describe(error));
    }
    if (this.wanted.start === 'random' || this.wanted.start === 'collapsed') this.wanted.start = 'automatic';
    await this.open(next, { busy: `Reading ${file.name}` });
  }

  /** What can be exported: the ids of the menu's buttons and what they do. */
  get exports() {
    const name = (this.source.name ?? this.source.sample).replace(/\.(obj|off|ply|stl|mesh|msh|vtk)(\.gz)?$/i, '');
    const { method } = this.wanted;
    return {
      'export-obj': async () => save(await this.session.exportObj(), `${name}-${method}.obj`, 'model/obj'),
      'export-trace': async () => save(`${JSON.stringify(await this.session.trace(), null, 1)}\n`, `${name}-${method}.json`, 'application/json'),
    };
  }

  connect() {
    for (const id of ['start', 'method', 'energy']) $(id).addEventListener('change', () => { if (this.active) this.change(id, $(id).value); });
    for (const id of ['sample', 'triangles']) $(id).addEventListener('change', () => { if (this.active) this.#changeSample(); });
  }

  /** Picks the solver a number key stands for. */
  pickMethod(index) {
    const method = [...$('method').options][index]?.value;
    if (method) this.change('method', method);
  }
}
