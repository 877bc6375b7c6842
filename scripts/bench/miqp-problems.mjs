// Mixed-integer problems made by rule, as .sys text.

/** Collects a problem and writes it. */
class System {
  constructor(unknowns) {
    this.unknowns = unknowns;
    this.matrix = [];
    this.linear = new Float64Array(unknowns);
    this.rows = [];
    this.integers = [];
  }

  /** ½ (x_b − x_a − pull)². */
  edge(a, b, pull) {
    this.matrix.push(`${a} ${a} 1`, `${b} ${b} 1`, `${a} ${b} -1`, `${b} ${a} -1`);
    this.linear[b] += pull;
    this.linear[a] -= pull;
  }

  diagonal(i, value) {
    this.matrix.push(`${i} ${i} ${value}`);
  }

  /** Σ coefficient · x + constant = 0. */
  row(terms, constant = 0) {
    this.rows.push({ terms, constant });
  }

  text() {
    const { unknowns, matrix, linear, rows, integers } = this;
    const lines = rows.flatMap(({ terms, constant }, r) => [
      ...terms.map(([i, a]) => `${r} ${i} ${a}`),
      ...(constant ? [`${r} ${unknowns} ${constant}`] : []),
    ]);
    const head = `${unknowns} ${rows.length} ${integers.length} ${matrix.length} ${lines.length}`;
    return `${[head, ...matrix, Array.from(linear).join('\n'), ...lines, integers.join('\n')].join('\n')}\n`;
  }
}

/** The same numbers in every run (mulberry32), from 0 to 1. */
function random(seed) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let t = Math.imul(state ^ (state >>> 15), 1 | state);
    t = (t + Math.imul(t ^ (t >>> 7), 61 | t)) ^ t;
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
}

/** Edges of a grid of size × size vertices, pulled apart unevenly. */
function grid(system, size) {
  const wave = (i, j) => 0.21 + 0.13 * Math.sin(3 * i + 5 * j);
  for (let i = 0; i < size; i++) {
    for (let j = 0; j + 1 < size; j++) {
      system.edge(i * size + j, i * size + j + 1, wave(i, j));
      system.edge(j * size + i, (j + 1) * size + i, 0.7 * wave(j, i) - 0.3);
    }
  }
}

/**
 * A torus cut open along two seams: a grid whose opposite sides differ by integers, one for each of `pieces` pieces of
 * a seam. About `unknowns` unknowns, 2 `pieces` integers.
 */
export function torus(unknowns, pieces) {
  const size = Math.round(Math.sqrt(unknowns));
  const vertices = size * size;
  const system = new System(vertices + 2 * pieces);
  grid(system, size);
  const integer = (side, place) => vertices + side * pieces + Math.floor((place * pieces) / size);
  for (let k = vertices; k < system.unknowns; k++) {
    system.diagonal(k, 1e-6);
    system.integers.push(k);
  }
  const middle = size >> 1;
  system.row([[middle * size + middle, 1]]);
  for (let i = 0; i < size; i++) {
    system.row([[i * size, 1], [i * size + size - 1, -1], [integer(0, i), 1]]);
    system.row([[i, 1], [(size - 1) * size + i, -1], [integer(1, i), 1]]);
  }
  return system.text();
}

/**
 * A grid with many sharp features: curves of `length` vertices each, along which the value is one integer, the same
 * at all of them. At each junction of features the values of `terms` + 1 curves add up, with signs, to a number, which is
 * said `times` times, for one vertex of each curve or another: thousands of rows of integers that depend on each other,
 * shuffled.
 */
export function features({ size, length, terms, times, seed }) {
  const next = random(seed);
  const system = new System(size * size);
  grid(system, size);
  for (let i = 0; i < system.unknowns; i++) system.diagonal(i, 1e-3);
  const curves = [];
  for (let i = 2; i < size; i += 4) {
    for (let j = 1; j + length < size; j += length + 1) {
      curves.push(Array.from({ length }, (_, k) => i * size + j + k));
    }
  }
  for (const curve of curves) {
    system.integers.push(...curve);
    // equal along the curve; a closed loop of conditions, so that one of them is redundant
    curve.forEach((vertex, k) => system.row([[vertex, 1], [curve[(k + 1) % curve.length], -1]]));
  }
  const somewhere = (curve) => curve[Math.floor(next() * curve.length)];
  for (let k = terms; k < curves.length; k += terms + 1) {
    const jump = Math.floor(3 * next());
    for (let again = 0; again < times; again++) {
      const others = Array.from({ length: terms }, (_, i) => [somewhere(curves[k - 1 - i]), i % 2 ? 1 : -1]);
      system.row([[somewhere(curves[k]), 1], ...others], jump);
    }
  }
  shuffle(system.rows, (count) => Math.floor(next() * count));
  return system.text();
}

/**
 * A gear, cut open along every edge of its `teeth`: sectors of `width` columns and of different depths (about `depth`
 * rows of vertices). Both sides of an edge are feature curves: all their vertices are integers, equal along the curve, and
 * differ across the cut by the integer of the seam, which every vertex says again. Over each `span` teeth the widths
 * add up to a number, which is said `times` times for other vertices of the same curves: thousands of integer rows that
 * depend on each other, short and long ones, shuffled.
 */
export function gear({ teeth, width, depth, span, times, seed }) {
  const next = random(seed);
  const some = (count) => Math.floor(next() * count);
  const depths = Array.from({ length: teeth }, () => Math.max(2, Math.round(depth * (0.15 + 1.7 * next() ** 2))));
  const begin = [0];
  for (const rows of depths) begin.push(begin.at(-1) + rows * width);
  const vertices = begin.at(-1);
  const system = new System(vertices + teeth);
  const at = (tooth, column, row) => begin[tooth] + row * width + column;
  const [left, right] = [(tooth, row) => at(tooth, 0, row), (tooth, row) => at(tooth, width - 1, row)];
  for (let i = 0; i < system.unknowns; i++) system.diagonal(i, 1e-3);
  depths.forEach((rows, tooth) => {
    const seam = vertices + tooth;
    const after = (tooth + 1) % teeth;
    system.integers.push(seam);
    for (let row = 0; row < rows; row++) {
      for (let column = 0; column < width; column++) {
        const pull = 0.27 + 0.15 * Math.sin(3 * column + 5 * row + tooth);
        if (column + 1 < width) system.edge(at(tooth, column, row), at(tooth, column + 1, row), pull);
        if (row + 1 < rows) system.edge(at(tooth, column, row), at(tooth, column, row + 1), 0.2 * pull - 0.06);
      }
      system.integers.push(left(tooth, row), right(tooth, row));
      // closed loops of conditions, so that one of each is redundant
      for (const side of [left, right]) system.row([[side(tooth, row), 1], [side(tooth, (row + 1) % rows), -1]]);
      if (row < depths[after]) system.row([[left(after, row), 1], [right(tooth, row), -1], [seam, -1]]);
    }
  });
  for (let from = 0; from + span <= teeth; from += span) {
    for (let again = 0; again < times; again++) {
      const terms = Array.from({ length: span }, (_, k) => from + k).flatMap((tooth) => [
        [right(tooth, some(depths[tooth])), 1], [left(tooth, some(depths[tooth])), -1],
      ]);
      system.row(terms, -Math.round(1.3 * span));
    }
  }
  shuffle(system.rows, some);
  return system.text();
}

/** In the order in which a mesh happens to be visited. */
function shuffle(rows, some) {
  for (let k = rows.length - 1; k > 0; k--) {
    const other = some(k + 1);
    [rows[k], rows[other]] = [rows[other], rows[k]];
  }
}
