// What differs between a browser and Node: how a worker is made, and whether threads are there.
import type { FromWorker, ToWorker } from './protocol.js';

/** The client's end of a worker. */
export interface WorkerPort {
  post(message: ToWorker, transfer?: Transferable[]): void;
  terminate(): void;
  /** In Node: does this worker keep the process alive? */
  keepAlive(busy: boolean): void;
}

export interface WorkerEvents {
  message(message: FromWorker): void;
  failed(what: string): void;
}

interface NodeWorker {
  on(event: string, listener: (value: never) => void): void;
  postMessage(message: unknown, transfer?: readonly unknown[]): void;
  terminate(): Promise<number>;
  ref(): void;
  unref(): void;
}

/** Is this Node (or something with its worker threads), without the Worker of browsers? */
export const isNode = typeof Worker === 'undefined' && typeof process !== 'undefined' && !!process.versions?.node;

/** Starts the worker, from `url` or from beside this module. */
export async function startWorker(url: string | URL | undefined, events: WorkerEvents): Promise<WorkerPort> {
  if (isNode) return startNodeWorker(url ?? new URL('./worker.js', import.meta.url), events);
  const worker = url === undefined
    ? new Worker(new URL('./worker.js', import.meta.url), { type: 'module', name: 'foldfree' })
    : new Worker(sameOrigin(url), { type: 'module', name: 'foldfree' });
  worker.onmessage = (event: MessageEvent<FromWorker>) => events.message(event.data);
  worker.onmessageerror = () => events.failed('a message could not be read');
  worker.onerror = (event) => {
    event.preventDefault();
    events.failed(event.message || 'the worker script could not be loaded');
  };
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    terminate: () => worker.terminate(),
    keepAlive: () => {},
  };
}

/** Browsers start workers of their own origin only; a module of another origin can be imported by one. */
function sameOrigin(url: string | URL): string | URL {
  const absolute = new URL(url, location.href);
  if (absolute.origin === location.origin || absolute.protocol === 'blob:') return absolute;
  const source = `import ${JSON.stringify(absolute.href)};`;
  return URL.createObjectURL(new Blob([source], { type: 'text/javascript' }));
}

async function startNodeWorker(url: string | URL, events: WorkerEvents): Promise<WorkerPort> {
  const name = 'node:worker_threads'; // not a literal: bundlers for browsers would look for it
  const { Worker: Threads } = await import(/* @vite-ignore */ /* webpackIgnore: true */ name) as {
    Worker: new (url: string | URL) => NodeWorker;
  };
  const worker = new Threads(url);
  worker.on('message', (message: FromWorker) => events.message(message));
  worker.on('error', (error: Error) => events.failed(error.message));
  worker.on('exit', (code: number) => events.failed(`the worker ended with ${code}`));
  return {
    post: (message, transfer = []) => worker.postMessage(message, transfer),
    terminate: () => void worker.terminate(),
    keepAlive: (busy) => (busy ? worker.ref() : worker.unref()),
  };
}

// (module (memory 1 1 shared) (func (drop (i32.atomic.load (i32.const 0)))))
const THREADS_PROBE = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 5, 4, 1, 3, 1, 1, 10, 11, 1, 9, 0, 65, 0, 254, 16, 2, 0, 26, 11,
];

/** Can this page run the threaded build? It needs COOP and COEP headers and wasm threads. */
export function threadsAvailable(): boolean {
  return (
    !isNode &&
    globalThis.crossOriginIsolated === true &&
    typeof SharedArrayBuffer === 'function' &&
    typeof Atomics === 'object' &&
    WebAssembly.validate(new Uint8Array(THREADS_PROBE))
  );
}
