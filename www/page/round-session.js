// One problem with integers and what each rounding makes of it, in the package's worker. No DOM here.
import { arraysOf, linearOf } from './round-problems.js';

/** The roundings, in the order of their keys. */
export const ROUNDINGS = ['direct', 'greedy', 'two-opt', 'lattice'];

/** Steps of a rounding at most; more nobody could watch. */
const MOST_STEPS = 2000;

/** Options of a rounding; `updates` is what makes the others follow. */
function optionsOf(rounding, updates) {
  const exact = updates === 'exact' || rounding === 'two-opt' || rounding === 'lattice';
  return { rounding, engine: exact ? 'dense' : 'three-level', budget: 0 };
}

export class RoundSession {
  #foldfree;
  #solvers = new Map();
  #turn = 0;
  #working = Promise.resolve();
  #revealed = 1;
  problem;
  /** Where the minimum without integrality is. */
  minimum = [];
  /** What the transport steps through. */
  rounding = 'greedy';
  /** By rounding: all its steps, the start first. */
  paths = new Map();
  /** By rounding: the package's result. */
  results = new Map();

  constructor(foldfree) {
    this.#foldfree = foldfree;
  }

  get ready() {
    return this.results.size === ROUNDINGS.length;
  }

  get path() {
    return this.paths.get(this.rounding) ?? [];
  }

  get finished() {
    return this.ready && this.#revealed >= this.path.length;
  }

  /** The steps that have been asked for. */
  get records() {
    return this.path.slice(0, this.#revealed);
  }

  /** Another problem: all roundings solve it. Nothing when a later call overtook this one. */
  open(problem, updates) {
    return this.#alone(async (overtaken) => {
      const made = new Map();
      try {
        for (const rounding of ROUNDINGS) {
          made.set(rounding, await this.#foldfree.mixedInteger(arraysOf(problem), optionsOf(rounding, updates)));
          if (overtaken()) return undefined;
        }
        const starts = new Map(ROUNDINGS.map((rounding) => [rounding, made.get(rounding).start]));
        const solved = await this.#solve(made, starts, overtaken);
        if (!solved) return undefined;
        for (const solver of this.#solvers.values()) solver.free();
        this.#solvers = new Map(made);
        made.clear();
        Object.assign(this, { problem, minimum: [...problem.minimum], ...solved });
        this.#revealed = 1;
        return this.records;
      } finally {
        for (const solver of made.values()) solver.free();
      }
    });
  }

  /** The minimum lies elsewhere: another b, and nothing is factored again. As many steps stay revealed. */
  move(minimum) {
    return this.#alone(async (overtaken) => {
      if (!this.ready) return undefined;
      const done = this.finished;
      const linear = linearOf(this.problem, minimum);
      const starts = new Map();
      for (const [rounding, solver] of this.#solvers) starts.set(rounding, await solver.resolve({ linear }));
      const solved = await this.#solve(this.#solvers, starts, overtaken);
      if (!solved) return undefined;
      Object.assign(this, { minimum: [...minimum], ...solved });
      this.#revealed = done ? this.path.length : Math.min(this.#revealed, this.path.length);
      return this.records;
    });
  }

  /** Another rounding is stepped through, from its start. */
  choose(rounding) {
    this.rounding = rounding;
    this.#revealed = 1;
    return this.records;
  }

  /** The next step; nothing when all has been done. */
  async step() {
    if (this.finished) return undefined;
    return this.path[this.#revealed++];
  }

  async #solve(solvers, starts, overtaken) {
    const [paths, results] = [new Map(), new Map()];
    for (const [rounding, solver] of solvers) {
      const path = [starts.get(rounding)];
      while (path.at(-1).status === 'running' && path.length < MOST_STEPS) path.push(await solver.step());
      paths.set(rounding, path);
      results.set(rounding, await solver.result());
      if (overtaken()) return undefined;
    }
    return { paths, results };
  }

  /** Work that touches the solvers, one after the other; what is overtaken ends early. */
  #alone(work) {
    const mine = ++this.#turn;
    const overtaken = () => mine !== this.#turn;
    const done = this.#working.then(() => (overtaken() ? undefined : work(overtaken)));
    this.#working = done.catch(() => {});
    return done;
  }
}
