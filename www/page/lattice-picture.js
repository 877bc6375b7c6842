// Two integers as a picture: level lines, the lattice, and where each rounding goes (figure 1 of Bommes et al. 2010).
import { WINDOW } from './round-problems.js';
import { ROUNDINGS } from './round-session.js';
import { arrow, followArrows, followPointer, list, px, svg } from './svg.js';
import { ROUNDING_NAMES, number } from './words.js';

/** Steps between level lines: f − min f = ½ r², r = 1, 2, … of these. */
const LEVEL = 0.5;
const LEVELS = 14;
/** How far from the minimum a pointer may take hold of it, in pixels. */
const REACH = 26;
const NUDGE = 0.05;

/** The level line ½ (x − m)ᵀ A (x − m) = `level`: half axes and turn of its ellipse. */
function ellipse([[a, b], [, c]], level) {
  const [mean, half] = [(a + c) / 2, Math.hypot((a - c) / 2, b)];
  // The long axis belongs to the small eigenvalue.
  const turn = half < 1e-12 ? 0 : 0.5 * Math.atan2(-2 * b, c - a);
  return { long: Math.sqrt((2 * level) / (mean - half)), short: Math.sqrt((2 * level) / (mean + half)), turn };
}

export class LatticePicture {
  #scale = 60;
  #origin = [0, 0];
  #below = svg('g');
  #above = svg('g', { 'pointer-events': 'none' });
  #handle = svg('g', { class: 'handle', tabindex: 0, role: 'slider', 'aria-label': 'Minimum without integrality' },
    svg('circle', { class: 'halo', r: 15 }), svg('path', { class: 'cross', d: 'M-7 -7L7 7M-7 7L7 -7' }));
  element = svg('svg', { class: 'picture', role: 'group', 'aria-label': 'Two integers: level lines of the energy, the integer points, and what each rounding finds' });
  #minimum = [0, 0];

  /** `aim([x, y])` is told where the minimum is wanted. */
  constructor(aim) {
    this.element.append(this.#below, this.#handle, this.#above);
    this.aim = ([x, y]) => {
      const { left, right, low, high, margin } = WINDOW;
      aim([Math.min(Math.max(x, left + margin), right - margin), Math.min(Math.max(y, low + margin), high - margin)]);
    };
    let offset = [0, 0];
    followPointer(this.element, {
      grab: (at) => {
        const here = this.#to(this.#minimum);
        offset = [here[0] - at[0], here[1] - at[1]];
        return Math.hypot(...offset) < REACH;
      },
      drag: (at) => this.aim(this.#from([at[0] + offset[0], at[1] + offset[1]])),
    });
    followArrows(this.#handle, (dx, dy) => this.nudge(dx, dy));
  }

  /** Moves the minimum by a key's step. */
  nudge(dx, dy) {
    const [x, y] = this.#minimum;
    this.aim([Math.round((x + NUDGE * dx) / NUDGE) * NUDGE, Math.round((y + NUDGE * dy) / NUDGE) * NUDGE]);
  }

  /** There is but one handle. */
  next() { this.#handle.focus(); }

  #to([x, y]) { return [this.#origin[0] + this.#scale * x, this.#origin[1] - this.#scale * y]; }
  #from([x, y]) { return [(x - this.#origin[0]) / this.#scale, (this.#origin[1] - y) / this.#scale]; }

  /** Draws for a picture of `width` × `height` pixels. */
  draw(session, shown, { width, height }) {
    const { left, right, low, high } = WINDOW;
    this.element.setAttribute('viewBox', `0 0 ${width} ${height}`);
    this.#scale = Math.min(width / (right - left), height / (high - low));
    this.#origin = [width / 2 - (this.#scale * (left + right)) / 2, height / 2 + (this.#scale * (low + high)) / 2];
    this.#minimum = session.minimum;
    const [cx, cy] = this.#to(session.minimum);
    this.#handle.setAttribute('transform', `translate(${px(cx)} ${px(cy)})`);
    const said = session.minimum.map((x) => number(x, 3)).join(', ');
    this.#handle.setAttribute('aria-valuetext', said);
    this.#handle.setAttribute('aria-valuenow', String(px(session.minimum[0])));
    this.#below.replaceChildren(...this.#levels(session, cx, cy), ...this.#lattice(width, height));
    this.#above.replaceChildren(...this.#ways(session, shown), ...this.#found(session, width));
  }

  #levels({ problem, results, rounding }, cx, cy) {
    const line = (level, attributes) => {
      const { long, short, turn } = ellipse(problem.matrix, level);
      const radians = -turn; // the screen's y axis points down
      return svg('ellipse', {
        cx: px(cx), cy: px(cy), rx: px(long * this.#scale), ry: px(short * this.#scale),
        transform: `rotate(${px((radians * 180) / Math.PI)} ${px(cx)} ${px(cy)})`, ...attributes,
      });
    };
    const even = Array.from({ length: LEVELS }, (_, k) => line(0.5 * (LEVEL * (k + 1)) ** 2, { class: 'level' }));
    const { energy, report } = results.get(rounding);
    const through = line(Math.max(energy - report.relaxedEnergy, 0), { class: 'through', 'data-method': rounding });
    return [...even, through];
  }

  #lattice(width, height) {
    const [[left, high], [right, low]] = [this.#from([0, 0]), this.#from([width, height])];
    const dots = [];
    for (let x = Math.ceil(left); x <= right; x += 1) {
      for (let y = Math.ceil(low); y <= high; y += 1) {
        const [cx, cy] = this.#to([x, y]);
        dots.push(svg('circle', { class: 'dot', cx: px(cx), cy: px(cy), r: 2.6 }));
        if (y === Math.ceil(low) && cx > 24) dots.push(svg('text', { class: 'tick', x: px(cx), y: height - 6, 'text-anchor': 'middle' }, String(x).replace('-', '−')));
        if (x === Math.ceil(left) && cy < height - 22) dots.push(svg('text', { class: 'tick', x: 6, y: px(cy + 4) }, String(y).replace('-', '−')));
      }
    }
    return dots;
  }

  /** The way of the rounding on show: done, what is to come, and the line on which an integer has been fixed. */
  #ways({ path, rounding }, shown) {
    const points = path.map(({ x }) => this.#to(x));
    const parts = [];
    const fixed = path[shown]?.remaining === 1 ? path[shown].action.rounded?.[0] : undefined;
    if (fixed) {
      const { left, right, low, high } = WINDOW;
      const ends = fixed.unknown === 0 ? [[fixed.to, low], [fixed.to, high]] : [[left, fixed.to], [right, fixed.to]];
      parts.push(svg('polyline', { class: 'fixed', points: list(ends.map((end) => this.#to(end))) }));
    }
    for (let k = 1; k < points.length; k += 1) {
      const done = k <= shown;
      const d = arrow(points[k - 1], points[k], done ? 9 : 0);
      if (d) parts.push(svg('path', { class: done ? 'way' : 'way to-come', d, 'data-method': rounding }));
    }
    const [x, y] = points[Math.min(shown, points.length - 1)];
    if (shown > 0) parts.push(svg('circle', { class: 'here', cx: px(x), cy: px(y), r: 6, 'data-method': rounding }));
    return parts;
  }

  /** What each rounding finds: a ring and the names of those that find the same. */
  #found({ results }, width) {
    const groups = new Map();
    for (const rounding of ROUNDINGS) {
      const { x } = results.get(rounding);
      groups.set(x.join(), [...(groups.get(x.join()) ?? []), rounding]);
    }
    return [...groups.values()].flatMap((names) => {
      const { x, energy, report } = results.get(names[0]);
      const [cx, cy] = this.#to(x);
      const best = names.includes('lattice');
      const all = names.map((name) => ROUNDING_NAMES[name]).join(', ');
      const words = best ? (width < 520 ? 'optimum' : `${all}: the optimum`) : all;
      const side = cx + 15 + 7.5 * words.length > width ? -1 : 1;
      const anchor = side > 0 ? 'start' : 'end';
      return [
        svg('circle', { class: best ? 'ring best' : 'ring', cx: px(cx), cy: px(cy), r: best ? 11 : 9, 'data-method': best ? 'lattice' : names.at(-1) }),
        svg('text', { class: 'label', x: px(cx + 15 * side), y: px(cy - 8), 'text-anchor': anchor, 'data-method': best ? 'lattice' : names.at(-1) }, words),
        svg('text', { class: 'label small', x: px(cx + 15 * side), y: px(cy + 7), 'text-anchor': anchor }, `+${number(Math.max(energy - report.relaxedEnergy, 0), 3)}`),
      ];
    });
  }
}
