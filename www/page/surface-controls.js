// The controls that say which surface is on the bench, shared by the modes that flatten.
import { whole } from './words.js';

const $ = (id) => document.getElementById(id);

/** The library knows its samples best. */
export function listSamples(shapes) {
  const options = [...$('sample').options];
  for (const { name, title, description } of shapes) {
    const option = options.find((o) => o.value === name) ?? new Option(title, name);
    option.title = description;
    if (!option.parentNode) $('sample').add(option);
  }
}

/** The sample that is chosen, or nothing. */
export function chosenSample() {
  const sample = $('sample').value;
  return sample ? { sample, triangles: Number($('triangles').value) } : undefined;
}

/** What people call what is on the bench. */
export const titleOf = (source) => source.name ?? $('sample').selectedOptions[0]?.text ?? source.sample;

/** Shows which surface is on the bench. */
export function reflectSource(source) {
  const sample = $('sample');
  sample.querySelector('option[data-file]')?.remove();
  if (source.bytes) {
    const option = new Option(source.name, '', true, true);
    option.dataset.file = '';
    sample.add(option, 0);
  } else {
    if (![...sample.options].some((option) => option.value === source.sample)) sample.add(new Option(source.sample, source.sample));
    sample.value = source.sample;
    const sizes = $('triangles');
    if (![...sizes.options].some((option) => Number(option.value) === source.triangles)) {
      sizes.add(new Option(`${whole(source.triangles)} triangles`, String(source.triangles)));
    }
    sizes.value = String(source.triangles);
  }
  $('triangles').disabled = Boolean(source.bytes);
}
