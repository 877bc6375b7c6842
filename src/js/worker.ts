// The worker: holds the wasm instance, answers the client's calls, and sends frames of runs.
import { Core, CoreMesh, CoreSolver, type WasmBindings } from './engine.js';
import { FoldfreeError, toPlain } from './error.js';
import { CoreMixedInteger } from './mixed-integer-engine.js';
import type { AnyFrame, AnyReport, CallName, Calls, FromWorker, ToWorker } from './protocol.js';
import { CoreDeformation, type CoreSolid } from './solid-engine.js';
import type { Certificate, DeformInfo, DeformOptions, LimDeformOptions, MeshInfo, MixedIntegerInfo, SolidInfo, SolverInfo, UntangleInfo } from './types.js';
import { CoreUntangling } from './untangle-engine.js';

interface Port {
  postMessage(message: FromWorker, transfer?: Transferable[]): void;
  listen(listener: (message: ToWorker) => void): void;
}

type Handlers = { [K in CallName]: (args: Calls[K][0]) => Calls[K][1] | Promise<Calls[K][1]> };

/** A run in progress: frames wait until the one before was taken. */
interface Run {
  acknowledged: boolean;
  cancelled: boolean;
  /** Called when a frame was taken. */
  taken?: () => void;
}

/** Lets messages in between two steps. */
const breathe: () => Promise<void> = (() => {
  if (typeof setImmediate === 'function') return () => new Promise<void>((resolve) => setImmediate(resolve));
  const { port1, port2 } = new MessageChannel();
  const waiting: (() => void)[] = [];
  port1.onmessage = () => waiting.shift()?.();
  return () => new Promise<void>((resolve) => {
    waiting.push(resolve);
    port2.postMessage(null);
  });
})();

/** Fetches a wasm file with progress, and compiles it while it arrives. */
async function compile(url: URL, progress: (loaded: number, total: number) => void): Promise<WebAssembly.Module> {
  if (url.protocol === 'file:') {
    const name = 'node:fs/promises'; // not a literal: bundlers for browsers would look for it
    const { readFile } = await import(/* @vite-ignore */ /* webpackIgnore: true */ name) as {
      readFile(url: URL): Promise<Uint8Array<ArrayBuffer>>;
    };
    return WebAssembly.compile(await readFile(url));
  }
  const unavailable = (what: string) => new FoldfreeError('wasm-unavailable', `${url.href} ${what}`, { url: url.href });
  const response = await fetch(url).catch((error: unknown) => {
    throw unavailable(`could not be fetched: ${String((error as Error).message)}`);
  });
  if (!response.ok || !response.body) throw unavailable(`answered with status ${response.status}`);
  const type = response.headers.get('Content-Type') ?? '';
  if (type.startsWith('text/html')) throw unavailable('answered with a page of HTML instead of wasm');
  // The length is that of the bytes on the wire: with a content encoding it says nothing of ours.
  const total = response.headers.has('Content-Encoding') ? 0 : Number(response.headers.get('Content-Length') ?? 0);
  let loaded = 0;
  const counted = response.body.pipeThrough(
    new TransformStream<Uint8Array<ArrayBuffer>, Uint8Array<ArrayBuffer>>({
      transform(chunk, controller) {
        loaded += chunk.length;
        progress(loaded, total);
        controller.enqueue(chunk);
      },
    }),
  );
  return WebAssembly.compileStreaming(new Response(counted, { headers: { 'Content-Type': 'application/wasm' } }));
}

/** Buffers of an answer that are moved, not copied. */
function transferables(value: unknown): Transferable[] {
  const found = new Set<ArrayBuffer>(); // none may be named twice
  const visit = (inner: unknown) => {
    if (ArrayBuffer.isView(inner)) {
      if (inner.buffer instanceof ArrayBuffer) found.add(inner.buffer);
    } else if (Array.isArray(inner)) {
      inner.forEach(visit);
    } else if (inner && Object.getPrototypeOf(inner) === Object.prototype) {
      Object.values(inner).forEach(visit);
    }
  };
  visit(value);
  return [...found];
}

/** Calls whose answers stay here, too. */
const KEPT: readonly CallName[] = [
  'read', 'generate', 'parameterize', 'readSolid', 'uploadSolid', 'generateSolid', 'deform', 'untangle', 'mixedInteger',
];

function serve(port: Port): void {
  let core: Core | undefined;
  const meshes = new Map<number, CoreMesh | CoreSolid>();
  type Untangling = CoreUntangling | CoreUntangling<Certificate>;
  const solvers = new Map<number, CoreSolver | CoreDeformation | CoreDeformation<Certificate> | Untangling | CoreMixedInteger>();
  const runs = new Map<number, Run>();

  const theCore = (): Core => {
    if (!core) throw new FoldfreeError('internal', 'the worker is not initialised');
    return core;
  };
  const found = <T>(map: Map<number, T>, id: number, what: string): T => {
    const value = map.get(id);
    if (value === undefined) throw new FoldfreeError('freed', `this ${what} was freed`);
    return value;
  };
  const surface = (id: number): CoreMesh => {
    const mesh = found(meshes, id, 'mesh');
    if (mesh instanceof CoreMesh) return mesh;
    throw new FoldfreeError('internal', 'this is no surface');
  };
  const solid = (id: number): CoreSolid => {
    const mesh = found(meshes, id, 'solid');
    if (mesh instanceof CoreMesh) throw new FoldfreeError('internal', 'this is no solid');
    return mesh;
  };
  const map = (id: number): CoreSolver => {
    const solver = found(solvers, id, 'solver');
    if (solver instanceof CoreSolver) return solver;
    throw new FoldfreeError('internal', 'this is no map');
  };
  const deformation = (id: number): CoreDeformation | CoreDeformation<Certificate> => {
    const solver = found(solvers, id, 'solver');
    if (solver instanceof CoreDeformation) return solver;
    throw new FoldfreeError('internal', 'this is no deformation');
  };
  const untangling = (id: number): Untangling => {
    const solver = found(solvers, id, 'solver');
    if (solver instanceof CoreUntangling) return solver;
    throw new FoldfreeError('internal', 'this is no untangling');
  };
  const mixedInteger = (id: number): CoreMixedInteger => {
    const solver = found(solvers, id, 'solver');
    if (solver instanceof CoreMixedInteger) return solver;
    throw new FoldfreeError('internal', 'this is no mixed-integer problem');
  };
  const keepSolid = (id: number, made: CoreSolid): SolidInfo => {
    meshes.set(id, made);
    const { positions, tetrahedra, surface, notes } = made;
    return { positions, tetrahedra, surface, notes };
  };
  const keep = (id: number, mesh: CoreMesh): MeshInfo => {
    meshes.set(id, mesh);
    const { positions, indices, notes, texture } = mesh;
    return { positions, indices, notes, ...(texture && { texture }) };
  };

  const handlers: Handlers = {
    async init({ threads, wasmUrl, instance }) {
      const progress = (loaded: number, total: number) => port.postMessage({ progress: { loaded, total } });
      if (threads > 1) {
        const url = new URL('./threads/foldfree_bg.wasm', import.meta.url);
        const module = await compile(wasmUrl ? new URL(wasmUrl) : url, progress);
        const bindings = await import('./threads/foldfree.js');
        await bindings.default({ module_or_path: module });
        port.postMessage({ starting: true });
        await bindings.initThreadPool(threads);
        bindings.setInstance(instance);
        core = new Core(bindings as unknown as WasmBindings);
      } else {
        const url = new URL('./single/foldfree_bg.wasm', import.meta.url);
        const module = await compile(wasmUrl ? new URL(wasmUrl) : url, progress);
        const bindings = await import('./single/foldfree.js');
        await bindings.default({ module_or_path: module });
        core = new Core(bindings);
      }
      return { threads: core.threads, version: core.version, shapes: core.shapes, solidShapes: core.solidShapes };
    },
    read: ({ mesh, bytes, format }) => keep(mesh, theCore().mesh(bytes, format)),
    upload: ({ mesh, arrays }) => void meshes.set(mesh, theCore().mesh(arrays)),
    generate: ({ mesh, name, triangles }) => keep(mesh, theCore().generate(name, triangles)),
    freeMesh: ({ mesh }) => {
      meshes.get(mesh)?.free();
      meshes.delete(mesh);
      return undefined;
    },
    parameterize({ mesh, solver, options, frames }): SolverInfo {
      const made = theCore().parameterize(surface(mesh), { ...options, frames });
      solvers.set(solver, made);
      const { start, inputVertices, seamEdges, startKind, notes, setupSeconds } = made;
      return { start, mesh: made.mesh, inputVertices: inputVertices.slice(), seamEdges, startKind, notes, setupSeconds };
    },
    readSolid: ({ mesh, bytes, format, elements }) => keepSolid(mesh, theCore().solid(bytes, format, elements)),
    uploadSolid: ({ mesh, arrays }) => keepSolid(mesh, theCore().solid(arrays)),
    generateSolid: ({ mesh, name, tetrahedra }) => keepSolid(mesh, theCore().generateSolid(name, tetrahedra)),
    write: ({ mesh, format, positions }) => found(meshes, mesh, 'mesh').write(format, positions),
    deform({ mesh, solver, options, frames }): DeformInfo {
      const body = found(meshes, mesh, 'mesh');
      const made: CoreDeformation | CoreDeformation<Certificate> = body instanceof CoreMesh
        ? theCore().deform(body, { ...(options as LimDeformOptions), frames })
        : theCore().deform(body, { ...(options as DeformOptions), frames });
      solvers.set(solver, made);
      const { start, notes, setupSeconds } = made;
      return { start, notes, setupSeconds };
    },
    setTargets: ({ solver, targets }) => void deformation(solver).setTargets(targets),
    setField: ({ solver, field }) => void deformation(solver).setField(field),
    checkSolid: ({ mesh, positions }) => theCore().checkSolid(solid(mesh), positions),
    deformed: ({ solver }) => deformation(solver).result(),
    untangle({ mesh, solver, options, frames }): UntangleInfo {
      const body = found(meshes, mesh, 'mesh');
      const made: Untangling = body instanceof CoreMesh
        ? theCore().untangle(body, { ...options, frames })
        : theCore().untangle(body, { ...options, frames });
      solvers.set(solver, made);
      const { start, notes, flowed, setupSeconds } = made;
      return { start, notes, flowed, setupSeconds };
    },
    movePins: ({ solver, targets }) => void untangling(solver).movePins(targets),
    primaryPositions: ({ solver }) => untangling(solver).primaryPositions(),
    untangled: ({ solver }) => untangling(solver).result(),
    mixedInteger({ solver, input, options }): MixedIntegerInfo {
      const made = theCore().mixedInteger('bytes' in input ? input.bytes : input.problem, options);
      solvers.set(solver, made);
      const { start, integerUnknowns, setupSeconds } = made;
      return { start, integerUnknowns, setupSeconds };
    },
    resolve: ({ solver, change }) => mixedInteger(solver).resolve(change),
    solved: ({ solver }) => mixedInteger(solver).result(),
    mixedIntegerReport: ({ solver }) => mixedInteger(solver).report(),
    step: ({ solver }) => found(solvers, solver, 'solver').step(),
    async run({ solver: id, run: runId, maxIterations, minInterval }) {
      const solver = found(solvers, id, 'solver');
      const run: Run = { acknowledged: true, cancelled: false };
      runs.set(runId, run);
      try {
        let reports: AnyReport[] = [];
        let sent = -Infinity;
        // a rounding may take microseconds, less than it takes to listen
        const listens = solver instanceof CoreMixedInteger ? 4 : 0;
        let listened = performance.now();
        let last: AnyFrame;
        for (let count = 0; ;) {
          while (count < maxIterations) {
            const report = solver.advance();
            count += 1;
            reports.push(report);
            if (run.acknowledged && performance.now() - sent >= minInterval) {
              run.acknowledged = false;
              sent = performance.now();
              const frame = solver.frame();
              port.postMessage({ run: runId, frame, reports }, transferables(frame));
              reports = [];
            }
            if (report.status !== 'running') break;
            if (performance.now() - listened < listens) continue;
            await breathe();
            listened = performance.now();
            if (!solvers.has(id)) throw new FoldfreeError('freed', 'this solver was freed');
            if (run.cancelled) break;
          }
          last = solver.frame();
          if (!reports.length || run.acknowledged) break;
          await new Promise<void>((resolve) => (run.taken = resolve));
          if (!solvers.has(id)) break;
          // targets that came meanwhile have it go on
          last = solver.frame();
          if (last.status !== 'running' || run.cancelled || count >= maxIterations) break;
        }
        if (reports.length) port.postMessage({ run: runId, frame: last, reports });
        return run.cancelled && last.status === 'running' ? { ...last, status: 'cancelled' } : last;
      } finally {
        runs.delete(runId);
      }
    },
    weights({ solver: id }) {
      const solver = found(solvers, id, 'solver');
      return solver instanceof CoreMixedInteger || solver instanceof CoreUntangling ? new Float32Array() : solver.weights();
    },
    result: ({ solver }) => map(solver).result(),
    exportObj: ({ solver }) => map(solver).exportObj(),
    freeSolver: ({ solver }) => {
      solvers.get(solver)?.free();
      solvers.delete(solver);
      return undefined;
    },
    check: ({ mesh, uv }) => theCore().check(surface(mesh), uv),
    checkCorners: ({ mesh, corners }) => theCore().checkCorners(surface(mesh), corners),
    memory: () => theCore().memoryBytes,
  };

  port.listen(async (message) => {
    if ('acknowledge' in message) {
      const run = runs.get(message.acknowledge);
      if (run) {
        run.acknowledged = true;
        run.taken?.();
      }
    } else if ('cancel' in message) {
      const run = runs.get(message.cancel);
      if (run) run.cancelled = true;
    } else {
      const { id, call, args } = message;
      try {
        const handler = handlers[call] as (args: unknown) => unknown;
        const value = await handler(args);
        // A mesh's arrays stay here too: they are copied, once.
        const keepHere = KEPT.includes(call);
        port.postMessage({ id, value }, keepHere ? [] : transferables(value));
      } catch (thrown) {
        port.postMessage({ id, error: toPlain(thrown) });
      }
    }
  });
}

async function thisPort(): Promise<Port> {
  const scope = globalThis as unknown as {
    postMessage?: (message: unknown, transfer: Transferable[]) => void;
    onmessage: ((event: MessageEvent<ToWorker>) => void) | null;
    process?: { versions?: { node?: string } };
  };
  if (scope.process?.versions?.node) {
    const name = 'node:worker_threads';
    const { parentPort } = await import(/* @vite-ignore */ /* webpackIgnore: true */ name) as {
      parentPort: { postMessage(message: unknown, transfer: readonly unknown[]): void; on(event: 'message', listener: (message: ToWorker) => void): void };
    };
    return {
      postMessage: (message, transfer = []) => parentPort.postMessage(message, transfer),
      listen: (listener) => parentPort.on('message', listener),
    };
  }
  return {
    postMessage: (message, transfer = []) => scope.postMessage?.(message, transfer),
    listen: (listener) => {
      scope.onmessage = (event) => listener(event.data);
    },
  };
}

serve(await thisPort());
