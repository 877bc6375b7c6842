// Files of pins and targets: a vertex a line, the first vertex being 0. Empty lines and what follows a # are
// passed over.
import { Failure } from './failure.mjs';
import { readBytes } from './files.mjs';

const DECIMAL = /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** Vertex indices, one a line. */
export function readPins(path, vertices) {
  return lines(path, (fields, wrong) => {
    if (fields.length !== 1) throw wrong(`expected a vertex index, found ${JSON.stringify(fields.join(' '))}`);
    return vertex(fields[0], vertices, wrong);
  });
}

/** Lines `index x y` or `index x y z`; without z it is 0. One `{ vertex, position }` a line. */
export function readTargets(path, vertices) {
  return lines(path, (fields, wrong) => {
    const [index, ...coordinates] = fields;
    if (coordinates.length < 2 || coordinates.length > 3) {
      throw wrong(`expected "index x y z", found ${JSON.stringify(fields.join(' '))}`);
    }
    const position = coordinates.map((field) => {
      const value = DECIMAL.test(field) ? Number(field) : NaN;
      if (!Number.isFinite(value)) throw wrong(`expected a finite coordinate, found ${JSON.stringify(field)}`);
      return value;
    });
    return { vertex: vertex(index, vertices, wrong), position: [...position, 0].slice(0, 3) };
  });
}

/** Fails for `--hard` without targets. */
export function needTargets({ hard, targets }) {
  if (hard && targets === undefined) throw new Failure('--hard goes with --targets');
}

/** Reads the handles of a body of so many vertices. */
export function readHandles(values, vertices) {
  const pins = values.pins === undefined ? [] : readPins(values.pins, vertices);
  const targets = values.targets === undefined ? [] : readTargets(values.targets, vertices);
  if (values.hard) pins.push(...targets.map((target) => target.vertex));
  return {
    pins: Uint32Array.from(pins),
    targets: {
      vertices: Uint32Array.from(targets, (target) => target.vertex),
      positions: Float64Array.from(targets.flatMap((target) => target.position)),
    },
  };
}

function vertex(field, vertices, wrong) {
  const index = /^\+?\d+$/.test(field) ? Number(field) : NaN;
  if (!(index < 2 ** 32)) throw wrong(`expected a vertex index, found ${JSON.stringify(field)}`);
  if (index >= vertices) throw wrong(`vertex ${index} of ${vertices} (the first is 0)`);
  return index;
}

function lines(path, parse) {
  const found = [];
  new TextDecoder().decode(readBytes(path)).split('\n').forEach((line, number) => {
    const fields = line.split('#')[0].split(/\s+/).filter((field) => field !== '');
    const wrong = (what) => new Failure(`${path}: line ${number + 1}: ${what}`);
    if (fields.length > 0) found.push(parse(fields, wrong));
  });
  return found;
}
