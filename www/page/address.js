// The state of the page in the address, so that a link opens the same bench.
import { COMPARABLE, FEWEST, MOST } from './compare-session.js';
import { MOST_ELEMENTS, keepsApart } from './contact-problems.js';
import { isFigure } from './figures.js';
import { LIM_ENERGIES, MATERIALS } from './materials.js';
import { WINDOW } from './round-problems.js';
import { ENERGIES, HELD, STARTS, isFlat } from './untangle-problems.js';

/** The modes, the first of which the page opens on. */
export const MODES = ['flatten', 'deform', 'untangle', 'compare', 'round'];

/** What each mode opens on. */
export const DEFAULTS = Object.freeze({
  flatten: Object.freeze({
    sample: 'bumpy-cap', triangles: 4000, start: 'random', method: 'wrapd', energy: 'symmetric-dirichlet',
  }),
  deform: Object.freeze({
    solid: 'bar', tetrahedra: 3000, preset: 'random', method: 'wrapd', material: 'neo-hookean', young: 1e6, poisson: 0.3,
    energy: 'arap', barrier: 'on', hessian: 'projected', field: 'stretch', cut: 'z', at: 0.5,
  }),
  untangle: Object.freeze({
    body: 'bar', size: 3000, held: 'twisted', start: 'random', energy: 'arap', state: 'trial', field: 'zone', cut: 'z', at: 0.5,
  }),
  compare: Object.freeze({
    sample: 'bumpy-cap', triangles: 4000, start: 'tutte', energy: 'symmetric-dirichlet', clock: 'iterations',
    methods: 'wrapd,wrapd+cm,cm,slim',
  }),
  round: Object.freeze({
    problem: 'lattice', rounding: 'greedy', updates: 'exact', condition: 8, turn: 30, x: 0.4, y: 0.55, points: 16, coupling: 10, seed: 3,
  }),
});

const CHOICES = {
  flatten: {
    start: ['automatic', 'harmonic', 'tutte', 'lscm', 'random', 'collapsed'],
    method: ['wrapd', 'wrapd+cm', 'cm', 'slim', 'gini', 'gini+cm', 'r-admm', 'w-admm', 'admm-pd', 'arap', 'lscm', 'harmonic', 'tutte'],
    energy: ['symmetric-dirichlet', 'arap'],
  },
  deform: {
    preset: ['held', 'drag', 'squash', 'twist', 'random', 'collapse'],
    method: ['wrapd', 'wrapd+newton', 'newton', 'r-admm', 'w-admm', 'admm-pd', 'l-bfgs', 'lim'],
    material: Object.keys(MATERIALS),
    energy: Object.keys(LIM_ENERGIES),
    barrier: ['on', 'off'],
    hessian: ['projected', 'frozen'],
    field: ['stretch', 'volume', 'stress'],
    cut: ['none', 'x', 'y', 'z'],
  },
  untangle: {
    held: Object.keys(HELD),
    start: Object.keys(STARTS),
    energy: Object.keys(ENERGIES),
    state: ['trial', 'result', 'primary'],
    field: ['stretch', 'volume', 'zone'],
    cut: ['none', 'x', 'y', 'z'],
  },
  compare: {
    start: ['automatic', 'harmonic', 'tutte', 'lscm', 'random', 'collapsed'],
    energy: ['symmetric-dirichlet', 'arap'],
    clock: ['iterations', 'seconds'],
  },
  round: {
    problem: ['lattice', 'chain'],
    rounding: ['direct', 'greedy', 'two-opt', 'lattice'],
    updates: ['exact', 'three-level'],
  },
};

const NAMES = { flatten: ['sample'], deform: ['solid'], untangle: ['body'], compare: ['sample'], round: [] };
const RANGES = {
  round: {
    condition: [1, 100, false], turn: [-90, 90, true], x: [WINDOW.left + WINDOW.margin, WINDOW.right - WINDOW.margin, false],
    y: [WINDOW.low + WINDOW.margin, WINDOW.high - WINDOW.margin, false], points: [2, 64, true], coupling: [0, 40, true], seed: [1, 999, true],
  },
  flatten: { triangles: [2, 1e6, true] },
  compare: { triangles: [2, 1e6, true] },
  untangle: { size: [2, 1e6, true], at: [0, 1, false] },
  deform: { tetrahedra: [2, 1e6, true], young: [1e-6, 1e15, false], poisson: [-0.99, 0.499, false], at: [0, 1, false] },
};

/** How the address names the methods that are compared; that alone asks for the mode. */
const COMPARED = 'compare';

/** The methods of a list that can be compared by an energy, in the order of their buttons; nothing if they are too few. */
function compared(list, energy) {
  const asked = list.replaceAll(' ', '+').split(',');
  const known = COMPARABLE[energy].filter((method) => asked.includes(method)).slice(0, MOST);
  return known.length >= FEWEST ? known.join(',') : undefined;
}

/** The mode an address asks for. */
export function modeOf(search = location.search) {
  const asked = new URLSearchParams(search);
  if (MODES.includes(asked.get('mode'))) return asked.get('mode');
  return asked.has(COMPARED) ? 'compare' : MODES[0];
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
  if (mode === 'compare') {
    const { energy, methods } = state;
    // What nobody asked for has to be comparable by the energy, too.
    const fallback = compared(methods, energy) ?? COMPARABLE[energy].slice(0, MOST).join(',');
    state.methods = compared(asked.get(COMPARED) ?? '', energy) ?? fallback;
  }
  // Figures in the plane have a method of their own.
  if (mode === 'deform' && isFigure(state.solid)) {
    state.method = 'lim';
    if (!['held', 'drag'].includes(state.preset)) state.preset = 'drag';
  }
  // Bodies that are kept apart are small.
  if (mode === 'untangle' && keepsApart(state.body)) state.size = Math.min(state.size, MOST_ELEMENTS);
  if (mode === 'untangle' && isFlat(state.body) && !ENERGIES[state.energy].planar) state.energy = 'arap';
  const steps = Number(asked.get(STEPS[mode]));
  if (steps > 0 && steps <= MOST_STEPS) state.steps = Math.round(steps);
  return state;
}

/** Steps an address may ask for at most. */
export const MOST_STEPS = 5000;

/** How the address says how many steps to make. */
const STEPS = { flatten: 'at', deform: 'steps', untangle: 'steps', compare: 'at', round: 'steps' };

/** Writes the state of `mode` into the address, defaults left out, and everything of other modes. */
export function writeAddress(mode, state) {
  const asked = new URLSearchParams(location.search);
  for (const other of MODES) {
    for (const key of [...Object.keys(DEFAULTS[other]), STEPS[other]]) asked.delete(key);
  }
  asked.delete(COMPARED);
  if (mode === MODES[0] || mode === 'compare') asked.delete('mode');
  else asked.set('mode', mode);
  for (const [key, value] of Object.entries(DEFAULTS[mode])) {
    if (key !== 'methods' && state[key] !== undefined && state[key] !== value) asked.set(key, state[key]);
  }
  if (state.steps) asked.set(STEPS[mode], state.steps);
  if (mode === 'compare') asked.set(COMPARED, state.methods);
  const query = asked.toString().replaceAll('%2C', ',');
  history.replaceState(null, '', query ? `?${query}` : location.pathname);
}

/** Whether a problem is the one that `mode` opens on; how it is looked at does not count. */
export function isDefault(mode, state) {
  const looks = ['field', 'cut', 'at', 'state'];
  return Object.entries(DEFAULTS[mode]).every(([key, value]) => looks.includes(key) || state[key] === value);
}
