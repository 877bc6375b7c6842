// The controls of locally injective mappings.
import { LIM_ENERGIES } from './materials.js';

const $ = (id) => document.getElementById(id);

/** The settings of the method, of what is wanted. */
export const limSettings = ({ energy, barrier, hessian }) => ({ method: 'lim', energy, barrier: barrier === 'on', hessian });

/** The name of its curve. */
export const limName = ({ barrier, hessian }) => `lim${hessian === 'frozen' ? '-frozen' : ''}${barrier === 'on' ? '' : '-off'}`;

export class LimControls {
  #mode;

  constructor(mode) {
    this.#mode = mode;
  }

  connect() {
    const mode = this.#mode;
    $('lim-energy').replaceChildren(...Object.entries(LIM_ENERGIES).map(([name, title]) => new Option(title, name)));
    $('lim-energy').addEventListener('change', () => mode.again('energy', $('lim-energy').value));
    $('lim-hessian').addEventListener('change', () => mode.again('hessian', $('lim-hessian').value));
    $('lim-barrier').addEventListener('click', () => mode.again('barrier', mode.wanted.barrier === 'on' ? 'off' : 'on'));
  }

  /** Shows what is wanted; what belongs to materials gives way. */
  reflect() {
    const { wanted, isLim, active } = this.#mode;
    for (const element of document.querySelectorAll('[data-lim]')) element.classList.toggle('off', (element.dataset.lim === 'yes') !== isLim);
    $('lim-energy').value = wanted.energy;
    $('lim-hessian').value = wanted.hessian;
    $('lim-barrier').setAttribute('aria-pressed', String(wanted.barrier === 'on'));
    $('lim-barrier').textContent = wanted.barrier === 'on' ? 'Barrier on' : 'Barrier off';
    if (active) document.querySelector('#view-tabs [data-view="map"]').textContent = isLim ? 'α μ σ' : 'Cut';
  }
}
