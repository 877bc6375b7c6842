// Steps a second while a person drags one end of a bar: new targets before each step, a frame to draw after it.
import { say } from '../lib/progress.mjs';
import { inBrowser } from './programs.mjs';

/** In the browser, through the worker as the page does it. */
async function drag({ tetrahedra, steps, threads }) {
  const { load } = await import('/pkg/index.js');
  const foldfree = await load({ threads });
  const bar = await foldfree.generateSolid('bar', tetrahedra);
  const xs = bar.positions.filter((_, i) => i % 3 === 0);
  const low = xs.reduce((a, b) => Math.min(a, b));
  const length = xs.reduce((a, b) => Math.max(a, b)) - low;
  const near = (test) => Uint32Array.from([...xs.keys()].filter((v) => test((xs[v] - low) / length)));
  const [held, dragged] = [near((t) => t < 0.05), near((t) => t > 0.95)];
  /** The dragged end after a while: turned about the axis, and moved to and fro beside it. */
  const targets = (step) => {
    const [angle, aside] = [0.02 * step, 0.1 * length * Math.sin(0.05 * step)];
    const positions = new Float64Array(3 * dragged.length);
    dragged.forEach((v, k) => {
      const [x, y, z] = bar.positions.subarray(3 * v, 3 * v + 3);
      positions.set([x, Math.cos(angle) * y - Math.sin(angle) * z + aside, Math.sin(angle) * y + Math.cos(angle) * z], 3 * k);
    });
    return { vertices: dragged, positions };
  };
  const pins = [...held, ...dragged];
  const solver = await foldfree.deform(bar, { pins, maxIterations: 100_000, frames: 'f32', field: 'stretch' });
  const warm = 10;
  const times = [];
  let last;
  for (let step = 1; step <= warm + steps; step++) {
    const begun = performance.now();
    await solver.setTargets(targets(step));
    last = await solver.step();
    if (step > warm) times.push(performance.now() - begun);
  }
  const seconds = times.reduce((sum, time) => sum + time, 0) / 1000;
  const measured = {
    used: foldfree.threads,
    tetrahedra: bar.tetrahedra.length / 4,
    rate: steps / seconds,
    slow: times.sort((a, b) => a - b)[Math.floor(0.95 * steps)],
    inverted: last.inverted,
  };
  foldfree.terminate();
  return measured;
}

/** With one thread and with several. */
export async function measureDrag(bench, { tetrahedra, steps }) {
  say(`dragging a bar of ${tetrahedra} tetrahedra`);
  const measured = await inBrowser(bench, drag, { tetrahedra, steps });
  return { tetrahedra: measured.wasm.tetrahedra, ...measured };
}
