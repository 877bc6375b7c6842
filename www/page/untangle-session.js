// What is being untangled: one body, one solver, and every part of every step. No DOM here.
import { keepsApart } from './contact-problems.js';
import { apartOf, generate, invertedOf, problemOf, readPins } from './untangle-problems.js';

/** Formats that may hold triangles instead of tetrahedra. */
const SURFACES = ['obj', 'off', 'ply', 'stl', 'mesh', 'msh', 'vtk'];
const SOLIDS = ['mesh', 'msh', 'vtk', 'node'];

/** Vertices of a body of whose quadratic problem every iteration is shown: there are fifty to a step. */
export const MOST_TRACED = 20_000;
const UNTRACED = 'of so large a body the iterations of the quadratic problem are not shown, only where they lead';

/**
 * A body on the bench and its solver. A step of the solver comes as the parts it consists of, one after the other: local
 * step, quadratic problem, the iterations of the polisher, outcome. `records` has the numbers of all of them.
 */
export class UntangleSession {
  #foldfree;
  #body;
  #solver;
  #generation = 0;
  #queue = []; // parts of the newest step that were not shown yet
  #reports = []; // of the steps
  #targets; // where what is held is to go, when the solver does not know yet
  #sending;
  #moves = 0; // how often the solver was told of other targets
  #known = 0; // how many of them its newest step knew
  #count = 0; // steps of the solver
  #shownResult;
  #last; // { result, primary, report, folded }: what the newest step led to; `folded`: inverted elements of `primary`, if known

  records = [];
  /** Name, settings and facts of the problem. */
  problem = undefined;
  /** Steps of the solver since what is held moved, or the start. */
  stepsOfMove = 0;
  /** What is known of the end: certificate, outcome, obstacles. */
  result = undefined;

  constructor(foldfree) {
    this.#foldfree = foldfree;
  }

  get ready() {
    return this.#solver !== undefined;
  }

  get body() {
    return this.#body;
  }

  /** Whether it is triangles in a plane. */
  get planar() {
    return this.#body?.indices !== undefined;
  }

  get newest() {
    return this.records.at(-1);
  }

  /** Whether all parts of the last step were shown. */
  get finished() {
    return this.#queue.length === 0 && this.#moves === this.#known && this.#targets === undefined && this.newest !== undefined && this.newest.status !== 'running';
  }

  /** Whether bodies are kept from passing through each other and themselves. */
  get keepsApart() {
    return this.problem?.groups !== undefined;
  }

  /** x, the newest state that was handed out and shown (n×3). */
  get positions() {
    return this.#shownResult;
  }

  /** Reads a file: as a solid where its format can hold one, else as triangles. */
  async #file({ name, format, bytes, elements }) {
    if (SOLIDS.includes(format)) {
      try {
        return await this.#foldfree.solid(bytes, format, elements);
      } catch (error) {
        if (!SURFACES.includes(format)) throw error;
        return this.#foldfree.mesh(bytes, format).catch(() => { throw error; });
      }
    }
    if (!SURFACES.includes(format)) throw new Error(`${name} is no body`);
    return this.#foldfree.mesh(bytes, format);
  }

  /** The body of a source, and what a person brought with it. */
  async #read(source) {
    if (!source.files) return { body: await generate(this.#foldfree, source), given: {} };
    const [first, second] = source.files;
    const body = await this.#file(first);
    const given = {};
    try {
      const vertices = body.positions.length / 3;
      if (source.pins) given.pins = readPins(source.pins.text, vertices, source.pins.name);
      if (second) {
        const other = await this.#file(second);
        given.start = other.positions;
        other.free();
        if (given.start.length !== body.positions.length) {
          throw new Error(`${second.name} has ${given.start.length / 3} vertices, ${first.name} ${vertices}`);
        }
      }
    } catch (error) {
      body.free();
      throw error;
    }
    return { body, given };
  }

  /**
   * Puts a problem on the bench; only when everything went well does the last one leave. Resolves with the start, or
   * with undefined when a later call overtook this one.
   */
  async open({ source, held, start, energy }) {
    const generation = ++this.#generation;
    const same = this.#body !== undefined && this.problem?.source === source;
    const { body, given } = same ? { body: this.#body, given: this.problem.given } : await this.#read(source);
    let solver;
    let made;
    let known; // of the start
    try {
      made = !source.files && keepsApart(source.body) ? apartOf(body, source.body) : problemOf(body, { held, start }, given);
      const { groups, ...handles } = made;
      const large = body.positions.length > 3 * MOST_TRACED;
      // the first state in which nothing crosses will do: a person may want to go on from there
      solver = await this.#foldfree.untangle(body, { ...handles, ...(groups && { settle: 0 }), energy, primary: true, trace: large ? 'polisher' : true });
      known = await solver.result();
    } catch (error) {
      solver?.free();
      if (!same) body.free();
      throw error;
    }
    if (generation !== this.#generation) {
      solver.free();
      if (!same) body.free();
      return undefined;
    }
    this.#solver?.free();
    if (!same) this.#body?.free();
    [this.#body, this.#solver] = [body, solver];
    this.problem = {
      source, given, ...made, settings: { held, start, energy },
      notes: [...body.notes, ...solver.notes, ...(body.positions.length > 3 * MOST_TRACED ? [UNTRACED] : [])], setupSeconds: solver.setupSeconds,
    };
    this.result = undefined;
    [this.#queue, this.#reports, this.#count, this.#targets, this.#moves, this.#known] = [[], [], 0, undefined, 0, 0];
    const { positions } = solver.start;
    // of what is flat floating point cannot tell: the start is counted exactly
    const wrong = known.outcome.notPositive.length;
    this.#last = { result: positions, primary: positions, report: { ...numbersOf(solver.start), inverted: wrong, smallest: known.outcome.smallestMeasure }, folded: wrong };
    const first = this.#part('start', { trial: positions, inverted: [wrong, wrong, wrong], report: this.#last.report, ...(made.groups && { meeting: known.outcome.intersections }) });
    this.records = [first.record];
    this.#shownResult = positions;
    if (solver.start.status !== 'running') this.result = known;
    return first;
  }

  /** The next part of a step; resolves with nothing when there is none. */
  async step() {
    const solver = this.#solver;
    if (!solver || this.finished) return undefined;
    if (this.#queue.length === 0) {
      await this.#sending?.catch(() => {}); // whoever sent it hears of that
      const known = this.#moves;
      const step = await solver.step();
      if (solver !== this.#solver) return undefined;
      this.stepsOfMove = step.iteration;
      step.iteration = ++this.#count; // the solver's own count begins anew when what is held moves
      if (step.status !== 'running') {
        const result = await solver.result();
        if (solver !== this.#solver) return undefined;
        if (known === this.#moves) this.result = result;
      }
      this.#known = known;
      this.#reports.push(numbersOf(step));
      this.#queue = this.#partsOf(step);
    }
    const part = this.#queue.shift();
    this.records.push(part.record);
    this.#shownResult = part.result;
    return part;
  }

  /** Has what is held go elsewhere: one message at a time; while one is on its way only the newest waits. */
  async aim(targets) {
    this.#targets = targets;
    this.#sending ??= this.#send();
    await this.#sending;
  }

  async #send() {
    try {
      while (this.#targets) {
        const [targets, solver] = [this.#targets, this.#solver];
        try {
          await solver.movePins(targets);
        } catch (error) {
          if (solver === this.#solver) {
            this.#targets = undefined;
            throw error;
          }
        }
        if (solver !== this.#solver) continue; // another problem has come
        if (targets === this.#targets) this.#targets = undefined;
        this.#moves += 1;
        this.result = undefined;
      }
    } finally {
      this.#sending = undefined;
    }
  }

  /** The parts of a step. What is handed out changes with the last of them. */
  #partsOf(step) {
    const { result, primary, report: before, folded = invertedOf(this.#body, primary) } = this.#last;
    const { gini, trace, quadratic = [] } = step;
    const report = numbersOf(step);
    // Seconds of solving: the solver's own clock also runs while it waits for the next step.
    report.seconds = before.seconds + step.phases.reduce((sum, phase) => sum + phase.milliseconds, 0) / 1000;
    const [polished] = trace;
    const of = gini.polish.length;
    const now = { ...before, iteration: step.iteration, phases: step.phases, seconds: report.seconds, status: 'running' };
    // until its outcome measures and η are those of before
    const { smallestMeasure, leastOffset, reducedOffsets } = before.gini ?? { smallestMeasure: before.smallest, leastOffset: gini.firstOffset, reducedOffsets: 0 };
    const meanwhile = { ...gini, smallestMeasure, leastOffset, reducedOffsets };
    const common = { gini: meanwhile, of, report: now };
    const parts = [
      this.#part('local', { ...common, trial: primary, inverted: [folded, before.inverted, folded] }),
      // the last state of the quadratic problem is the first of the polisher
      ...quadratic.slice(0, -1).map((state, k) => this.#part('quadratic', {
        ...common, ...wrongIn(state), k, of: gini.qpIterations, trial: state.positions,
        inverted: [state.inverted, before.inverted, state.inverted], primary: state.positions,
      })),
      ...trace.map((state, k) => this.#part(k === 0 ? 'quadratic' : 'polish', {
        ...common, ...wrongIn(state), ...(k === 0 ? { k: gini.qpIterations, of: gini.qpIterations } : { k }),
        trial: state.positions, zones: state.zones, inverted: [state.inverted, before.inverted, polished.inverted], primary: polished.positions,
      })),
    ];
    const last = trace.at(-1);
    this.#last = { result: step.positions, primary: step.primary, report };
    parts.push(this.#part('outcome', {
      ...common, gini, k: of, report, trial: last.positions, zones: gini.reached ? undefined : last.zones, ...wrongIn(last),
      inverted: [last.inverted, report.inverted, polished.inverted], primary: polished.positions, result: step.positions,
    }));
    // until then what is handed out is what it was
    for (const part of parts.slice(0, -1)) part.result = result;
    return parts;
  }

  #part(kind, { trial, result = this.#last.result, primary = this.#last.primary, zones, report, gini, k = 0, of = 0, inverted, violated, meeting, contacts }) {
    const most = (list) => list?.reduce((highest, zone) => Math.max(highest, zone), 0) ?? 0;
    const count = Math.max(most(zones), most(contacts?.zones)); // a zone may be of contacts alone
    const touching = contacts && { all: contacts.active.length, active: contacts.active.reduce((sum, one) => sum + one, 0) };
    const record = {
      ...report, part: kind, k, of, counts: inverted, inverted: inverted[0], violated, zones: count, gini,
      ...(meeting !== undefined && { meeting, contacts: touching ?? { all: 0, active: 0 } }),
    };
    return { record, status: record.status, iteration: record.iteration, trial, zones, result, primary, contacts };
  }

  /** A file of what is handed out. */
  async file(format) {
    const { positions } = await this.#solver.result();
    return this.#body.write(format, positions);
  }

  /** Everything a person would want to plot elsewhere. */
  async trace() {
    const { source, settings, notes, setupSeconds, pins } = this.problem;
    const { certificate, outcome, obstacles } = this.result ?? (await this.#solver.result());
    return {
      format: 'foldfree-trace', formatVersion: 1, foldfree: this.#foldfree.version,
      problem: source.files ? { files: source.files.map(({ name }) => name) } : { body: source.body, size: source.size },
      settings, pins: pins.length, notes, threads: this.#foldfree.threads, setupSeconds, iterations: this.#reports,
      outcome, obstacles, certificate,
    };
  }
}

/** What is wrong in a state inside a step. */
const wrongIn = ({ violated, meeting, contacts }) => ({ violated, meeting, contacts });

/** A step without its arrays. */
function numbersOf({ positions, primary, trace, quadratic, ...numbers }) {
  return numbers;
}
