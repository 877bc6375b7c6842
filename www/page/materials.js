// The materials, named once: what people call them, and whether they have moduli.

export const MATERIALS = {
  'neo-hookean': { title: 'neo-Hookean', elastic: true },
  'stable-neo-hookean': { title: 'stable neo-Hookean', elastic: true },
  'st-venant-kirchhoff': { title: 'St. Venant–Kirchhoff', elastic: true },
  arap: { title: 'ARAP', elastic: false },
  'symmetric-dirichlet': { title: 'symmetric Dirichlet', elastic: false },
  dirichlet: { title: 'Dirichlet', elastic: false },
};

/** Whether Young's modulus and Poisson's ratio say anything of a material. */
export const isElastic = (material) => MATERIALS[material]?.elastic === true;

/** The energies of locally injective mappings. */
export const LIM_ENERGIES = {
  arap: 'ARAP', lscm: 'LSCM', dirichlet: 'Dirichlet', laplacian: 'Laplacian', 'uniform-laplacian': 'uniform Laplacian',
  'green-strain': 'Green strain',
};
