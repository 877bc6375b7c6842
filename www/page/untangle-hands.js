// What people do with what is held while bodies are kept apart: it is moved, and nothing else.
import { Hands } from './deform-hands.js';

/** The hands of the Untangle mode. */
export class Movers extends Hands {
  #mode;

  constructor(mode) {
    super(mode);
    this.#mode = mode;
  }

  /** What is held is part of the problem. */
  async pin() {
    this.#refuse();
  }

  async release() {
    this.#refuse();
  }

  nextPlace() {
    this.#refuse();
  }

  async pinPlace() {
    this.#refuse();
  }

  next() {
    if (this.#mode.mayHold) super.next();
    else this.#refuse();
  }

  #refuse() {
    const why = this.#mode.mayHold ? 'What is held can only be moved here' : 'What is held stays where it is here';
    this.#mode.say(why);
  }
}
