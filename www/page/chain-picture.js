// A chain of integers: which was rounded when, to what, and how far the others moved.
import { HEIGHT } from './round-problems.js';
import { arrow, followArrows, followPointer, list, px, svg } from './svg.js';
import { number } from './words.js';

const NUDGE = 0.05;
const REACH = 24;
/** Values below and above the places of the points. */
const [LOW, HIGH] = [-1, HEIGHT + 1];
/** Movements are drawn on a log scale between these. */
const [LEAST, MOST] = [1e-4, 1];
/** Around and between the parts, for text of the usual size. */
const MARGIN = { left: 44, right: 16, top: 12, between: 42, bars: 62, bottom: 22 };

export class ChainPicture {
  #size = { width: 600, height: 400 };
  #below = svg('g');
  #handles = svg('g');
  #above = svg('g', { 'pointer-events': 'none' });
  #minimum = [];
  #margin = MARGIN;
  #chosen = 0;
  #held = 0;
  element = svg('svg', { class: 'picture', role: 'group', 'aria-label': 'A chain of integers: places, values, the order of the roundings, and how far each point moved' });

  /** `aim(minimum)` is told where all the points are wanted. */
  constructor(aim) {
    this.aim = aim;
    this.element.append(this.#below, this.#handles, this.#above);
    followPointer(this.element, {
      grab: (at) => {
        const far = this.#minimum.map((m, i) => Math.hypot(this.#x(i) - at[0], this.#y(m) - at[1]));
        this.#held = far.indexOf(Math.min(...far));
        if (!(far[this.#held] < REACH)) return false;
        this.#choose(this.#held);
        return true;
      },
      drag: ([, y]) => this.#put(this.#held, this.#value(y)),
    });
  }

  #x(i) {
    const { width } = this.#size;
    return this.#margin.left + ((i + 0.5) * (width - this.#margin.left - this.#margin.right)) / Math.max(this.#minimum.length, 1);
  }

  /** Below this the bars begin. */
  get #floor() { return this.#size.height - this.#margin.bottom - this.#margin.bars - this.#margin.between; }
  #y(value) { return this.#floor - ((value - LOW) * (this.#floor - this.#margin.top)) / (HIGH - LOW); }
  #value(y) { return LOW + ((this.#floor - y) * (HIGH - LOW)) / (this.#floor - this.#margin.top); }

  #put(index, value) {
    const next = [...this.#minimum];
    next[index] = Math.min(Math.max(value, LOW + 0.4), HIGH - 0.4);
    this.#minimum = next;
    this.aim(next);
  }

  /** Moves the chosen point by a key's step. */
  nudge(dx, dy) {
    if (dx) return this.next(dx);
    this.#put(this.#chosen, Math.round((this.#minimum[this.#chosen] + NUDGE * dy) / NUDGE) * NUDGE);
  }

  next(by = 1) {
    this.#choose((this.#chosen + by + this.#minimum.length) % this.#minimum.length);
    this.#handles.children[this.#chosen]?.focus();
  }

  #choose(index) {
    this.#chosen = index;
    [...this.#handles.children].forEach((handle, i) => handle.setAttribute('tabindex', i === index ? 0 : -1));
  }

  draw(session, shown, size) {
    this.#size = size;
    const scale = Number(getComputedStyle(this.element).getPropertyValue('--scale')) || 1;
    this.#margin = Object.fromEntries(Object.entries(MARGIN).map(([side, margin]) => [side, margin * scale]));
    this.#minimum = session.minimum;
    const { width, height } = size;
    this.element.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#drawHandles();
    const { path } = session;
    const now = path[Math.min(shown, path.length - 1)];
    const before = path[Math.max(Math.min(shown, path.length - 1) - 1, 0)];
    this.#below.replaceChildren(...this.#grid(), svg('polyline', { class: 'places', points: list(session.minimum.map((m, i) => [this.#x(i), this.#y(m)])) }));
    this.#above.replaceChildren(...this.#optimum(session, shown), ...this.#values(path, shown, now, before), ...this.#bars(path, shown, now, before));
  }

  #drawHandles() {
    const n = this.#minimum.length;
    if (this.#handles.children.length !== n) {
      this.#chosen = Math.min(this.#chosen, n - 1);
      this.#handles.replaceChildren(...this.#minimum.map((_, i) => {
        const handle = svg('g', { class: 'handle', role: 'slider', 'aria-orientation': 'vertical', 'aria-label': `Place of point ${i + 1}`, 'aria-valuemin': LOW, 'aria-valuemax': HIGH },
          svg('circle', { class: 'halo', r: 11 }), svg('circle', { class: 'place', r: 4.5 }));
        followArrows(handle, (dx, dy) => this.nudge(dx, dy));
        return handle;
      }));
      this.#choose(this.#chosen);
    }
    this.#minimum.forEach((m, i) => {
      const handle = this.#handles.children[i];
      handle.setAttribute('transform', `translate(${px(this.#x(i))} ${px(this.#y(m))})`);
      handle.setAttribute('aria-valuenow', String(px(m)));
    });
  }

  #grid() {
    const { width } = this.#size;
    const lines = [];
    for (let v = LOW; v <= HIGH; v += 1) {
      const y = px(this.#y(v));
      lines.push(svg('line', { class: 'grid', x1: this.#margin.left, x2: width - this.#margin.right, y1: y, y2: y }));
      lines.push(svg('text', { class: 'tick', x: this.#margin.left - 8, y: y + 4, 'text-anchor': 'end' }, String(v).replace('-', '−')));
    }
    return lines;
  }

  /** Once all have values: where the optimum differs. */
  #optimum({ path, results, rounding }, shown) {
    if (rounding === 'lattice' || shown < path.length - 1) return [];
    const { x } = results.get('lattice');
    const mine = path.at(-1).x;
    if (mine.every((value, i) => Math.abs(value - x[i]) < 1e-6)) return [];
    return [svg('polyline', { class: 'optimum', 'data-method': 'lattice', points: list([...x].map((value, i) => [this.#x(i), this.#y(value)])) })];
  }

  /** The points: squares have their integer, discs still move. */
  #values(path, shown, now, before) {
    const order = roundedIn(path, shown);
    const at = (x, i) => [this.#x(i), this.#y(x[i])];
    const parts = [svg('polyline', { class: 'springs', points: list([...now.x].map((_, i) => at(now.x, i))) })];
    now.x.forEach((value, i) => {
      const [cx, cy] = at(now.x, i);
      const fixed = order.has(i) || now.remaining === 0;
      const isNew = shown > 0 && changedIn(now).has(i);
      if (Math.abs(before.x[i] - value) > 1e-3) parts.push(svg('path', { class: isNew ? 'moved new' : 'moved', d: arrow(at(before.x, i), [cx, cy], 6) }));
      parts.push(fixed
        ? svg('rect', { class: isNew ? 'value new' : 'value', x: px(cx - 5), y: px(cy - 5), width: 10, height: 10 })
        : svg('circle', { class: 'value free', cx: px(cx), cy: px(cy), r: 3.6 }));
      if (isNew && now.remaining > 0) parts.push(svg('circle', { class: 'ring best', cx: px(cx), cy: px(cy), r: 11 }));
      const rank = order.get(i);
      if (rank !== undefined) parts.push(svg('text', { class: isNew ? 'rank new' : 'rank', x: px(cx), y: px(this.#floor + 0.38 * this.#margin.between), 'text-anchor': 'middle' }, String(rank)));
    });
    if (order.size > 0) parts.push(svg('text', { class: 'tick', x: this.#margin.left - 8, y: px(this.#floor + 0.38 * this.#margin.between), 'text-anchor': 'end' }, 'step'));
    return parts;
  }

  /** How far each point moved in this step. */
  #bars(path, shown, now, before) {
    const { width, height } = this.#size;
    const base = height - this.#margin.bottom;
    const top = base - this.#margin.bars;
    const tall = (moved) => (Math.log(Math.min(Math.max(moved, LEAST), MOST) / LEAST) / Math.log(MOST / LEAST)) * this.#margin.bars;
    const parts = [
      svg('line', { class: 'grid', x1: this.#margin.left, x2: width - this.#margin.right, y1: base, y2: base }),
      svg('text', { class: 'tick', x: this.#margin.left, y: top - 6 }, 'moved in this step (log)'),
    ];
    for (const value of [1e-4, 1e-2, 1]) {
      const y = px(base - tall(value));
      parts.push(svg('text', { class: 'tick', x: this.#margin.left - 5, y: y + 4, 'text-anchor': 'end' }, value === 1 ? '1' : value.toString().replace('0.', '.')));
      if (value > LEAST) parts.push(svg('line', { class: 'grid faint', x1: this.#margin.left, x2: width - this.#margin.right, y1: y, y2: y }));
    }
    const step = this.#x(1) - this.#x(0);
    now.x.forEach((value, i) => {
      parts.push(svg('text', { class: 'tick', x: px(this.#x(i)), y: base + 0.7 * this.#margin.bottom, 'text-anchor': 'middle' }, step > 17 || i % 4 === 0 ? String(i + 1) : ''));
      const moved = Math.abs(value - before.x[i]);
      const size = shown > 0 ? tall(moved) : 0;
      if (size < 0.5) return;
      const wide = Math.min(0.6 * step, 22);
      const title = svg('title', {}, `point ${i + 1} moved by ${number(moved, 3)}`);
      parts.push(svg('rect', { class: changedIn(now).has(i) ? 'column new' : 'column', x: px(this.#x(i) - wide / 2), y: px(base - size), width: px(wide), height: px(size) }, title));
    });
    return parts;
  }
}

/** The points that a step gave a value. */
export const changedIn = ({ action }) => new Set((action.rounded ?? action.changed ?? []).map(({ unknown }) => unknown));

/** The points that have been rounded up to a step, and in which. */
function roundedIn(path, shown) {
  const order = new Map();
  path.slice(0, shown + 1).forEach((step, k) => {
    for (const { unknown } of step.action.rounded ?? []) order.set(unknown, k);
  });
  return order;
}
