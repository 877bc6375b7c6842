// Untangling, as installed from the packed package: triangles in the plane and solids.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { after, describe, it } from 'node:test';
import { importPacked, installPacked } from './packed.mjs';
import { inverted, square } from './plane.mjs';

const { folder } = installPacked();
const { initSync, wasm } = await importPacked(folder, 'foldfree/core');
const { load } = await importPacked(folder, 'foldfree');
const core = initSync(readFileSync(new URL(wasm)));
const foldfree = await load({ threads: false });
after(() => foldfree.terminate());

/** Numbers from 0 to 1, the same every time. */
function randoms(seed) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const rim = (n) => [...Array(n * n).keys()].filter((v) => v % n === 0 || v % n === n - 1 || v < n || v >= n * n - n);

/** `rest` with the vertices that are not pinned somewhere else: `place(random)` gives three coordinates. */
function spoiled(rest, pins, place, seed = 5) {
  const [held, random, start] = [new Set(pins), randoms(seed), rest.slice()];
  for (let v = 0; v < rest.length / 3; v += 1) if (!held.has(v)) start.set(place(random, start.subarray(3 * v, 3 * v + 3)), 3 * v);
  return start;
}

/** Six times the signed volume of a tetrahedron. */
function volume(p, [a, b, c, d]) {
  const e = (v) => [0, 1, 2].map((k) => p[3 * v + k] - p[3 * a + k]);
  const [[x, y, z], [u, v, w], [r, s, t]] = [e(b), e(c), e(d)];
  return x * (v * t - w * s) + y * (w * r - u * t) + z * (u * s - v * r);
}

/** Tetrahedra that are not turned as those of `rest` are. */
function invertedTetrahedra({ positions: rest, tetrahedra }, positions) {
  let count = 0;
  for (let t = 0; t < tetrahedra.length; t += 4) {
    const corners = tetrahedra.subarray(t, t + 4);
    if (!(volume(positions, corners) * volume(rest, corners) > 0)) count += 1;
  }
  return count;
}

const skin = (solid) => [...new Set(solid.surface)];

/** The bar's rest positions, turned about x by up to `angle` along it. */
function twisted({ positions }, angle) {
  const xs = positions.filter((_, i) => i % 3 === 0);
  const [low, high] = [Math.min(...xs), Math.max(...xs)];
  const out = positions.slice();
  for (let i = 0; i < out.length; i += 3) {
    const [x, y, z] = positions.subarray(i, i + 3);
    const turn = angle * ((x - low) / (high - low) - 0.5);
    out.set([x, Math.cos(turn) * y - Math.sin(turn) * z, Math.sin(turn) * y + Math.cos(turn) * z], i);
  }
  return out;
}

const fails = (code, call, words = '') => assert.throws(call, (error) => {
  assert.equal(error.code, code, error.message);
  assert.ok(error.message.includes(words), error.message);
  return true;
});

describe('untangling in this thread', () => {
  const n = 15;
  const rest = square(n);
  const pins = rim(n);
  const shuffled = spoiled(rest.positions, pins, (random) => [random(), random(), 0]);

  it('leaves no triangle inverted, from random places and from one point', () => {
    const mesh = core.mesh(rest);
    for (const start of [shuffled, spoiled(rest.positions, pins, () => [0.4, 0.6, 0])]) {
      const solver = core.untangle(mesh, { pins, start });
      assert.equal(solver.start.inverted, inverted(rest, start));
      assert.ok(solver.start.inverted > 50);
      assert.deepEqual(solver.start.positions, start);
      const last = [...solver].at(-1);
      assert.deepEqual([last.status, last.criterion, last.inverted], ['converged', 'injective', 0]);
      const { positions, certificate, outcome, obstacles } = solver.result();
      assert.deepEqual(positions, last.positions);
      assert.equal(inverted(rest, positions), 0);
      assert.ok(certificate.locallyInjective && certificate.globallyInjective);
      assert.deepEqual([outcome.notPositive, outcome.hopeless, outcome.hopelessMeasure, obstacles], [[], [], undefined, []]);
      assert.ok(outcome.smallestMeasure > 0 && outcome.smallestMeasure < 1);
      for (const v of pins) assert.deepEqual(positions.subarray(3 * v, 3 * v + 3), start.subarray(3 * v, 3 * v + 3));
      solver.free();
    }
  });

  it('says what each step did, and shows both states and the polisher’s', () => {
    const solver = core.untangle(core.mesh(rest), { pins, start: shuffled, primary: true, trace: true });
    assert.deepEqual([solver.start.trace, solver.start.primary], [[], shuffled]);
    let polished = 0;
    for (const step of solver) {
      const { gini, primary, trace, positions } = step;
      assert.deepEqual(step.phases.map(({ kind }) => kind), ['local', 'global', 'evaluate']);
      assert.ok(gini.active <= gini.constraints && gini.qpIterations <= 50 && gini.polish.length <= 30);
      assert.ok(gini.leastOffset <= gini.firstOffset && gini.polishMilliseconds >= 0);
      assert.equal(trace.length, gini.polish.length + 1);
      assert.equal(inverted(rest, trace[0].positions), gini.invertedIterate);
      gini.polish.forEach(({ inverted: wrong, violated, zones }, k) => {
        assert.equal(inverted(rest, trace[k].positions), wrong, `iteration ${k}`);
        assert.deepEqual([trace[k].inverted, trace[k].violated, Math.max(...trace[k].zones)], [wrong, violated, zones]);
        assert.ok(trace[k].zones.filter((zone) => zone > 0).length >= violated && violated >= wrong);
      });
      polished += gini.polish.length;
      assert.ok(gini.accepted || !gini.reached, 'where it got to it has moved');
      if (gini.reached) assert.deepEqual(trace.at(-1).positions, positions);
      assert.equal(trace[0].zones.length, rest.indices.length / 3);
      assert.deepEqual(primary, solver.primaryPositions());
      assert.ok(step.lim === undefined);
    }
    assert.ok(polished > 0);
    // of the polisher alone
    const few = core.untangle(core.mesh(rest), { pins, start: shuffled, trace: 'polisher' });
    assert.ok(!('quadratic' in few.start) && few.start.trace.length === 0);
    const one = few.step();
    assert.ok(!('quadratic' in one) && one.trace.length === one.gini.polish.length + 1);
    // single precision, and no more than what was asked for
    const plain = core.untangle(core.mesh(rest), { pins, start: shuffled, frames: 'f32' });
    const step = plain.step();
    assert.ok(step.positions instanceof Float32Array && !('primary' in step) && !('trace' in step));
    const again = core.untangle(core.mesh(rest), { pins, start: shuffled });
    assert.deepEqual(Float32Array.from(again.step().positions), step.positions, 'watching changes nothing');
  });

  it('does not depend on the unit, and stays in its plane', () => {
    const last = [1, 1e-4, 1e6].map((size) => {
      const body = square(n, { size, z: 3 * size });
      const start = shuffled.map((x, i) => (i % 3 === 2 ? 3 * size : size * x));
      const solver = core.untangle(core.mesh(body), { pins, start });
      const step = [...solver].at(-1);
      assert.equal(step.inverted, 0);
      assert.ok(step.positions.every((x, i) => i % 3 < 2 || x === 3 * size));
      return { iteration: step.iteration, positions: step.positions.map((x) => x / size) };
    });
    for (const other of last.slice(1)) {
      assert.equal(other.iteration, last[0].iteration);
      assert.ok(other.positions.every((x, i) => Math.abs(x - last[0].positions[i]) < 1e-5));
    }
  });

  it('untangles solids: skin held and twisted, in every energy; nothing held', () => {
    const bar = core.generateSolid('bar', 1200);
    const held = skin(bar);
    const shape = twisted(bar, 2);
    const start = spoiled(shape, held, (random) => [random() - 0.5, random() - 0.5, random() - 0.5]);
    for (const energy of ['arap', 'neo-hookean', 'stable-neo-hookean', 'symmetric-dirichlet', 'dirichlet']) {
      const solver = core.untangle(bar, { energy, pins: held, start });
      const last = [...solver].at(-1);
      assert.deepEqual([last.criterion, invertedTetrahedra(bar, last.positions)], ['injective', 0], energy);
      const { positions, certificate } = solver.result();
      assert.equal(certificate.inverted.length + certificate.degenerate.length, 0, energy);
      assert.deepEqual(core.checkSolid(bar, positions), certificate);
      solver.free();
    }
    const random = randoms(9);
    const free = core.untangle(bar, { start: bar.positions.map((x) => x + 0.2 * (random() - 0.5)) });
    assert.ok(free.start.inverted > 0);
    assert.equal(invertedTetrahedra(bar, [...free].at(-1).positions), 0);
  });

  it('moves pins to their targets, and lets targets pull', () => {
    const corner = n * n - 1;
    const targets = { vertices: Uint32Array.of(corner), positions: Float64Array.of(1.3, 1.2, 0) };
    const held = core.untangle(core.mesh(rest), { pins, start: shuffled, targets });
    const last = [...held].at(-1);
    assert.equal(last.inverted, 0);
    assert.deepEqual([...last.positions.subarray(3 * corner)], [1.3, 1.2, 0]);
    const pulled = core.untangle(core.mesh(rest), { pins: pins.filter((v) => v !== corner), start: shuffled, targets, targetStiffness: 10 });
    const end = [...pulled].at(-1);
    assert.equal(end.inverted, 0);
    assert.ok(end.positions[3 * corner] > 1.1);
  });

  it('keeps a boundary from passing through itself', () => {
    // a strip whose ends are pulled through each other
    const [nx, ny] = [25, 3];
    const at = (i, j) => j * nx + i;
    const positions = Float64Array.from(Array.from({ length: nx * ny }, (_, v) => [(v % nx) / 2, Math.floor(v / nx) / 2, 0]).flat());
    const cells = Array.from({ length: (nx - 1) * (ny - 1) }, (_, c) => [c % (nx - 1), Math.floor(c / (nx - 1))]);
    const triangles = cells.flatMap(([i, j]) => [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
    const mesh = core.mesh({ positions, indices: Uint32Array.from(triangles) });
    const ends = [[0, 9], [nx - 1, 3]];
    const targets = {
      vertices: Uint32Array.from(ends.flatMap(([i]) => [0, 1, 2].map((j) => at(i, j)))),
      positions: Float64Array.from(ends.flatMap(([, x]) => [0, 1, 2].flatMap((j) => [x, 4 + j / 2, 0]))),
    };
    const options = { targets, overlap: true, targetStiffness: 0.01, maxIterations: 60 };
    const pulled = core.untangle(mesh, options);
    const contacts = [];
    for (const step of pulled) contacts.push(step.gini.contacts);
    const { positions: x, certificate, outcome } = pulled.result();
    assert.ok(Math.max(...contacts) > 0, 'they meet');
    assert.deepEqual([certificate.inverted.length, certificate.boundaryCrossingCount, certificate.globallyInjective], [0, 0, true]);
    assert.deepEqual([outcome.globallyInjective, outcome.intersections], [true, 0]);
    // most of the 9 from where each end began
    assert.ok(x[3 * at(0, 1)] > 6 && x[3 * at(nx - 1, 1)] < 6, `${x[3 * at(0, 1)]} ${x[3 * at(nx - 1, 1)]}`);

    // and a boundary that meets itself already is refused, with the places
    const crossed = positions.slice();
    for (let v = 0; v < nx * ny; v += 1) {
      const angle = 1.4 * Math.PI * positions[3 * v] / 6;
      const radius = 1.4 + positions[3 * v + 1];
      crossed.set([radius * Math.sin(angle), 3 - radius * Math.cos(angle), 0], 3 * v);
    }
    const refused = () => core.untangle(mesh, { ...options, start: crossed });
    assert.throws(refused, (error) => error.code === 'intersecting-start' && /meet.*flow/.test(error.message) && error.details.pairs.length > 0);

    // unless it may flow: then it is pulled back as near as it can come
    const { targets: _, ...soft } = options;
    const flowed = core.untangle(mesh, { ...soft, start: crossed, flow: true, maxIterations: 30 });
    assert.match(flowed.notes.join(), /met itself in \d+ pairs of edges: \d+ steps? of flow parted it/);
    assert.ok(flowed.flowed.steps > 0 && flowed.flowed.pairs.at(-1) === 0);
    const distance = (p) => Math.hypot(...p.map((x, i) => x - crossed[i]));
    const begin = distance(flowed.start.positions);
    for (const step of flowed) assert.equal(step.inverted, 0);
    const end = flowed.result();
    assert.deepEqual([end.certificate.globallyInjective, end.outcome.globallyInjective], [true, true]);
    assert.ok(distance(end.positions) < 0.9 * begin, `${distance(end.positions)} ${begin}`);
    const still = core.untangle(mesh, { ...soft, start: positions, flow: true });
    assert.match(still.notes.join(), /does not meet itself/);
    assert.deepEqual([still.flowed, pulled.flowed], [{ steps: 0, pairs: [0] }, undefined]);
    assert.deepEqual(still.start.positions, positions);
    fails('invalid-option', () => core.untangle(mesh, { start: crossed, flow: true }), 'overlap');
  });

  it('goes on to low distortion, and nothing inverts on the way', () => {
    const options = { pins, start: shuffled, energy: 'symmetric-dirichlet' };
    const alone = core.untangle(core.mesh(rest), options);
    const energyOf = (solver) => { let last; for (const step of solver) last = step; return last; };
    const before = energyOf(alone);
    assert.equal(before.status, 'converged');
    const both = core.untangle(core.mesh(rest), { ...options, minimize: true });
    const energies = [];
    for (const step of both) if (step.switchedAt !== undefined) energies.push([step.energy, step.inverted]);
    assert.ok(energies.length > 2);
    energies.forEach(([energy, count], k) => {
      assert.equal(count, 0);
      assert.ok(k === 0 || energy <= energies[k - 1][0], `${k}: ${energy}`);
    });
    // all of the rim is held at rest: the minimum is at rest
    assert.ok(Math.abs(energies.at(-1)[0] - 1) < 1e-5, `${energies.at(-1)}`);
    assert.ok(energies.at(-1)[0] < before.energy);
    assert.equal(inverted(rest, both.result().positions), 0);
    fails('invalid-option', () => core.untangle(core.mesh(rest), { pins, minimize: true }), 'minimize');
    alone.free();
    both.free();
  });

  it('ends in bounded time where pins leave no room, and says why', () => {
    // left and right edge exchanged: the outline encloses a negative area
    const start = rest.positions.map((x, i) => (i % 3 === 0 ? 1 - x : x));
    const solver = core.untangle(core.mesh(rest), { pins, start });
    assert.equal(solver.start.status, 'stalled', 'there is nothing to try');
    assert.deepEqual([...solver], []);
    const { outcome, obstacles, certificate } = solver.result();
    assert.ok(outcome.hopelessMeasure < 0 && outcome.hopeless.length > 0 && outcome.notPositive.length > 0);
    assert.equal(outcome.notPositive.length, certificate.inverted.length + certificate.degenerate.length);
    assert.match(obstacles.join(' '), /pinned.*encloses.*Inverted or degenerate elements: \d/);
    const bar = core.generateSolid('bar', 600);
    const anywhere = spoiled(bar.positions, [], (random) => [random(), random(), random()]);
    const few = core.untangle(bar, { start: anywhere, maxIterations: 1 });
    const best = [...few].at(-1);
    assert.deepEqual([best.status, best.iteration], ['max-iterations', 1]);
    assert.ok(best.inverted > 0 && best.inverted < few.start.inverted);
    assert.equal(invertedTetrahedra(bar, best.positions), best.inverted);
    assert.equal(few.result().outcome.notPositive.length, best.inverted);
  });

  it('turns a clockwise mesh and says so', () => {
    const turned = square(n, { clockwise: true });
    const solver = core.untangle(core.mesh(turned), { pins, start: shuffled });
    assert.match(solver.notes.join(), /clockwise: all triangles were turned/);
    assert.equal(inverted(turned, [...solver].at(-1).positions), 0);
    assert.ok(solver.result().certificate.locallyInjective);
  });

  it('refuses bad input by name, and changes nothing', () => {
    const mesh = core.mesh(rest);
    const bar = core.generateSolid('bar', 300);
    const [before, barBefore] = [mesh.positions.slice(), bar.positions.slice()];
    fails('invalid-argument', () => core.untangle(mesh, { pins: 3 }), 'pins');
    fails('invalid-argument', () => core.untangle(mesh, { pins, start: [0, 1] }), 'start');
    fails('invalid-argument', () => core.untangle(mesh, { pins, start: new Float64Array(4) }), 'multiple of 3');
    fails('wrong-length', () => core.untangle(mesh, { pins, start: new Float64Array(6) }), 'start');
    fails('invalid-argument', () => core.untangle(mesh, { pins, targets: { vertices: Uint32Array.of(1), positions: new Float64Array(2) } }), 'expected 3');
    fails('invalid-option', () => core.untangle(mesh, { pins: [999] }), '999');
    fails('invalid-option', () => core.untangle(mesh, { pins, energy: 'rubber' }), 'arap');
    fails('invalid-option', () => core.untangle(mesh, { pins, energy: 'neo-hookean' }), 'plane');
    fails('invalid-option', () => core.untangle(bar, { energy: 'st-venant-kirchhoff' }), 'arap');
    fails('invalid-option', () => core.untangle(bar, { energy: 'neo-hookean', poisson: 0.5 }), 'poisson');
    fails('invalid-option', () => core.untangle(mesh, { pins, offset: 2 }), 'offset');
    fails('invalid-option', () => core.untangle(mesh, { pins, targetStiffness: 0 }), 'targetStiffness');
    fails('invalid-option', () => core.untangle(mesh, { pins, maxPolishIterations: 0 }), 'maxPolishIterations');
    fails('invalid-option', () => core.untangle(mesh, { pins, maxIterations: 1.5 }), 'maxIterations');
    fails('invalid-option', () => core.untangle(mesh, { pins, overlap: true, contactOffset: 1 }), 'contactOffset');
    fails('invalid-option', () => core.untangle(mesh, { pins, settle: -1 }), 'settle');
    const wild = shuffled.slice();
    wild[100] = NaN;
    assert.throws(() => core.untangle(mesh, { pins, start: wild }), /33/);
    const bent = square(n);
    bent.positions[3 * 8 + 2] = 0.1;
    assert.throws(() => core.untangle(core.mesh(bent), { pins }), /vertex 8 is not in the plane/);
    const twice = { vertices: Uint32Array.of(5, 5), positions: new Float64Array(6) };
    assert.throws(() => core.untangle(mesh, { pins, targets: twice }), /vertex 5 has two targets/);
    assert.deepEqual([mesh.positions, bar.positions], [before, barBefore]);
    assert.equal([...core.untangle(mesh, { pins, start: shuffled })].at(-1).inverted, 0, 'it goes on as before');
  });

  it('writes what it found, and has defaults that can be read', () => {
    const mesh = core.mesh(rest);
    const { positions } = (() => {
      const solver = core.untangle(mesh, { pins, start: shuffled });
      for (const step of solver) void step;
      return solver.result();
    })();
    for (const format of ['obj', 'off', 'ply', 'mesh']) {
      const read = core.mesh(mesh.write(format, positions), format);
      assert.deepEqual(read.positions, positions, format);
    }
    fails('invalid-argument', () => mesh.write('obj', new Float64Array(3)), '1 points of 225');
    fails('invalid-argument', () => mesh.write('docx'), 'obj');
    const { energy, maxQpIterations, maxPolishIterations, offset, maxIterations } = core.defaultUntangleOptions();
    assert.deepEqual([energy, maxQpIterations, maxPolishIterations, offset, maxIterations], ['arap', 50, 30, 0.1, 100]);
    const ofOverlap = ({ overlap, targetStiffness, settle }) => ({ overlap, targetStiffness, settle });
    assert.deepEqual(ofOverlap(core.defaultUntangleOptions(true)), { overlap: true, targetStiffness: 1e-5, settle: 1e-3 });
    assert.deepEqual(ofOverlap(core.defaultUntangleOptions()), { overlap: false, targetStiffness: 1, settle: 0 });
  });
});

describe('untangling in a worker', () => {
  it('gives the same as in this thread, step by step and in a run', async () => {
    const rest = core.generateSolid('box', 1000);
    const pins = skin(rest);
    const start = spoiled(rest.positions, pins, () => [0, 0, 0]);
    const here = [...core.untangle(rest, { pins, start })].at(-1);
    const solid = await foldfree.solid({ positions: rest.positions, tetrahedra: rest.tetrahedra });

    await using_(await foldfree.untangle(solid, { pins, start, primary: true, trace: true }), async (solver) => {
      assert.deepEqual(solver.start.positions, start);
      let last;
      for await (const step of solver) {
        assert.equal(step.trace.length, step.gini.polish.length + 1);
        assert.ok(step.primary.length === start.length);
        last = step;
      }
      assert.deepEqual([last.positions, last.iteration], [here.positions, here.iteration]);
      assert.deepEqual((await solver.result()).outcome.notPositive, []);
      assert.equal((await solver.primaryPositions()).length, start.length);
    });
    await using_(await foldfree.untangle(solid, { pins, start }), async (solver) => {
      let reports = 0;
      const last = await solver.run({ onFrame: (_frame, list) => void (reports += list.length) });
      assert.deepEqual([reports, last.status, solver.status], [here.iteration, 'converged', 'converged']);
      const { positions, certificate } = await solver.result();
      assert.deepEqual(positions, here.positions);
      assert.equal(certificate.inverted.length, 0);
      const file = await solid.write('mesh', positions);
      assert.deepEqual((await foldfree.solid(file, 'mesh')).positions, positions);
    });
  });

  it('ends a run when its signal aborts, and refuses the same', async () => {
    const n = 12;
    const mesh = await foldfree.mesh(square(n));
    const start = spoiled(mesh.positions, rim(n), (random) => [random(), random(), 0]);
    const stop = new AbortController();
    const solver = await foldfree.untangle(mesh, { pins: rim(n), start, signal: stop.signal });
    stop.abort(new Error('enough'));
    await assert.rejects(solver.run(), /enough/);
    await assert.rejects(foldfree.untangle(mesh, { pins: rim(n), start, signal: stop.signal }), /enough/);
    await assert.rejects(foldfree.untangle(mesh, { pins: 3 }), { code: 'invalid-argument' });
    await assert.rejects(foldfree.untangle(mesh, { pins: rim(n), energy: 'neo-hookean' }), { code: 'invalid-option' });
    const other = await foldfree.untangle(mesh, { pins: rim(n), start });
    const last = await other.run();
    assert.equal(last.inverted, 0);
    assert.equal((await other.result()).certificate.globallyInjective, true);
    assert.match(new TextDecoder().decode(await mesh.write('obj', last.positions)), /^v .*\nv /);
    other.free();
    await assert.rejects(other.step(), { code: 'freed' });
  });
});

/** `using` as the engine will have it. */
async function using_(resource, act) {
  try {
    await act(resource);
  } finally {
    resource[Symbol.dispose ?? Symbol.for('Symbol.dispose')]();
  }
}
