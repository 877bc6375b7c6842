// What is being compared: several solvers on one mesh, from one start, and the clock they share. No DOM here.

/** Iterates of one solver at most. */
export const MOST_ITERATIONS = 5000;

/** Where solvers stop: far below where a person would, so that their curves can be told apart to the end. */
export const TOLERANCE = 1e-10;

/** Solvers at least and at most. */
export const [FEWEST, MOST] = [2, 4];

/** Methods that minimise (or solve for) something else than symmetric Dirichlet; that of their maps is measured. */
const MEASURED = ['arap', 'lscm'];

/** Methods that can be compared by an energy, in the order of their buttons. */
export const COMPARABLE = {
  'symmetric-dirichlet': ['wrapd', 'wrapd+cm', 'cm', 'slim', 'r-admm', 'w-admm', 'admm-pd', 'arap', 'lscm'],
  arap: ['wrapd', 'slim', 'r-admm', 'w-admm', 'admm-pd', 'arap'],
};

/** One of the solvers. */
class Lane {
  /** Numbers of its iterates, the start first. */
  records = [];
  /** What went wrong. */
  error = undefined;
  solver = undefined;
  #areas; // of the triangles, relative, where its energy is measured

  constructor(method, energy) {
    this.method = method;
    this.measured = energy === 'symmetric-dirichlet' && MEASURED.includes(method);
  }

  get newest() {
    return this.records.at(-1);
  }

  /** Whether it has nothing more to do. */
  get finished() {
    return this.error !== undefined || (this.newest !== undefined && this.newest.iteration > 0 && this.newest.status !== 'running');
  }

  get converged() {
    return this.newest?.status === 'converged';
  }

  begin(solver) {
    this.solver = solver;
    if (this.measured) this.#areas = areasOf(solver.mesh);
    this.take(solver.start);
  }

  /** Keeps the numbers of a step. */
  take(step) {
    if (this.measured) step.energy = step.distortion.reduce((sum, density, t) => sum + density * this.#areas[t], 0);
    this.records.push(numbersOf(step));
  }

  free() {
    this.solver?.free();
    this.solver = undefined;
  }
}

/**
 * Solvers side by side. They step in turn, one after the other, in one worker, so that none disturbs the time of another:
 * it is always the turn of the one that is behind on the clock. What the clock shows are `moments`: iterations, or the
 * seconds at which some solver had a new iterate, up to where all those still running have come.
 */
export class CompareSession {
  #foldfree;
  #mesh;
  #generation = 0;
  #clock = 'iterations';
  #merged = []; // by lane: how many of its records are in the moments
  #lowest = { energy: Infinity }; // without inversions, with the lane and by how much its last step went down

  lanes = [];
  /** Times on the clock, each `{ at }`. */
  moments = [];
  /** Source, settings and facts of the problem. */
  problem = undefined;

  constructor(foldfree) {
    this.#foldfree = foldfree;
  }

  get ready() {
    return this.problem !== undefined;
  }

  get records() {
    return this.moments;
  }

  /** Whether no solver has anything more to do, and the clock has come to the end. */
  get finished() {
    return this.lanes.length > 0 && this.lanes.every((lane) => lane.finished);
  }

  /** What the clock counts: `iterations`, or `seconds` of solving. */
  get clock() {
    return this.#clock;
  }

  set clock(clock) {
    this.#clock = clock;
    this.#merged = this.lanes.map(() => 0);
    this.moments = [];
    this.#merge();
  }

  /** The time of a record on the clock. */
  timeOf(record) {
    return this.#clock === 'seconds' ? record.seconds : record.iteration;
  }

  /**
   * The lowest energy reached without inversions, from which the gaps count: `{ energy, settled }`. Until a solver has
   * converged to it (`settled`) it is lowered by what that solver's last step gained, so that its curve does not end
   * in a hole; undefined when nothing was reached.
   */
  get best() {
    const { energy, lane, gain } = this.#lowest;
    if (!Number.isFinite(energy)) return undefined;
    const settled = lane.converged;
    return { energy: settled ? energy : energy - gain, settled, lane };
  }

  /**
   * Puts a problem on the bench. Only when at least one solver could be made does the last problem leave. Resolves with
   * `{ surface, starts }`, a start for each method (undefined for those that failed), or with undefined when a later
   * call overtook this one; rejects with the first error when all fail.
   */
  async open({ source, settings, methods }) {
    const generation = ++this.#generation;
    const overtaken = () => generation !== this.#generation;
    const same = this.#mesh !== undefined && this.problem?.source === source;
    const mesh = same ? this.#mesh : await this.#read(source);
    const lanes = methods.map((method) => new Lane(method, settings.energy));
    const starts = [];
    const errors = [];
    for (const lane of lanes) {
      if (overtaken()) break;
      try {
        const solver = await this.#foldfree.parameterize(mesh, {
          ...settings, method: lane.method, tolerance: TOLERANCE, maxIterations: MOST_ITERATIONS, frames: 'f32',
        });
        lane.begin(solver);
        starts.push(solver.start);
      } catch (error) {
        lane.error = error;
        errors.push(error);
        starts.push(undefined);
      }
    }
    const begun = lanes.filter((lane) => lane.solver);
    if (overtaken() || begun.length === 0) {
      for (const lane of lanes) lane.free();
      if (!same) mesh.free();
      if (overtaken()) return undefined;
      throw errors[0];
    }
    for (const lane of this.lanes) lane.free();
    if (!same) this.#mesh?.free();
    this.#mesh = mesh;
    this.lanes = lanes;
    const { startKind, notes } = begun[0].solver;
    this.problem = {
      source, settings, methods, startKind, notes: [...mesh.notes, ...notes], startInverted: starts.find(Boolean).inverted,
      setupSeconds: lanes.map((lane) => lane.solver?.setupSeconds),
    };
    this.#lowest = { energy: Infinity };
    for (const lane of begun) this.#look(lane);
    this.clock = this.#clock;
    return { surface: begun[0].solver.mesh, starts };
  }

  #read(source) {
    return source.bytes
      ? this.#foldfree.mesh(source.bytes, source.format)
      : this.#foldfree.generate(source.sample, source.triangles);
  }

  /**
   * Steps until the clock has gone on by one moment; `onStep(lane, step)` hears of every step, `onEnd(lane)` of the end of
   * a solver, whether it has converged or failed. Resolves with the moment, or with undefined when there is none to come.
   */
  async step(onStep = () => {}, onEnd = () => {}) {
    const generation = this.#generation;
    const known = this.moments.length;
    while (this.moments.length === known) {
      const index = this.#behind();
      if (index < 0) return undefined;
      const lane = this.lanes[index];
      try {
        const step = await lane.solver.step();
        if (generation !== this.#generation || this.lanes[index] !== lane) return undefined;
        lane.take(step);
        this.#look(lane);
        onStep(index, step);
      } catch (error) {
        if (generation !== this.#generation || this.lanes[index] !== lane) return undefined;
        lane.error = error;
      }
      if (lane.finished) onEnd(index);
      this.#merge();
    }
    return this.moments.at(-1);
  }

  /** The solver whose turn it is: of those that run the one that is behind, the first of several; -1: none runs. */
  #behind() {
    let found = -1;
    this.lanes.forEach((lane, index) => {
      if (lane.finished) return;
      if (found < 0 || this.timeOf(lane.newest) < this.timeOf(this.lanes[found].newest)) found = index;
    });
    return found;
  }

  /** Adds the moments that are known by now, in order. */
  #merge() {
    const until = Math.min(...this.lanes.filter((lane) => !lane.finished).map((lane) => this.timeOf(lane.newest)));
    for (;;) {
      let next = -1;
      this.lanes.forEach(({ records }, index) => {
        const record = records[this.#merged[index]];
        if (!record || this.timeOf(record) > until) return;
        if (next < 0 || this.timeOf(record) < this.timeOf(this.lanes[next].records[this.#merged[next]])) next = index;
      });
      if (next < 0) return;
      const at = this.timeOf(this.lanes[next].records[this.#merged[next]]);
      this.#merged[next] += 1;
      if (this.moments.length === 0 || at > this.moments.at(-1).at) this.moments.push({ at });
    }
  }

  /** Whether the newest iterate of a solver is the lowest of all. */
  #look(lane) {
    const { energy, inverted } = lane.newest;
    if (inverted > 0 || !(energy < this.#lowest.energy)) return;
    const before = lane.records.at(-2);
    const gain = before && before.inverted === 0 ? before.energy - energy : NaN;
    // Where nothing is known of how it goes on, a thousandth.
    this.#lowest = { energy, lane, gain: gain > 0 ? gain : 1e-3 * Math.max(Math.abs(energy), 1e-3) };
  }

  /** For every solver the index of the iterate it had at a time of the clock: the newest not after it. */
  shownAt({ at }) {
    return this.lanes.map(({ records }) => {
      let [low, high] = [0, records.length]; // the first that is later
      while (low < high) {
        const middle = (low + high) >> 1;
        if (this.timeOf(records[middle]) <= at) low = middle + 1;
        else high = middle;
      }
      return Math.max(0, low - 1);
    });
  }

  /** The index of the newest moment not after a time. */
  momentAt(time) {
    const after = this.moments.findIndex(({ at }) => at > time);
    return Math.max(0, (after < 0 ? this.moments.length : after) - 1);
  }

  /** Every iterate of every solver, as comma-separated values. */
  csv() {
    const lowest = this.best?.energy ?? NaN;
    const columns = ['iteration', 'seconds', 'energy', 'inverted', 'gradientNorm', 'smallestSigma', 'largestSigma', 'switchedAt'];
    const names = columns.map((column) => column.replace(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`));
    const lines = [['method', ...names, 'energy_above_lowest'].join(',')];
    for (const { method, records } of this.lanes) {
      for (const record of records) {
        const values = columns.map((column) => (record[column] ?? ''));
        lines.push([method, ...values, record.energy - lowest].map((value) => (typeof value === 'number' && !Number.isFinite(value) ? '' : value)).join(','));
      }
    }
    return `${lines.join('\n')}\n`;
  }

  /** Everything a person would want to plot elsewhere. */
  trace() {
    const { source, settings, startKind, notes, setupSeconds } = this.problem;
    return {
      format: 'foldfree-comparison', formatVersion: 1, foldfree: this.#foldfree.version,
      problem: source.bytes ? { file: source.name } : { sample: source.sample, triangles: source.triangles },
      settings: { ...settings, tolerance: TOLERANCE, maxIterations: MOST_ITERATIONS }, start: startKind, notes, threads: this.#foldfree.threads,
      lowestEnergy: this.best?.energy, settled: this.best?.settled,
      solvers: this.lanes.map(({ method, records, error }, i) => ({
        method, setupSeconds: setupSeconds[i], ...(error && { error: String(error.message ?? error) }), iterations: records,
      })),
    };
  }
}

/** The areas of the triangles, their sum 1. */
function areasOf({ positions, indices }) {
  const edge = (a, b) => [0, 1, 2].map((k) => positions[3 * b + k] - positions[3 * a + k]);
  const areas = Float64Array.from({ length: indices.length / 3 }, (_, t) => {
    const [a, b, c] = indices.subarray(3 * t, 3 * t + 3);
    const [[x, y, z], [u, v, w]] = [edge(a, b), edge(a, c)];
    return Math.hypot(y * w - z * v, z * u - x * w, x * v - y * u);
  });
  const whole = areas.reduce((sum, area) => sum + area, 0);
  return areas.map((area) => area / whole);
}

/** A step without its arrays. */
function numbersOf({ positions, distortion, ...numbers }) {
  return numbers;
}
