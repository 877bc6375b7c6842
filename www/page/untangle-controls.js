// The controls of the Untangle mode.
import { CONTACTS, MOST_ELEMENTS } from './contact-problems.js';
import { FIGURES } from './figures.js';
import { reflectSight } from './sight.js';
import { ENERGIES, HELD, STARTS } from './untangle-problems.js';
import { whole } from './words.js';

const $ = (id) => document.getElementById(id);

const option = ([name, { title, hint = '' }]) => Object.assign(new Option(title, name), { title: hint });

export class UntangleControls {
  #mode;

  constructor(mode) {
    this.#mode = mode;
  }

  get title() {
    return $('body').selectedOptions[0]?.text ?? this.#mode.source.body;
  }

  /** The library knows its solids best. */
  list(shapes) {
    const group = (label, list) => {
      const made = Object.assign(document.createElement('optgroup'), { label });
      made.append(...list.map(({ name, title, description }) => Object.assign(new Option(title, name), { title: description })));
      return made;
    };
    const figures = Object.entries(FIGURES).map(([name, { title }]) => ({ name, title, description: 'Triangles in the plane' }));
    const apart = Object.entries(CONTACTS).map(([name, { title, description }]) => ({ name, title, description }));
    $('body').replaceChildren(group('Solids', shapes), group('In the plane', figures), group('Kept apart', apart));
    this.reflect();
  }

  connect() {
    const mode = this.#mode;
    $('held').replaceChildren(...Object.entries(HELD).map(option));
    $('untangle-start').replaceChildren(...Object.entries(STARTS).map(option));
    $('untangle-energy').replaceChildren(...Object.entries(ENERGIES).map(option));
    for (const id of ['body', 'size']) $(id).addEventListener('change', () => { if ($('body').value) mode.changeBody($('body').value, Number($('size').value)); });
    $('held').addEventListener('change', () => mode.change('held', $('held').value));
    $('untangle-start').addEventListener('change', () => mode.change('start', $('untangle-start').value));
    $('untangle-energy').addEventListener('change', () => mode.change('energy', $('untangle-energy').value));
    $('further').addEventListener('click', () => mode.further());
    for (const button of $('states').children) button.addEventListener('click', () => mode.look('state', button.dataset.state));
  }

  /** Shows what is wanted. */
  reflect() {
    const { wanted, source, planar } = this.#mode;
    $('held').value = wanted.held;
    $('untangle-start').value = wanted.start;
    $('untangle-energy').value = wanted.energy;
    for (const one of $('untangle-energy').options) one.disabled = planar && !ENERGIES[one.value].planar;
    const [bodies, sizes] = [$('body'), $('size')];
    bodies.querySelector('option[data-file]')?.remove();
    if (source.files) {
      const made = new Option(source.name, '', true, true);
      made.dataset.file = '';
      bodies.add(made, 0);
    } else {
      if (![...bodies.options].some(({ value }) => value === source.body)) bodies.add(new Option(source.body, source.body));
      bodies.value = source.body;
      if (![...sizes.options].some(({ value }) => Number(value) === source.size)) sizes.add(new Option(`${whole(source.size)} elements`, String(source.size)));
      sizes.value = String(source.size);
    }
    sizes.disabled = Boolean(source.files);
    // what a person brought is held, and starts, as the files say
    $('held').disabled = Boolean(source.pins || source.files?.length > 1);
    $('untangle-start').disabled = source.files?.length > 1;
    const { apart } = this.#mode;
    // bodies that are kept apart have their own start, and are small
    for (const id of ['held', 'untangle-start']) $(id).closest('label').classList.toggle('off', apart !== undefined);
    for (const one of sizes.options) one.disabled = apart !== undefined && Number(one.value) > MOST_ELEMENTS;
    this.reflectHandles();
    this.look();
  }

  /** Shows whether what is held can go on. */
  reflectHandles() {
    const { apart, mayHold } = this.#mode;
    $('further').closest('.group').classList.toggle('off', !apart);
    $('further').textContent = apart?.further ?? '';
    $('further').disabled = !mayHold;
  }

  /** Shows how the body is looked at. */
  look() {
    const { wanted, planar, active } = this.#mode;
    for (const button of $('states').children) button.setAttribute('aria-pressed', String(button.dataset.state === wanted.state));
    if (active) reflectSight(wanted, planar);
  }
}
