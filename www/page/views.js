// Theme, tabs, projector, switches: how the bench is looked at.

import { notice } from './notice.js';

const $ = (id) => document.getElementById(id);
let board; // the canvas, once it is there

/** The canvas follows from now on. */
export function follow(canvas) {
  board = canvas;
  board.theme(isDark());
  board.reducedMotion(still.matches);
  arrange();
}

const still = matchMedia('(prefers-reduced-motion: reduce)');
still.addEventListener('change', () => board?.reducedMotion(still.matches));

const darkScheme = matchMedia('(prefers-color-scheme: dark)');
const isDark = () => (document.documentElement.dataset.theme ?? (darkScheme.matches ? 'dark' : 'light')) === 'dark';
darkScheme.addEventListener('change', () => board?.theme(isDark()));

/** Light becomes dark, and says so in the address. */
export function flipTheme() {
  const theme = isDark() ? 'light' : 'dark';
  document.documentElement.dataset.theme = theme;
  const asked = new URLSearchParams(location.search);
  asked.set('theme', theme);
  history.replaceState(null, '', `?${asked}`);
  board?.theme(theme === 'dark');
}

const narrow = matchMedia('(max-width: 719.98px)');
let tab = 'map'; // the view a phone shows
let pane = 0; // of several maps the one a phone shows
let choosePane = () => {};

/** Lays out for the size of the window. */
function arrange() {
  board?.view(narrow.matches ? tab : 'all');
  const wide = innerWidth >= 1000;
  const box = $('invite').style;
  // Over the middle of the map, a little above its middle; below the whole solid, which has to be seen.
  const { mode } = document.body.dataset;
  const deforming = mode === 'deform' || mode === 'untangle';
  const comparing = mode === 'compare';
  const rounding = mode === 'round';
  const column = wide && !narrow.matches && !projecting() ? 292 : 0;
  box.setProperty('--invite-x', narrow.matches ? '50%' : `calc((100% - ${column}px) * ${comparing || rounding ? 0.5 : deforming ? 0.25 : 0.75})`);
  // The plot below the views has at most 250 points (layout.rs).
  const low = narrow.matches ? 'calc(100% - 86px)' : 'calc(100% - clamp(130px, 30%, 250px) - 74px)';
  // Where solvers are compared: in the middle of the plot, which is empty yet.
  if (comparing) box.setProperty('--invite-y', 'calc(100% - clamp(150px, 46%, 340px) / 2)');
  else if (rounding) box.setProperty('--invite-y', narrow.matches ? 'calc(50% - 74px)' : 'calc(100% - 74px)');
  else box.setProperty('--invite-y', deforming ? low : narrow.matches ? '50%' : '34%');
}

/** Shows one view, on a phone. */
function choose(view, index = 0) {
  tab = view;
  pane = index;
  choosePane(index);
  document.body.dataset.tab = view;
  for (const button of document.querySelectorAll('[role="tab"]')) {
    const on = button.dataset.view === view && Number(button.dataset.pane ?? index) === index;
    button.setAttribute('aria-selected', String(on));
    button.tabIndex = on ? 0 : -1;
  }
  arrange();
}

/** The names of the views on a phone's tabs, and the one that is shown first. */
export function nameViews(names, first) {
  choosePane = () => {};
  for (const button of $('view-tabs').children) button.textContent = names[button.dataset.view];
  choose(first);
}

/** Tabs for several maps, by their names, and for the numbers; `show(index)` is told which is chosen. */
export function showPanes(names, show) {
  const make = (text, data) => {
    const button = Object.assign(document.createElement('button'), { type: 'button', textContent: text });
    button.setAttribute('role', 'tab');
    button.setAttribute('aria-controls', 'stage');
    Object.assign(button.dataset, data);
    return button;
  };
  const maps = names.map((name, index) => make(name, { view: 'map', pane: String(index) }));
  $('pane-tabs').replaceChildren(...maps, make('Numbers', { view: 'inspector' }));
  choosePane = show;
  choose(tab === 'inspector' ? tab : 'map', pane < names.length ? pane : 0);
}

/** Views only, text at double size; or back. */
export function project() {
  const on = document.body.classList.toggle('projecting');
  $('projector').setAttribute('aria-pressed', String(on));
  board?.projector(on ? 1.9 : 1, !on);
  arrange();
  if (on) notice('Projector', 'P or Esc brings the controls back.', { plain: true });
}

/** Turns a switch of the canvas: `wireframe`, `tinted`, `gap`, `seconds`. */
export function flip(name) {
  board?.toggle(name);
}

/** Whether only the views are shown. */
export const projecting = () => document.body.classList.contains('projecting');

/** Connects the controls of the views. */
export function connectViews() {
  $('theme').addEventListener('click', flipTheme);
  $('projector').addEventListener('click', project);
  const pick = (button) => choose(button.dataset.view, Number(button.dataset.pane ?? 0));
  for (const list of document.querySelectorAll('[role="tablist"]')) {
    list.addEventListener('click', (event) => {
      const button = event.target.closest('[role="tab"]');
      if (button) pick(button);
    });
    list.addEventListener('keydown', (event) => {
      const turn = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
      if (!turn) return;
      const tabs = [...list.children];
      const next = tabs[(tabs.findIndex((button) => button.getAttribute('aria-selected') === 'true') + turn + tabs.length) % tabs.length];
      pick(next);
      next.focus();
    });
  }
  narrow.addEventListener('change', arrange);
  addEventListener('resize', arrange);
}
