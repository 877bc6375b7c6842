// Beside the picture: what this step did, and what each rounding found.
import { changedIn } from './chain-picture.js';
import { ROUNDINGS } from './round-session.js';
import { ROUNDING_NAMES, number, whole } from './words.js';

const $ = (id) => document.getElementById(id);

const ABOUT = {
  direct: 'every integer to the nearest, all at once',
  greedy: 'one at a time, the nearest first; the others follow',
  'two-opt': 'greedy, then ±1 on one integer or two while that helps',
  lattice: 'a reduced basis, then all points that could be better',
};

const FOLLOWED = {
  'gauss-seidel': 'Local Gauss–Seidel made the others follow',
  'conjugate-gradients': 'Conjugate gradients made the others follow',
  cholesky: 'Sparse Cholesky made the others follow',
  dense: 'The exact update made the others follow',
  none: 'No level reached its tolerance',
};

const named = (kind, unknown) => (kind === 'lattice' ? 'xy'[unknown] : `point ${unknown + 1}:`);
const minus = (text) => String(text).replace('-', '−');

/** "x 0.40 → 0", for a few of them. */
function changes(kind, list) {
  const words = list.slice(0, 4).map(({ unknown, from, to }) => `${named(kind, unknown)} ${minus(number(from, 3))} → ${minus(to)}`);
  return words.join(', ') + (list.length > 4 ? ` and ${list.length - 4} more` : '');
}

/** What a step did: a headline and a sentence. */
export function explain(session, shown) {
  const { path, problem: { kind } } = session;
  const step = path[shown];
  const before = path[Math.max(shown - 1, 0)];
  const { action } = step;
  switch (action.kind) {
    case 'relax':
      return { head: 'The minimum without integrality', text: kind === 'lattice' ? `x = ${minus(number(step.x[0], 3))}, y = ${minus(number(step.x[1], 3))}. No integer point has less energy than this.` : `All ${step.x.length} points at their places: no spring pulls. Now they are to become integers.` };
    case 'round': {
      const { rounded, level } = action;
      const changed = changedIn(step);
      const moved = [...step.x].filter((x, i) => !changed.has(i) && Math.abs(x - before.x[i]) > 1e-3).length;
      const rest = step.remaining > 0 ? `${FOLLOWED[level]}: ${moved} of ${step.remaining} moved by more than .001.` : 'All are integers now.';
      return { head: rounded.length > 1 ? 'Rounded, all at once' : 'Rounded, the nearest', text: `${changes(kind, rounded)}. ${rest}` };
    }
    case 'improve':
      return { head: 'Improved', text: `${changes(kind, action.changed)} lowers the energy by ${number(before.energy - step.energy, 3)}.` };
    case 'reduce':
      return { head: action.reduced ? 'The lattice basis is reduced' : 'The lattice basis is being reduced', text: `${whole(action.exchanges)} exchanges of basis vectors (LLL): a short, nearly orthogonal basis, in which rounding is good.` };
    default:
      return { head: 'Points were enumerated', text: `${whole(action.nodes)} nodes of the search visited, ${whole(action.improvements)} times a better point. ${action.proven ? 'Every other point is excluded: this is the optimum.' : 'The search goes on.'}` };
  }
}

/** Writes the column anew. */
export function drawFacts(session, shown) {
  const { head, text } = explain(session, shown);
  $('round-head').textContent = head;
  $('round-text').textContent = text;
  const above = (rounding) => {
    const { energy, report } = session.results.get(rounding);
    return Math.max(energy - report.relaxedEnergy, 0);
  };
  const most = Math.max(...ROUNDINGS.map(above), 1e-300);
  const least = above('lattice');
  const sure = session.results.get('lattice').proven;
  for (const rounding of ROUNDINGS) {
    const row = $('round-table').querySelector(`tr[data-method="${rounding}"]`);
    const value = above(rounding);
    row.querySelector('.energy').textContent = number(value, 3);
    const more = least > 1e-9 ? (100 * (value - least)) / least : 0;
    row.querySelector('.more').textContent = rounding === 'lattice' ? (sure ? 'proven' : 'not proven') : more < 0.05 ? 'the same' : `+${whole(more)} %`;
    row.querySelector('.amount').style.width = `${(100 * value) / most}%`;
    row.classList.toggle('chosen', session.rounding === rounding);
    row.querySelector('button').setAttribute('aria-pressed', String(session.rounding === rounding));
  }
}

/** Makes the table; `choose(rounding)` is told which row was clicked. */
export function makeTable(choose) {
  for (const rounding of ROUNDINGS) {
    const row = $('round-table').insertRow();
    row.dataset.method = rounding;
    const name = document.createElement('th');
    name.scope = 'row';
    const button = Object.assign(document.createElement('button'), { type: 'button', title: ABOUT[rounding] });
    const swatch = document.createElement('span');
    swatch.className = 'swatch';
    button.append(swatch, ROUNDING_NAMES[rounding]);
    button.addEventListener('click', () => choose(rounding));
    name.append(button);
    row.append(name);
    const energy = row.insertCell();
    energy.className = 'energy';
    const track = row.insertCell();
    track.className = 'track';
    track.setAttribute('aria-hidden', 'true');
    track.append(Object.assign(document.createElement('span'), { className: 'amount' }));
    row.insertCell().className = 'more';
  }
}
