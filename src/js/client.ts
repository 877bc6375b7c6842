// The client's end of one worker: calls and their answers, its death and its restart.
import { FATAL, FoldfreeError, fromPlain } from './error.js';
import { startWorker, threadsAvailable, type WorkerPort } from './platform.js';
import type { AnyFrame, AnyReport, CallName, Calls, FromWorker, Loaded, ToWorker } from './protocol.js';
import type { Progress, Step, StepReport } from './types.js';

/** Where the parts are, and how many threads to use. */
export interface LoadOptions {
  /**
   * `'auto'` (default): the page's cores, at most 8, where the page may have threads, else one.
   * A number: so many where the page may have threads, else one. `false`: one.
   */
  threads?: 'auto' | number | false;
  /** Folder with `worker.js` (and the wasm beside it), when it is not beside this module. */
  baseUrl?: string | URL;
  /** The worker script itself. */
  workerUrl?: string | URL;
  /** The single-thread wasm; give `threadsWasmUrl` too, or threads are off. */
  wasmUrl?: string | URL;
  /** The threaded wasm. */
  threadsWasmUrl?: string | URL;
  /** How long the pool of threads may take to start before one thread is used instead (5000 ms). */
  threadTimeoutMs?: number;
  /** Bytes of wasm loaded so far; `total` is 0 where the server does not tell. */
  onProgress?: (loaded: number, total: number) => void;
  /** Aborts loading. */
  signal?: AbortSignal;
}

interface Pending {
  resolve(value: unknown): void;
  reject(error: unknown): void;
}

/** What a run does with a frame. The next is sent when this has returned, or its promise is done. */
export type FrameListener<F extends Progress = Step, R extends Progress = StepReport> = (frame: F, reports: R[]) => void | Promise<void>;

/** A listener of any kind of run: which kind is known to who made it. */
export type AnyListener = FrameListener<AnyFrame, AnyReport>;

const DEFAULT_THREAD_TIMEOUT = 5000;
const MOST_THREADS = 8;

/** One worker at a time; after a panic or a termination the next call starts another. */
export class Client {
  /** Grows with every new worker: what was made in an older one is gone. */
  generation = 0;
  readonly #options: LoadOptions;
  #port: WorkerPort | undefined;
  #starting: Promise<Loaded> | undefined;
  #threadsFailed = false;
  #closed = false;
  #nextId = 1;
  #channel: BroadcastChannel | undefined;
  readonly #pending = new Map<number, Pending>();
  readonly #runs = new Map<number, AnyListener>();
  /** What the listeners of runs are doing with the newest frame; what they threw is in it. */
  readonly #listening = new Map<number, Promise<unknown>>();
  /** Runs that were cancelled, perhaps before the worker has heard of them. */
  readonly #cancelled = new Set<number>();
  #onStarting: (() => void) | undefined;

  constructor(options: LoadOptions) {
    this.#options = options;
  }

  /** A number nothing else of this client has. */
  newId(): number {
    return this.#nextId++;
  }

  /** Starts the worker unless it is there. */
  start(): Promise<Loaded> {
    if (this.#closed) return Promise.reject(new FoldfreeError('terminated', 'this instance was terminated'));
    this.#starting ??= this.#startSomehow().catch((error: unknown) => {
      this.#starting = undefined;
      throw error;
    });
    return this.#starting;
  }

  /** Calls into the worker; starts one if need be. */
  async call<K extends CallName>(call: K, args: Calls[K][0], transfer: Transferable[] = []): Promise<Calls[K][1]> {
    await this.start();
    return this.#send(call, args, transfer);
  }

  /** A run: `listener` gets its frames, one at a time; `ended` the last, before the listener is done with those before. */
  async run(
    args: Calls['run'][0], generation: number, listener: AnyListener | undefined, ended: (last: AnyFrame) => void,
  ): Promise<AnyFrame> {
    await this.start();
    this.#mustBe(generation);
    if (listener) this.#runs.set(args.run, listener);
    try {
      const sent = this.#send('run', args, []);
      if (this.#cancelled.has(args.run)) this.#port?.post({ cancel: args.run });
      const last = await sent;
      ended(last);
      await this.#listening.get(args.run);
      return last;
    } finally {
      this.#runs.delete(args.run);
      this.#listening.delete(args.run);
      this.#cancelled.delete(args.run);
    }
  }

  /** A call about something that was made in worker `generation`. */
  async callIn<K extends CallName>(generation: number, call: K, args: Calls[K][0]): Promise<Calls[K][1]> {
    this.#mustBe(generation);
    return this.#send(call, args, []);
  }

  /** Ends a run after its current step. */
  cancel(run: number): void {
    this.#cancelled.add(run);
    this.#port?.post({ cancel: run });
  }

  /** Ends the worker at once, in the middle of a step if need be; the next call starts another. */
  restart(error: FoldfreeError): void {
    this.#port?.terminate();
    this.#port = undefined;
    this.#starting = undefined;
    this.#channel?.close();
    this.#channel = undefined;
    this.generation++;
    const pending = [...this.#pending.values()];
    this.#pending.clear();
    this.#runs.clear();
    for (const { reject } of pending) reject(error);
  }

  /** Ends the worker for good. */
  close(): void {
    this.#closed = true;
    this.restart(new FoldfreeError('terminated', 'this instance was terminated'));
  }

  #mustBe(generation: number): void {
    if (this.#closed) throw new FoldfreeError('terminated', 'this instance was terminated');
    if (generation !== this.generation) {
      throw new FoldfreeError('worker-lost', 'the worker this solver lived in was ended; make a new solver');
    }
  }

  #threadsWanted(): number {
    const { threads = 'auto', wasmUrl, threadsWasmUrl } = this.#options;
    if (threads === false || this.#threadsFailed || !threadsAvailable()) return 1;
    if (wasmUrl !== undefined && threadsWasmUrl === undefined) return 1;
    if (threads === 'auto') return Math.min(navigator.hardwareConcurrency || 1, MOST_THREADS);
    return Math.max(1, Math.floor(threads));
  }

  async #startSomehow(): Promise<Loaded> {
    const threads = this.#threadsWanted();
    if (threads > 1) {
      try {
        return await this.#startWith(threads);
      } catch (error) {
        if (this.#closed || this.#options.signal?.aborted) throw error;
        this.#threadsFailed = true;
      }
    }
    return this.#startWith(1);
  }

  async #startWith(threads: number): Promise<Loaded> {
    const { baseUrl, workerUrl, wasmUrl, threadsWasmUrl, signal } = this.#options;
    signal?.throwIfAborted();
    const instance = 1 + Math.floor(Math.random() * 0xffff_fffe);
    const generation = ++this.generation;
    const failed = (what: string) => {
      if (generation === this.generation) this.restart(new FoldfreeError('worker-lost', what));
    };
    const port = await startWorker(workerUrl ?? (baseUrl === undefined ? undefined : new URL('worker.js', absolute(baseUrl, true))), {
      message: (message) => {
        if (generation === this.generation) this.#receive(message);
      },
      failed,
    });
    this.#port = port;
    if (threads > 1 && typeof BroadcastChannel === 'function') {
      this.#channel = new BroadcastChannel(`foldfree-panic-${instance}`);
      this.#channel.onmessage = (event) => {
        if (generation === this.generation) this.restart(new FoldfreeError('panic', `internal error: ${event.data}`));
      };
    }
    const abort = () => this.restart(new FoldfreeError('aborted', 'loading was aborted'));
    signal?.addEventListener('abort', abort, { once: true });
    let timer: ReturnType<typeof setTimeout> | undefined;
    this.#onStarting = () => {
      const limit = this.#options.threadTimeoutMs ?? DEFAULT_THREAD_TIMEOUT;
      timer = setTimeout(() => failed(`the pool of threads did not start within ${limit} ms`), limit);
    };
    try {
      const wasm = threads > 1 ? threadsWasmUrl : wasmUrl;
      return await this.#send('init', { threads, instance, wasmUrl: wasm && absolute(wasm).href }, []);
    } catch (error) {
      if (generation === this.generation) failed('the worker could not be initialised');
      signal?.throwIfAborted();
      throw error;
    } finally {
      clearTimeout(timer);
      this.#onStarting = undefined;
      signal?.removeEventListener('abort', abort);
    }
  }

  #send<K extends CallName>(call: K, args: Calls[K][0], transfer: Transferable[]): Promise<Calls[K][1]> {
    const port = this.#port;
    if (!port) return Promise.reject(new FoldfreeError('worker-lost', 'the worker was ended'));
    const id = this.newId();
    return new Promise((resolve, reject) => {
      this.#pending.set(id, { resolve: resolve as (value: unknown) => void, reject });
      port.keepAlive(true);
      try {
        port.post({ id, call, args } as ToWorker, transfer);
      } catch (error) {
        this.#settle(id);
        reject(new FoldfreeError('invalid-argument', `the arguments cannot be sent to a worker: ${(error as Error).message}`));
      }
    });
  }

  #settle(id: number): Pending | undefined {
    const pending = this.#pending.get(id);
    this.#pending.delete(id);
    if (this.#pending.size === 0) this.#port?.keepAlive(false);
    return pending;
  }

  #receive(message: FromWorker): void {
    if ('progress' in message) {
      this.#options.onProgress?.(message.progress.loaded, message.progress.total);
    } else if ('starting' in message) {
      this.#onStarting?.();
    } else if ('run' in message) {
      const { run, frame, reports } = message;
      const acknowledge = () => this.#port?.post({ acknowledge: run });
      const listener = this.#runs.get(run);
      // a listener that fails ends its run, which then rejects with what was thrown
      const before = this.#listening.get(run);
      const heard = (async () => {
        await before;
        await listener?.(frame, reports);
      })();
      heard.catch(() => this.#port?.post({ cancel: run })).finally(acknowledge);
      this.#listening.set(run, heard);
    } else if ('error' in message) {
      const error = fromPlain(message.error);
      this.#settle(message.id)?.reject(error);
      if (FATAL.includes(error.code)) this.restart(error);
    } else {
      this.#settle(message.id)?.resolve(message.value);
    }
  }
}

function absolute(url: string | URL, folder = false): URL {
  const base = typeof location === 'undefined' ? import.meta.url : location.href;
  const whole = new URL(url, base);
  if (folder && !whole.pathname.endsWith('/')) whole.pathname += '/';
  return whole;
}
