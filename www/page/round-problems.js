// The problems of the Round mode: ½ (x − m)ᵀ A (x − m) with integers x, small enough to be drawn. No DOM here.

/** How far the picture of two integers reaches, and where the minimum may lie in it. */
export const WINDOW = { left: -2.6, right: 3.6, low: -2.2, high: 3.2, margin: 0.45 };

/** Values of a chain, and how far its points may be dragged. */
export const HEIGHT = 6;

/** A = R diag(1, κ) Rᵀ: level lines are ellipses whose long axis is turned by `turn` degrees. */
function ellipse({ condition, turn }) {
  const [c, s] = [Math.cos((turn * Math.PI) / 180), Math.sin((turn * Math.PI) / 180)];
  const mixed = (1 - condition) * c * s;
  return [[c * c + condition * s * s, mixed], [mixed, s * s + condition * c * c]];
}

/** A of springs: one from each point to its place, of stiffness 1, and one to each neighbour, of stiffness `coupling`. */
function springs({ points, coupling }) {
  return Array.from({ length: points }, (_, i) => Array.from({ length: points }, (_, j) => {
    if (i === j) return 1 + coupling * ((i > 0) + (i < points - 1));
    return Math.abs(i - j) === 1 ? -coupling : 0;
  }));
}

/** Places of a chain: a wave and some noise, the same for the same seed. */
function wave({ points, seed }) {
  let state = seed * 7919 + 1;
  const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
  random();
  random();
  return Array.from({ length: points }, (_, i) => HEIGHT / 2 + 2.1 * Math.sin(0.55 * i + seed) + (random() - 0.5));
}

/** The problem that `wanted` describes: `{ kind, matrix (dense), minimum }`. */
export function makeProblem(wanted) {
  return wanted.problem === 'chain'
    ? { kind: 'chain', matrix: springs(wanted), minimum: wave(wanted) }
    : { kind: 'lattice', matrix: ellipse(wanted), minimum: [wanted.x, wanted.y] };
}

/** b = A m. */
export const linearOf = ({ matrix }, minimum) => Float64Array.from(matrix, (row) => row.reduce((sum, a, j) => sum + a * minimum[j], 0));

/** What the package takes. */
export function arraysOf(problem) {
  const entries = problem.matrix.flatMap((row, i) => row.map((value, j) => [i, j, value])).filter(([, , value]) => value !== 0);
  return {
    matrix: {
      rows: Uint32Array.from(entries, ([i]) => i),
      columns: Uint32Array.from(entries, ([, j]) => j),
      values: Float64Array.from(entries, ([, , value]) => value),
    },
    linear: linearOf(problem, problem.minimum),
    integers: Uint32Array.from(problem.minimum.keys()),
  };
}

/** The same as a `.sys` file. */
export function sysOf(problem, minimum) {
  const { matrix, integers } = arraysOf(problem);
  const n = integers.length;
  const entries = [...matrix.values].map((value, t) => `${matrix.rows[t]} ${matrix.columns[t]} ${value}`);
  return `${n} 0 ${n} ${entries.length} 0\n${entries.join('\n')}\n${[...linearOf(problem, minimum)].join('\n')}\n${[...integers].join(' ')}\n`;
}
