// What is being computed in the worker: steps, runs, and their ends.
import type { AnyListener, Client, FrameListener } from './client.js';
import { FoldfreeError } from './error.js';
import { needTargets } from './input.js';
import type { CallName, Calls } from './protocol.js';
import {
  dispose,
  type Certificate, type DeformInfo, type DeformResult, type DeformStep, type Field, type Frame, type MeshArrays, type Progress, type Result,
  type SolidCertificate, type SolverInfo, type Step, type StepReport, type Targets,
} from './types.js';

/** What `Solver.run` takes. */
export interface RunOptions<F extends Progress = Step, R extends Progress = StepReport> {
  /** Gets the newest iterate and the reports of all iterations since the last frame. */
  onFrame?: FrameListener<F, R>;
  /** Stop after so many iterations more. */
  maxIterations?: number;
  /** Milliseconds between frames, at least (default 0: as fast as they are taken). */
  minInterval?: number;
}

export type Wait = <T>(work: Promise<T>) => Promise<T>;

/** Calls that need nothing but the solver. */
type Plain = { [K in CallName]: Calls[K][0] extends { solver: number } ? ({ solver: number } extends Calls[K][0] ? K : never) : never }[CallName];

/** An iterative computation; `F` is what a step leads to, `R` what is known of those that are not sent. */
export abstract class Stepper<F extends Progress, R extends Progress = StepReport> implements AsyncIterable<F> {
  readonly start: F;
  readonly setupSeconds: number;
  readonly #client: Client;
  readonly #generation: number;
  readonly #id: number;
  readonly #wait: Wait;
  readonly #signal: AbortSignal | undefined;
  #run: number | undefined;
  #status: Progress['status'];
  #cancelled = false;
  #freed = false;

  /** @internal */
  constructor(
    client: Client, generation: number, id: number,
    info: { start: F; setupSeconds: number }, wait: Wait, signal: AbortSignal | undefined,
  ) {
    this.#client = client;
    this.#generation = generation;
    this.#id = id;
    this.#wait = wait;
    this.#signal = signal;
    this.start = info.start;
    this.setupSeconds = info.setupSeconds;
    this.#status = info.start.status;
  }

  /** The status after the newest step. */
  get status(): Progress['status'] {
    return this.#status;
  }

  /** One iteration of the method. */
  async step(): Promise<F> {
    const step = (await this.call('step')) as unknown as F;
    this.#status = step.status;
    return step;
  }

  /**
   * Steps until the status is no longer `running`, without waiting for this thread: frames come as fast
   * as `onFrame` takes them, iterations as fast as they can be computed. Resolves with the last step.
   */
  async run({ onFrame, maxIterations = Infinity, minInterval = 0 }: RunOptions<F, R> = {}): Promise<F> {
    if (this.#run !== undefined) throw new FoldfreeError('busy', 'this solver is running already');
    this.#mustLive();
    const run = this.#client.newId();
    this.#run = run;
    this.#cancelled = false;
    const stop = () => this.#client.cancel(run);
    this.#signal?.addEventListener('abort', stop, { once: true });
    try {
      const args = { solver: this.#id, run, maxIterations, minInterval };
      const listener = onFrame as AnyListener | undefined;
      // targets that come while a frame is still being taken wake it again
      const ended = ({ status }: { status: Progress['status'] }) => {
        this.#status = status === 'cancelled' ? 'running' : status;
      };
      return (await this.#wait(this.#client.run(args, this.#generation, listener, ended))) as unknown as F;
    } finally {
      this.#run = undefined;
      this.#signal?.removeEventListener('abort', stop);
    }
  }

  /** Steps, one at a time, until the status is no longer `running`, or `cancel()` is called. */
  async *[Symbol.asyncIterator](): AsyncGenerator<F, void, undefined> {
    this.#cancelled = false;
    while (this.#status === 'running' && !this.#cancelled) yield await this.step();
  }

  /** Ends a run or an iteration after the current step. The solver stays usable. */
  cancel(): void {
    this.#cancelled = true;
    if (this.#run !== undefined) this.#client.cancel(this.#run);
  }

  /** Gives its memory in the worker back. */
  free(): void {
    if (this.#freed) return;
    this.#freed = true;
    this.cancel();
    this.#client.callIn(this.#generation, 'freeSolver', { solver: this.#id }).catch(() => {});
  }

  [dispose](): void {
    this.free();
  }

  #mustLive(): void {
    if (this.#freed) throw new FoldfreeError('freed', 'this solver was freed');
    this.#signal?.throwIfAborted();
  }

  protected call<K extends Plain>(call: K): Promise<Calls[K][1]> {
    return this.callWith(call, {} as Omit<Calls[K][0], 'solver'>);
  }

  protected async callWith<K extends CallName>(call: K, args: Omit<Calls[K][0], 'solver'>): Promise<Calls[K][1]> {
    this.#mustLive();
    return this.#wait(this.#client.callIn(this.#generation, call, { ...args, solver: this.#id } as Calls[K][0]));
  }

  /** The status is this, `running` as a rule, again. */
  protected awake(status: Progress['status'] = 'running'): void {
    this.#status = status;
  }
}

/** An iterative computation on a mesh. */
abstract class MeshStepper<F extends Frame> extends Stepper<F> {
  readonly notes: string[];

  /** @internal */
  constructor(
    client: Client, generation: number, id: number,
    info: { start: F; notes: string[]; setupSeconds: number }, wait: Wait, signal: AbortSignal | undefined,
  ) {
    super(client, generation, id, info, wait, signal);
    this.notes = info.notes;
  }

  /** Weight over rest weight an element; empty where the method has no weights. */
  weights(): Promise<Float32Array> {
    return this.call('weights');
  }
}

/** A map being computed in the worker. */
export class Solver extends MeshStepper<Step> implements SolverInfo {
  readonly mesh: MeshArrays;
  readonly inputVertices: Uint32Array;
  readonly seamEdges: number;
  readonly startKind: SolverInfo['startKind'];

  /** @internal */
  constructor(client: Client, generation: number, id: number, info: SolverInfo, wait: Wait, signal: AbortSignal | undefined) {
    super(client, generation, id, info, wait, signal);
    this.mesh = info.mesh;
    this.inputVertices = info.inputVertices;
    this.seamEdges = info.seamEdges;
    this.startKind = info.startKind;
  }

  /** The newest map with its certificate. */
  result(): Promise<Result> {
    return this.call('result');
  }

  /** The input surface as an OBJ file with the map as texture coordinates. */
  exportObj(): Promise<Uint8Array> {
    return this.call('exportObj');
  }
}

/** A solid, or (with `Certificate`) triangles in their plane, being deformed in the worker. */
export class Deformation<C extends SolidCertificate | Certificate = SolidCertificate> extends MeshStepper<DeformStep> implements DeformInfo {
  /**
   * Replaces all targets, also while a run goes on, between two of its steps: pinned vertices are moved to
   * theirs, free ones pulled. The iterate is kept and the status goes back to `running`; a run that has ended
   * is to be started again. On an error nothing has changed.
   */
  async setTargets(targets: Targets): Promise<void> {
    await this.callWith('setTargets', { targets: needTargets(targets) });
    this.awake();
  }

  /** The field that comes with each step from here on. */
  async setField(field: Field): Promise<void> {
    await this.callWith('setField', { field });
  }

  /** The newest positions in double precision, with their certificate. */
  result(): Promise<DeformResult<C>> {
    return this.call('deformed') as Promise<DeformResult<C>>;
  }
}

/** Makes waits reject with the signal's reason as soon as it aborts, and ends the worker if asked. */
export function abortable(client: Client, signal: AbortSignal | undefined, terminate: boolean): Wait {
  if (!signal) return (work) => work;
  return (work) =>
    new Promise((resolve, reject) => {
      const abort = () => {
        reject(signal.reason);
        if (terminate) client.restart(new FoldfreeError('worker-lost', 'the worker was ended by an abort'));
      };
      signal.addEventListener('abort', abort, { once: true });
      work.then(resolve, reject).finally(() => signal.removeEventListener('abort', abort));
    });
}
