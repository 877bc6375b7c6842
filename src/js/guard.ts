// Calls into wasm.
import { toFoldfreeError } from './error.js';

/** Calls into wasm; what it throws comes out as a `FoldfreeError`. */
export function guard<T>(call: () => T): T {
  try {
    return call();
  } catch (thrown) {
    throw toFoldfreeError(thrown);
  }
}
