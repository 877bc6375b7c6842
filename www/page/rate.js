// How many there are a second, lately. No DOM here.

/** Counts what comes, over the last second. */
export class Rate {
  #ticks = [];

  /** So many have come now. */
  tick(count = 1, now = performance.now()) {
    this.#ticks.push([now, count]);
    while (this.#ticks.length > 2 && this.#ticks[0][0] < now - 1000) this.#ticks.shift();
  }

  /** It begins anew. */
  clear() {
    this.#ticks = [];
  }

  /** So many a second; undefined while too few have come. */
  get perSecond() {
    if (this.#ticks.length < 3) return undefined;
    const passed = this.#ticks.at(-1)[0] - this.#ticks[0][0];
    const count = this.#ticks.slice(1).reduce((sum, [, n]) => sum + n, 0);
    return passed > 100 ? (1000 * count) / passed : undefined;
  }
}
