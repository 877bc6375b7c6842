#!/usr/bin/env node
// The command line of the native program on the single-thread wasm build, in this Node: the same arguments,
// the same REPORT.json, the same exit codes (0: done, 2: not reached, 1: an error, one line on stderr).
import { readFileSync, writeFileSync } from 'node:fs';
import { parseArgs } from 'node:util';
import { gunzipSync, gzipSync } from 'node:zlib';
import { initSync } from '../pkg/core.js';

const text = { type: 'string' };
const flag = { type: 'boolean', default: false };
const COMMON = { report: text, quiet: { ...flag, short: 'q' } };
const COMMANDS = {
  parameterize: {
    run: parameterize,
    options: {
      ...COMMON, method: text, energy: text, start: text, iterations: text, tolerance: text, threads: text, seed: text,
      out: text, 'no-cut': flag, 'no-rotation-aware': flag, 'no-reweighting': flag,
    },
  },
  check: { run: check, options: { ...COMMON, rest: text, global: flag } },
  generate: { run: generate, options: { ...COMMON, triangles: text, out: text } },
};

/** An error that needs no stack. */
class Failure extends Error {}

const core = initSync(readFileSync(new URL('../pkg/single/foldfree_bg.wasm', import.meta.url)));
const program = `foldfree ${core.version} (wasm)`;

/** Keys in snake_case; numbers JSON does not have become null, as the native program writes them. */
function snake(value) {
  if (ArrayBuffer.isView(value)) return [...value];
  if (Array.isArray(value)) return value.map(snake);
  if (value === undefined) return null;
  if (value === null || typeof value !== 'object') return value;
  return Object.fromEntries(
    Object.entries(value).map(([key, inner]) => [key.replace(/[A-Z]/g, (c) => `_${c.toLowerCase()}`), snake(inner)]),
  );
}

function writeReport(path, report) {
  if (path !== undefined) writeFileSync(path, `${JSON.stringify(snake(report), null, 2)}\n`);
}

function read(path) {
  const format = /\.(obj|off)(\.gz)?$/i.exec(path)?.[1].toLowerCase();
  if (!format) throw new Failure(`${path}: the format is not known by this name (known: .obj, .obj.gz, .off, .off.gz)`);
  return of(path, () => {
    const bytes = readFileSync(path);
    return core.mesh(bytes[0] === 0x1f && bytes[1] === 0x8b ? gunzipSync(bytes) : bytes, format);
  });
}

/** Errors of `body` concern the file `path`. */
function of(path, body) {
  try {
    return body();
  } catch (error) {
    const what = error.code === 'ENOENT' ? 'no such file or folder' : error.message;
    throw new Failure(`${path}: ${what}`.replace(/\s+/g, ' '));
  }
}

function write(path, bytes) {
  of(path, () => writeFileSync(path, path.endsWith('.gz') ? gzipSync(bytes) : bytes));
}

function number(name, value) {
  if (value === undefined) return undefined;
  const parsed = Number(value);
  if (value.trim() === '' || Number.isNaN(parsed)) throw new Failure(`--${name}: "${value}" is not a number`);
  return parsed;
}

function methodOf({ method = 'wrapd', 'no-rotation-aware': linear, 'no-reweighting': fixed }) {
  if (!linear && !fixed) return method;
  if (method !== 'wrapd') throw new Failure('--no-rotation-aware and --no-reweighting go with --method wrapd');
  return linear ? (fixed ? 'admm-pd' : 'w-admm') : 'r-admm';
}

function parameterize(input, values) {
  const options = {
    ...core.defaultOptions(),
    method: methodOf(values),
    cut: values['no-cut'] ? 'refuse' : 'cut',
  };
  for (const [name, value] of Object.entries({
    energy: values.energy,
    start: values.start,
    maxIterations: number('iterations', values.iterations),
    tolerance: number('tolerance', values.tolerance),
    seed: number('seed', values.seed),
  })) if (value !== undefined) options[name] = value;

  const clock = performance.now();
  const mesh = read(input);
  const readSeconds = (performance.now() - clock) / 1000;
  const solver = of(input, () => core.parameterize(mesh, options));
  const notes = [...mesh.notes, ...solver.notes];
  const say = (line) => values.quiet || console.error(line);
  notes.forEach(say);

  const row = ({ status, criterion, converged, positions, distortion, ...rest }) => rest;
  const iterations = [row(solver.start)];
  let { status, criterion } = solver.start;
  if (options.maxIterations === 0) status = 'max-iterations';
  while (status === 'running') {
    const step = of(input, () => solver.advance());
    ({ status, criterion } = step);
    iterations.push(row(step));
  }
  if (values.out !== undefined) write(values.out, solver.exportObj());
  const start = performance.now();
  const { certificate } = solver.result();
  const certificateSeconds = (performance.now() - start) / 1000;
  const last = iterations.at(-1);
  say(`${status} after ${last.iteration} iterations: ${solver.setupSeconds.toFixed(3)} s to set up, ${last.seconds.toFixed(3)} s to solve.`);
  say(`energy ${certificate.symmetricDirichlet}, ${certificate.inverted.length} inverted`);
  writeReport(values.report, {
    program, input, status, criterion, options,
    threads: core.threads,
    start: solver.startKind,
    vertices: solver.mesh.positions.length / 3,
    triangles: solver.mesh.indices.length / 3,
    seamEdges: solver.seamEdges,
    notes, readSeconds,
    setupSeconds: solver.setupSeconds,
    seconds: last.seconds,
    iterations, certificate, certificateSeconds,
    memoryBytes: core.memoryBytes,
  });
  return status === 'converged' ? 0 : 2;
}

function check(map, values) {
  const mesh = read(map);
  const rest = values.rest === undefined ? mesh : read(values.rest);
  if (rest.triangleCount !== mesh.triangleCount) {
    throw new Failure(`${values.rest}: has ${rest.triangleCount} triangles, but ${map} has ${mesh.triangleCount}`);
  }
  const start = performance.now();
  const certificate = of(map, () => {
    if (mesh.texture) return core.checkCorners(rest, images(mesh.texture.coordinates, 2, mesh.texture.corners));
    if (rest === mesh) throw new Failure('there are no texture coordinates; give the surface with --rest');
    const tall = mesh.positions.findIndex((value, i) => i % 3 === 2 && value !== 0);
    if (tall >= 0) throw new Failure(`there are no texture coordinates, and vertex ${(tall - 2) / 3} is not in the plane z = 0`);
    return core.checkCorners(rest, images(mesh.positions, 3, mesh.indices));
  });
  const certificateSeconds = (performance.now() - start) / 1000;
  const folds = certificate.inverted.length + certificate.degenerate.length;
  if (!values.quiet) console.error(`${folds} inverted or degenerate, ${certificate.globallyInjective ? 'injective' : 'not injective'}`);
  writeReport(values.report, { program, map, notes: mesh.notes, certificate, certificateSeconds });
  const fine = values.global ? certificate.globallyInjective : certificate.mirrored || folds === 0;
  return fine ? 0 : 2;
}

/** Two coordinates for every corner. */
function images(points, stride, corners) {
  const flat = new Float64Array(2 * corners.length);
  corners.forEach((index, corner) => {
    flat[2 * corner] = points[stride * index];
    flat[2 * corner + 1] = points[stride * index + 1];
  });
  return flat;
}

function generate(shape, values) {
  if (values.out === undefined) throw new Failure('--out is needed');
  const { positions, indices } = of(shape, () => core.generate(shape, number('triangles', values.triangles) ?? 10_000));
  const lines = [];
  for (let i = 0; i < positions.length; i += 3) lines.push(`v ${positions[i]} ${positions[i + 1]} ${positions[i + 2]}`);
  for (let i = 0; i < indices.length; i += 3) lines.push(`f ${indices[i] + 1} ${indices[i + 1] + 1} ${indices[i + 2] + 1}`);
  if (!/\.obj(\.gz)?$/.test(values.out)) throw new Failure(`${values.out}: only .obj and .obj.gz are written here`);
  write(values.out, `${lines.join('\n')}\n`);
  return 0;
}

try {
  const [name, ...rest] = process.argv.slice(2);
  const command = COMMANDS[name];
  if (!command) throw new Failure(`which command? ${Object.keys(COMMANDS).join(', ')}`);
  const { values, positionals } = parseArgs({ args: rest, options: command.options, allowPositionals: true });
  if (positionals.length !== 1) throw new Failure(`${name} takes one file, and was given ${positionals.length}`);
  process.exitCode = command.run(positionals[0], values);
} catch (error) {
  console.error(`error: ${error instanceof Failure || error.code ? error.message : error.stack}`);
  process.exitCode = 1;
}
