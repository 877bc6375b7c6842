// What the modes share: a list of iterates, the one that is shown, and playing on.
import { clearNotice, describe, notice } from './notice.js';
import { drawStatus, speak } from './status.js';
import { ending, spoken } from './words.js';

const $ = (id) => document.getElementById(id);

/** Resolves with the next frame; while the page is hidden, after a moment. */
export const nextFrame = () => new Promise((done) => {
  if (document.hidden) setTimeout(done, 100);
  else requestAnimationFrame(done);
});

/** A mode of the page. Subclasses have a `session` that steps, and a `bench` of the canvas that draws. */
export class Mode {
  /** Numbers of the iterates the canvas has, a prepared start included. */
  records = [];
  shown = 0;
  playing = false;
  /** The solver's end, once there is one. */
  session;
  /** Play without a pause between two steps, whatever the pace says. */
  hurried = false;
  #lastStep = Promise.resolve();
  #task = 0; // what a person asked for last; anything older stops
  #soon;
  #follows = true; // whether what is shown is the newest, and stays so
  #pending; // an act a person asked for before the solver had come
  #film = false; // whether what plays is the history
  #busy = ''; // what it is busy with
  #unsaid; // a failure that came while another mode was on show

  /** `page`: `{ canvas, foldfree, active, busy(text, part) }`. */
  constructor(page, name) {
    this.page = page;
    this.name = name;
  }

  get active() {
    return this.page.active === this;
  }

  get bench() {
    return this.page.canvas?.on(this.name);
  }

  /** Whether a person asked for something that waits for the solver. */
  get waiting() {
    return this.#pending !== undefined;
  }

  // ——— on show, or not ———

  /** Another mode is shown from now on. */
  leave() {
    this.pause();
    cancelAnimationFrame(this.#soon);
    this.#soon = undefined;
  }

  /** This mode is on show again, with its bench. */
  enter() {
    this.setPlaying(false);
    this.page.busy(this.#busy);
    if (this.#unsaid) notice(...this.#unsaid);
    this.#unsaid = undefined;
  }

  /** Says what it is busy with, or that it is no more. */
  busy(text) {
    this.#busy = text;
    if (this.active) this.page.busy(text);
  }

  /** Tells of something, as `notice` does; a failure waits until this mode is on show. */
  notice(title, text, options = {}) {
    if (this.active) notice(title, text, options);
    else if (!options.plain) this.#unsaid = [title, text, options];
  }

  /** Says something to people who listen instead of looking. */
  say(text) {
    if (this.active) speak(text, { now: true });
  }

  /** Takes a message away: any, or that of a `title`. */
  clearNotice(title) {
    if (this.active) clearNotice(title);
    if (title === undefined || this.#unsaid?.[0] === title) this.#unsaid = undefined;
  }

  // ——— what subclasses say ———

  /** The one obvious button: `{ button, text }`, or nothing. */
  invitation() {}
  /** The numbers of an iterate as people read them. */
  readout(record) { return record; }
  /** Hands a step to the canvas. */
  push(step) { this.bench.push(step); }
  /** Lets the canvas draw an iterate. */
  drawShown(index) { this.bench?.show(index); }
  /** Makes a step; resolves with nothing when there is none to make. */
  makeStep() { return this.session.step(); }
  /** Before a step is made: moves what moves by itself. */
  async beforeStep() {}
  /** The solver has nothing more to do. */
  finish() {}
  /** How long what is shown stays while it plays, in units of the pace. */
  get beat() { return 1; }
  /** Whether there is more to do than the solver knows of. */
  get restless() { return false; }

  // ——— what is shown ———

  show(index, { quietly = false, soon = false } = {}) {
    if (!this.records.length) return;
    if (!soon) this.#follows = index >= this.records.length - 1;
    this.shown = Math.max(0, Math.min(index, this.records.length - 1));
    this.drawShown(this.shown);
    if (!this.active) return;
    drawStatus(this);
    if (!quietly) speak(spoken(this.readout(this.records[this.shown])), { now: !this.playing });
  }

  /** Shows the newest iterate with the next frame, however many come until then. */
  showSoon() {
    this.shown = this.records.length - 1;
    if (document.hidden || this.session.finished) {
      cancelAnimationFrame(this.#soon);
      this.#soon = undefined;
      this.show(this.shown, { soon: true });
    } else this.#soon ??= requestAnimationFrame(() => { this.#soon = undefined; this.show(this.shown, { soon: true }); });
  }

  invite() {
    if (!this.active) return;
    const asked = this.records.length === 1 ? this.invitation() : undefined;
    $('invite').hidden = !asked;
    if (!asked) return;
    $('unfold').textContent = asked.button;
    $('invite-text').textContent = asked.text;
  }

  // ——— playing ———

  setPlaying(on) {
    this.playing = on;
    if (!this.active) return;
    const button = $('play');
    button.classList.toggle('playing', on);
    button.setAttribute('aria-label', on ? 'Pause' : 'Play');
    if (on) $('invite').hidden = true;
  }

  pause() {
    this.#task += 1;
    this.hurried = false;
    this.session?.stop?.();
    if (!this.playing) return;
    this.setPlaying(false);
    if (this.records[this.shown] && this.active) {
      drawStatus(this);
      speak(spoken(this.readout(this.records[this.shown])), { now: true });
    }
  }

  /** Whether the solver is there; if not, `act` is done when it is. */
  whenReady(act) {
    if (this.session?.ready) return true;
    this.#pending = act;
    if (this.active) $('invite').hidden = true;
    if (this.page.canvas && !this.session) this.busy('Loading the solver');
    return false;
  }

  /** Does what waited for the solver. */
  async catchUp() {
    const act = this.#pending;
    this.#pending = undefined;
    if (this.active) await act?.();
  }

  /** Makes one step after those asked for before it and shows it; false when there is none to make. */
  stepOnce(mayGo = () => true) {
    this.#lastStep = this.#lastStep.then(() => mayGo() && this.#makeStep());
    return this.#lastStep;
  }

  async #makeStep() {
    try {
      await this.beforeStep();
      const step = await this.makeStep();
      if (!step) return false;
      this.took(step);
      return !this.session.finished || this.restless;
    } catch (error) {
      this.notice('The solver stopped', describe(error));
      return false;
    }
  }

  /** A step has come: the canvas gets it, and shows it unless a person has scrubbed away. */
  took(step) {
    this.push(step);
    if (this.session.finished && !this.restless) this.ended(step);
    if (this.#follows) this.showSoon();
    else if (this.active) drawStatus(this);
  }

  ended(step) {
    this.finish(step);
    if (step.status !== 'converged') this.notice('The solver ended', `${ending(step)} after ${step.iteration} iterations.`, { plain: true });
  }

  async play() {
    if (!this.active || !this.whenReady(() => this.play())) return;
    if (this.playing) return this.pause();
    if (this.session.finished && !this.restless) {
      // Nothing left to solve: play the film again.
      if (this.shown >= this.records.length - 1) this.show(0);
      return this.#playFilm();
    }
    await this.keepGoing();
  }

  /** Steps at the pace until there is nothing more to do, or a person says stop. */
  async keepGoing() {
    if (!this.active) return;
    this.#film = false;
    this.setPlaying(true);
    const mine = ++this.#task;
    const mayGo = () => this.playing && mine === this.#task;
    this.show(this.records.length - 1, { quietly: true });
    let due = performance.now();
    while (mayGo()) {
      const pace = this.hurried ? 0 : Number($('pace').value);
      const more = pace === 0 && this.session.run ? await this.runFreely(mayGo) : await this.stepOnce(mayGo);
      if (!more && mayGo()) this.pause();
      if (pace > 0) { // else as fast as it can: the worker steps, the page draws the newest every frame
        await nextFrame();
        due = Math.max(due + (this.beat * 1000) / pace, performance.now() - 100);
        while (mayGo() && performance.now() < due) await nextFrame();
      }
    }
  }

  /** Whether it plays, and what it plays is the solver's work and not the history. */
  get solving() {
    return this.playing && !this.#film;
  }

  async #playFilm() {
    const mine = ++this.#task;
    const mayGo = () => this.playing && mine === this.#task;
    this.#film = true;
    this.setPlaying(true);
    while (mayGo() && this.shown < this.records.length - 1) {
      this.show(this.shown + 1);
      const wait = (this.beat * 1000) / (Number($('pace').value) || 60);
      const until = performance.now() + wait;
      do await nextFrame(); while (mayGo() && performance.now() < until);
    }
    if (mayGo()) this.pause();
  }

  async steps(count) {
    if (!this.whenReady(() => this.steps(count))) return;
    this.pause();
    $('invite').hidden = true;
    if (this.shown < this.records.length - 1) return this.show(this.shown + count);
    const mine = this.#task;
    const mayGo = () => mine === this.#task;
    for (let i = 0; i < count && mayGo(); i += 1) {
      if (!(await this.stepOnce(mayGo))) break;
    }
  }

  /** Moves along the history. */
  scrub(index) {
    this.pause();
    this.show(index);
  }
}
