// Folded bodies to untangle: what of them is held, where, and where everything else starts. No DOM here.
import { CONTACTS, handlesOf, keepsApart, moved } from './contact-problems.js';
import { FIGURES, isFigure } from './figures.js';
import { bounds, collapsed, ends, pick, scattered, scene } from './presets.js';

/** What is held: what it is called, and what that means. */
export const HELD = {
  twisted: { title: 'outside, twisted', hint: 'All of the outside is held where a twist takes it' },
  bent: { title: 'outside, bent', hint: 'All of the outside is held where a bend takes it' },
  outside: { title: 'outside, at rest', hint: 'All of the outside is held where it is at rest' },
  ends: { title: 'both ends', hint: 'Both ends are held, one of them half a turn on' },
  nothing: { title: 'nothing', hint: 'Nothing is held' },
};

/** Where the rest starts. */
export const STARTS = {
  random: { title: 'at random', hint: 'Every other vertex is put at a random place' },
  point: { title: 'in one point', hint: 'Every other vertex is put into one point' },
};

/** Energies, by what they are called; those that a figure in the plane can have. */
export const ENERGIES = {
  arap: { title: 'ARAP', planar: true },
  'symmetric-dirichlet': { title: 'symmetric Dirichlet', planar: true },
  dirichlet: { title: 'Dirichlet', planar: true },
  'neo-hookean': { title: 'neo-Hookean', planar: false },
  'stable-neo-hookean': { title: 'stable neo-Hookean', planar: false },
};

/** Whether a name is that of triangles in a plane. */
export const isFlat = (body) => isFigure(body) || (keepsApart(body) && CONTACTS[body].planar === true);

/** A body of the library's, or a figure or bodies of the page's. */
export function generate(foldfree, { body, size }) {
  if (isFigure(body)) return foldfree.mesh(FIGURES[body].make(size));
  if (!keepsApart(body)) return foldfree.generateSolid(body, size);
  const arrays = CONTACTS[body].make(size);
  return arrays.indices ? foldfree.mesh(arrays) : foldfree.solid(arrays);
}

/**
 * `{ pins, start, groups, targets, overlap }` of bodies that are kept apart: they start at rest, and what is held
 * (`groups` of vertices, and where each is to be) goes on its first move.
 */
export function apartOf(body, name) {
  const problem = CONTACTS[name];
  const groups = handlesOf(problem, body).map((vertices, i) => {
    const points = pick(body.positions, vertices);
    return { vertices, at: i === problem.moved ? moved(problem, points, 1) : points };
  });
  const pins = Uint32Array.from(groups.flatMap(({ vertices }) => [...vertices]));
  const targets = { vertices: pins, positions: Float64Array.from(groups.flatMap(({ at }) => [...at])) };
  return { pins, start: Float64Array.from(body.positions), groups, targets, overlap: true };
}

/** The vertices of the outside: of the skin of a solid, of the rim of triangles. */
export function outsideOf({ positions, surface, indices }) {
  if (surface) return Uint32Array.from(new Set(surface)).sort();
  const count = new Map();
  const n = positions.length / 3;
  for (let t = 0; t < indices.length; t += 3) {
    for (let k = 0; k < 3; k += 1) {
      const [a, b] = [indices[t + k], indices[t + ((k + 1) % 3)]];
      const key = Math.min(a, b) * n + Math.max(a, b);
      count.set(key, (count.get(key) ?? 0) + 1);
    }
  }
  const rim = new Set();
  for (const [key, times] of count) if (times === 1) rim.add(Math.floor(key / n)).add(key % n);
  return Uint32Array.from(rim).sort();
}

/** Signed measures of the elements, times 6 or 2. */
function measures({ tetrahedra, indices }, p) {
  const difference = (a, b, k) => p[3 * b + k] - p[3 * a + k];
  if (indices) {
    return Float64Array.from({ length: indices.length / 3 }, (_, t) => {
      const [a, b, c] = indices.subarray(3 * t, 3 * t + 3);
      return difference(a, b, 0) * difference(a, c, 1) - difference(a, b, 1) * difference(a, c, 0);
    });
  }
  return Float64Array.from({ length: tetrahedra.length / 4 }, (_, t) => {
    const [a, b, c, d] = tetrahedra.subarray(4 * t, 4 * t + 4);
    let six = 0;
    for (let k = 0; k < 3; k += 1) {
      const [u, v] = [(k + 1) % 3, (k + 2) % 3];
      six += difference(a, b, k) * (difference(a, c, u) * difference(a, d, v) - difference(a, c, v) * difference(a, d, u));
    }
    return six;
  });
}

/** Elements of `positions` (n×3) that are flat, or turned otherwise than at rest. */
export function invertedOf(body, positions) {
  const [rest, now] = [measures(body, body.positions), measures(body, positions)];
  return now.reduce((count, measure, t) => (measure * rest[t] > 0 ? count : count + 1), 0);
}

/** The maps that the outside is held by: of a point in a body from −1 to 1 along its longest axis, in the order x, y, z from it. */
const BENDS = {
  twisted: (planar) => ([x, y, z], amount) => {
    if (planar) {
      const angle = 1.8 * amount * Math.hypot(x, y);
      return [Math.cos(angle) * x - Math.sin(angle) * y, Math.sin(angle) * x + Math.cos(angle) * y, z];
    }
    const angle = amount * Math.PI * x;
    return [x, Math.cos(angle) * y - Math.sin(angle) * z, Math.sin(angle) * y + Math.cos(angle) * z];
  },
  bent: () => ([x, y, z], amount) => {
    const [angle, radius] = [1.2 * amount * x, 1 / (1.2 * amount) - y];
    return [radius * Math.sin(angle), 1 / (1.2 * amount) - radius * Math.cos(angle), z];
  },
};

/** The body bent as far as no element inverts: then pins on its outside have a solution. */
function bentBody(body, bend) {
  const { positions } = body;
  const { low, high } = bounds(positions);
  const extent = high.map((x, k) => x - low[k]);
  const axis = extent.indexOf(Math.max(...extent));
  // the plane of a figure has no third axis to turn to
  const order = [axis, ...[0, 1, 2].filter((k) => k !== axis)];
  const handed = (order[1] - order[0] + 3) % 3 === 1 ? 1 : -1;
  const scale = 2 / extent[axis];
  const middle = low.map((x, k) => 0.5 * (x + high[k]));
  const flip = [1, 1, handed];
  for (let amount = 1; amount > 0.01; amount *= 0.8) {
    const out = new Float64Array(positions.length);
    for (let i = 0; i < positions.length; i += 3) {
      const local = order.map((k, j) => flip[j] * scale * (positions[i + k] - middle[k]));
      bend(local, amount).forEach((x, j) => { out[i + order[j]] = middle[order[j]] + flip[j] * x / scale; });
    }
    if (invertedOf(body, out) === 0) return out;
  }
  return Float64Array.from(positions);
}

/**
 * `{ pins, start }` of a body: what is held as `held` says, and everything else as `start` says. What a person brought
 * comes first: `given` may have `pins` and a `start`.
 */
export function problemOf(body, { held, start }, given = {}) {
  const rest = body.positions;
  const planar = body.indices !== undefined;
  const spoil = start === 'point' ? collapsed : scattered;
  if (given.start) return { pins: given.pins ?? outsideOf(body), start: given.start };
  if (!given.pins && held === 'ends' && !planar) {
    const made = scene(start === 'point' ? 'collapse' : 'random', rest);
    return { pins: Uint32Array.from(made.held.flatMap((vertices) => [...vertices])), start: made.start };
  }
  const shape = !given.pins && BENDS[held] ? bentBody(body, BENDS[held](planar)) : Float64Array.from(rest);
  const pins = given.pins ?? chosen(body, held);
  return { pins, start: Float64Array.from(spoil(pins.length ? pick(shape, pins) : rest, shape, pins)) };
}

function chosen(body, held) {
  if (held === 'nothing') return new Uint32Array();
  if (held !== 'ends') return outsideOf(body);
  const { low, high } = ends(body.positions, 1e-6);
  return Uint32Array.from(new Set([...low, ...high]));
}

/** Vertex indices, one a line, of a body of so many vertices. */
export function readPins(text, vertices, name) {
  const pins = new Set();
  text.split('\n').forEach((line, number) => {
    const field = line.split('#')[0].trim();
    if (field === '') return;
    const wrong = (what) => new Error(`${name}: line ${number + 1}: ${what}`);
    if (!/^\d+$/.test(field)) throw wrong(`expected a vertex index, found “${field.slice(0, 40)}”`);
    if (Number(field) >= vertices) throw wrong(`vertex ${field} of ${vertices} (the first is 0)`);
    pins.add(Number(field));
  });
  return Uint32Array.from(pins);
}
