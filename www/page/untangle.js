// The Untangle mode: a folded body, and the solver that leads it to a map without inverted elements, part by part.
import { readAddress, writeAddress } from './address.js';
import { CONTACTS, MOST_ELEMENTS, keepsApart, moved } from './contact-problems.js';
import { proofOf } from './deform-facts.js';
import { readUntangleFiles, save } from './files.js';
import { Handles } from './handles.js';
import { Mode } from './mode.js';
import { describe } from './notice.js';
import { pick } from './presets.js';
import { areaOf, relativeTo, volumeOf } from './relative.js';
import { drawSight } from './sight.js';
import { UntangleControls } from './untangle-controls.js';
import { Movers } from './untangle-hands.js';
import { ENERGIES, HELD, STARTS, isFlat } from './untangle-problems.js';
import { UntangleSession } from './untangle-session.js';
import { ending, number, whole } from './words.js';

/** The states, in the order in which a part of a step counts their inverted elements. */
const STATES = ['trial', 'result', 'primary'];

/** What a part of a step is called. */
const PARTS = {
  start: () => 'the start',
  local: () => 'local step',
  quadratic: ({ k, of }) => (of > 0 ? `QP ${k} of ${of}` : 'quadratic problem'),
  polish: ({ k, of }) => `polisher ${k} of ${of}`,
  outcome: ({ gini }) => (gini.reached ? 'handed out' : gini.accepted ? 'x went a part of the way' : 'not handed out'),
};

export class Untangle extends Mode {
  static accepts = '.mesh,.msh,.vtk,.node,.ele,.obj,.off,.ply,.stl,.txt,.gz';
  static dropHere = 'Drop a solid, or flat triangles, to untangle: the body at rest, with its tangled start and a list of pins if you have them';
  static label = 'A folded body in 3D, the body cut open, its violated constraints by the parts of the steps, and what the step did';
  static first = 'shape'; // the view a phone shows
  static views = { map: 'Cut', shape: 'Body', plot: 'Plot', inspector: 'Step' };
  wanted = readAddress('untangle');
  source = { body: this.wanted.body, size: this.wanted.size };
  controls = new UntangleControls(this);
  hands = new Movers(this);
  #tinted = false; // whether the body on the bench came with colours on its outside
  #moves = 1; // of what is held, the first included
  #good = { ...this.wanted };
  #relative = (record) => record; // a record without units

  constructor(page) {
    super(page, 'untangle');
  }

  /** Nothing is prepared: the start is made by the solver's own shapes. */
  async prepare() {
    return this.records.length > 0;
  }

  async arrive(foldfree) {
    this.session ??= new UntangleSession(foldfree);
    this.controls.list(foldfree.solidShapes);
    if (this.session.ready) return true;
    const opened = await this.open(this.source);
    if (opened && this.waiting) await this.catchUp();
    else if (opened && this.wanted.steps) await this.steps(this.wanted.steps);
    return opened;
  }

  /** Whether what is on the bench, or will be, is triangles in a plane. */
  get planar() {
    return this.session?.body ? this.session.planar : isFlat(this.source.body);
  }

  /** The prepared problem in which bodies are kept apart, if it is one. */
  get apart() {
    return !this.source.files && keepsApart(this.source.body) ? CONTACTS[this.source.body] : undefined;
  }

  /** Whether what is held may be moved. */
  get mayHold() {
    return this.session?.keepsApart === true;
  }

  /** The coordinate axis that keys turn what is held about. */
  get axis() {
    return this.planar ? 2 : 0;
  }

  invitation() {
    if (this.session.finished) return undefined; // there is nothing to try
    if (this.apart) return { button: this.apart.button, text: `${this.apart.hint}. Nothing may pass through anything.` };
    const { inverted } = this.records[0];
    const words = this.planar ? 'triangles' : 'tetrahedra';
    const { source } = this;
    const how = source.files ? '' : `${HELD[this.wanted.held].hint}. ${STARTS[this.wanted.start].hint}. `;
    return { button: 'Untangle', text: `${how}${whole(inverted)} of ${whole(this.bench.tetrahedra)} ${words} are inverted or flat.` };
  }

  /** Puts `next` on the bench; on failure the bench stays as it is. */
  async open(next = this.source, { busy = '' } = {}) {
    this.pause();
    const { session } = this;
    const asked = { ...this.wanted };
    const before = session.body;
    let overtaken = false; // what came later says what is going on
    if (busy) this.busy(busy);
    try {
      const { held, start, energy } = asked;
      const first = await session.open({ source: next, held, start, energy });
      if (!first) return (overtaken = true, false);
      this.source = next;
      if (session.body !== before) this.#lay();
      this.clearNotice();
      this.#begin(first);
      this.remember();
      this.#good = asked;
      return true;
    } catch (error) {
      const name = next.name ?? next.body;
      this.notice(next === this.source && session.ready ? 'The solver could not start' : `${name} was not opened`, describe(error));
      Object.assign(this.wanted, this.#good);
      if (this.records.length) this.show(this.shown, { quietly: true });
      return false;
    } finally {
      if (!overtaken) {
        this.busy('');
        this.reflect();
      }
    }
  }

  /** Another body lies on the bench. */
  #lay() {
    const { body, planar } = this.session;
    if (planar) this.bench.planar(body);
    else this.bench.solid(body);
    // zones of contacts are on the outside; of bodies of one kind it is as a person had it
    const apart = this.apart !== undefined;
    if (apart !== this.#tinted) this.bench.tinted(apart);
    this.#tinted = apart;
    const measure = planar ? areaOf(body.positions, body.indices) : volumeOf(body.positions, body.tetrahedra);
    this.#relative = relativeTo(1, Math.abs(measure));
  }

  /** Positions (n×3) that views are to have room for: where what is held goes first, too. */
  #room(start) {
    const { groups } = this.session.problem;
    if (!groups) return start;
    const points = [start];
    let { at } = groups[this.apart.moved];
    for (let count = 2; count < 4; count += 1) {
      points.push(at);
      at = moved(this.apart, at, count);
    }
    return Float64Array.from(points.flatMap((list) => [...list]));
  }

  #begin(first) {
    const { session, wanted } = this;
    const { pins, start } = session.problem;
    this.bench.begin('gini', wanted.start, wanted.energy);
    this.bench.lookAt(this.#room(start));
    this.#moves = 1;
    const handles = new Handles();
    handles.keepOnly(session.problem.groups?.map((group) => ({ ...group })) ?? (pins.length ? [{ vertices: pins, at: pick(start, pins) }] : []));
    this.bench.movable(this.mayHold);
    this.#look();
    this.push(first);
    this.hands.take(handles);
    this.records = session.records;
    this.show(0);
    this.#facts();
    this.invite();
    if (session.finished) this.ended();
  }

  // ——— what is shown ———

  readout(record) {
    const { violated, zones } = record;
    const inverted = record.counts[STATES.indexOf(this.wanted.state)];
    const name = PARTS[record.part](record);
    const where = record.part === 'start' ? name : `step ${record.iteration} · ${name}`;
    const { meeting, contacts } = record;
    // x̂ and x̄ cross and ask for more room, what is handed out does not
    const own = worksOn(record, this.wanted.state);
    const below = own && violated !== undefined ? `${whole(violated)} below η` : undefined;
    const touching = own && meeting !== undefined ? touchingWords(meeting, contacts) : undefined;
    const zoned = zones > 0 ? ` in ${whole(zones)} ${zones === 1 ? 'zone' : 'zones'}` : '';
    const { energy } = this.#relative(record);
    return {
      ...record, inverted, where, touching,
      energyText: below ?? (own || this.wanted.state === 'result' ? `energy ${number(energy)}` : ''),
      spoken: `${where.replace(' · ', ', ').replace('QP', 'quadratic problem')}, ${below ? `${below}${zoned}, ` : ''}${inverted} inverted${touching ? `, ${touching.join(', ')}` : ''}`,
    };
  }

  push(part) {
    this.bench.pushMoment({ ...this.#relative(part.record), trial: part.trial, zoneOf: part.zones, result: part.result, primary: part.primary, contacts: part.contacts });
  }

  /** While it plays the many iterations of the quadratic problem pass five times as fast. */
  get beat() {
    const { part, k, of } = this.records[this.shown] ?? {};
    return part === 'quadratic' && k < of ? 0.2 : 1;
  }

  ended() {
    this.finish();
    const { obstacles, outcome } = this.session.result;
    if (this.#late) {
      const { stepsOfMove: count } = this.session;
      return this.notice('It has not arrived', `What is held is not yet where it is to go after ${count} ${count === 1 ? 'step' : 'steps'}. Play goes on.`, { plain: true });
    }
    if (this.mayHold && this.session.newest.status !== 'converged' && outcome.notPositive.length === 0) {
      this.#stay();
      return this.notice('No way was found', 'What is held stays where it got to. Move it elsewhere, or begin anew.', { plain: true });
    }
    if (this.session.newest.iteration === 0 && outcome.notPositive.length === 0) return this.notice('Nothing to do', 'Nothing is inverted in this start.', { plain: true });
    if (outcome.notPositive.length > 0) return this.notice('Not everything came free', obstacles.join(' '), { plain: true });
  }

  finish() {
    this.#facts();
  }

  /** Whether it ended only because it may make so many steps at once. */
  get #late() {
    const { session } = this;
    return this.mayHold && session.finished && session.newest.status === 'max-iterations' && session.result.outcome.notPositive.length === 0;
  }

  async play() {
    if (this.active && !this.playing && this.session?.ready && this.#late) void this.aim(); // its steps wait for that
    await super.play();
  }

  /** What is held is to stay where it is. */
  #stay() {
    const { positions } = this.session;
    for (const group of this.hands.handles.groups) group.at = Float64Array.from(pick(positions, group.vertices));
    this.hands.draw();
  }

  #facts() {
    const { session } = this;
    const { problem, body, newest, result, planar } = session;
    const elements = planar ? 'triangles' : 'tetrahedra';
    const pairs = [
      [planar ? 'figure' : 'solid', this.source.name ?? this.controls.title],
      ['energy', ENERGIES[problem.settings.energy].title],
      ['vertices', whole(body.positions.length / 3)],
      [elements, whole(this.bench.tetrahedra)],
      ['held', `${whole(problem.pins.length)} vertices`],
      ['setup', `${number(1000 * problem.setupSeconds, 3)} ms`],
      ['threads', String(this.page.foldfree.threads)],
      ...problem.notes.map((text, i) => [i === 0 ? 'notes' : '', text]),
    ];
    if (session.finished && result) {
      pairs.push(['ended', newest.iteration === 0 ? 'before the first step' : `${ending(newest)} after ${newest.iteration} ${newest.iteration === 1 ? 'step' : 'steps'}`]);
      pairs.push(...proofOf(result.certificate, planar));
      const { globallyInjective } = result.outcome;
      if (globallyInjective !== undefined && !planar) pairs.push(['', globallyInjective ? 'nothing in anything else (exact)' : 'parts of it lie in each other (exact)']);
    }
    this.bench.facts(pairs);
  }

  /** How the body is looked at: `field`, `cut`, `at`, `state`. */
  look(key, value, { moving = false } = {}) {
    this.wanted[key] = value;
    this.#good[key] = value;
    if (this.page.canvas) this.#look();
    if (key === 'state' && this.records.length) this.show(this.shown);
    if (!moving) this.remember();
  }

  #look() {
    drawSight(this.bench, this.wanted);
    this.bench.state(this.wanted.state);
    this.controls.look();
  }

  /** The next state (S). */
  nextState() {
    this.look('state', STATES[(STATES.indexOf(this.wanted.state) + 1) % STATES.length]);
  }

  // ——— what people do ———

  async reset() {
    if (!this.whenReady(() => this.reset())) return;
    await this.open();
  }

  async change(key, value) {
    this.wanted[key] = value;
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    await this.open();
  }

  /** Picks the energy that a number key stands for. */
  pickMethod(index) {
    const [name, { planar } = {}] = Object.entries(ENERGIES)[index] ?? [];
    if (name && (planar || !this.planar)) this.change('energy', name);
  }

  /** What is held goes on: the next of its moves. */
  async further() {
    if (!this.apart || !this.whenReady(() => this.further()) || !this.mayHold) return;
    const { handles } = this.hands;
    const group = handles.groups[this.apart.moved];
    this.#moves += 1;
    group.at = moved(this.apart, group.at, this.#moves);
    await this.aim();
    if (!this.session.finished && !this.solving) {
      this.pause();
      await this.keepGoing();
    }
  }

  /** The solver hears where what is held is to go. */
  async aim() {
    this.clearNotice();
    this.hands.used = true;
    if (this.active) document.getElementById('invite').hidden = true;
    this.showNewest();
    this.hands.drawTargets();
    try {
      await this.session.aim(this.hands.handles.targets());
    } catch (error) {
      this.notice('It cannot go there', describe(error));
    }
  }

  listen(name, value) {
    this.hands.listen(name, value);
  }

  showNewest() {
    if (this.shown < this.records.length - 1) this.show(this.records.length - 1);
  }

  /** Nothing moves by itself. */
  endMotion() {}

  /** Goes on at full speed until it rests. */
  hurry() {
    if (!this.active) return;
    this.clearNotice();
    if (this.playing && !this.solving) this.pause();
    this.hurried = true;
    if (!this.playing) this.keepGoing();
  }

  leave() {
    void this.hands.drop();
    super.leave();
  }

  async changeBody(body, size) {
    const next = { body, size: keepsApart(body) ? Math.min(size, MOST_ELEMENTS) : size };
    Object.assign(this.wanted, next);
    if (isFlat(body) && !ENERGIES[this.wanted.energy].planar) this.wanted.energy = 'arap';
    if (!this.whenReady(() => this.open(next))) return;
    await this.open(next, { busy: size > 10_000 ? 'Building the body' : '' });
  }

  async openFiles(files) {
    if (!this.whenReady(() => this.openFiles(files))) return;
    this.busy(`Reading ${files[0].name}`);
    let next;
    try {
      next = await readUntangleFiles(files);
    } catch (error) {
      this.busy('');
      return this.notice(`${files[0].name} was not opened`, describe(error));
    }
    // a file of triangles takes no energy of solids; one of them all take
    this.wanted.energy = 'arap';
    if (BENT.includes(this.wanted.held)) this.wanted.held = 'outside';
    await this.open(next, { busy: `Reading ${next.name}` });
  }

  reflect() {
    this.controls.reflect();
  }

  enter() {
    super.enter();
    this.reflect(); // colours and cut are shared with other modes
  }

  /** Writes what is on the bench into the address; of a file only how it is solved and looked at. */
  remember(extra = {}) {
    if (!this.active) return;
    const { wanted, source } = this;
    const body = source.files ? { body: undefined, size: undefined } : { body: source.body, size: source.size };
    writeAddress('untangle', { ...wanted, steps: undefined, ...body, ...(!source.files && extra) });
  }

  /** What a link does not carry. */
  get notShared() {
    if (this.source.files) return 'It has the solver and its settings; the files stay with you.';
    return this.hands.used ? 'It has the problem; where you have moved what is held stays with you.' : '';
  }

  get exports() {
    const name = (this.source.name ?? this.source.body).replace(/\.[a-z]+(\.gz)?$/i, '');
    const { session } = this;
    const format = session.planar ? 'obj' : 'mesh';
    return {
      'export-solid': async () => save(await session.file(format), `${name}-untangled.${format}`, 'text/plain'),
      'export-trace': async () => save(`${JSON.stringify(await session.trace(), null, 1)}\n`, `${name}-untangled.json`, 'application/json'),
    };
  }

  connect() {
    this.controls.connect();
  }
}

/** Whether a state is what a part of a step works on: x̄ is until the polisher takes it over, x never. */
function worksOn({ part }, state) {
  return state === 'trial' || (state === 'primary' && part !== 'polish' && part !== 'outcome');
}

/** What crosses and what is in contact, in words. */
function touchingWords(meeting, { all, active }) {
  const pairs = meeting === 1 ? '1 pair crosses' : `${whole(meeting)} pairs cross`;
  return [pairs, `${whole(all)} ${all === 1 ? 'contact' : 'contacts'}, ${whole(active)} active`];
}

/** What is held otherwise than a person's file has it. */
const BENT = ['twisted', 'bent'];
