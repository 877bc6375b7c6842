// How a body is looked at: what its colours mean, where it is cut open. The modes with bodies share these controls.

const $ = (id) => document.getElementById(id);

/** `active()` is the mode on show. */
export function connectSight(active) {
  const look = (...args) => active().look?.(...args);
  const at = () => Number($('cut-at').value) / 100;
  $('field').addEventListener('change', () => look('field', $('field').value));
  $('cut').addEventListener('change', () => look('cut', $('cut').value));
  $('cut-at').addEventListener('input', () => look('at', at(), { moving: true }));
  $('cut-at').addEventListener('change', () => look('at', at()));
}

/** Shows how a body is looked at; what lies in a plane is not cut. */
export function reflectSight({ field, cut, at }, planar) {
  $('field').value = field;
  $('cut').value = cut;
  $('cut-at').value = String(Math.round(100 * at));
  $('cut').disabled = planar;
  $('cut-at').disabled = cut === 'none' || planar;
  $('cut-at').setAttribute('aria-valuetext', `${Math.round(100 * at)} % along ${cut}`);
}

/** Tells a bench how to look. */
export function drawSight(bench, { field, cut, at }) {
  bench.field(field);
  bench.cut('xyz'.indexOf(cut), at);
}
