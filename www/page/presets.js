// Scenes for solids: who is held, where everything starts, and how what is held moves. No DOM here.

import { along } from './figures.js';

/** Part of the longest axis that counts as an end. */
const END = 0.08;

/** How far a preset goes, in how many seconds when it plays freely, and in how many iterations otherwise. */
const TWIST = { total: 2 * Math.PI, seconds: 5, steps: 60 };
const SQUASH = { total: 0.45, seconds: 3, steps: 60 };

/** Names, in the order of the buttons: what the button says, what it is for. */
export const PRESETS = {
  held: { title: 'At rest', hint: 'Both ends are held, and nothing moves until you drag something' },
  drag: { title: 'Drag', hint: 'One handle is drawn to where the others hardly let it go' },
  squash: { title: 'Squash', hint: 'Both ends are held, and one is pressed towards the other' },
  twist: { title: 'Twist', hint: 'Both ends are held, and one is turned once round' },
  random: { title: 'Randomise', hint: 'Everything that is not held goes to a random place' },
  collapse: { title: 'Collapse', hint: 'Everything that is not held goes to one point' },
};

const DRAG = { total: 1, seconds: 6, steps: 80 };

/** What can be played with a body: a figure in the plane has drags of its own; to be scattered it would have to invert. */
export const presetsOf = (figure) => (figure ? ['held', 'drag'] : Object.keys(PRESETS).filter((name) => name !== 'drag'));

/** Lowest and highest corner of positions (n×3). */
export function bounds(positions) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  return { low, high };
}

/** The two ends of a solid along its longest axis: `{ axis, low, high }`, lists of vertices. */
export function ends(positions, part = END) {
  const box = bounds(positions);
  const lengths = box.high.map((x, k) => x - box.low[k]);
  const axis = lengths.indexOf(Math.max(...lengths));
  const reach = part * lengths[axis];
  const where = (test) => {
    const found = [];
    for (let v = 0; v < positions.length / 3; v += 1) if (test(positions[3 * v + axis])) found.push(v);
    return Uint32Array.from(found);
  };
  return {
    axis,
    length: lengths[axis],
    low: where((x) => x <= box.low[axis] + reach),
    high: where((x) => x >= box.high[axis] - reach),
  };
}

/** The positions of some vertices, one after the other. */
export function pick(positions, vertices) {
  const out = new Float64Array(3 * vertices.length);
  vertices.forEach((v, i) => { for (let k = 0; k < 3; k += 1) out[3 * i + k] = positions[3 * v + k]; });
  return out;
}

/** Points (n×3) turned by `angle` about the coordinate axis `axis` through their middle. */
export function turned(points, axis, angle) {
  const [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
  const n = points.length / 3;
  let [cu, cv] = [0, 0];
  for (let i = 0; i < n; i += 1) { cu += points[3 * i + u] / n; cv += points[3 * i + v] / n; }
  const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
  const out = Float64Array.from(points);
  for (let i = 0; i < n; i += 1) {
    const [a, b] = [points[3 * i + u] - cu, points[3 * i + v] - cv];
    out[3 * i + u] = cu + cos * a - sin * b;
    out[3 * i + v] = cv + sin * a + cos * b;
  }
  return out;
}

/** Random numbers in [0, 1), the same every time (mulberry32). */
function randomNumbers(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** `positions` with every vertex that is not in `held` at a random place of the box of `rest`. */
export function scattered(rest, positions, held) {
  const { low, high } = bounds(rest);
  const random = randomNumbers(7);
  const fixed = new Set(held);
  return positions.map((x, i) => {
    const place = low[i % 3] + (high[i % 3] - low[i % 3]) * random();
    return fixed.has(Math.floor(i / 3)) ? x : place;
  });
}

/** `positions` with every vertex that is not in `held` in the middle of the box of `rest`. */
export function collapsed(rest, positions, held) {
  const { low, high } = bounds(rest);
  const fixed = new Set(held);
  return positions.map((x, i) => (fixed.has(Math.floor(i / 3)) ? x : 0.5 * (low[i % 3] + high[i % 3])));
}

/**
 * The scene of a preset on a solid at rest: its longest `axis`, `held` handles (lists of vertices; `kept`, or else the
 * ends), the `start` (n×3) with all of them at their places, and the `motion` of the upper end, if it is one of them:
 * `{ handle, seconds, steps, at(part) }`, where its vertices are after a part (0–1) of it.
 */
export function scene(preset, rest, kept, figure) {
  if (figure) return figureScene(preset, rest, kept, figure);
  const { axis, length, low, high } = ends(rest);
  const start = Float64Array.from(rest);
  // A solid so coarse that its ends meet, or are all of it, is held at one of them.
  const apart = low.length + high.length < rest.length / 3 && !low.some((v) => high.includes(v));
  const held = kept ?? (apart ? [low, high] : [low]);
  const handle = apart ? held.findIndex((vertices) => same(vertices, high)) : -1;
  const base = pick(rest, high);
  const motion = ({ total, seconds, steps }, at) => (handle < 0 ? undefined : { handle, seconds, steps, at: (part) => at(part * total) });
  switch (preset) {
    case 'squash':
      return { axis, held, start, motion: motion(SQUASH, (part) => base.map((x, i) => (i % 3 === axis ? x - part * length : x))) };
    case 'twist':
      return { axis, held, start, motion: motion(TWIST, (angle) => turned(base, axis, angle)) };
    case 'random':
    case 'collapse': {
      if (handle >= 0) {
        const half = turned(base, axis, Math.PI);
        high.forEach((v, i) => start.set(half.subarray(3 * i, 3 * i + 3), 3 * v));
      }
      const all = held.flatMap((vertices) => [...vertices]);
      return { axis, held, start: preset === 'random' ? scattered(rest, start, all) : collapsed(rest, start, all) };
    }
    default:
      return { axis, held, start };
  }
}

const same = (a, b) => a.length === b.length && a.every((x, i) => x === b[i]);

/** The same of a figure in the plane, whose last handle a drag moves. */
function figureScene(preset, rest, kept, { held, path }) {
  const own = held.map((find) => find(rest));
  const last = own.at(-1);
  const groups = kept ?? own;
  const handle = groups.findIndex((vertices) => same(vertices, last));
  const base = pick(rest, last);
  const motion = preset === 'drag' && handle >= 0
    ? { handle, seconds: DRAG.seconds, steps: DRAG.steps, at: (part) => along(base, path, part * DRAG.total) } : undefined;
  return { axis: 2, held: groups, start: Float64Array.from(rest), motion };
}
