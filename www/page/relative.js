// Numbers of a solid without units: of a material of stiffness 1 in a solid of volume 1. No DOM here.

/** Relative energies below this are nothing but rounding, and told as 0. */
const ROUNDING = 1e-14;

/** Volume of a solid at rest: positions (n×3), tetrahedra (m×4). */
export function volumeOf(positions, tetrahedra) {
  const edge = (from, to, k) => positions[3 * to + k] - positions[3 * from + k];
  let six = 0;
  for (let i = 0; i < tetrahedra.length; i += 4) {
    const [a, b, c, d] = tetrahedra.subarray(i, i + 4);
    for (let k = 0; k < 3; k += 1) {
      const [u, v] = [(k + 1) % 3, (k + 2) % 3];
      six += edge(a, b, k) * (edge(a, c, u) * edge(a, d, v) - edge(a, c, v) * edge(a, d, u));
    }
  }
  return six / 6;
}

/** Area of triangles (m×3) of the plane at rest: positions (n×3). */
export function areaOf(positions, triangles) {
  let twice = 0;
  for (let i = 0; i < triangles.length; i += 3) {
    const [a, b, c] = triangles.subarray(i, i + 3);
    const edge = (to, k) => positions[3 * to + k] - positions[3 * a + k];
    twice += edge(b, 0) * edge(c, 1) - edge(b, 1) * edge(c, 0);
  }
  return Math.abs(twice) / 2;
}

/**
 * Makes steps relative: energies over stiffness × volume, gradients over stiffness × volume^⅔, stresses over stiffness.
 * `stiffness` is Young's modulus, or 1 for a material without moduli.
 */
export function relativeTo(stiffness, volume) {
  const [energy, force] = [stiffness * volume, stiffness * Math.cbrt(volume) ** 2];
  return (step) => {
    const part = step.energy / energy;
    return {
      ...step, energy: Math.abs(part) < ROUNDING ? 0 : part, gradientNorm: step.gradientNorm / force,
      ...(step.field && { field: step.field.map((x) => x / stiffness) }),
    };
  };
}
