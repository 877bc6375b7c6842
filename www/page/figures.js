// Planar figures to deform, made of triangles, with what is held of each and what is dragged. No DOM here.

/** Distance of a point to a segment. */
function toSegment(x, y, [ax, ay, bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const t = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

/** Limbs of a gingerbread man: segments (ax, ay, bx, by) with a radius. */
const MAN = [
  [0, 0.62, 0, 0.64, 0.24], // head
  [0, 0.36, 0, -0.1, 0.225], // trunk
  [0.1, 0.26, 0.6, 0.16, 0.115], // arms
  [-0.1, 0.26, -0.6, 0.16, 0.115],
  [0.1, -0.2, 0.24, -0.72, 0.13], // legs
  [-0.1, -0.2, -0.24, -0.72, 0.13],
];

/** Below 0 inside the man: the union of his limbs, joints rounded. */
function man(x, y) {
  const soft = 40;
  const sum = MAN.reduce((all, [ax, ay, bx, by, r]) => all + Math.exp(-soft * (toSegment(x, y, [ax, ay, bx, by]) - r)), 0);
  return -Math.log(sum) / soft;
}

/** 1 of an equilateral triangle, 0 of a flat one, below 0 of one that is turned over. */
function quality([ax, ay], [bx, by], [cx, cy]) {
  const twice = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  const squares = (bx - ax) ** 2 + (by - ay) ** 2 + (cx - ax) ** 2 + (cy - ay) ** 2 + (cx - bx) ** 2 + (cy - by) ** 2;
  return (2 * Math.sqrt(3) * twice) / squares;
}

/**
 * Triangles of the shape `inside` (a distance, below 0 inside) within a box: those of a lattice with edges of length
 * `h`, vertices near the outline moved onto it, the others relaxed.
 */
function filled(inside, { low, high }, h) {
  const rows = Math.ceil((high[1] - low[1]) / (h * Math.sqrt(0.75))) + 1;
  const columns = Math.ceil((high[0] - low[0]) / h) + 2;
  const points = [];
  for (let j = 0; j < rows; j += 1) {
    for (let i = 0; i < columns; i += 1) points.push([low[0] + h * (i + 0.5 * (j % 2) - 0.5), low[1] + j * h * Math.sqrt(0.75)]);
  }
  /** Along the gradient of the distance. */
  const onto = ([x, y]) => {
    for (let k = 0; k < 4; k += 1) {
      const [d, e] = [inside(x, y), 1e-4];
      const [gx, gy] = [(inside(x + e, y) - inside(x - e, y)) / (2 * e), (inside(x, y + e) - inside(x, y - e)) / (2 * e)];
      const square = gx * gx + gy * gy || 1;
      [x, y] = [x - (d * gx) / square, y - (d * gy) / square];
    }
    return [x, y];
  };
  const near = points.map(([x, y]) => Math.abs(inside(x, y)) < 0.5 * h);
  const moved = points.map((p, v) => (near[v] ? onto(p) : p));
  const kept = points.map((p, v) => near[v] || inside(...p) < 0);
  const triangles = [];
  const add = (a, b, c) => {
    if (!(kept[a] && kept[b] && kept[c])) return;
    const [x, y] = [0, 1].map((k) => (moved[a][k] + moved[b][k] + moved[c][k]) / 3);
    const thin = quality(moved[a], moved[b], moved[c]) < 0.3; // lies along the outline
    if (inside(x, y) < -0.02 * h && !thin) triangles.push([a, b, c]);
  };
  for (let j = 0; j + 1 < rows; j += 1) {
    for (let i = 0; i + 1 < columns; i += 1) {
      const [a, b, c, d] = [j * columns + i, j * columns + i + 1, (j + 1) * columns + i, (j + 1) * columns + i + 1];
      if (j % 2 === 0) { add(a, b, c); add(b, d, c); } else { add(a, b, d); add(a, d, c); }
    }
  }
  const neighbours = points.map(() => new Set());
  for (const [a, b, c] of triangles) for (const [p, q] of [[a, b], [b, c], [c, a]]) { neighbours[p].add(q); neighbours[q].add(p); }
  for (let k = 0; k < 4; k += 1) {
    for (const [v, others] of neighbours.entries()) {
      if (near[v] || others.size === 0) continue;
      moved[v] = [0, 1].map((c) => [...others].reduce((sum, o) => sum + moved[o][c], 0) / others.size);
    }
  }
  const index = new Map();
  const positions = [];
  const number = (v) => {
    if (!index.has(v)) {
      index.set(v, positions.length / 3);
      positions.push(...moved[v], 0);
    }
    return index.get(v);
  };
  const indices = Uint32Array.from(triangles.flatMap((t) => t.map((v) => number(v))));
  return { positions: Float64Array.from(positions), indices };
}

/** A unit square of n×n vertices, its cells split along their rising diagonals. */
function grid(triangles) {
  const n = Math.max(2, Math.round(Math.sqrt(triangles / 2)) + 1);
  const positions = Array.from({ length: n * n }, (_, v) => [(v % n) / (n - 1), Math.floor(v / n) / (n - 1), 0]);
  const indices = [];
  for (let j = 0; j + 1 < n; j += 1) {
    for (let i = 0; i + 1 < n; i += 1) {
      const a = j * n + i;
      indices.push(a, a + 1, a + n + 1, a, a + n + 1, a + n);
    }
  }
  return { positions: Float64Array.from(positions.flat()), indices: Uint32Array.from(indices) };
}

/** About so many triangles. */
function gingerbread(triangles) {
  const area = 1.02; // of the man
  const h = Math.sqrt((4 * area) / (Math.sqrt(3) * Math.max(20, triangles)));
  return filled(man, { low: [-0.78, -0.9], high: [0.78, 0.92] }, h);
}

const within = (test) => (positions) => {
  const found = [];
  for (let v = 0; v < positions.length / 3; v += 1) if (test(positions[3 * v], positions[3 * v + 1])) found.push(v);
  return Uint32Array.from(found);
};
const around = (x, y, r) => within((u, v) => Math.hypot(u - x, v - y) < r);

/**
 * By name: title, `make(triangles)`; the handles `held`, the last of which a drag moves: by the displacements `path`, one
 * after the other.
 */
export const FIGURES = {
  gingerbread: {
    title: 'Gingerbread man (flat)',
    description: 'A figure in the plane: a hand is pressed through the body',
    make: gingerbread,
    held: [around(-0.24, -0.72, 0.09), around(0.24, -0.72, 0.09), around(-0.6, 0.16, 0.08), around(0.6, 0.16, 0.08)],
    path: [[0, 0], [-0.8, 0.05]],
  },
  square: {
    title: 'Square (flat)',
    description: 'A square in the plane, held at two sides: its corner is drawn in',
    make: grid,
    held: [within((x, y) => x < 1e-9 || y < 1e-9), within((x, y) => x > 1 - 1e-9 && y > 1 - 1e-9)],
    path: [[0, 0], [-0.8, -0.8]],
  },
};

/** Whether a source is a figure in the plane. */
export const isFigure = (name) => Object.hasOwn(FIGURES, name);

/** Where the handle of a drag is after a part (0–1) of its path: `base` moved along straight pieces of equal time. */
export function along(base, path, part) {
  const pieces = path.length - 1;
  const piece = Math.min(pieces - 1, Math.floor(part * pieces));
  const t = part * pieces - piece;
  const move = [0, 1].map((k) => (1 - t) * path[piece][k] + t * path[piece + 1][k]);
  return base.map((x, i) => (i % 3 < 2 ? x + move[i % 3] : x));
}
