// Numbers and sentences as a person reads them.

/** A number with about `digits` significant digits. */
export function number(value, digits = 4) {
  if (value === 0) return '0';
  if (Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return '∞';
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent < -3 || exponent > 5) return value.toExponential(Math.min(digits - 1, 2)).replace('e+', 'e');
  return value.toFixed(Math.max(digits - 1 - exponent, 0));
}

/** So many seconds, in milliseconds below one. */
export const duration = (seconds) => (seconds < 1 ? `${number(1000 * seconds, 3)} ms` : `${number(seconds, 3)} s`);

/** A whole number in groups of three. */
export function whole(value) {
  const digits = String(Math.round(value));
  return digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, '\u00a0') : digits;
}

/** "iteration 12, energy 1.043, 0 inverted": what a screen reader hears. */
export function spoken(record) {
  return record.spoken ?? `iteration ${record.iteration}, energy ${number(record.energy)}, ${record.inverted} inverted`;
}

/** Names of methods, as people write them. */
export const METHODS = {
  wrapd: 'WRAPD', 'r-admm': 'R-ADMM', 'w-admm': 'W-ADMM', 'admm-pd': 'ADMM-PD', 'l-bfgs': 'L-BFGS', arap: 'ARAP',
  cm: 'CM', 'wrapd+cm': 'WRAPD+CM', slim: 'SLIM', gini: 'GINI', 'gini+cm': 'GINI+CM', newton: 'Newton', 'wrapd+newton': 'WRAPD+Newton', lim: 'LIM',
  lscm: 'LSCM', harmonic: 'Harmonic', tutte: 'Tutte',
};

/** Names of the roundings of integers. */
export const ROUNDING_NAMES = { direct: 'direct', greedy: 'greedy', 'two-opt': 'two-opt', lattice: 'lattice' };

/** Methods that cannot begin at a start with inverted triangles, unless the energy allows it. */
export const NEEDS_INJECTIVE = ['cm', 'slim'];

/** Methods that minimise symmetric Dirichlet alone. */
export const MAJORIZES = ['cm', 'wrapd+cm', 'gini+cm'];

/** Starts that are full of inversions. */
export const FOLDED_STARTS = ['random', 'collapsed'];

/** Why a run ended. */
export function ending(step) {
  switch (step.status) {
    case 'converged': return 'converged';
    case 'max-iterations': return 'iteration limit reached';
    // where nothing but energy is left to lower, and where inverted elements come first
    case 'stalled': return step.gini ? 'stalled: no better state found' : 'stalled: no step lowers the energy';
    case 'cancelled': return 'stopped';
    default: return '';
  }
}
