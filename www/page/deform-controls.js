// The controls of the Deform mode.
import { MATERIALS, isElastic } from './materials.js';
import { FIGURES } from './figures.js';
import { PRESETS, presetsOf } from './presets.js';
import { reflectSight } from './sight.js';
import { number, whole } from './words.js';

const $ = (id) => document.getElementById(id);

export class DeformControls {
  #mode;
  #box = false;

  constructor(mode) {
    this.#mode = mode;
  }

  get methods() {
    return [...$('deform-method').options].map((option) => option.value);
  }

  get solidTitle() {
    return $('solid').selectedOptions[0]?.text ?? this.#mode.source.solid;
  }

  /** The library knows its shapes best. */
  list(shapes) {
    const select = $('solid');
    const chosen = this.#mode.source.solid;
    const group = (label, list) => {
      const options = list.map(({ name, title, description }) => Object.assign(new Option(title, name), { title: description }));
      const made = Object.assign(document.createElement('optgroup'), { label });
      made.append(...options);
      return made;
    };
    const figures = Object.entries(FIGURES).map(([name, figure]) => ({ name, ...figure }));
    select.replaceChildren(group('Solids', shapes), group('In the plane', figures));
    if (chosen && [...shapes, ...figures].some(({ name }) => name === chosen)) select.value = chosen;
  }

  connect() {
    const mode = this.#mode;
    for (const id of ['solid', 'tetrahedra']) {
      $(id).addEventListener('change', () => { if ($('solid').value) mode.changeSolid($('solid').value, Number($('tetrahedra').value)); });
    }
    $('deform-method').addEventListener('change', () => mode.change('method', $('deform-method').value));
    $('material').addEventListener('change', () => mode.change('material', $('material').value));
    for (const id of ['young', 'poisson']) $(id).addEventListener('change', () => this.#changeNumber(id));
    $('material').replaceChildren(...Object.entries(MATERIALS).map(([name, { title }]) => new Option(title, name)));
    for (const [name, { title, hint }] of Object.entries(PRESETS)) {
      const button = Object.assign(document.createElement('button'), { type: 'button', textContent: title, title: hint });
      button.dataset.preset = name;
      button.addEventListener('click', () => mode.preset(name));
      $('presets').append(button);
    }
    $('pin-box').addEventListener('click', () => this.toggleBox());
    $('release').addEventListener('click', () => mode.release());
    for (const [id, times] of [['turn-back', -1], ['turn-on', 1]]) $(id).addEventListener('click', () => mode.hands.twist(times));
  }

  /** Young's modulus or Poisson's ratio, if it is a number in range; else the field says what is wrong. */
  #changeNumber(id) {
    const input = $(id);
    const value = Number(input.value);
    const wrong = id === 'young'
      ? !(value > 0 && value < 1e15) && 'Young’s modulus is a number above 0'
      : !(value > -1 && value < 0.5) && 'Poisson’s ratio lies between −1 and 0.5';
    input.setCustomValidity(wrong || '');
    if (wrong || input.value === '') return void input.reportValidity();
    this.#mode.change(id, value);
  }

  /** A drag spans a box of vertices to pin; or not any more. */
  toggleBox() {
    this.#box = !this.#box;
    $('pin-box').setAttribute('aria-pressed', String(this.#box));
    this.look();
  }

  /** Shows what is wanted. */
  reflect() {
    const { wanted, source } = this.#mode;
    $('deform-method').value = wanted.method;
    $('material').value = wanted.material;
    $('young').value = number(wanted.young, 3).replace('.00', '');
    $('poisson').value = String(wanted.poisson);
    for (const id of ['young', 'poisson']) {
      $(id).disabled = !isElastic(wanted.material);
      $(id).setCustomValidity('');
    }
    const solid = $('solid');
    solid.querySelector('option[data-file]')?.remove();
    if (source.bytes) {
      const option = new Option(source.name, '', true, true);
      option.dataset.file = '';
      solid.add(option, 0);
    } else {
      if (![...solid.options].some((option) => option.value === source.solid)) solid.add(new Option(source.solid, source.solid));
      solid.value = source.solid;
      const sizes = $('tetrahedra');
      if (![...sizes.options].some((option) => Number(option.value) === source.tetrahedra)) {
        sizes.add(new Option(`${whole(source.tetrahedra)} tetrahedra`, String(source.tetrahedra)));
      }
      sizes.value = String(source.tetrahedra);
    }
    $('tetrahedra').disabled = Boolean(source.bytes);
    const { figure } = this.#mode;
    for (const option of $('deform-method').options) option.disabled = Boolean(figure) && option.value !== 'lim';
    for (const button of $('presets').children) button.hidden = !presetsOf(figure).includes(button.dataset.preset);
    for (const option of $('tetrahedra').options) option.text = option.text.replace(/tetrahedra|triangles/, figure ? 'triangles' : 'tetrahedra');
    this.reflectHandles();
    this.look();
  }

  /** What the buttons about handles can do now. */
  reflectHandles() {
    const { groups, selected } = this.#mode.handles;
    $('release').disabled = groups.length === 0;
    for (const id of ['turn-back', 'turn-on']) $(id).disabled = selected < 0;
    $('release').textContent = groups.length > 0 && selected < 0 ? 'Release all' : 'Release';
  }

  /** Shows how the solid is looked at. */
  look() {
    const { wanted, bench, active, figure } = this.#mode;
    if (active) reflectSight(wanted, Boolean(figure));
    bench?.boxTool(this.#box);
  }
}
