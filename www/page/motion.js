// How the handle of a scene moves by itself. No DOM here.

/** Part of a motion one turn of a free run makes at most, so that what is inside can follow on a slow machine. */
const MOST_AT_ONCE = 1 / 10;

/** A motion on its way: by the clock while the solver runs freely, else by so much an iteration. */
export class Motion {
  #plan;
  #part = 0;
  #last; // when it went on last

  /** `plan`: `{ handle, seconds, steps, at(part) }`, or nothing. */
  constructor(plan) {
    this.#plan = plan;
  }

  /** The handle that moves, while it does; or -1. */
  get handle() {
    return this.#plan && this.#part < 1 ? this.#plan.handle : -1;
  }

  /** Goes on by one iteration, or by the time that has passed; returns where the handle is now (k×3). */
  advance({ freely = false, now = performance.now() } = {}) {
    const { seconds, steps, at } = this.#plan;
    const passed = this.#last === undefined ? 1 / steps : (now - this.#last) / 1000 / seconds;
    this.#last = freely ? now : undefined;
    this.#part = Math.min(1, this.#part + (freely ? Math.min(passed, MOST_AT_ONCE) : 1 / steps));
    if (1 - this.#part < 1e-9) this.#part = 1;
    return at(this.#part);
  }

  /** The clock stands still. */
  pause() {
    this.#last = undefined;
  }

  /** It has come to its end, wherever it is. */
  end() {
    this.#plan = undefined;
  }
}
