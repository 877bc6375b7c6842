// The drawing board: loads the egui module and hands it typed arrays.

const PHASES = ['local', 'global', 'reweight', 'evaluate'];

/** Fetches `url`, telling how much of it has come (0–1, undefined when unknown). */
async function fetchWithProgress(url, onProgress) {
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url} answered ${response.status}`);
  const total = Number(response.headers.get('content-length')) || 0;
  const encoded = response.headers.has('content-encoding');
  if (!response.body) return response.arrayBuffer();
  const parts = [];
  let loaded = 0;
  for (const reader = response.body.getReader(); ;) {
    const { done, value } = await reader.read();
    if (done) break;
    parts.push(value);
    loaded += value.length;
    onProgress(total && !encoded ? loaded / total : undefined);
  }
  return new Blob(parts).arrayBuffer();
}

/** Starts the canvas; `listen(name, value)` hears what people do on it. */
export async function startCanvas(element, listen, onProgress = () => {}) {
  const [module, bytes] = await Promise.all([
    import('../canvas/foldfree_www.js'),
    fetchWithProgress(new URL('../canvas/foldfree_www_bg.wasm', import.meta.url), onProgress),
  ]);
  await module.default({ module_or_path: bytes });
  const canvas = await module.Canvas.start(element, listen);
  return new Board(canvas);
}

/** The canvas, and the benches of its modes. */
class Board {
  #benches = new Map();

  constructor(canvas) {
    this.canvas = canvas;
  }

  /** The bench of a mode. */
  on(mode) {
    if (!this.#benches.has(mode)) this.#benches.set(mode, new BenchBoard(this.canvas.bench(mode)));
    return this.#benches.get(mode);
  }

  /** Shows the bench of a mode. */
  mode(name) { this.canvas.setMode(name); }
  theme(dark) { this.canvas.setTheme(dark); }
  view(name) { this.canvas.setView(name); }
  toggle(name) { this.canvas.toggle(name); }
  fit() { this.canvas.fitViews(); }
  reducedMotion(on) { this.canvas.setReducedMotion(on); }

  /** Text at `scale` times its size, with or without the inspector. */
  projector(scale, inspector) {
    this.canvas.setTextScale(scale);
    this.canvas.setInspector(inspector);
  }
}

/** One mode's bench, speaking the page's records. */
class BenchBoard {
  /** Elements of the body on this bench. */
  tetrahedra = 0;

  constructor(handle) {
    this.handle = handle;
  }

  /** A surface: positions (n×3), triangles (m×3). */
  surface({ positions, indices }) {
    this.handle.setProblem(Float64Array.from(positions), Uint32Array.from(indices));
  }

  /** A solid: positions (n×3), tetrahedra (m×4), triangles of its skin (k×3). */
  solid({ positions, tetrahedra, surface }) {
    this.tetrahedra = tetrahedra.length / 4;
    this.handle.setSolid(Float64Array.from(positions), tetrahedra, surface);
  }

  /** Triangles in a plane: positions (n×3), triangles (m×3). */
  planar({ positions, indices }) {
    this.tetrahedra = indices.length / 3;
    this.handle.setPlanar(Float64Array.from(positions), indices);
  }

  /** A run of `method` from `start` begins. */
  begin(method, start, energy) {
    this.handle.beginRun(method, start, energy);
  }

  /** An iterate of a map. */
  push(step) {
    if (step.solid) return this.pushSolid(step);
    this.handle.pushFrame(numbers(step), phases(step), single(step.positions));
  }

  /** An iterate of a solid; `field` are its relative stresses. */
  pushSolid(step, field = step.field) {
    this.handle.pushSolid(numbers(step), phases(step), single(step.positions), field ?? new Float32Array());
  }

  /** A part of a step of an untangling, with the three states and the zone of every element of the first. */
  pushMoment(step) {
    const zones = step.zoneOf ? Float32Array.from(step.zoneOf) : new Float32Array();
    this.handle.pushMoment(
      Float64Array.of(...numbers(step), ...moment(step)), phases(step), single(step.trial), zones, single(step.result), single(step.primary),
      contactNumbers(step.contacts),
    );
  }

  /** Whether what is held of an untangling may be dragged. */
  movable(on) { this.handle.setMovable(on); }
  /** Which state of an untangling is shown. */
  state(name) { this.handle.setState(name); }
  /** Looks at where these positions (n×3) are. */
  lookAt(positions) { this.handle.lookAt(Float64Array.from(positions)); }

  /** An iterate of which only the numbers have come. */
  pushNumbers(step) {
    this.handle.pushNumbers(numbers(step), phases(step));
  }

  /** Solvers are compared, by their methods. */
  race(methods, energy) { this.handle.beginRace(methods, energy); }

  /** An iterate of one of them. */
  pushLane(lane, step) {
    this.handle.pushLane(lane, numbers(step), phases(step), single(step.positions));
  }

  /** How one of them ended, or what went wrong. */
  endLane(lane, words, failed) { this.handle.endLane(lane, words, failed); }
  /** A time of their clock, and the iterate each had then. */
  moment(at, shown) { this.handle.showMoment(at, Uint32Array.from(shown)); }
  /** The lowest energy, from which the gaps count. */
  best(best) { this.handle.setBest(best?.energy ?? NaN, best?.settled ?? false); }
  /** What their clock counts: `iterations` or `seconds`. */
  clock(name) { this.handle.setClock(name === 'seconds'); }
  /** The map that a phone shows. */
  pane(index) { this.handle.setPane(index); }

  /** Pairs of boundary edges that meet in the newest map. */
  crossings(list) {
    this.handle.setCrossings(Uint32Array.from(list.flatMap(({ edges }) => edges.flat())));
  }

  /** What is held, handle by handle. */
  handles({ groups, selected }) {
    const vertices = Uint32Array.from(groups.flatMap((group) => [...group.vertices]));
    this.handle.setHandles(vertices, Uint32Array.from(groups, (group) => group.vertices.length));
    this.handle.setSelected(selected);
  }

  /** Where vertices are to go. */
  targets({ vertices, positions }) {
    this.handle.setTargets(vertices, positions);
  }

  /** Where the newest step led vertices that are not at their targets yet. */
  subTargets({ vertices, positions } = { vertices: new Uint32Array(), positions: new Float64Array() }) {
    this.handle.setSubTargets(vertices, positions);
  }

  /** The vertex that keys would pin, or nothing. */
  cursor(vertex) { this.handle.setCursor(vertex ?? 0xffff_ffff); }
  show(index) { this.handle.showFrame(index); }
  facts(pairs) { this.handle.setFacts(pairs.flat()); }
  field(name) { this.handle.setField(name); }
  cut(axis, at) { this.handle.setCut(axis, at); }
  boxTool(on) { this.handle.setBoxTool(on); }
  tinted(on) { this.handle.setTinted(on); }
  cameraAxes(step) { return this.handle.cameraAxes(step); }
}

const single = (positions) => (positions instanceof Float32Array ? positions : Float32Array.from(positions));

const numbers = (step) => Float64Array.of(
  step.iteration, step.energy, step.inverted, step.gradientNorm, step.smallestSigma, step.largestSigma,
  step.lbfgsIterations, step.reweighted ? 1 : 0, step.seconds, step.switchedAt ?? -1, ...parameters(step.lim),
);

/** What a step of a locally injective mapping was made with. */
const parameters = (lim) => (lim ? [lim.alpha, lim.mu, lim.sigma, lim.positionalError, lim.barrier, lim.arrived, lim.handles] : []);

const PARTS = ['start', 'local', 'quadratic', 'polish', 'outcome'];

/** Which part of which step of an untangling this is, and what is wrong then. */
function moment({ part, k, counts, violated = -1, meeting = -1, zones, gini }) {
  const {
    qpIterations = 0, constraints = 0, active = 0, accepted = false, reached = false, leastOffset = 0, firstOffset = 0, reducedOffsets = 0, smallestMeasure = NaN,
  } = gini ?? {};
  return [
    PARTS.indexOf(part), k, gini?.polish.length ?? 0, ...counts, violated, zones, qpIterations, constraints, active, accepted ? 1 : 0, reached ? 1 : 0, leastOffset,
    firstOffset, reducedOffsets, smallestMeasure, meeting,
  ];
}

/** Seven numbers a contact: its vertices, two edges or not, active or not, its zone. */
function contactNumbers({ vertices, edges, active, zones } = { edges: [] }) {
  const out = new Uint32Array(7 * edges.length);
  for (let i = 0; i < edges.length; i += 1) out.set([...vertices.subarray(4 * i, 4 * i + 4), edges[i], active[i], zones[i]], 7 * i);
  return out;
}

const phases = (step) => Float64Array.from(
  (step.phases ?? []).flatMap(({ kind, count, milliseconds }) => [PHASES.indexOf(kind), count, milliseconds]),
);

/** Reads arrays one after the other. */
function reader(buffer) {
  let at = 16;
  return (Type, count) => {
    const array = new Type(buffer, at, count);
    at += array.byteLength;
    return array;
  };
}

/** Iteration 0 from its five numbers. */
function startFrom([energy, inverted, gradientNorm, smallestSigma, largestSigma], positions) {
  return {
    iteration: 0, status: 'running', converged: false, energy, inverted, gradientNorm, smallestSigma, largestSigma,
    lbfgsIterations: 0, reweighted: false, seconds: 0, phases: [], positions,
  };
}

/** The prepared solid: "SOLI", vertices, tetrahedra, skin triangles; numbers f64; positions, start f32; indices u32. */
export async function preparedSolid(url = new URL('../start-deform.bin', import.meta.url)) {
  const response = await fetch(url);
  if (!response.ok) return undefined;
  const buffer = await response.arrayBuffer();
  const [magic, vertices, count, triangles] = new Uint32Array(buffer, 0, 4);
  if (magic !== 0x494c4f53) return undefined;
  const take = reader(buffer);
  const values = take(Float64Array, 6);
  const [positions, start] = [take(Float32Array, 3 * vertices), take(Float32Array, 3 * vertices)];
  const [tetrahedra, surface] = [take(Uint32Array, 4 * count), take(Uint32Array, 3 * triangles)];
  return { positions, tetrahedra, surface, start: { ...startFrom(values, start), solid: true } };
}

/** The prepared start: "FOLD", counts, positions f32, triangles u32, map f32, numbers f64 (little-endian). */
export async function preparedStart(url = new URL('../start.bin', import.meta.url)) {
  const response = await fetch(url);
  if (!response.ok) return undefined;
  const buffer = await response.arrayBuffer();
  const [magic, vertices, triangles] = new Uint32Array(buffer, 0, 3);
  if (magic !== 0x444c4f46) return undefined;
  const take = reader(buffer);
  const values = take(Float64Array, 6);
  const [positions, indices, map] = [take(Float32Array, 3 * vertices), take(Uint32Array, 3 * triangles), take(Float32Array, 2 * vertices)];
  return { positions, indices, start: startFrom(values, map) };
}
