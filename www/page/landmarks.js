// Places on a solid that can be named, for people who have no pointer. No DOM here.
import { bounds } from './presets.js';

/**
 * Vertices of the skin (triangles, k×3) next to the corners, the middles of the edges and the middles of the faces of the
 * bounding box of `positions` (n×3): `{ vertex, words }`, each vertex once.
 */
export function landmarks(positions, surface) {
  const { low, high } = bounds(positions);
  const skin = [...new Set(surface)].sort((a, b) => a - b);
  const found = new Map();
  for (let i = 0; i < 27; i += 1) {
    const part = [i % 3, Math.floor(i / 3) % 3, Math.floor(i / 9)].map((x) => x / 2);
    if (part.every((x) => x === 0.5)) continue;
    let [best, least] = [-1, Infinity];
    for (const v of skin) {
      let far = 0;
      for (let k = 0; k < 3; k += 1) far += (((positions[3 * v + k] - low[k]) / (high[k] - low[k] || 1)) - part[k]) ** 2;
      if (far < least) [best, least] = [v, far];
    }
    if (best >= 0 && !found.has(best)) found.set(best, part.map((x, k) => `${'xyz'[k]} ${Math.round(100 * x)} %`).join(', '));
  }
  return [...found].map(([vertex, words]) => ({ vertex, words }));
}
