// Bodies that would pass through each other, or through themselves, on the way to where their pins go. No DOM here.

/** The cells of a block from `low` up to `high`, `fine` times finer, of body number `part`. */
function block(low, high, fine, part) {
  let cells = [[]];
  for (let i = 0; i < low.length; i += 1) {
    const range = Array.from({ length: (high[i] - low[i]) * fine }, (_, k) => low[i] * fine + k);
    cells = range.flatMap((x) => cells.map((cell) => [...cell, x]));
  }
  return cells.map((cell) => ({ cell, part }));
}

/** The corners of a cell by the bits of their numbers, split along the diagonal from the first to the last. */
const SIMPLICES = {
  2: [[0, 1, 3], [0, 3, 2]],
  3: [[1, 3], [3, 2], [2, 6], [6, 4], [4, 5], [5, 1]].map(([a, b]) => [0, a, b, 7]),
};

/**
 * Squares of two triangles, or cubes of six tetrahedra; vertices of different bodies are different. `place(at, part)` puts
 * a lattice point of a body into space.
 */
function lattice(cells, place) {
  const dimension = cells[0].cell.length;
  const number = new Map();
  const [positions, simplices] = [[], []];
  for (const { cell, part } of cells) {
    const corners = Array.from({ length: 2 ** dimension }, (_, bits) => {
      const at = cell.map((x, i) => x + ((bits >> i) & 1));
      const key = `${part},${at}`;
      if (!number.has(key)) {
        number.set(key, number.size);
        positions.push(...place(at, part));
      }
      return number.get(key);
    });
    for (const simplex of SIMPLICES[dimension]) simplices.push(...simplex.map((k) => corners[k]));
  }
  return { positions, simplices };
}

const solid = ({ positions, simplices }) => ({ positions: Float64Array.from(positions), tetrahedra: Uint32Array.from(simplices) });
const flat = ({ positions, simplices }) => ({ positions: Float64Array.from(positions), indices: Uint32Array.from(simplices) });

/** How fine a lattice of `cells` cells is to be for about so many elements, `each` a cell. */
const fineness = (size, cells, each) => {
  const dimension = each === 2 ? 2 : 3;
  return Math.max(1, Math.round((Math.max(1, Math.min(size, MOST_ELEMENTS)) / (cells * each)) ** (1 / dimension) - 0.2));
};

/** Elements of these problems at most: contacts are looked for again and again. */
export const MOST_ELEMENTS = 3000;

function hooks(dimension, size) {
  const thick = dimension === 3 ? [0, 1] : [];
  const [low, high] = [thick.slice(0, 1), thick.slice(1)];
  const cut = (a, b, fine, part) => block([...a, ...low], [...b, ...high], fine, part);
  const fine = fineness(size, 15, dimension === 3 ? 6 : 2);
  const cells = [
    ...cut([0, 0], [5, 1], fine, 0), ...cut([4, 1], [5, 3], fine, 0),
    ...cut([2, 3], [8, 4], fine, 1), ...cut([2, 1], [3, 3], fine, 1),
  ];
  const apart = [0, 0.3, dimension === 3 ? 0.07 : 0];
  return lattice(cells, (at, part) => [0, 1, 2].map((i) => (at[i] ?? 0) / fine + part * apart[i]));
}

function boxes(size) {
  const fine = fineness(size, 12, 6);
  const cells = [...block([0, 0, 0], [4, 2, 1], fine, 0), ...block([0, 0, 1], [2, 2, 2], fine, 1)];
  return lattice(cells, (at, part) => at.map((x, i) => x / fine + part * [0.03, 0.04, 0.05][i]));
}

/** Half the width of the box in which the cushion lies; that of the cushion is 1. */
const HALF = 1.02;

function press(size) {
  const count = fineness(size - 156, 1, 6);
  const half = count / 2;
  const cushion = lattice(block([0, 0, 0], [count, count, count], 1, 0), (at) => {
    // corners are rounded, halfway to a ball
    const p = at.map((x) => x / half - 1);
    const [length, most] = [Math.hypot(...p), Math.max(...p.map(Math.abs))];
    return p.map((x) => x * (length > 0 ? 0.35 + (0.65 * most) / length : 1));
  });
  const shell = block([-1, -1, -1], [2, 2, 2], 1, 0).filter(({ cell }) => cell.some((x) => x !== 0));
  const walls = lattice(shell, (at) => at.map((i) => HALF * [-1.5, -1, 1, 1.5][i + 1]));
  const first = cushion.positions.length / 3;
  return {
    positions: [...cushion.positions, ...walls.positions],
    simplices: [...cushion.simplices, ...walls.simplices.map((v) => v + first)],
  };
}

/**
 * By name: `make(size)`, the arrays of a body; `held`, which of its points each handle holds; `moved`, the handle that
 * goes elsewhere, and `move(point, count)`, where the `count`-th move takes a point of it; words for people.
 */
export const CONTACTS = {
  hooks: {
    title: 'Two hooks', description: 'Two hooks in each other, one of which is pulled away',
    button: 'Pull', further: 'Pull further', hint: 'Two hooks, one in the other; their far ends are held. The right one is pulled away',
    make: (size) => solid(hooks(3, size)),
    held: [([x]) => x === 0, ([x]) => x === 8], moved: 1, move: ([x, y, z], count) => [x + (count > 1 ? 0.75 : 1.5), y, z],
  },
  'flat-hooks': {
    title: 'Two hooks (flat)', planar: true, description: 'The same in the plane',
    button: 'Pull', further: 'Pull further', hint: 'Two hooks in the plane, one in the other; their far ends are held. The right one is pulled away',
    make: (size) => flat(hooks(2, size)),
    held: [([x]) => x === 0, ([x]) => x === 8], moved: 1, move: ([x, y, z], count) => [x + (count > 1 ? 0.5 : 1.5), y, z],
  },
  cushion: {
    title: 'A cushion in a box', description: 'A rounded cube in a box whose walls come closer',
    button: 'Press', further: 'Press further', hint: 'A cushion in a box. The walls are held, and come closer',
    make: (size) => solid(press(size)),
    held: [(p) => Math.max(...p.map(Math.abs)) > 1.01], moved: 0, move: (p, count) => p.map((x) => x * (count > 1 ? 0.95 : 0.9)),
  },
  boxes: {
    title: 'Two boxes', description: 'One box on another, pressed down and pushed along',
    button: 'Press down', further: 'Push along', hint: 'One box on another. The lowest face and the highest are held; the upper one is pressed down, then pushed along',
    make: (size) => solid(boxes(size)),
    held: [([, , z]) => z === 0, ([, , z]) => z > 2.04], moved: 1, move: ([x, y, z], count) => (count > 1 ? [x + 0.5, y, z] : [x, y, z - 0.3]),
  },
};

/** Whether this is the name of one of them. */
export const keepsApart = (name) => Object.hasOwn(CONTACTS, name);

/** The handles of one of them: lists of vertices of its body. */
export function handlesOf({ held }, { positions }) {
  const all = Array.from({ length: positions.length / 3 }, (_, v) => v);
  return held.map((test) => Uint32Array.from(all.filter((v) => test([...positions.subarray(3 * v, 3 * v + 3)]))));
}

/** Where the `count`-th move takes the points (n×3) of the handle that moves. */
export function moved({ move }, points, count) {
  const out = new Float64Array(points.length);
  for (let i = 0; i < points.length; i += 3) out.set(move([...points.subarray(i, i + 3)], count), i);
  return out;
}
