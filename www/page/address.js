// The state of the page in the address, so that a link opens the same bench.
import { MATERIALS } from './materials.js';

/** The modes, the first of which the page opens on. */
export const MODES = ['flatten', 'deform'];

/** What each mode opens on. */
export const DEFAULTS = Object.freeze({
  flatten: Object.freeze({
    sample: 'bumpy-cap', triangles: 4000, start: 'random', method: 'wrapd', energy: 'symmetric-dirichlet',
  }),
  deform: Object.freeze({
    solid: 'bar', tetrahedra: 3000, preset: 'random', method: 'wrapd', material: 'neo-hookean', young: 1e6, poisson: 0.3,
    field: 'stretch', cut: 'z', at: 0.5,
  }),
});

const CHOICES = {
  flatten: {
    start: ['automatic', 'harmonic', 'tutte', 'lscm', 'random', 'collapsed'],
    method: ['wrapd', 'wrapd+cm', 'cm', 'slim', 'r-admm', 'w-admm', 'admm-pd', 'arap', 'lscm', 'harmonic', 'tutte'],
    energy: ['symmetric-dirichlet', 'arap'],
  },
  deform: {
    preset: ['held', 'squash', 'twist', 'random', 'collapse'],
    method: ['wrapd', 'wrapd+newton', 'newton', 'r-admm', 'w-admm', 'admm-pd', 'l-bfgs'],
    material: Object.keys(MATERIALS),
    field: ['stretch', 'volume', 'stress'],
    cut: ['none', 'x', 'y', 'z'],
  },
};

const NAMES = { flatten: ['sample'], deform: ['solid'] };
const RANGES = {
  flatten: { triangles: [2, 1e6, true] },
  deform: { tetrahedra: [2, 1e6, true], young: [1e-6, 1e15, false], poisson: [-0.99, 0.499, false], at: [0, 1, false] },
};

/** The mode an address asks for. */
export function modeOf(search = location.search) {
  const asked = new URLSearchParams(search).get('mode');
  return MODES.includes(asked) ? asked : MODES[0];
}

/**
 * The state of `mode` an address asks for; what it does not say, or says wrongly, is the default. `steps`
 * is how many to make at once. Another mode's address says nothing of this one.
 */
export function readAddress(mode = modeOf(), search = location.search) {
  const asked = new URLSearchParams(modeOf(search) === mode ? search : '');
  const state = { ...DEFAULTS[mode] };
  for (const [key, values] of Object.entries(CHOICES[mode])) {
    const value = asked.get(key)?.replaceAll(' ', '+'); // a plus sign that was typed into the address is read as a space
    if (values.includes(value)) state[key] = value;
  }
  for (const key of NAMES[mode]) {
    if (/^[a-z0-9-]{1,40}$/.test(asked.get(key) ?? '')) state[key] = asked.get(key);
  }
  for (const [key, [low, high, whole]] of Object.entries(RANGES[mode])) {
    const value = Number(asked.get(key) || NaN);
    if (value >= low && value <= high) state[key] = whole ? Math.round(value) : value;
  }
  const steps = Number(asked.get(STEPS[mode]));
  if (steps > 0 && steps <= MOST_STEPS) state.steps = Math.round(steps);
  return state;
}

/** Steps an address may ask for at most. */
export const MOST_STEPS = 5000;

/** How the address says how many steps to make. */
const STEPS = { flatten: 'at', deform: 'steps' };

/** Writes the state of `mode` into the address, defaults left out, and everything of other modes. */
export function writeAddress(mode, state) {
  const asked = new URLSearchParams(location.search);
  for (const other of MODES) {
    for (const key of [...Object.keys(DEFAULTS[other]), STEPS[other]]) asked.delete(key);
  }
  if (mode === MODES[0]) asked.delete('mode');
  else asked.set('mode', mode);
  for (const [key, value] of Object.entries(DEFAULTS[mode])) {
    if (state[key] !== undefined && state[key] !== value) asked.set(key, state[key]);
  }
  if (state.steps) asked.set(STEPS[mode], state.steps);
  const query = asked.toString();
  history.replaceState(null, '', query ? `?${query}` : location.pathname);
}

/** Whether a problem is the one that `mode` opens on; how it is looked at does not count. */
export function isDefault(mode, state) {
  const looks = ['field', 'cut', 'at'];
  return Object.entries(DEFAULTS[mode]).every(([key, value]) => looks.includes(key) || state[key] === value);
}
