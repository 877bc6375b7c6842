// Other programs that flatten, where they are installed: libigl (by pip), watlas (by npm).
import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { ask } from '../lib/progress.mjs';

const SLIM = `
import json, sys, time
import igl, numpy as np
v, f = [np.asarray(a) for a in (lambda r: (r[0], r[3]))(igl.readOBJ(sys.argv[1]))]
v = v[:, :3] / np.sqrt(igl.doublearea(v[:, :3], f).sum() / 2)
loop = igl.boundary_loop(f)
circle = np.asarray(igl.map_vertices_to_circle(np.asfortranarray(v), loop.astype(np.int32)))
uv = igl.harmonic(v, f, loop, circle / np.sqrt(np.pi), 1)
v, uv = np.asfortranarray(v), np.asfortranarray(uv)
# rest triangles in their planes: energy and area are those of our reports
a, b = v[f[:, 1]] - v[f[:, 0]], v[f[:, 2]] - v[f[:, 0]]
length = np.linalg.norm(a, axis=1)
x = (a * b).sum(1) / length
area = igl.doublearea(v, f).ravel() / 2
y = 2 * area / length
def energy(uv):
    p, q = uv[f[:, 1]] - uv[f[:, 0]], uv[f[:, 2]] - uv[f[:, 0]]
    p = p / length[:, None]
    q = (q - x[:, None] * p) / y[:, None]
    squares, det = (p * p + q * q).sum(1), p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return float((area * squares * (1 + det ** -2)).sum() / 4), int((det <= 0).sum())
rows = []
def row(seconds, uv):
    e, inverted = energy(uv)
    rows.append({'iteration': len(rows), 'seconds': seconds, 'energy': e, 'inverted': inverted})
row(0, uv)
begin = time.perf_counter()
fixed, where = np.zeros(0, dtype=np.int32), np.asfortranarray(np.zeros((0, 2)))
data = igl.slim_precompute(v, np.asfortranarray(f.astype(np.int32)), uv,
                           igl.MappingEnergyType.SYMMETRIC_DIRICHLET, fixed, where, 0.0)
setup = time.perf_counter() - begin
spent, first = 0, 0
for i in range(1 + int(sys.argv[2])):
    begin = time.perf_counter()
    uv = igl.slim_solve(data, 1)
    spent += time.perf_counter() - begin
    first = first or spent
    row(spent, np.asarray(uv))
print(json.dumps({'mean': (spent - first) / int(sys.argv[2]) * 1000, 'setupSeconds': setup, 'rows': rows}))
`;

/**
 * SLIM of the PyPI wheel libigl, one thread: rows of the iterations, and milliseconds an iteration from the second on.
 * Undefined when it is not installed.
 */
export async function measureSlim(path, { work, iterations }) {
  const script = join(work, 'slim.py');
  writeFileSync(script, SLIM);
  const env = { ...process.env, OMP_NUM_THREADS: '1', OPENBLAS_NUM_THREADS: '1' };
  const output = await ask('python3', [script, path, String(iterations)], { env, timeout: 300_000 });
  const line = output?.split('\n').findLast((text) => text.startsWith('{'));
  return line && JSON.parse(line);
}

/** xatlas in wasm, where the npm package watlas is installed: whole milliseconds. */
export async function measureWatlas(path) {
  let watlas;
  try {
    watlas = await import('watlas');
  } catch {
    return undefined;
  }
  const positions = [];
  const indices = [];
  for (const line of readFileSync(path, 'utf8').split('\n')) {
    const [kind, ...rest] = line.trim().split(/\s+/);
    if (kind === 'v') positions.push(...rest.slice(0, 3).map(Number));
    if (kind === 'f') indices.push(...rest.map((corner) => parseInt(corner, 10) - 1));
  }
  await watlas.Initialize?.();
  const atlas = new watlas.Atlas();
  const start = performance.now();
  atlas.addMesh({ vertexPositionData: new Float32Array(positions), indexData: new Uint32Array(indices), vertexCount: positions.length / 3, indexCount: indices.length });
  atlas.generate();
  return { total: performance.now() - start };
}
