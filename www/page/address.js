// The state of the bench in the address, so that a link opens the same bench.

/** What the page opens on. */
export const DEFAULTS = Object.freeze({
  sample: 'bumpy-cap', triangles: 4000, start: 'random', method: 'wrapd', energy: 'symmetric-dirichlet',
});

const CHOICES = {
  start: ['automatic', 'harmonic', 'tutte', 'lscm', 'random', 'collapsed'],
  method: ['wrapd', 'r-admm', 'w-admm', 'admm-pd', 'arap', 'lscm', 'harmonic', 'tutte'],
  energy: ['symmetric-dirichlet', 'arap'],
};

/** The state an address asks for; what it does not say, or says wrongly, is the default. */
export function readAddress(search = location.search) {
  const asked = new URLSearchParams(search);
  const state = { ...DEFAULTS };
  for (const [key, values] of Object.entries(CHOICES)) {
    if (values.includes(asked.get(key))) state[key] = asked.get(key);
  }
  if (/^[a-z-]{1,40}$/.test(asked.get('sample') ?? '')) state.sample = asked.get('sample');
  const triangles = Number(asked.get('triangles'));
  if (triangles >= 2 && triangles <= 1e6) state.triangles = Math.round(triangles);
  const at = Number(asked.get('at'));
  if (asked.has('at') && at > 0 && at <= 5000) state.at = Math.round(at);
  return state;
}

/** Writes the state into the address, defaults left out. */
export function writeAddress(state) {
  const asked = new URLSearchParams(location.search);
  for (const key of Object.keys(DEFAULTS)) {
    if (state[key] === undefined || state[key] === DEFAULTS[key]) asked.delete(key);
    else asked.set(key, state[key]);
  }
  if (state.at) asked.set('at', state.at);
  else asked.delete('at');
  const query = asked.toString();
  history.replaceState(null, '', query ? `?${query}` : location.pathname);
}

/** Whether a state is what the page opens on. */
export function isDefault(state) {
  return Object.keys(DEFAULTS).every((key) => state[key] === DEFAULTS[key]);
}
