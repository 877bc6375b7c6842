// The Round mode: integers found by rounding, one after the other, on problems small enough to be drawn.
import { readAddress, writeAddress } from './address.js';
import { ChainPicture } from './chain-picture.js';
import { save } from './files.js';
import { LatticePicture } from './lattice-picture.js';
import { Mode } from './mode.js';
import { describe } from './notice.js';
import { drawFacts, makeTable } from './round-facts.js';
import { makeProblem, sysOf } from './round-problems.js';
import { ROUNDINGS, RoundSession } from './round-session.js';
import { ROUNDING_NAMES, number } from './words.js';

const $ = (id) => document.getElementById(id);

/** Slider positions of the condition number: 1 to 100, by ratio. */
const CONDITION = { toSlider: (c) => Math.round(50 * Math.log10(c)), fromSlider: (s) => Number((10 ** (s / 50)).toPrecision(3)) };
const TURN = 5;

export class Round extends Mode {
  static accepts = '';
  static dropHere = 'Nothing is opened here: this mode has its own two problems';
  static label = 'Nothing in this mode';
  static first = 'map';
  static views = { map: 'Picture', shape: '', plot: '', inspector: '' };
  wanted = readAddress('round');
  #pictures = {};
  #wish; // where the minimum is wanted next
  #moving = false;
  #pace; // of the other modes
  #isMoved = false; // whether a chain's points have been dragged

  constructor(page) {
    super(page, 'round');
    this.hands = {
      next: () => this.#picture.next(), nudge: (dx, dy) => this.#picture.nudge(dx, dy),
      twist: (by) => { if (this.wanted.problem === 'lattice') this.#slide('turn', Math.min(Math.max(this.wanted.turn - TURN * by, -90), 90)); },
      nextPlace() {}, pinPlace() {}, release() {},
    };
  }

  get bench() {
    return undefined; // it draws beside the canvas
  }

  get #picture() {
    return this.#pictures[this.wanted.problem];
  }

  get source() {
    return {};
  }

  get notShared() {
    return this.#isMoved && this.wanted.problem === 'chain' ? 'Points that were dragged are not in it.' : '';
  }

  // ——— opening ———

  async prepare() {
    return this.records.length > 0;
  }

  async arrive(foldfree) {
    if (this.active) this.#slowDown();
    this.session ??= new RoundSession(foldfree);
    if (this.session.ready) return true;
    const opened = await this.open();
    if (opened && this.waiting) await this.catchUp();
    else if (opened && this.wanted.steps) await this.steps(this.wanted.steps);
    return opened;
  }

  enter() {
    super.enter();
    this.#slowDown();
    this.reflect();
  }

  leave() {
    super.leave();
    if (this.#pace !== undefined) $('pace').value = this.#pace;
    this.#pace = undefined;
  }

  /** There are few steps, and each is to be understood. */
  #slowDown() {
    if (this.#pace !== undefined || $('pace').value !== '12') return;
    this.#pace = $('pace').value;
    $('pace').value = '4';
  }

  invitation() {
    const text = this.wanted.problem === 'chain'
      ? `${this.wanted.points} points become integers, one after the other, and their neighbours follow.`
      : 'Two numbers become integers, one after the other. Drag the cross to move the minimum.';
    return { button: 'Round', text };
  }

  /** Another problem, from its start. */
  async open() {
    this.pause();
    const { wanted, session } = this;
    try {
      session.rounding = wanted.rounding;
      const records = await session.open(makeProblem(wanted), wanted.updates);
      if (!records) return false; // overtaken
      this.#isMoved = false;
      this.records = records;
      this.show(0);
      this.clearNotice();
      this.remember();
      this.invite();
      return true;
    } catch (error) {
      this.notice('The problem could not be solved', describe(error));
      return false;
    } finally {
      this.reflect();
    }
  }

  /** The minimum is wanted elsewhere: the newest wish counts, one is solved at a time. */
  async #aim(minimum) {
    if (!this.session?.ready) return;
    this.#wish = [...minimum];
    if (this.#moving) return;
    this.pause();
    this.#moving = true;
    try {
      while (this.#wish) {
        const next = this.#wish;
        this.#wish = undefined;
        const records = await this.session.move(next);
        if (!records) continue;
        this.#isMoved = true;
        if (this.session.problem.kind === 'lattice') [this.wanted.x, this.wanted.y] = next.map((v) => Math.round(1e4 * v) / 1e4);
        this.records = records;
        this.show(Math.min(this.shown, records.length - 1), { quietly: true });
      }
      this.remember();
    } catch (error) {
      this.notice('The problem could not be solved', describe(error));
    } finally {
      this.#moving = false;
    }
  }

  // ——— playing ———

  push() {
    this.records = this.session.records;
  }

  ended() {} // the picture says what was found

  drawShown(index) {
    if (!this.session?.ready || !this.active) return;
    const { kind } = this.session.problem;
    const box = $('round-picture');
    const picture = this.#pictures[kind];
    if (box.firstElementChild !== picture.element) box.replaceChildren(picture.element);
    const size = { width: box.clientWidth, height: box.clientHeight };
    if (size.width < 40 || size.height < 40) return;
    picture.draw(this.session, index, size);
    drawFacts(this.session, index);
  }

  show(index, options) {
    super.show(index, options);
    if (this.active) $('history').max = String(this.records.length - 1);
  }

  readout(record) {
    const { results, path } = this.session;
    const above = Math.max(record.energy - results.get('lattice').report.relaxedEnergy, 0);
    const count = record.x.length;
    const done = count - record.remaining;
    const where = `step ${record.iteration} of ${path.length - 1}`;
    const energyText = `energy +${number(above, 3)}`;
    const fate = { text: `${done} of ${count} rounded`, good: record.remaining === 0 };
    return { ...record, where, energyText, fate, inverted: 0, spoken: `${ROUNDING_NAMES[this.session.rounding]}, ${where}, ${energyText}, ${fate.text}` };
  }

  // ——— what people do ———

  async reset() {
    if (!this.whenReady(() => this.reset())) return;
    this.pause();
    this.records = this.session.choose(this.wanted.rounding);
    this.show(0);
    this.invite();
  }

  choose(rounding) {
    this.wanted.rounding = rounding;
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    this.pause();
    const atEnd = this.session.finished && this.shown >= this.records.length - 1;
    this.records = this.session.choose(rounding);
    // Who has seen the end of one wants to see the end of the other.
    if (atEnd) while (!this.session.finished) { void this.session.step(); this.records = this.session.records; }
    this.show(atEnd ? this.records.length - 1 : 0);
    this.invite();
    this.remember();
  }

  pickMethod(index) {
    if (ROUNDINGS[index]) this.choose(ROUNDINGS[index]);
  }

  async change(key, value) {
    this.wanted[key] = value;
    this.reflect();
    if (!this.whenReady(() => this.open())) return;
    await this.open();
  }

  /** A slider: the problem changes, and as many steps stay on show. */
  async #slide(key, value) {
    this.wanted[key] = value;
    this.reflect();
    if (!this.session?.ready) return;
    const { session, shown, records } = this;
    const done = session.finished;
    const steps = records.length;
    this.pause();
    try {
      const problem = makeProblem(this.wanted);
      if (this.#isMoved && problem.minimum.length === session.minimum.length) problem.minimum = [...session.minimum];
      if (!(await session.open(problem, this.wanted.updates))) return;
      while (!session.finished && (done || session.records.length < steps)) await session.step();
      this.records = session.records;
      this.show(done && shown >= steps - 1 ? this.records.length - 1 : Math.min(shown, this.records.length - 1), { quietly: true });
      this.remember();
    } catch (error) {
      this.notice('The problem could not be solved', describe(error));
    }
  }

  async openFiles() {
    this.notice('Nothing is opened here', 'Round has its own two problems. Larger ones, and .sys files: solveMixedInteger of the package, or foldfree miqp.', { plain: true });
  }

  // ——— controls ———

  reflect() {
    if (!this.active) return;
    const { wanted } = this;
    for (const element of document.querySelectorAll('[data-problem]')) element.hidden = element.dataset.problem !== wanted.problem;
    $('round-problem').value = wanted.problem;
    $('rounding').value = wanted.rounding;
    $('updates').value = wanted.updates;
    $('updates').disabled = wanted.rounding === 'two-opt' || wanted.rounding === 'lattice';
    $('condition').value = String(CONDITION.toSlider(wanted.condition));
    $('turn').value = String(wanted.turn);
    $('coupling').value = String(wanted.coupling);
    $('points').value = String(wanted.points);
    const say = (id, text) => {
      $(`${id}-value`).textContent = text;
      $(id).setAttribute('aria-valuetext', text);
    };
    say('condition', number(wanted.condition, 2));
    say('turn', `${String(wanted.turn).replace('-', '−')}°`);
    say('coupling', String(wanted.coupling));
  }

  remember(extra = {}) {
    if (this.active) writeAddress('round', { ...this.wanted, steps: extra.steps });
  }

  get exports() {
    const { session } = this;
    const { kind } = session.problem;
    const plain = ({ x, ...step }) => ({ ...step, x: [...x] });
    const trace = () => ROUNDINGS.map((rounding) => {
      const { report, energy, proven, lowerBound } = session.results.get(rounding);
      return { rounding, energy, proven, lowerBound, report, steps: session.paths.get(rounding).map(plain) };
    });
    return {
      'export-trace': async () => save(`${JSON.stringify({ problem: kind, minimum: session.minimum, roundings: trace() }, null, 1)}\n`, `${kind}-rounded.json`, 'application/json'),
      'export-sys': async () => save(sysOf(session.problem, session.minimum), `${kind}.sys`, 'text/plain'),
    };
  }

  connect() {
    this.#pictures = { lattice: new LatticePicture((at) => this.#aim(at)), chain: new ChainPicture((at) => this.#aim(at)) };
    makeTable((rounding) => this.choose(rounding));
    $('round-problem').addEventListener('change', () => this.change('problem', $('round-problem').value));
    $('rounding').addEventListener('change', () => this.choose($('rounding').value));
    $('updates').addEventListener('change', () => this.change('updates', $('updates').value));
    $('points').addEventListener('change', () => this.change('points', Number($('points').value)));
    $('another').addEventListener('click', () => this.change('seed', (this.wanted.seed % 999) + 1));
    $('condition').addEventListener('input', () => this.#slide('condition', CONDITION.fromSlider(Number($('condition').value))));
    $('turn').addEventListener('input', () => this.#slide('turn', Number($('turn').value)));
    $('coupling').addEventListener('input', () => this.#slide('coupling', Number($('coupling').value)));
    new ResizeObserver(() => { if (this.active) this.drawShown(this.shown); }).observe($('round-picture'));
  }
}
