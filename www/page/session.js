// What is being solved: one mesh, one solver, and the record of its steps. No DOM here.

/** Iterates kept as numbers at most; the solver stops there. */
export const MOST_ITERATIONS = 5000;

/** A mesh on the bench, a solver for it, and every step so far. */
export class Session {
  #foldfree;
  #mesh;
  #solver;
  #generation = 0;

  /** Numbers of every iterate, the start first (without the maps). */
  records = [];
  /** Name, settings and facts of the problem. */
  problem = undefined;
  /** The certificate of the finished map. */
  certificate = undefined;

  constructor(foldfree) {
    this.#foldfree = foldfree;
  }

  get ready() {
    return this.#solver !== undefined;
  }

  get newest() {
    return this.records.at(-1);
  }

  /** Whether the solver has nothing more to do. */
  get finished() {
    return this.newest !== undefined && this.newest.iteration > 0 && this.newest.status !== 'running';
  }

  /**
   * Puts a problem on the bench. Only when everything went well does the last one leave; resolves
   * with `{ start, surface }`, `surface` undefined when it is the one already there, or with
   * undefined when a later call overtook this one.
   */
  async open({ source, settings }) {
    const generation = ++this.#generation;
    const same = this.#mesh !== undefined && this.problem?.source === source;
    const mesh = same ? this.#mesh : await this.#read(source);
    let solver;
    try {
      solver = await this.#foldfree.parameterize(mesh, { ...settings, maxIterations: MOST_ITERATIONS, frames: 'f32' });
    } catch (error) {
      if (!same) mesh.free();
      throw error;
    }
    if (generation !== this.#generation) {
      solver.free();
      if (!same) mesh.free();
      return undefined;
    }
    this.#solver?.free();
    if (!same) this.#mesh?.free();
    [this.#mesh, this.#solver] = [mesh, solver];
    this.problem = { source, settings, notes: [...mesh.notes, ...solver.notes], startKind: solver.startKind, setupSeconds: solver.setupSeconds };
    this.certificate = undefined;
    this.records = [numbersOf(solver.start)];
    return { start: solver.start, surface: same ? undefined : solver.mesh };
  }

  #read(source) {
    return source.bytes
      ? this.#foldfree.mesh(source.bytes, source.format)
      : this.#foldfree.generate(source.sample, source.triangles);
  }

  /** One step; resolves with it, or with undefined when there is none to make. */
  async step() {
    const solver = this.#solver;
    if (!solver || this.finished) return undefined;
    const step = await solver.step();
    if (solver !== this.#solver) return undefined;
    // Seconds of solving: the solver's own clock also runs while it waits for the next step.
    step.seconds = this.newest.seconds + step.phases.reduce((sum, phase) => sum + phase.milliseconds, 0) / 1000;
    this.records.push(numbersOf(step));
    if (step.status !== 'running') {
      const { certificate } = await solver.result();
      if (solver === this.#solver) this.certificate = certificate;
    }
    return step;
  }

  /** The mesh with the newest map as texture coordinates, as an OBJ file. */
  exportObj() {
    return this.#solver.exportObj();
  }

  /** Everything a person would want to plot elsewhere. */
  async trace() {
    const { source, settings, startKind, setupSeconds, notes } = this.problem;
    const certificate = this.certificate ?? (await this.#solver.result()).certificate;
    return {
      format: 'foldfree-trace', formatVersion: 1, foldfree: this.#foldfree.version,
      problem: source.bytes ? { file: source.name } : { sample: source.sample, triangles: source.triangles },
      settings: { ...settings, maxIterations: MOST_ITERATIONS }, start: startKind, notes, threads: this.#foldfree.threads,
      setupSeconds, iterations: this.records, certificate,
    };
  }
}

/** A step without its arrays. */
function numbersOf({ positions, distortion, ...numbers }) {
  return numbers;
}
