/** What went wrong, for programs: `code` is stable, `details` has the fields of the Rust error. */
export class FoldfreeError extends Error {
  override readonly name = 'FoldfreeError';
  /** A short stable name: `parse`, `non-manifold-edge`, `invalid-option`, `not-a-disk`, `panic`, … */
  readonly code: string;
  /** Where and what exactly: `vertex`, `face`, `vertices`, `option`, …, whatever the kind of error has. */
  readonly details: Readonly<Record<string, unknown>>;
  /** 1-based line of the file, of a `parse` error; 0 in the binary part of a file. */
  readonly line?: number;
  /** 1-based column of the file, in bytes, of a `parse` error; where `line` is 0, the byte of the file. */
  readonly column?: number;

  constructor(code: string, message: string, details: Record<string, unknown> = {}, options?: ErrorOptions) {
    super(message, options);
    this.code = code;
    this.details = details;
    if (typeof details['line'] === 'number') this.line = details['line'];
    if (typeof details['column'] === 'number') this.column = details['column'];
  }
}

/** An error as it crosses the border of a worker. */
export interface PlainError {
  code: string;
  message: string;
  details: Record<string, unknown>;
}

declare global {
  // Set by the panic hook of the wasm module.
  var foldfreePanic: string | undefined;
}

/** Codes after which the wasm instance must not be used again. */
export const FATAL: readonly string[] = ['panic', 'out-of-memory', 'worker-lost'];

/** Makes a `FoldfreeError` of whatever the wasm module threw. */
export function toFoldfreeError(thrown: unknown): FoldfreeError {
  if (thrown instanceof FoldfreeError) return thrown;
  const { code, message, details } = (thrown ?? {}) as Partial<PlainError>;
  if (thrown instanceof Error && typeof code === 'string' && thrown.name === 'FoldfreeError') {
    return new FoldfreeError(code, message ?? code, details ?? {});
  }
  if (thrown instanceof WebAssembly.RuntimeError || globalThis.foldfreePanic !== undefined) {
    const panic = globalThis.foldfreePanic;
    globalThis.foldfreePanic = undefined;
    // Rust's allocator ends in a trap without a panic when memory cannot grow.
    if (panic === undefined && /unreachable/.test(String(message))) {
      return new FoldfreeError('out-of-memory', 'the wasm memory could not grow: the mesh is too large for this device', {}, { cause: thrown });
    }
    return new FoldfreeError('panic', `internal error: ${panic ?? message}`, {}, { cause: thrown });
  }
  return new FoldfreeError('internal', String(message ?? thrown), {}, { cause: thrown });
}

/** The plain form of an error, for `postMessage`. */
export function toPlain(thrown: unknown): PlainError {
  const { code, message, details } = toFoldfreeError(thrown);
  return { code, message, details };
}

/** The inverse of `toPlain`. */
export function fromPlain({ code, message, details }: PlainError): FoldfreeError {
  return new FoldfreeError(code, message, details);
}
