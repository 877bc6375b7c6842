// The single-thread wasm build, in this Node.
import { readFileSync } from 'node:fs';
import { initSync } from '../../pkg/core.js';

export const core = initSync(readFileSync(new URL('../../pkg/single/foldfree_bg.wasm', import.meta.url)));

/** Name and version of the program. */
export const program = `foldfree ${core.version} (wasm)`;
