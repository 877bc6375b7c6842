// What is being deformed: one solid, one solver after the other, and the record of all their steps. No DOM here.
import { FIGURES, isFigure } from './figures.js';
import { areaOf, volumeOf } from './relative.js';

/** Iterations of one solver at most: a person may drag for a long time. */
export const MOST_ITERATIONS = 100_000;

/** Iterates, the newest, whose phases are kept. */
const MOST_PHASES = 5000;

/**
 * A solid on the bench. Its solver is made anew when pins or material change, from where the solid is.
 *
 * Building, stepping and running wait in one queue. Targets do not: they go to the solver while it runs, except during a
 * build, when the newest waits for the solver that is being made.
 */
export class DeformSession {
  #foldfree;
  #solid;
  #solver;
  #queue = Promise.resolve();
  #generation = 0; // of builds
  #building = 0; // builds that wait or are going on
  #before = { iterations: 0, seconds: 0 }; // of the solvers before this one
  #solvers = []; // of these records: from which iteration, with which settings
  #status = 'running';
  #suspended = false;
  #targets; // the newest wish that was not sent yet
  #sending;
  #aimed = false; // whether targets came since the newest run or step began
  #stops = 0; // how often everything that was asked for before was to stop
  #running = false;

  /** Numbers of every iterate, the start first. */
  records = [];
  /** Where the solid is: the newest positions that have come (n×3). */
  positions = undefined;
  /** Name, settings and facts of the problem. */
  problem = undefined;
  /** The certificate of the finished deformation. */
  certificate = undefined;

  constructor(foldfree) {
    this.#foldfree = foldfree;
  }

  get ready() {
    return this.#solver !== undefined;
  }

  get solid() {
    return this.#solid;
  }

  /** Whether it is triangles in a plane. */
  get planar() {
    return this.#solid?.indices !== undefined;
  }

  get newest() {
    return this.records.at(-1);
  }

  /** Whether there is nothing to do: the solver has ended, or nothing is held. While one is built there is. */
  get finished() {
    return this.#building === 0 && (this.#suspended || this.#status !== 'running');
  }

  /** Reads or generates a solid; it lies on the bench only when `build` has been called. */
  read(source) {
    if (isFigure(source.solid)) return this.#foldfree.mesh(FIGURES[source.solid].make(source.tetrahedra));
    if (!source.bytes) return this.#foldfree.generateSolid(source.solid, source.tetrahedra);
    return this.#foldfree.solid(source.bytes, source.format, source.elements);
  }

  /** `act` after everything that was asked for before it. */
  #inTurn(act) {
    const mine = this.#queue.then(act);
    this.#queue = mine.catch(() => {});
    return mine;
  }

  /**
   * Makes a solver. `solid`: another than before. `start()`: where it begins (n×3) or a promise of it, asked for when everything before has
   * ended. `fresh`: the records begin anew with the start, else they go on.
   * Only when everything went well does the last solver leave. Resolves with the start, or with undefined when a later
   * build (or `suspend()`) overtook this one; rejects when it failed.
   */
  async build({ source, solid = this.#solid, settings, pins, start, targets, fresh }) {
    const generation = ++this.#generation;
    const overtaken = () => generation !== this.#generation;
    const unsent = this.#targets;
    this.#targets = undefined; // those of the new solver are newer
    this.#building += 1;
    this.stop();
    try {
      await this.#inTurn(async () => {
        if (overtaken()) return;
        const solver = await this.#foldfree.deform(solid, {
          ...settings, pins, start: await start(), targets, maxIterations: MOST_ITERATIONS, field: 'stress', frames: 'f32',
        });
        if (overtaken()) solver.free();
        else this.#install(solver, { source, solid, settings, pins, fresh });
      });
    } catch (error) {
      if (!overtaken()) {
        this.#targets ??= unsent;
        throw error;
      }
    } finally {
      this.#building -= 1;
      if (overtaken() && solid !== this.#solid) solid.free();
    }
    await this.#flush();
    return overtaken() ? undefined : this.#solver.start;
  }

  /** The solver that was made takes the place of the last. */
  #install(solver, { source, solid, settings, pins, fresh }) {
    const same = solid === this.#solid;
    this.#solver?.free();
    if (!same) this.#solid?.free();
    [this.#solid, this.#solver, this.#suspended, this.#aimed] = [solid, solver, false, false];
    const { setupSeconds } = solver;
    const volume = same ? this.problem.volume : measureOf(solid);
    this.problem = { source, settings, volume, pins: pins.length, notes: [...solid.notes, ...solver.notes], setupSeconds };
    this.certificate = undefined;
    this.#status = solver.start.status;
    this.positions = solver.start.positions;
    if (fresh) {
      this.#before = { iterations: 0, seconds: 0 };
      this.records = [numbersOf(solver.start)];
      this.#solvers = [];
    } else {
      this.#before = { iterations: this.newest.iteration, seconds: this.newest.seconds };
    }
    this.#solvers.push({ from: this.#before.iterations, settings, pins: pins.length, setupSeconds });
  }

  /** One step; resolves with it, or with undefined when there is none to make. */
  step() {
    return this.#inTurn(async () => {
      const solver = this.#solver;
      if (!solver || this.#rests) return undefined;
      this.#aimed = false;
      const step = await solver.step();
      this.#record(step);
      this.positions = step.positions;
      await this.#settle(step, solver);
      return step;
    });
  }

  /**
   * Steps until there is nothing more to do, or `stop()`. `onFrame(step, skipped)` gets the newest iterate as often
   * as it takes it, and the numbers of those between.
   */
  run(onFrame) {
    const stops = this.#stops;
    return this.#inTurn(async () => {
      const solver = this.#solver;
      if (!solver || this.#rests || stops !== this.#stops) return;
      const take = async (frame, reports) => {
        const steps = reports.map((report) => this.#record({ ...report }));
        this.positions = frame.positions;
        const step = { ...frame, ...steps.pop() };
        await this.#settle(step, solver);
        await onFrame(step, steps);
      };
      this.#aimed = false;
      this.#running = true;
      try {
        await solver.run({ onFrame: take });
      } finally {
        this.#running = false;
      }
    });
  }

  /** Whether the solver that is there has nothing to do. */
  get #rests() {
    return this.#suspended || this.#status !== 'running';
  }

  /** Nothing is held: there is nothing to solve until a solver is built with pins. */
  suspend() {
    this.#suspended = true;
    this.#generation += 1;
    this.stop();
  }

  /** Ends a run after its current step, and those that wait to begin. */
  stop() {
    this.#stops += 1;
    if (this.#running) this.#solver.cancel();
  }

  /** Sends targets, one message at a time; while one is on its way, or a solver is built, only the newest waits. */
  async aim(targets) {
    this.#targets = targets;
    await this.#flush();
  }

  #flush() {
    if (this.#mayAim) this.#sending ??= this.#send();
    return this.#sending;
  }

  get #mayAim() {
    return this.#targets !== undefined && this.#building === 0 && this.#solver !== undefined;
  }

  async #send() {
    try {
      while (this.#mayAim) {
        const [targets, solver] = [this.#targets, this.#solver];
        this.#targets = undefined;
        try {
          await solver.setTargets(targets);
        } catch (error) {
          if (solver === this.#solver) throw error;
        }
        if (solver !== this.#solver) continue; // the next one was built with newer targets
        this.#aimed = true;
        [this.#status, this.certificate] = ['running', undefined];
      }
    } finally {
      this.#sending = undefined;
    }
  }

  /** Keeps a step's numbers, counted on from the solvers before. */
  #record(step) {
    const milliseconds = (step.phases ?? []).reduce((sum, phase) => sum + phase.milliseconds, 0);
    // Seconds of solving: the solver's own clock also runs while it waits for the next step.
    step.seconds = (this.newest?.seconds ?? 0) + milliseconds / 1000;
    step.iteration += this.#before.iterations;
    if (step.switchedAt !== undefined) step.switchedAt += this.#before.iterations;
    // Targets may have come after the solver had ended and before this was heard of: it has to look once more.
    this.#status = step.status === 'cancelled' || this.#aimed ? 'running' : step.status;
    const numbers = numbersOf(step);
    this.records.push(numbers);
    const old = this.records[this.records.length - 1 - MOST_PHASES];
    if (old) old.phases = [];
    return numbers;
  }

  /** The certificate, when this was the last step. */
  async #settle(step, solver) {
    if (step.status === 'running' || this.#status === 'running') return;
    const { certificate } = await solver.result();
    if (this.#status !== 'running') this.certificate = certificate;
  }

  /** The newest positions in double precision (n×3). */
  async result() {
    return (await this.#solver.result()).positions;
  }

  /** Everything a person would want to plot elsewhere. */
  async trace() {
    const { source, settings, setupSeconds, notes, pins, volume } = this.problem;
    const certificate = this.certificate ?? (await this.#solver.result()).certificate;
    return {
      format: 'foldfree-trace', formatVersion: 1, foldfree: this.#foldfree.version,
      problem: source.bytes ? { file: source.name } : { solid: source.solid, tetrahedra: source.tetrahedra },
      settings: { ...settings, maxIterations: MOST_ITERATIONS }, pins, notes, threads: this.#foldfree.threads,
      setupSeconds, volume, solvers: this.#solvers, iterations: this.records, certificate,
    };
  }
}

/** A step without its arrays. */
function numbersOf({ positions, field, subTargets, ...numbers }) {
  return numbers;
}

/** Volume of a solid, area of triangles. */
const measureOf = ({ positions, tetrahedra, indices }) => (indices ? areaOf(positions, indices) : volumeOf(positions, tetrahedra));
