// The session of the Deform mode, with a solver whose every answer the test gives: what overtakes what.
import assert from 'node:assert/strict';
import { describe, test } from 'node:test';
import { DeformSession } from '../page/deform-session.js';

/** A promise and its ends. */
function later() {
  const out = {};
  out.promise = new Promise((resolve, reject) => Object.assign(out, { resolve, reject }));
  return out;
}

const turn = () => new Promise((done) => { setTimeout(done, 0); });
const solid = (name = 'bar') => ({
  name, notes: [], positions: new Float64Array(12), tetrahedra: Uint32Array.of(0, 1, 2, 3), freed: 0, free() { this.freed += 1; },
});
const step = (iteration, status = 'running') => ({
  iteration, status, energy: 1, inverted: 0, gradientNorm: 1, smallestSigma: 1, largestSigma: 1, phases: [], seconds: 0,
  positions: Float32Array.of(iteration, 0, 0),
});

/** A library whose solvers are made, stepped and run when the test says so. */
function library() {
  const builds = [];
  const deform = (on, options) => {
    const build = { on, options, ...later() };
    build.finish = (status = 'running') => {
      const solver = {
        start: step(0, status), notes: [], setupSeconds: 0, freed: 0, cancels: 0, targets: [], runs: [], steps: [],
        free() { this.freed += 1; },
        cancel() { this.cancels += 1; this.runs.at(-1)?.end.resolve(); },
        setTargets(targets) { const sent = { targets, ...later() }; this.targets.push(sent); return sent.promise; },
        step() { const made = later(); this.steps.push(made); return made.promise; },
        run({ onFrame }) {
          const run = { frame: (it) => onFrame(it, [it]), end: later() };
          this.runs.push(run);
          return run.end.promise;
        },
        result: async () => ({ certificate: { inverted: [] } }),
      };
      build.resolve(solver);
      return solver;
    };
    builds.push(build);
    return build.promise;
  };
  return { builds, deform };
}

const plan = (changes = {}) => ({
  source: {}, settings: {}, pins: [0], start: () => new Float64Array(3), targets: {}, fresh: false, ...changes,
});

/** A session with a first solver. */
async function begun() {
  const { builds, deform } = library();
  const session = new DeformSession({ deform });
  const first = session.build(plan({ solid: solid(), fresh: true }));
  await turn();
  const solver = builds[0].finish();
  await first;
  return { session, builds, solver };
}

describe('building', () => {
  test('of two builds the later one stays; the earlier is overtaken, not failed', async () => {
    const { session, builds, solver } = await begun();
    const [a, b] = [session.build(plan({ settings: { method: 'a' } })), session.build(plan({ settings: { method: 'b' } }))];
    await turn();
    assert.equal(builds.length, 2, 'what was overtaken before its turn is not built');
    const made = builds[1].finish();
    assert.equal(await a, undefined);
    assert.equal(await b, made.start);
    assert.deepEqual([session.problem.settings.method, solver.freed, made.freed], ['b', 1, 0]);
  });

  test('a build that is overtaken on its way frees its solver and its solid; its failure is nobody’s', async () => {
    const { session, builds } = await begun();
    const other = solid('other');
    const slow = session.build(plan({ solid: other, fresh: true }));
    await turn();
    const next = session.build(plan());
    const lost = builds[1].finish();
    await turn();
    assert.equal(await slow, undefined);
    assert.deepEqual([lost.freed, other.freed], [1, 1]);
    const last = session.build(plan());
    builds[2].reject(new Error('too late to matter'));
    assert.equal(await next, undefined);
    await turn();
    const made = builds[3].finish();
    assert.equal(await last, made.start);
    assert.equal(session.solid.freed, 0, 'the solid on the bench is still there');
  });

  test('a failed build leaves solver, records and solid', async () => {
    const { session, builds, solver } = await begun();
    const { records, solid: before } = session;
    const build = session.build(plan({ fresh: true }));
    await turn();
    builds[1].reject(new Error('no'));
    await assert.rejects(build, /no/);
    assert.deepEqual([solver.freed, session.records, session.solid], [0, records, before]);
    assert.equal(session.finished, false);
  });

  test('where it starts is asked for when the run before has ended', async () => {
    const { session, builds, solver } = await begun();
    const run = session.run(() => {});
    await turn();
    const build = session.build(plan({ start: () => session.positions }));
    await solver.runs[0].frame(step(7));
    await Promise.all([run, turn()]);
    assert.equal(solver.cancels, 1);
    assert.equal(builds[1].options.start[0], 7);
    builds[1].finish();
    await build;
  });
});

describe('targets', () => {
  test('those that move during a build go to the solver it makes, the newest alone', async () => {
    const { session, builds, solver } = await begun();
    const build = session.build(plan());
    await session.aim({ n: 1 });
    await turn();
    await session.aim({ n: 2 });
    const made = builds[1].finish('converged');
    await turn();
    assert.deepEqual([solver.targets.length, made.targets.map((sent) => sent.targets.n)], [0, [2]]);
    made.targets[0].resolve();
    await build;
    assert.equal(session.finished, false, 'there is something to do again');
  });

  test('those that wait when a build fails go to the solver that stays', async () => {
    const { session, builds, solver } = await begun();
    session.aim({ n: 1 });
    session.aim({ n: 2 });
    const build = session.build(plan()).catch(() => {});
    await turn();
    builds[1].reject(new Error('no'));
    await turn();
    solver.targets[0].resolve();
    await turn();
    assert.deepEqual(solver.targets.map((sent) => sent.targets.n), [1, 2]);
    solver.targets[1].resolve();
    await build;
  });

  test('one message at a time, only the newest waits', async () => {
    const { session, solver } = await begun();
    const sent = [1, 2, 3].map((n) => session.aim({ n }));
    await turn();
    assert.equal(solver.targets.length, 1);
    solver.targets[0].resolve();
    await turn();
    assert.deepEqual(solver.targets.map(({ targets }) => targets.n), [1, 3]);
    solver.targets[1].resolve();
    await Promise.all(sent);
  });

  test('targets that overtake the news of an end are solved for', async () => {
    const { session, solver } = await begun();
    const run = session.run(() => {});
    await turn();
    const aim = session.aim({ n: 1 });
    solver.targets[0].resolve();
    await aim;
    await solver.runs[0].frame(step(1, 'converged'));
    solver.runs[0].end.resolve();
    await run;
    assert.equal(session.finished, false);
    const again = session.run(() => {});
    await turn();
    assert.equal(solver.runs.length, 2);
    await solver.runs[1].frame(step(2, 'converged'));
    solver.runs[1].end.resolve();
    await again;
    assert.equal(session.finished, true);
    assert.ok(session.certificate);
  });
});

describe('running', () => {
  test('nothing held: the last frame of a run does not wake it, only pins do', async () => {
    const { session, builds, solver } = await begun();
    const run = session.run(() => {});
    await turn();
    const build = session.build(plan());
    session.suspend();
    await solver.runs[0].frame(step(1));
    await run;
    assert.equal(await build, undefined, 'the build with pins that are gone is overtaken');
    assert.equal(builds.length, 1);
    assert.equal(session.finished, true);
    assert.equal(await session.step(), undefined);
    const held = session.build(plan());
    await turn();
    builds[1].finish();
    await held;
    assert.equal(session.finished, false);
  });

  test('a run that was stopped before its turn never begins; a step waits for the run before', async () => {
    const { session, builds, solver } = await begun();
    const build = session.build(plan());
    const run = session.run(() => assert.fail('it was stopped'));
    session.stop();
    await turn();
    const made = builds[1].finish();
    await Promise.all([build, run]);
    assert.equal(made.runs.length + solver.runs.length, 0);
    const second = session.run(() => {});
    const single = session.step();
    await turn();
    assert.deepEqual([made.runs.length, made.steps.length], [1, 0]);
    made.runs[0].end.resolve();
    await Promise.all([second, turn()]);
    made.steps[0].resolve(step(1));
    assert.equal((await single).iteration, 1);
  });

  test('iterations and seconds go on from solver to solver', async () => {
    const { session, builds, solver } = await begun();
    const run = session.run(() => {});
    await turn();
    await solver.runs[0].frame({ ...step(1), phases: [{ milliseconds: 500 }] });
    const build = session.build(plan());
    await Promise.all([run, turn()]);
    const made = builds[1].finish();
    await build;
    const single = session.step();
    await turn();
    made.steps[0].resolve({ ...step(1), phases: [{ milliseconds: 250 }] });
    await single;
    assert.deepEqual(session.records.map(({ iteration, seconds }) => [iteration, seconds]), [[0, 0], [1, 0.5], [2, 0.75]]);
    const { solvers } = await session.trace();
    assert.deepEqual(solvers.map(({ from }) => from), [0, 1], 'a trace says which solver made which iterates');
  });
});
