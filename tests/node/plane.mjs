// Triangles in a plane, and which of them do not turn as they did.

/** A unit square of n×n vertices, times `size`, at `z`. */
export function square(n, { size = 1, z = 0, clockwise = false } = {}) {
  const positions = Float64Array.from(Array.from({ length: n * n }, (_, v) => [size * (v % n) / (n - 1), size * Math.floor(v / n) / (n - 1), z]).flat());
  const indices = [];
  for (let j = 0; j + 1 < n; j += 1) {
    for (let i = 0; i + 1 < n; i += 1) {
      const a = j * n + i;
      for (const [p, q, r] of [[a, a + 1, a + n + 1], [a, a + n + 1, a + n]]) indices.push(...(clockwise ? [p, r, q] : [p, q, r]));
    }
  }
  return { positions, indices: Uint32Array.from(indices) };
}

/** Triangles that do not turn as those of `rest` do. */
export function inverted({ positions: rest, indices }, positions) {
  const area = (p, [a, b, c]) => (p[3 * b] - p[3 * a]) * (p[3 * c + 1] - p[3 * a + 1]) - (p[3 * b + 1] - p[3 * a + 1]) * (p[3 * c] - p[3 * a]);
  let count = 0;
  for (let t = 0; t < indices.length; t += 3) {
    const corners = indices.subarray(t, t + 3);
    if (!(area(positions, corners) * area(rest, corners) > 0)) count += 1;
  }
  return count;
}
