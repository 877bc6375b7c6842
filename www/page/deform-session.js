// What is being deformed: one solid, one solver after the other, and the record of all their steps. No DOM here.

/** Iterations of one solver at most: a person may drag for a long time. */
export const MOST_ITERATIONS = 100_000;

/** Energies below this part of the stiffness are nothing but rounding, and told as 0. */
const ROUNDING = 1e-14;

/** A solid on the bench. Its solver is made anew when pins or material change, from where the solid is. */
export class DeformSession {
  #foldfree;
  #solid;
  #solver;
  #generation = 0;
  #before = { iterations: 0, seconds: 0 }; // of the solvers before this one
  #status = 'running';
  #targets; // the newest wish that was not sent yet
  #sending;
  #running; // a promise, while the solver runs by itself

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

  get newest() {
    return this.records.at(-1);
  }

  /** Whether the solver has nothing more to do. */
  get finished() {
    return this.#status !== 'running';
  }

  /** Reads or generates a solid; it lies on the bench only when `build` has been called. */
  read(source) {
    if (!source.bytes) return this.#foldfree.generateSolid(source.solid, source.tetrahedra);
    return this.#foldfree.solid(source.bytes, source.format, source.elements);
  }

  /**
   * Makes a solver. `solid`: another than before. `fresh`: the records begin anew with the start, else they go on.
   * Only when everything went well does the last solver leave; resolves with the start, or with undefined when a later
   * call overtook this one.
   */
  async build({ source, solid = this.#solid, settings, pins, start, targets, fresh }) {
    const generation = ++this.#generation;
    this.stop();
    while (this.#running) await this.#running.catch(() => {});
    const solver = await this.#foldfree.deform(solid, {
      ...settings, pins, start, targets, maxIterations: MOST_ITERATIONS, field: 'stress', frames: 'f32',
    });
    if (generation !== this.#generation) {
      solver.free();
      return undefined;
    }
    this.#solver?.free();
    if (solid !== this.#solid) this.#solid?.free();
    [this.#solid, this.#solver, this.#targets] = [solid, solver, undefined];
    this.problem = {
      source, settings, pins: pins.length, notes: [...solid.notes, ...solver.notes], setupSeconds: solver.setupSeconds,
    };
    this.certificate = undefined;
    this.#calm(solver.start);
    this.#status = solver.start.status;
    this.positions = solver.start.positions;
    if (fresh) {
      this.#before = { iterations: 0, seconds: 0 };
      this.records = [numbersOf(solver.start)];
    } else {
      this.#before = { iterations: this.newest.iteration, seconds: this.newest.seconds };
    }
    return solver.start;
  }

  /** One step; resolves with it, or with undefined when there is none to make. */
  async step() {
    while (this.#running) await this.#running.catch(() => {});
    const solver = this.#solver;
    if (!solver || this.finished) return undefined;
    const step = await solver.step();
    if (solver !== this.#solver) return undefined;
    this.#record(step);
    this.positions = step.positions;
    await this.#settle(step, solver);
    return step;
  }

  /**
   * Steps until there is nothing more to do, or `stop()`. `onFrame(step, skipped)` gets the newest iterate as often
   * as it takes it, and the numbers of those between.
   */
  async run(onFrame) {
    // Looked at and claimed without a pause between: of two calls only one goes on.
    while (this.#running) await this.#running.catch(() => {});
    const solver = this.#solver;
    if (!solver || this.finished) return;
    const take = async (frame, reports) => {
      if (solver !== this.#solver) return;
      const steps = reports.map((report) => this.#record({ ...report }));
      this.positions = frame.positions;
      const last = steps.pop();
      const step = { ...frame, ...last };
      if (step.status !== 'running') await this.#settle(step, solver);
      await onFrame(step, steps);
    };
    this.#running = solver.run({ onFrame: take }).finally(() => { this.#running = undefined; });
    await this.#running;
  }

  /** Nothing is held: there is nothing to solve until a solver is built with pins. */
  suspend() {
    this.#status = 'suspended';
  }

  /** Ends a run after its current step. */
  stop() {
    if (this.#running) this.#solver?.cancel();
  }

  /** Sends targets, one message at a time: while one is on its way only the newest waits. */
  async aim(targets) {
    this.#targets = targets;
    this.#sending ??= this.#send().finally(() => { this.#sending = undefined; });
    await this.#sending;
  }

  async #send() {
    while (this.#targets) {
      const targets = this.#targets;
      this.#targets = undefined;
      const solver = this.#solver;
      await solver.setTargets(targets);
      if (this.#status !== 'suspended' && solver === this.#solver) [this.#status, this.certificate] = ['running', undefined];
    }
  }

  #calm(step) {
    if (Math.abs(step.energy) < ROUNDING * (this.problem.settings.young ?? 1)) step.energy = 0;
  }

  /** Keeps a step's numbers, counted on from the solvers before. */
  #record(step) {
    const milliseconds = (step.phases ?? []).reduce((sum, phase) => sum + phase.milliseconds, 0);
    // Seconds of solving: the solver's own clock also runs while it waits for the next step.
    step.seconds = (this.newest?.seconds ?? 0) + milliseconds / 1000;
    step.iteration += this.#before.iterations;
    this.#calm(step);
    this.#status = step.status === 'cancelled' ? 'running' : step.status;
    const numbers = numbersOf(step);
    this.records.push(numbers);
    return numbers;
  }

  async #settle(step, solver) {
    if (step.status === 'running') return;
    const { certificate } = await solver.result();
    if (solver === this.#solver && this.finished) this.certificate = certificate;
  }

  /** The newest positions in double precision (n×3). */
  async result() {
    return (await this.#solver.result()).positions;
  }

  /** Everything a person would want to plot elsewhere. */
  async trace() {
    const { source, settings, setupSeconds, notes, pins } = this.problem;
    const certificate = this.certificate ?? (await this.#solver.result()).certificate;
    return {
      format: 'foldfree-trace', formatVersion: 1, foldfree: this.#foldfree.version,
      problem: source.bytes ? { file: source.name } : { solid: source.solid, tetrahedra: source.tetrahedra },
      settings: { ...settings, maxIterations: MOST_ITERATIONS }, pins, notes, threads: this.#foldfree.threads,
      setupSeconds, iterations: this.records, certificate,
    };
  }
}

/** A step without its arrays. */
function numbersOf({ positions, field, ...numbers }) {
  return numbers;
}
