// The page: connects the controls, the canvas, the solver, and the modes.
import { load } from '../pkg/index.js';
import { MODES, MOST_STEPS, modeOf } from './address.js';
import { startCanvas } from './canvas.js';
import { Compare } from './compare.js';
import { Deform } from './deform.js';
import { acceptDrops } from './files.js';
import { Flatten } from './flatten.js';
import { listenToKeys } from './keys.js';
import { nextFrame } from './mode.js';
import { clearNotice, describe, notice } from './notice.js';
import { Round } from './round.js';
import { connectSight } from './sight.js';
import { drawStatus } from './status.js';
import { Untangle } from './untangle.js';
import { connectViews, flip, flipTheme, follow, nameViews, project, projecting } from './views.js';

const $ = (id) => document.getElementById(id);

/** What the modes share. */
const page = { canvas: undefined, foldfree: undefined, active: undefined, busy: setBusy };
const modes = { flatten: new Flatten(page), deform: new Deform(page), untangle: new Untangle(page), round: new Round(page) };
modes.compare = new Compare(page, modes.flatten);
page.active = modes[modeOf()];

function setBusy(text, progress) {
  const box = $('loading');
  box.hidden = !text;
  if (!text) return;
  $('loading-text').textContent = text;
  if (progress === undefined) $('loading-bar').removeAttribute('value');
  else $('loading-bar').value = progress;
}

// ——— modes ———

/** Shows what belongs to the active mode. */
function dress() {
  const { active } = page;
  const { accepts, dropHere, views, label } = active.constructor;
  document.body.dataset.mode = active.name;
  for (const element of document.querySelectorAll('[data-for]')) element.hidden = !element.dataset.for.split(' ').includes(active.name);
  for (const button of document.querySelectorAll('[data-mode-button]')) {
    if (button.dataset.modeButton === active.name) button.setAttribute('aria-current', 'page');
    else button.removeAttribute('aria-current');
  }
  $('file').accept = accepts;
  $('drop').firstElementChild.textContent = dropHere;
  nameViews(views, active.constructor.first);
  $('canvas').setAttribute('aria-label', label);
  page.canvas?.mode(active.name);
}

/** Another mode; what lies on the bench of this one stays there. */
async function switchTo(name) {
  if (page.active.name === name) return;
  page.active.leave();
  page.active = modes[name];
  const { active } = page;
  clearNotice();
  dress();
  active.enter();
  active.remember();
  $('invite').hidden = true;
  if (active.records.length) {
    active.show(active.shown);
    active.invite();
  } else {
    drawStatus(active);
  }
  if (!active.session?.ready) await enter();
}

const arriving = {}; // the modes' first problems, while they are put on their benches

/** Puts the active mode's first problem on its bench. */
async function enter() {
  const { active } = page;
  const drawn = page.canvas ? await active.prepare() : false;
  document.body.dataset.drawn = drawn ? 'prepared' : 'empty';
  if (!page.foldfree) return drawn;
  active.busy(drawn ? '' : 'Preparing the problem');
  arriving[active.name] ??= active.arrive(page.foldfree).finally(() => { arriving[active.name] = undefined; });
  const opened = await arriving[active.name];
  active.busy('');
  return opened || drawn;
}

// ——— controls ———

async function exporting(id) {
  $('export-menu').hidePopover();
  const { active } = page;
  if (!active.whenReady(() => exporting(id))) return;
  try {
    await active.exports[id]();
  } catch (error) {
    notice('Nothing was exported', describe(error));
  }
}

async function share() {
  const { active } = page;
  const { notShared = '', shown, source } = active;
  // Steps are made again by whoever opens the link: only what follows from the address, and not for too long.
  active.remember({ steps: shown > 0 && shown <= MOST_STEPS && !notShared ? shown : undefined });
  const stays = source.bytes ? 'It has the solver and its settings; the file stays with you.' : notShared;
  let title = 'The link is copied';
  try {
    await navigator.clipboard.writeText(location.href);
  } catch {
    title = 'The link is in the address bar';
  }
  notice(title, stays || location.href, { plain: true });
}

function connect() {
  const act = (name, ...args) => () => page.active[name]?.(...args);
  const hand = (name, ...args) => () => page.active.hands?.[name](...args);
  const show = (where) => () => page.active.scrub(where(page.active));
  for (const mode of Object.values(modes)) mode.connect();
  connectSight(() => page.active);
  for (const button of document.querySelectorAll('[data-mode-button]')) {
    button.addEventListener('click', () => switchTo(button.dataset.modeButton));
  }
  $('play').addEventListener('click', act('play'));
  $('unfold').addEventListener('click', () => { $('play').focus(); page.active.play(); });
  $('step').addEventListener('click', act('steps', 1));
  $('step-ten').addEventListener('click', act('steps', 10));
  $('reset').addEventListener('click', act('reset'));
  $('history').addEventListener('input', () => page.active.scrub(Number($('history').value)));
  $('open').addEventListener('click', () => $('file').click());
  $('file').addEventListener('change', () => {
    const files = [...$('file').files];
    $('file').value = '';
    if (files.length) page.active.openFiles(files);
  });
  acceptDrops($('drop'), (files) => page.active.openFiles(files));
  for (const id of ['export-obj', 'export-solid', 'export-csv', 'export-trace', 'export-sys']) $(id).addEventListener('click', () => exporting(id));
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
  const digits = Array.from({ length: 9 }, (_, i) => [String(i + 1), () => page.active.pickMethod(i)]);
  listenToKeys({
    ' ': act('play'), ArrowRight: act('steps', 1), 'Shift+ArrowRight': act('steps', 10),
    ArrowLeft: show((mode) => mode.shown - 1), 'Shift+ArrowLeft': show((mode) => mode.shown - 10),
    Home: show(() => 0), End: show((mode) => mode.records.length - 1),
    r: act('reset'), f: () => page.canvas?.fit(), w: () => flip('wireframe'), c: () => flip('tinted'), e: () => flip('gap'), x: () => flip('seconds'),
    p: project, t: flipTheme, o: () => $('file').click(), '?': help, Escape: () => { clearNotice(); if (projecting()) project(); },
    m: () => switchTo(MODES[(MODES.indexOf(page.active.name) + 1) % MODES.length]),
    g: act('further'),
    s: () => (page.active.nextState ? page.active.nextState() : page.active.setClock?.(page.active.wanted.clock === 'seconds' ? 'iterations' : 'seconds')),
    h: hand('next'), j: hand('nudge', -1, 0), l: hand('nudge', 1, 0), i: hand('nudge', 0, 1), k: hand('nudge', 0, -1),
    u: hand('twist', -1), y: hand('twist', 1), b: hand('nextPlace'), n: hand('pinPlace'), Delete: hand('release', false), Backspace: hand('release', false),
    ...Object.fromEntries(digits),
  }, ['g']);
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
  dress();
  for (const mode of Object.values(modes)) mode.reflect();
  setBusy('Loading the drawing board');
  try {
    const listen = (name, value) => { if (name === 'show') page.active.scrub(value); else page.active.listen?.(name, value); };
    page.canvas = await startCanvas($('canvas'), listen, (part) => setBusy('Loading the drawing board', part));
  } catch (error) {
    setBusy('');
    return notice('The drawing board did not start', `${describe(error)} The page needs WebGL 2 and WebAssembly.`);
  }
  quietCanvas();
  follow(page.canvas);
  page.canvas.mode(page.active.name);
  const drawn = await enter();
  setBusy(drawn ? '' : 'Loading the solver');
  await nextFrame();

  try {
    const progress = (loaded, total) => { if (!drawn) setBusy('Loading the solver', total ? loaded / total : undefined); };
    page.foldfree = await load({ onProgress: progress });
  } catch (error) {
    setBusy('');
    return notice('The solver did not load', `${describe(error)} Reload the page to try again.`);
  }
  const opened = await enter();
  document.body.dataset.solver = opened ? 'ready' : 'failed';
}

// For the console, and for tests.
globalThis.foldfreePage = {
  get board() { return page.canvas?.canvas; },
  get bench() { return page.active.bench.handle; },
  get mode() { return page.active; },
  get session() { return page.active.session; },
  get shown() { return page.active.shown; },
};

begin();
