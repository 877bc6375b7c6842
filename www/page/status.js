// The status line, the handle of the history, and what a screen reader hears.
import { number, spoken, whole } from './words.js';

const $ = (id) => document.getElementById(id);

function part(className, ...children) {
  const span = document.createElement('span');
  span.className = className;
  span.append(...children);
  return span;
}

/** Writes where `mode` is. */
export function drawStatus(mode) {
  const { records, shown } = mode;
  const record = records[shown] && mode.readout(records[shown]);
  if (!record) return $('status').replaceChildren(part('quiet', mode.idle ?? 'loading'));
  const newest = records.length - 1;
  const hatch = record.inverted > 0 ? [part('hatch')] : [];
  const rate = mode.playing ? mode.rate : undefined;
  const time = rate ? `${Math.round(rate)} steps a second` : `${number(stepMilliseconds(records, shown), 2)} ms`;
  const parts = [
    part('quiet', record.where ?? `iteration ${record.iteration}${newest > shown ? ` of ${records[newest].iteration}` : ''}`),
    ...(record.energyText === '' ? [] : [part(record.where ? 'detail' : '', ...(record.lead ? [record.lead, part('lead', ' is lowest,'), ' '] : []), record.energyText ?? `energy ${number(record.energy)}`)]),
    record.fate
      ? part(`inverted ${record.fate.good ? 'good' : ''}`, record.fate.text)
      : part(`inverted ${record.inverted > 0 ? 'bad' : 'good'}`, ...hatch, `${whole(record.inverted)} inverted`),
    ...(record.touching ?? []).map((words, i) => part(i === 0 && record.meeting > 0 ? 'touching bad' : 'touching quiet', words)),
    ...(record.iteration > 0 && !record.where ? [part('quiet time', time)] : []),
  ];
  $('status').replaceChildren(...parts.flatMap((element, i) => (i ? [part('dot', ' · '), element] : [element])));
  const handle = $('history');
  handle.max = String(newest);
  handle.value = String(shown);
  handle.setAttribute('aria-valuetext', spoken(record));
}

function stepMilliseconds(records, shown) {
  const record = records[shown];
  const phases = (record.phases ?? []).reduce((sum, phase) => sum + phase.milliseconds, 0);
  const before = records[shown - 1];
  return phases || (before ? 1000 * (record.seconds - before.seconds) : 0);
}

let lastSpoken = 0;
/** Says something to a screen reader: `now`, or at most every two seconds. */
export function speak(text, { now }) {
  const time = performance.now();
  if (!now && time - lastSpoken < 2000) return;
  lastSpoken = time;
  $('spoken').textContent = text;
}
