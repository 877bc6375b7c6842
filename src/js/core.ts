// `foldfree/core`: the library without a worker, synchronous, for Node, tests and people with their own worker.
import * as bindings from './single/foldfree.js';
import { Core } from './engine.js';

export { Core, CoreMesh, CoreSolver } from './engine.js';
export { CoreMixedInteger } from './mixed-integer-engine.js';
export { CoreDeformation, CoreSolid } from './solid-engine.js';
export { CoreUntangling } from './untangle-engine.js';
export { FoldfreeError } from './error.js';
export type * from './types.js';

/** The single-thread wasm: its bytes, or a compiled module. */
export type WasmSource = Uint8Array | ArrayBuffer | WebAssembly.Module;

/**
 * Instantiates the single-thread wasm at once. In Node:
 * `initSync(readFileSync(new URL(import.meta.resolve('foldfree/foldfree.wasm'))))`.
 */
export function initSync(source: WasmSource): Core {
  bindings.initSync({ module: source as BufferSource | WebAssembly.Module });
  return new Core(bindings);
}

/** Fetches the single-thread wasm (from beside this module, or from `url`) and instantiates it. */
export async function init(url?: string | URL): Promise<Core> {
  await bindings.default(url === undefined ? undefined : { module_or_path: url });
  return new Core(bindings);
}
