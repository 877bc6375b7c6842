// REPORT.json, as the native program writes it: its keys are snake_case throughout.
import { performance } from 'node:perf_hooks';
import { write } from './files.mjs';

/** Keys in snake_case; numbers that JSON does not have (NaN, infinity) become null. */
function snake(value) {
  if (ArrayBuffer.isView(value)) return [...value];
  if (Array.isArray(value)) return value.map(snake);
  if (value === undefined) return null;
  if (value === null || typeof value !== 'object') return value;
  return Object.fromEntries(
    Object.entries(value).map(([key, inner]) => [key.replace(/[A-Z]/g, (c) => `_${c.toLowerCase()}`), snake(inner)]),
  );
}

/** Writes a report, where one is wanted. */
export function writeReport(path, report) {
  if (path !== undefined) write(path, `${JSON.stringify(snake(report), null, 2)}\n`);
}

/** One iteration of a report: a step without its arrays and without how the run ended. */
export function iterationOf({ status, criterion, converged, positions, distortion, field, subTargets, primary, trace, ...iteration }) {
  return iteration;
}

/** What `body` returns, and the seconds it took. */
export function timed(body) {
  const start = performance.now();
  const value = body();
  return [value, (performance.now() - start) / 1000];
}

/** Says a line, on stderr, unless `quiet`. */
export function sayer(quiet) {
  return (line) => quiet || console.error(line);
}
