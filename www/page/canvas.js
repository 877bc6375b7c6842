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

/** The canvas, speaking the page's records. */
class Board {
  constructor(canvas) {
    this.canvas = canvas;
  }

  /** A surface: positions (n×3), triangles (m×3). */
  surface({ positions, indices }) {
    this.canvas.setProblem(Float64Array.from(positions), Uint32Array.from(indices));
  }

  /** A run of `method` from `start` begins. */
  begin(method, start, energy) {
    this.canvas.beginRun(method, start, energy);
  }

  /** An iterate. */
  push(step) {
    const numbers = Float64Array.of(
      step.iteration, step.energy, step.inverted, step.gradientNorm, step.smallestSigma, step.largestSigma,
      step.lbfgsIterations, step.reweighted ? 1 : 0, step.seconds,
    );
    const phases = Float64Array.from(
      (step.phases ?? []).flatMap(({ kind, count, milliseconds }) => [PHASES.indexOf(kind), count, milliseconds]),
    );
    const map = step.positions instanceof Float32Array ? step.positions : Float32Array.from(step.positions);
    this.canvas.pushFrame(numbers, phases, map);
  }

  /** Pairs of boundary edges that meet in the newest map. */
  crossings(list) {
    this.canvas.setCrossings(Uint32Array.from(list.flatMap(({ edges }) => edges.flat())));
  }

  show(index) { this.canvas.showFrame(index); }
  facts(pairs) { this.canvas.setFacts(pairs.flat()); }
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

/** The prepared start: "FOLD", counts, positions f32, triangles u32, map f32, numbers f64 (little-endian). */
export async function preparedStart(url = new URL('../start.bin', import.meta.url)) {
  const response = await fetch(url);
  if (!response.ok) return undefined;
  const buffer = await response.arrayBuffer();
  const [magic, vertices, triangles] = new Uint32Array(buffer, 0, 3);
  if (magic !== 0x444c4f46) return undefined;
  let at = 16;
  const take = (Type, count) => {
    const array = new Type(buffer, at, count);
    at += array.byteLength;
    return array;
  };
  const [energy, inverted, gradientNorm, smallestSigma, largestSigma] = take(Float64Array, 5);
  at += 8; // the next arrays stay aligned
  const [positions, indices, map] = [take(Float32Array, 3 * vertices), take(Uint32Array, 3 * triangles), take(Float32Array, 2 * vertices)];
  const start = {
    iteration: 0, status: 'running', converged: false, energy, inverted, gradientNorm, smallestSigma, largestSigma,
    lbfgsIterations: 0, reweighted: false, seconds: 0, phases: [], positions: map,
  };
  return { positions, indices, start };
}
