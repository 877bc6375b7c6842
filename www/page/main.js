// The page: connects the controls, the canvas and the solver.
import { load } from '../pkg/index.js';
import { isDefault, readAddress, writeAddress } from './address.js';
import { preparedStart, startCanvas } from './canvas.js';
import { acceptDrops, readMeshFile, save } from './files.js';
import { listenToKeys } from './keys.js';
import { clearNotice, describe, notice } from './notice.js';
import { Session } from './session.js';
import { connectViews, flip, flipTheme, follow, project, projecting } from './views.js';
import { METHODS, ending, number, spoken, whole } from './words.js';

const $ = (id) => document.getElementById(id);
const nextFrame = () => new Promise((done) => requestAnimationFrame(done));

const wanted = readAddress(); // what the controls say
let source = { sample: wanted.sample, triangles: wanted.triangles }; // what is, or will be, on the bench
let board; // the canvas
let session; // the solver
let playing = false;
let shown = 0;
let records = []; // numbers of the iterates the canvas has, prepared start included
let startsWhenReady; // an act a person asked for before the solver had come

// ——— status ———

function setWhere(record) {
  const where = $('where');
  if (!record) return where.replaceChildren('loading');
  const newest = records.length - 1;
  const part = (className, ...children) => {
    const span = document.createElement('span');
    span.className = className;
    span.append(...children);
    return span;
  };
  const hatch = record.inverted > 0 ? [part('hatch')] : [];
  const parts = [
    part('quiet', `iteration ${record.iteration}${newest > record.iteration ? ` of ${newest}` : ''}`),
    part('', `energy ${number(record.energy)}`),
    part(`inverted ${record.inverted > 0 ? 'bad' : 'good'}`, ...hatch, `${whole(record.inverted)} inverted`),
    ...(record.iteration > 0 ? [part('quiet time', `${number(stepMilliseconds(record), 2)} ms`)] : []),
  ];
  $('status').replaceChildren(...parts.flatMap((element, i) => (i ? [part('dot', ' · '), element] : [element])));
  const handle = $('history');
  handle.max = String(newest);
  handle.value = String(shown);
  handle.setAttribute('aria-valuetext', spoken(record));
  handle.style.setProperty('--at', newest ? shown / newest : 0);
}

function stepMilliseconds(record) {
  const phases = (record.phases ?? []).reduce((sum, phase) => sum + phase.milliseconds, 0);
  const before = records[record.iteration - 1];
  return phases || (before ? 1000 * (record.seconds - before.seconds) : 0);
}

let lastSpoken = 0;
/** Says where we are to a screen reader: at once when at rest, every two seconds while playing. */
function speak(text, { now = !playing } = {}) {
  const time = performance.now();
  if (!now && time - lastSpoken < 2000) return;
  lastSpoken = time;
  $('spoken').textContent = text;
}

function show(index, { quietly = false } = {}) {
  if (!records.length) return;
  shown = Math.max(0, Math.min(index, records.length - 1));
  board?.show(shown);
  setWhere(records[shown]);
  if (!quietly) speak(spoken(records[shown]));
}

let soon;
/** Shows the newest iterate with the next frame, however many come until then. */
function showSoon() {
  shown = records.length - 1;
  if (document.hidden || session.finished) {
    cancelAnimationFrame(soon);
    soon = undefined;
    show(shown);
  } else soon ??= requestAnimationFrame(() => { soon = undefined; show(shown); });
}

function setFacts() {
  if (!session?.problem) return;
  const { startKind, setupSeconds, notes } = session.problem;
  const pairs = [
    ['surface', source.name ?? $('sample').selectedOptions[0]?.text ?? source.sample],
    ['start', startKind],
    ['setup', `${number(1000 * setupSeconds, 3)} ms`],
    ['threads', String(foldfreeThreads)],
    ...notes.map((text, i) => [i === 0 ? 'notes' : '', text]),
  ];
  const last = session.newest;
  if (session.finished) pairs.push(['ended', `${ending(last)} after ${last.iteration}`]);
  const proof = session.certificate;
  if (proof) {
    pairs.push(['certificate', proof.locallyInjective ? 'no triangle inverted (exact)' : `${proof.inverted.length} inverted (exact)`]);
    if (proof.locallyInjective) pairs.push(['', proof.globallyInjective ? 'nothing overlaps (exact)' : `${proof.boundaryCrossingCount || ''} boundary crossings (exact)`]);
  }
  board.facts(pairs);
}

// ——— the problem ———

let foldfreeThreads = 1;

function settings() {
  return { method: wanted.method, energy: wanted.energy, start: wanted.start };
}

function reflectControls() {
  for (const id of ['start', 'method', 'energy']) $(id).value = wanted[id];
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
  const direct = ['lscm', 'harmonic', 'tutte'].includes(wanted.method);
  $('start').disabled = direct;
  $('energy').disabled = direct || wanted.method === 'arap';
}

/** Solves `next` instead of what is on the bench; on failure the bench stays as it is. */
async function open(next = source, { busy = '' } = {}) {
  pause();
  const asked = { ...wanted };
  if (busy) setBusy(busy);
  try {
    const opened = await session.open({ source: next, settings: settings() });
    if (!opened) return false;
    source = next;
    const { start, surface } = opened;
    if (surface) board.surface(surface);
    board.begin(wanted.method, session.problem.startKind, wanted.energy);
    board.push(start);
    records = session.records;
    show(0);
    setFacts();
    clearNotice();
    remember();
    invite();
    good = { ...asked };
    return true;
  } catch (error) {
    const name = next.name ?? next.sample;
    notice(next === source ? `${METHODS[wanted.method]} could not start` : `${name} was not opened`, describe(error));
    Object.assign(wanted, good);
    if (records.length) show(shown, { quietly: true });
    return false;
  } finally {
    setBusy('');
    reflectControls();
  }
}
let good = { ...wanted };

function remember() {
  if (source.bytes) writeAddress({});
  else writeAddress({ ...wanted, sample: source.sample, triangles: source.triangles });
}

function setBusy(text, progress) {
  const box = $('loading');
  box.hidden = !text;
  if (!text) return;
  $('loading-text').textContent = text;
  if (progress === undefined) $('loading-bar').removeAttribute('value');
  else $('loading-bar').value = progress;
}

// ——— playing ———

function setPlaying(on) {
  playing = on;
  const button = $('play');
  button.classList.toggle('playing', on);
  button.setAttribute('aria-label', on ? 'Pause' : 'Play');
  if (on) $('invite').hidden = true;
}

function pause() {
  task += 1;
  if (!playing) return;
  setPlaying(false);
  if (records[shown]) speak(spoken(records[shown]), { now: true });
}

let task = 0; // what a person asked for last; anything older stops
let lastStep = Promise.resolve();
/** Makes one step after those asked for before it and shows it; false when there is none to make. */
function stepOnce() {
  lastStep = lastStep.then(makeStep);
  return lastStep;
}

async function makeStep() {
  try {
    const step = await session.step();
    if (!step) return false;
    const following = shown >= records.length - 2; // a person may have scrubbed away meanwhile
    board.push(step);
    if (session.finished) finish(step);
    if (following) showSoon();
    else setWhere(records[shown]);
    return !session.finished;
  } catch (error) {
    notice('The solver stopped', describe(error));
    return false;
  }
}

function finish(step) {
  setFacts();
  board.crossings(session.certificate?.boundaryCrossings ?? []);
  if (step.status !== 'converged') notice('The solver ended', `${ending(step)} after ${step.iteration} iterations.`, { plain: true });
}

async function play() {
  if (!whenReady(play)) return;
  if (playing) return pause();
  if (session.finished) {
    // Nothing left to solve: play the film again.
    if (shown >= records.length - 1) show(0);
    return film();
  }
  setPlaying(true);
  show(records.length - 1, { quietly: true });
  let due = performance.now();
  while (playing) {
    if (!(await stepOnce())) pause();
    const pace = Number($('pace').value);
    if (pace > 0) { // else as fast as it can: the worker steps, the page draws the newest every frame
      await nextFrame();
      due = Math.max(due + 1000 / pace, performance.now() - 100);
      while (playing && performance.now() < due) await nextFrame();
    }
  }
}

async function film() {
  setPlaying(true);
  while (playing && shown < records.length - 1) {
    const wait = 1000 / (Number($('pace').value) || 60);
    show(shown + 1);
    const until = performance.now() + wait;
    do await nextFrame(); while (playing && performance.now() < until);
  }
  pause();
}

async function steps(count) {
  if (!whenReady(() => steps(count))) return;
  pause();
  $('invite').hidden = true;
  if (shown < records.length - 1) return show(shown + count);
  const mine = task;
  for (let i = 0; i < count && mine === task; i += 1) {
    if (!(await stepOnce())) break;
  }
}

async function reset() {
  if (!whenReady(reset)) return;
  await open();
}

/** Whether the solver is there; if not, `act` is done when it is. */
function whenReady(act) {
  if (session?.ready) return true;
  startsWhenReady = act;
  $('invite').hidden = true;
  if (board) setBusy('Loading the solver');
  return false;
}

function invite() {
  const start = records[0];
  $('invite').hidden = !start || records.length > 1;
  if (!start) return;
  const name = METHODS[wanted.method];
  const direct = $('start').disabled;
  $('unfold').textContent = start.inverted > 0 && !direct ? 'Unfold' : 'Flatten';
  $('invite-text').textContent = direct
    ? `${name} has no iterations: one linear system.`
    : start.inverted > 0
      ? `${whole(start.inverted)} triangles lie upside down in this map. ${name} will turn them.`
      : `Nothing is upside down in this map. ${name} will make it less distorted.`;
}

// ——— controls ———

async function change(key, value) {
  wanted[key] = value;
  reflectControls();
  if (!whenReady(() => open())) return;
  await open(source);
}

async function changeSample() {
  const next = { sample: $('sample').value, triangles: Number($('triangles').value) };
  if (!next.sample) return;
  [wanted.sample, wanted.triangles] = [next.sample, next.triangles];
  if (!whenReady(() => open(next))) return;
  await open(next, { busy: next.triangles > 10_000 ? 'Building the surface' : '' });
}

/** The library knows its samples best. */
function listSamples(shapes) {
  const options = [...$('sample').options];
  for (const { name, title, description } of shapes) {
    const option = options.find((o) => o.value === name) ?? new Option(title, name);
    option.title = description;
    if (!option.parentNode) $('sample').add(option);
  }
}

async function openFile(file) {
  if (!whenReady(() => openFile(file))) return;
  setBusy(`Reading ${file.name}`);
  let next;
  try {
    next = await readMeshFile(file);
  } catch (error) {
    setBusy('');
    return notice(`${file.name} was not opened`, describe(error));
  }
  if (wanted.start === 'random' || wanted.start === 'collapsed') wanted.start = 'automatic';
  await open(next, { busy: `Reading ${file.name}` });
}

async function exporting(act) {
  $('export-menu').hidePopover();
  if (!whenReady(() => exporting(act))) return;
  try {
    await act((source.name ?? source.sample).replace(/\.(obj|off|ply|stl|mesh|msh|vtk)(\.gz)?$/i, ''));
  } catch (error) {
    notice('Nothing was exported', describe(error));
  }
}

const exportObj = () =>
  exporting(async (name) => save(await session.exportObj(), `${name}-${wanted.method}.obj`, 'model/obj'));
const exportTrace = () =>
  exporting(async (name) =>
    save(`${JSON.stringify(await session.trace(), null, 1)}\n`, `${name}-${wanted.method}.json`, 'application/json'));

async function share() {
  if (source.bytes) notice('A link cannot carry a file', 'It has the solver and its settings; the file stays with you.', { plain: true });
  else writeAddress({ ...wanted, sample: source.sample, triangles: source.triangles, at: shown || undefined });
  try {
    await navigator.clipboard.writeText(location.href);
    if (!source.bytes) notice('The link is copied', location.href, { plain: true });
  } catch {
    notice('The link is in the address bar', location.href, { plain: true });
  }
}

function connect() {
  $('play').addEventListener('click', play);
  $('unfold').addEventListener('click', () => { $('play').focus(); play(); });
  $('step').addEventListener('click', () => steps(1));
  $('step-ten').addEventListener('click', () => steps(10));
  $('reset').addEventListener('click', reset);
  $('history').addEventListener('input', () => {
    pause();
    show(Number($('history').value));
  });
  for (const id of ['start', 'method', 'energy']) $(id).addEventListener('change', () => change(id, $(id).value));
  for (const id of ['sample', 'triangles']) $(id).addEventListener('change', changeSample);
  $('open').addEventListener('click', () => $('file').click());
  $('file').addEventListener('change', () => {
    const [file] = $('file').files;
    $('file').value = '';
    if (file) openFile(file);
  });
  acceptDrops($('drop'), openFile);
  $('export-obj').addEventListener('click', exportObj);
  $('export-trace').addEventListener('click', exportTrace);
  $('export-menu').addEventListener('beforetoggle', () => {
    const at = $('export').getBoundingClientRect();
    const style = $('export-menu').style;
    style.top = `${at.bottom + 4}px`;
    style.left = 'auto';
    style.right = `${Math.max(8, innerWidth - at.right)}px`;
  });
  $('share').addEventListener('click', share);
  $('help').addEventListener('click', help);
  $('setup-toggle').addEventListener('click', () => {
    const shownNow = $('setup').classList.toggle('shown');
    $('setup-toggle').setAttribute('aria-expanded', String(shownNow));
  });
  connectViews();
  const methods = Object.keys(METHODS);
  listenToKeys({
    ' ': play, ArrowRight: () => steps(1), 'Shift+ArrowRight': () => steps(10),
    ArrowLeft: () => { pause(); show(shown - 1); }, 'Shift+ArrowLeft': () => { pause(); show(shown - 10); },
    Home: () => { pause(); show(0); }, End: () => { pause(); show(records.length - 1); },
    r: reset, f: () => board?.fit(), w: () => flip('wireframe'), c: () => flip('tinted'), e: () => flip('gap'), x: () => flip('seconds'),
    p: project, t: flipTheme, o: () => $('file').click(), '?': help, Escape: () => { clearNotice(); if (projecting()) project(); },
    ...Object.fromEntries(methods.map((method, i) => [String(i + 1), () => change('method', method)])),
  });
}

function help() {
  const dialog = $('help-dialog');
  if (dialog.open) dialog.close();
  else dialog.showModal();
}

// ——— the beginning ———

/** The canvas wants neither the focus nor the keyboard: the page has its keys. */
function quietCanvas() {
  for (const agent of document.querySelectorAll('body > input, #stage > input')) agent.inert = true;
  $('canvas').tabIndex = -1;
  $('canvas').blur();
}

async function begin() {
  connect();
  reflectControls();
  setBusy('Loading the drawing board');
  const asIs = isDefault(wanted);
  const prepared = asIs ? preparedStart().catch(() => undefined) : undefined;
  try {
    const listen = (name, value) => { if (name === 'show') { pause(); show(value); } };
    board = await startCanvas($('canvas'), listen, (part) => setBusy('Loading the drawing board', part));
  } catch (error) {
    setBusy('');
    return notice('The drawing board did not start', `${describe(error)} The page needs WebGL 2 and WebAssembly.`);
  }
  quietCanvas();
  follow(board);

  const drawn = await prepared;
  if (drawn) {
    board.surface(drawn);
    board.begin(wanted.method, 'random', wanted.energy);
    board.push(drawn.start);
    records = [drawn.start];
    show(0);
    invite();
    setBusy('');
  }
  document.body.dataset.drawn = drawn ? 'prepared' : 'empty';
  await nextFrame();
  if (!drawn) setBusy('Loading the solver');

  try {
    const foldfree = await load({ onProgress: (loaded, total) => { if (!drawn) setBusy('Loading the solver', total ? loaded / total : undefined); } });
    foldfreeThreads = foldfree.threads;
    listSamples(foldfree.shapes);
    session = new Session(foldfree);
  } catch (error) {
    setBusy('');
    return notice('The solver did not load', `${describe(error)} Reload the page to try again.`);
  }
  const opened = await open(source);
  document.body.dataset.solver = opened ? 'ready' : 'failed';
  if (!opened && !drawn) return;
  const act = startsWhenReady;
  startsWhenReady = undefined;
  if (act) await act();
  else if (wanted.at) await steps(wanted.at);
}

// For the console, and for tests.
globalThis.foldfreePage = {
  get board() { return board?.canvas; },
  get session() { return session; },
  get shown() { return shown; },
};

begin();
