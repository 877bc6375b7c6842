// The Compare mode: several solvers on one surface, from one start, on one clock.
import { readAddress, writeAddress } from './address.js';
import { COMPARABLE, CompareSession, FEWEST, MOST } from './compare-session.js';
import { readMeshFile, save } from './files.js';
import { Mode } from './mode.js';
import { describe } from './notice.js';
import { chosenSample, listSamples, reflectSource, titleOf } from './surface-controls.js';
import { showPanes } from './views.js';
import { METHODS, duration, ending, number, whole } from './words.js';

const $ = (id) => document.getElementById(id);

export class Compare extends Mode {
  static accepts = '.obj,.off,.ply,.stl,.mesh,.msh,.vtk,.gz';
  static dropHere = 'Drop a surface to compare solvers on: OBJ, OFF, PLY, STL, MESH, MSH or VTK';
  static label = 'Flat maps of one surface by several solvers, how fast each lowers the energy, and numbers';
  static first = 'map';
  static views = { map: 'Maps', shape: 'Surface', plot: 'Plot', inspector: 'Numbers' };
  wanted = readAddress('compare');
  source = { sample: this.wanted.sample, triangles: this.wanted.triangles };
  #good = { ...this.wanted };
  #adopted; // what the mode before showed when its surface was last taken over

  constructor(page, flatten) {
    super(page, 'compare');
    this.flatten = flatten;
  }

  get methods() {
    return this.wanted.methods.split(',');
  }

  // ——— opening ———

  async prepare() {
    return this.records.length > 0;
  }

  async arrive(foldfree) {
    this.session ??= new CompareSession(foldfree);
    listSamples(foldfree.shapes);
    if (this.session.ready) return true;
    const opened = await this.open(this.source);
    if (opened && this.waiting) await this.catchUp();
    else if (opened && this.wanted.steps) await this.steps(this.wanted.steps);
    return opened;
  }

  /** The surface of the mode that was shown before comes along, unless it has already. */
  enter() {
    super.enter();
    const { source } = this.flatten;
    if (this.flatten.records.length && source !== this.#adopted) {
      this.#adopted = source;
      const { sample, triangles } = source;
      if (sample) Object.assign(this.wanted, { sample, triangles });
      if (!this.session?.ready) this.source = source;
      else void this.open(source, { busy: 'Building the solvers' });
    }
    this.reflect();
    this.#tabs();
  }

  invitation() {
    const { startInverted } = this.session.problem;
    const names = this.session.lanes.map(({ method }) => METHODS[method]);
    const list = `${names.slice(0, -1).join(', ')} and ${names.at(-1)}`;
    const start = startInverted > 0 ? `the same map, ${whole(startInverted)} triangles upside down` : 'the same map without inversions';
    return { button: 'Compare', text: `${list} begin at ${start}.` };
  }

  /** Compares on `next`; on failure the bench stays as it is. */
  async open(next = this.source, { busy = 'Building the solvers' } = {}) {
    this.pause();
    const { wanted, session } = this;
    const asked = { ...wanted };
    let overtaken = false;
    this.busy(busy);
    try {
      session.clock = wanted.clock;
      const { start, energy } = wanted;
      const opened = await session.open({ source: next, settings: { start, energy }, methods: this.methods });
      if (!opened) return (overtaken = true, false);
      this.source = next;
      this.bench.surface(opened.surface);
      this.bench.race(this.methods, energy);
      this.bench.clock(wanted.clock);
      opened.starts.forEach((step, lane) => {
        if (step) this.bench.pushLane(lane, { ...step, energy: session.lanes[lane].newest.energy });
        else this.#ended(lane);
      });
      this.records = session.moments;
      this.#tabs();
      this.show(0);
      this.#facts();
      this.clearNotice();
      this.remember();
      this.invite();
      this.#good = asked;
      return true;
    } catch (error) {
      const name = next.name ?? next.sample;
      this.notice(next === this.source ? 'None of the solvers could start' : `${name} was not opened`, describe(error));
      Object.assign(wanted, this.#good);
      if (this.records.length) this.show(this.shown, { quietly: true });
      return false;
    } finally {
      if (!overtaken) this.busy('');
      this.reflect();
    }
  }

  #facts() {
    const { startKind, startInverted, notes, setupSeconds } = this.session.problem;
    const names = { tutte: 'Tutte', harmonic: 'harmonic', lscm: 'LSCM', random: 'random', collapsed: 'one point' };
    const pairs = [
      ['surface', titleOf(this.source)],
      ['start of all', `${names[startKind] ?? startKind}, ${startInverted === 0 ? 'none' : whole(startInverted)} inverted`],
      ['', startInverted > 0 && this.wanted.energy === 'symmetric-dirichlet' ? 'CM and SLIM cannot begin there' : 'every solver can begin there'],
      ['setup, apart', this.session.lanes.map((_, i) => (setupSeconds[i] === undefined ? '–' : number(1000 * setupSeconds[i], 2))).join(' · ') + ' ms'],
      ['threads', String(this.page.foldfree.threads)],
      ...notes.map((text, i) => [i === 0 ? 'notes' : '', text]),
    ];
    this.bench.facts(pairs);
  }

  /** A solver has ended, or failed: its pane says so. */
  #ended(index) {
    const lane = this.session.lanes[index];
    this.bench.endLane(index, lane.error ? describe(lane.error) : ending(lane.newest).split(':')[0], Boolean(lane.error));
  }

  // ——— playing ———

  /** The session steps; every step of a solver goes to its pane. */
  async makeStep() {
    return this.session.step(
      (lane, step) => this.bench.pushLane(lane, step),
      (lane) => this.#ended(lane),
    );
  }

  push() {} // the panes have it already

  ended() {} // each pane says how its solver ended

  drawShown(index) {
    const { session, bench } = this;
    const moment = session.moments[index];
    if (!moment || !bench) return;
    const { best } = session;
    bench.best(best);
    bench.moment(moment.at, session.shownAt(moment));
  }

  /** What the status line says of a moment: the clock, the lowest energy, all inversions. */
  readout(moment) {
    const { session } = this;
    const shown = session.shownAt(moment);
    const now = session.lanes.map((lane, i) => ({ lane, record: lane.records[shown[i]] })).filter(({ record }) => record);
    const lead = now.reduce((best, next) => (rank(next.record) < rank(best.record) ? next : best));
    const newest = this.records.at(-1);
    const behind = newest.at > moment.at;
    const name = METHODS[lead.lane.method];
    const inverted = now.reduce((sum, { record }) => sum + record.inverted, 0);
    const where = session.clock === 'seconds'
      ? `${duration(moment.at)}${behind ? ` of ${duration(newest.at)}` : ''}`
      : `iteration ${moment.at}${behind ? ` of ${newest.at}` : ''}`;
    // Ahead of the others by more than rounding.
    const ahead = lead.record.inverted === 0 && now.every(({ record }) => (
      record === lead.record || record.inverted > 0 || record.energy - lead.record.energy > 1e-9 * Math.abs(lead.record.energy)
    ));
    return {
      iteration: moment.at, energy: lead.record.energy, inverted, phases: [], seconds: 0, where,
      lead: ahead ? name : undefined,
      spoken: `${where}, ${ahead ? `${name} is lowest, ` : ''}energy ${number(lead.record.energy)}, ${inverted} inverted in all maps`,
    };
  }

  showMoment(time) {
    this.scrub(this.session.momentAt(time));
  }

  listen(name, value) {
    if (name === 'moment' && this.session?.ready) this.showMoment(value);
  }

  // ——— what people do ———

  async reset() {
    if (!this.whenReady(() => this.reset())) return;
    await this.open();
  }

  /** Another start, or another energy. */
  async change(key, value) {
    this.wanted[key] = value;
    const known = COMPARABLE[this.wanted.energy];
    const kept = this.methods.filter((method) => known.includes(method));
    for (const method of known) if (kept.length < FEWEST && !kept.includes(method)) kept.push(method);
    this.wanted.methods = kept.join(',');
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    await this.open();
  }

  /** A solver joins, or leaves. */
  async toggle(method) {
    const { methods } = this;
    const on = methods.includes(method);
    if (on && methods.length <= FEWEST) return this.notice('Two at least', 'Choose another solver before this one leaves.', { plain: true });
    if (!on && methods.length >= MOST) return this.notice('Four at most', 'Let one of the others go first.', { plain: true });
    const next = on ? methods.filter((m) => m !== method) : [...methods, method];
    // Their order is that of the buttons.
    const known = COMPARABLE[this.wanted.energy];
    await this.change('methods', known.filter((m) => next.includes(m)).join(','));
  }

  /** The clock counts something else; what is on show stays as near as it can be. */
  setClock(clock) {
    this.wanted.clock = clock;
    this.reflect();
    if (!this.session?.ready) return;
    const { session } = this;
    this.pause();
    const atEnd = this.shown >= this.records.length - 1;
    const [index] = session.shownAt(session.moments[this.shown]);
    const first = session.lanes.find((lane) => lane.records.length) ?? session.lanes[0];
    const record = first.records[Math.min(index, first.records.length - 1)];
    session.clock = clock;
    this.records = session.moments;
    this.bench.clock(clock);
    this.show(atEnd ? this.records.length - 1 : session.momentAt(session.timeOf(record)));
    this.remember();
  }

  async changeSample() {
    const next = chosenSample();
    if (!next) return;
    Object.assign(this.wanted, next);
    if (!this.whenReady(() => this.open(next))) return;
    await this.open(next);
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
    await this.open(next, { busy: `Reading ${file.name}` });
  }

  pickMethod(index) {
    const method = COMPARABLE[this.wanted.energy][index];
    if (method) void this.toggle(method);
  }

  // ——— controls ———

  /** A phone's tabs: one for each map. */
  #tabs() {
    if (this.active) showPanes(this.methods.map((method) => METHODS[method]), (pane) => this.bench?.pane(pane));
  }

  reflect() {
    if (!this.active) return;
    const { wanted } = this;
    reflectSource(this.source);
    $('start').value = wanted.start;
    $('energy').value = wanted.energy;
    for (const id of ['start', 'energy']) $(id).disabled = false;
    const known = COMPARABLE[wanted.energy];
    for (const button of $('contestants').children) {
      const { method } = button.dataset;
      button.hidden = !known.includes(method);
      button.setAttribute('aria-pressed', String(this.methods.includes(method)));
    }
    for (const button of $('clock').children) button.setAttribute('aria-pressed', String(button.dataset.clock === wanted.clock));
  }

  remember(extra = {}) {
    if (!this.active) return;
    const { wanted, source } = this;
    const sample = source.bytes ? { sample: undefined, triangles: undefined } : { sample: source.sample, triangles: source.triangles };
    // Seconds differ from machine to machine, so that only iterations are shared.
    const steps = wanted.clock === 'iterations' && !source.bytes ? extra.steps : undefined;
    writeAddress('compare', { ...wanted, ...sample, steps });
  }

  get exports() {
    const name = (this.source.name ?? this.source.sample).replace(/\.(obj|off|ply|stl|mesh|msh|vtk)(\.gz)?$/i, '');
    const { session } = this;
    return {
      'export-csv': async () => save(session.csv(), `${name}-compared.csv`, 'text/csv'),
      'export-trace': async () => save(`${JSON.stringify(session.trace(), null, 1)}\n`, `${name}-compared.json`, 'application/json'),
    };
  }

  connect() {
    for (const id of ['start', 'energy']) $(id).addEventListener('change', () => { if (this.active) this.change(id, $(id).value); });
    for (const id of ['sample', 'triangles']) $(id).addEventListener('change', () => { if (this.active) this.changeSample(); });
    for (const method of COMPARABLE['symmetric-dirichlet']) {
      const button = Object.assign(document.createElement('button'), { type: 'button' });
      button.dataset.method = method;
      const swatch = document.createElement('span');
      swatch.className = 'swatch';
      button.append(swatch, METHODS[method]);
      button.addEventListener('click', () => this.toggle(method));
      $('contestants').append(button);
    }
    for (const button of $('clock').children) button.addEventListener('click', () => this.setClock(button.dataset.clock));
  }
}

/** Lower is better; what is inverted comes last. */
const rank = ({ energy, inverted }) => (inverted > 0 ? 1e300 : 0) + (Number.isFinite(energy) ? energy : 1e299);
