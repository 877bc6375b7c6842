// scripts/foldfree-wasm.mjs: the command line on the wasm build.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, before, describe, it } from 'node:test';
import { fileURLToPath } from 'node:url';
import { gunzipSync, gzipSync } from 'node:zlib';

const folder = mkdtempSync(join(tmpdir(), 'foldfree-cli-'));
after(() => rmSync(folder, { recursive: true, force: true }));
const file = (name) => join(folder, name);
const script = fileURLToPath(new URL('../../scripts/foldfree-wasm.mjs', import.meta.url));
const foldfree = (...args) => spawnSync(process.execPath, [script, ...args], { encoding: 'utf8' });
const json = (name) => JSON.parse(readFileSync(file(name), 'utf8'));

describe('the command line in WebAssembly', () => {
  it('generates, flattens and checks', () => {
    assert.equal(foldfree('generate', 'torus', '--triangles', '800', '--out', file('torus.obj')).status, 0);
    const flat = foldfree('parameterize', file('torus.obj'), '--out', file('flat.obj.gz'), '--report', file('flat.json'), '--quiet');
    assert.equal(flat.status, 0, flat.stderr);
    assert.equal(flat.stderr, '');
    const report = json('flat.json');
    assert.equal(report.status, 'converged');
    assert.equal(report.options.max_iterations, 5000);
    assert.ok(report.seam_edges > 0 && report.setup_seconds >= 0 && report.certificate_seconds >= 0);
    report.iterations.forEach((row, i) => assert.equal(row.iteration, i));
    const last = report.iterations.at(-1);
    for (const key of ['seconds', 'energy', 'inverted', 'gradient_norm', 'smallest_sigma', 'lbfgs_iterations', 'reweighted', 'phases']) {
      assert.ok(key in last, key);
    }
    assert.equal(report.certificate.locally_injective, true);

    assert.match(gunzipSync(readFileSync(file('flat.obj.gz'))).toString(), /^vt /m);
    const checked = foldfree('check', file('flat.obj.gz'), '--report', file('check.json'));
    assert.equal(checked.status, 0, checked.stderr);
    assert.deepEqual(json('check.json').certificate.inverted, []);
    // Coordinates are written so that they read back bit by bit; only the order of the sums may differ.
    const energies = [json('check.json').certificate.symmetric_dirichlet, report.certificate.symmetric_dirichlet];
    assert.ok(Math.abs(energies[0] / energies[1] - 1) < 1e-12, String(energies));
  });

  it('ends with 2 when it ran out of iterations', () => {
    foldfree('generate', 'bumpy-cap', '--triangles', '500', '--out', file('cap.obj'));
    const { status } = foldfree('parameterize', file('cap.obj'), '--iterations', '2', '--method', 'wrapd', '--no-reweighting', '--report', file('cap.json'));
    assert.equal(status, 2);
    assert.equal(json('cap.json').options.method, 'r-admm');
    assert.equal(json('cap.json').iterations.length, 3);
  });

  it('has the second-order methods, and reports when a hybrid switched', () => {
    foldfree('generate', 'bumpy-cap', '--triangles', '500', '--out', file('cap.obj'));
    for (const method of ['cm', 'slim', 'wrapd+cm']) {
      const { status, stderr } = foldfree('parameterize', file('cap.obj'), '--method', method, '--report', file('second.json'));
      assert.equal(status, 0, stderr);
      const { options, iterations } = json('second.json');
      assert.equal(options.method, method);
      const switched = iterations.map((iteration) => iteration.switched_at).filter((at) => at !== undefined);
      assert.equal(switched.length > 0, method === 'wrapd+cm', method);
      assert.equal(switched.length, switched.length && iterations.length - switched[0], 'from that iteration on');
      assert.ok(switched.every((at) => at === switched[0] && at >= 1));
    }
    foldfree('generate', 'bar', '--tetrahedra', '300', '--out', file('bar.mesh'));
    writeFileSync(file('pin.txt'), '0\n1\n');
    const { status, stderr } = foldfree('deform', '--init', file('bar.mesh'), '--pins', file('pin.txt'), '--method', 'newton', '--report', file('newton.json'));
    assert.equal(status, 0, stderr);
    assert.equal(json('newton.json').options.method, 'newton');
  });

  it('ends with 1 and one line on an error', () => {
    writeFileSync(file('bad.obj'), 'v 0 0 0\nv 1 0 0\nf 1 2 5\n');
    for (const args of [
      ['parameterize', file('bad.obj'), '--quiet'],
      ['parameterize', file('missing.obj')],
      ['parameterize', file('cap.obj'), '--iterations', 'many'],
      ['parameterize', file('cap.obj'), '--method', 'magic'],
      ['parameterize', file('cap.obj'), '--speed', '9'],
      ['check', file('cap.obj')],
      ['unfold'],
      [],
    ]) {
      const { status, stderr } = foldfree(...args);
      assert.equal(status, 1, `${args}: ${stderr}`);
      assert.equal(stderr.trim().split('\n').length, 1, stderr);
    }
    assert.match(foldfree('parameterize', file('bad.obj')).stderr, /bad\.obj: line 3/);
  });
});

/** A vertex a line: `index x y z`. */
const nodes = (name) => {
  const text = /\.gz$/.test(name) ? gunzipSync(readFileSync(file(name))).toString() : readFileSync(file(name), 'utf8');
  return text.trim().split('\n').slice(1).map((line) => line.trim().split(/\s+/).slice(1).map(Number));
};
const nodeFile = (points, first = 0) =>
  [`${points.length} 3 0 0`, ...points.map((point, v) => `${v + first} ${point.join(' ')}`)].join('\n');
const handleFile = (vertices, line = (v) => v) => `# handles\n\n${vertices.map((v) => line(v)).join('\n')}\n`;

describe('the command line on solids', () => {
  let rest, left, right;
  const turned = ([x, y, z], angle) => [x, Math.cos(angle) * y - Math.sin(angle) * z, Math.sin(angle) * y + Math.cos(angle) * z];
  const far = (a, b) => Math.max(...a.map((point, v) => Math.hypot(...point.map((x, i) => x - b[v][i]))));

  before(() => {
    const made = foldfree('generate', 'bar', '--tetrahedra', '600', '--out', file('bar.node'));
    assert.equal(made.status, 0, made.stderr);
    rest = nodes('bar.node');
    const xs = rest.map(([x]) => x);
    const [low, high] = [Math.min(...xs), Math.max(...xs)];
    const all = [...rest.keys()];
    left = all.filter((v) => xs[v] - low < 1e-9 * (high - low));
    right = all.filter((v) => high - xs[v] < 1e-9 * (high - low));
    assert.ok(left.length > 3 && right.length > 3);
    writeFileSync(file('pins.txt'), handleFile([...left, ...right]));
    // Both ends as at rest, the middle turned; indices from 1.
    const bend = ([x, y, z]) => turned([x, y, z], 1.5 * Math.sin(Math.PI * Math.min(1, Math.max(0, (x - low) / (high - low)))) ** 2);
    const twisted = rest.map((point, v) => (left.includes(v) || right.includes(v) ? point : bend(point)));
    writeFileSync(file('twisted.node.gz'), gzipSync(nodeFile(twisted, 1)));
    assert.ok(far(twisted, rest) > 0.1);
  });

  it('deforms back to rest, and says so in a report', () => {
    const ran = foldfree(
      'deform', '--rest', file('bar.ele'), '--init', file('twisted.node'), '--pins', file('pins.txt'), '--reference', file('bar.node'),
      '--out', file('back.node.gz'), '--report', file('back.json'), '--energy', 'arap', '--quiet',
    );
    assert.equal(ran.status, 0, ran.stderr);
    assert.equal(ran.stderr, '');
    const report = json('back.json');
    assert.deepEqual(Object.keys(report), [
      'program', 'rest', 'init', 'status', 'criterion', 'options', 'threads', 'vertices', 'tetrahedra', 'pins', 'targets',
      'notes', 'setup_seconds', 'seconds', 'iterations', 'certificate', 'certificate_seconds', 'memory_bytes',
    ]);
    assert.equal(report.status, 'converged');
    assert.ok(['energy-change', 'gradient-norm'].includes(report.criterion), report.criterion);
    assert.deepEqual(report.options.material, { energy: 'arap' });
    assert.equal(report.options.max_iterations, 5000);
    assert.equal(report.vertices, rest.length);
    assert.deepEqual([report.pins, report.targets], [left.length + right.length, 0]);
    report.iterations.forEach((row, i) => assert.equal(row.iteration, i));
    assert.equal(report.iterations[0].position_error, 1);
    const last = report.iterations.at(-1);
    assert.ok(last.position_error < 1e-3 && last.energy < 1e-6 * report.iterations[0].energy, JSON.stringify(last));
    for (const key of ['seconds', 'inverted', 'gradient_norm', 'smallest_sigma', 'largest_sigma', 'lbfgs_iterations', 'reweighted', 'phases']) {
      assert.ok(key in last, key);
    }
    assert.equal(report.certificate.locally_injective, true);
    assert.ok(far(nodes('back.node.gz'), rest) < 1e-2);

    const checked = foldfree('check', file('back.node'), '--rest', file('bar.node'), '--report', file('check.json'));
    assert.equal(checked.status, 0, checked.stderr);
    assert.deepEqual(json('check.json').certificate, report.certificate);
  });

  it('moves pinned vertices to their targets and pulls at free ones, in every format', () => {
    const lifted = (v) => `${v} ${turned(rest[v], 0.5).join(' ')} # turned`;
    writeFileSync(file('targets.txt'), handleFile(right, lifted));
    writeFileSync(file('left.txt'), handleFile(left));
    const common = ['--pins', file('left.txt'), '--targets', file('targets.txt'), '--report', file('moved.json')];
    const error = (points) => Math.max(...right.map((v) => far([points[v]], [turned(rest[v], 0.5)])));

    assert.equal(foldfree('deform', '--init', file('bar.node'), ...common, '--hard', '--out', file('hard.node')).status, 0);
    assert.deepEqual([json('moved.json').pins, json('moved.json').targets], [left.length + right.length, right.length]);
    const hard = error(nodes('hard.node'));
    assert.ok(hard < 1e-12, String(hard));
    const soft = ['--target-stiffness', '0.5', '--young', '3', '--poisson', '0.3'];
    assert.equal(foldfree('deform', '--init', file('bar.node'), ...common, ...soft, '--out', file('soft.node')).status, 0);
    assert.deepEqual(json('moved.json').options.material, { energy: 'neo-hookean', young: 3, poisson: 0.3 });
    assert.equal(json('moved.json').options.target_stiffness, 0.5);
    const off = error(nodes('soft.node'));
    assert.ok(off > 1e-3 && off < error(rest), `${off}, ${error(rest)}`);

    for (const name of ['moved.mesh', 'moved.msh.gz', 'moved.vtk', 'moved.obj']) {
      const ran = foldfree('deform', '--init', file('bar.node'), ...common, '--hard', '--iterations', '3', '--method', 'l-bfgs', '--out', file(name));
      assert.equal(ran.status, 2, ran.stderr);
      assert.equal(json('moved.json').status, 'max-iterations');
      assert.equal(json('moved.json').iterations.length, 4);
      if (name === 'moved.obj') continue; // the boundary, which is no start
      const again = foldfree('deform', '--rest', file('bar.node'), '--init', file(name), '--pins', file('pins.txt'), '--iterations', '0', '--report', file('again.json'));
      assert.equal(again.status, 2, again.stderr);
      assert.equal(json('again.json').iterations.length, 1);
      assert.equal(foldfree('check', file(name), '--rest', file('bar.node')).status, 0);
    }
    assert.match(readFileSync(file('moved.obj'), 'utf8'), /^f /m);
  });

  it('finds what folds', () => {
    const folded = rest.map((point) => [...point]);
    const inside = rest.findIndex((_, v) => !left.includes(v) && !right.includes(v));
    folded[inside][0] += 10;
    writeFileSync(file('folded.node'), nodeFile(folded));
    const checked = foldfree('check', file('folded.node'), '--rest', file('bar.node'), '--report', file('folded.json'));
    assert.equal(checked.status, 2, checked.stderr);
    assert.ok(json('folded.json').certificate.inverted.length > 0);
  });

  it('generates every solid that it names', () => {
    const { stderr } = foldfree('generate', 'teapot', '--out', file('teapot.node'));
    const names = stderr.match(/there are (.*)\)/)[1].split(', ');
    assert.ok(names.includes('bar') && names.includes('hand') && names.includes('torus'), stderr);
    for (const name of names.slice(names.indexOf('bar'))) {
      const out = file(`${name}.ele.gz`);
      assert.equal(foldfree('generate', name, '--tetrahedra', '500', '--out', out).status, 0);
      assert.ok(nodes(`${name}.node.gz`).length > 100);
      assert.equal(foldfree('check', out, '--rest', out).status, 0);
    }
  });

  it('names the file, line or argument that is wrong', () => {
    const bar = file('bar.node');
    const pins = ['--pins', file('pins.txt')];
    const written = (name, text) => {
      writeFileSync(file(name), text);
      return file(name);
    };
    const few = rest.slice(0, 20);
    for (const [words, ...args] of [
      [/far\.txt: line 3: vertex 999999 of \d+ \(the first is 0\)/, '--init', bar, '--pins', written('far.txt', '0\n\n999999\n')],
      [/two\.txt: line 1: expected a vertex index, found "1 2"/, '--init', bar, '--pins', written('two.txt', '1 2\n')],
      [/word\.txt: line 2: expected a vertex index, found "-1"/, '--init', bar, '--pins', written('word.txt', '0 # fine\n-1\n')],
      [/nan\.txt: line 1: expected a finite coordinate, found "nan"/, '--init', bar, ...pins, '--targets', written('nan.txt', '0 0 nan 0\n')],
      [/short\.txt: line 2: expected "index x y z", found "1 2"/, '--init', bar, ...pins, '--targets', written('short.txt', '\n1 2\n')],
      [/missing\.node: no such file/, '--init', file('missing.node'), ...pins],
      [/missing\.txt: no such file/, '--init', bar, '--pins', file('missing.txt')],
      [/lonely\.ele: no such file/, '--init', written('lonely.node', nodeFile(few)), ...pins],
      [/lonely\.node: has 20 vertices, the rest shape \d+/, '--rest', bar, '--init', file('lonely.node'), ...pins],
      [/lonely\.node: has 20 vertices, the start \d+/, '--init', bar, ...pins, '--reference', file('lonely.node')],
      [/broken\.node: line 3/, '--rest', bar, '--init', written('broken.node', '4 3 0 0\n0 0 0 0\n1 x 0 0\n2 0 1 0\n3 0 0 1\n'), ...pins],
      [/solid\.stl: the format is not known/, '--init', file('solid.stl'), ...pins],
      [/float away/, '--init', bar],
      [/--hard goes with --targets/, '--init', bar, ...pins, '--hard'],
      [/--init is needed/, '--rest', bar, ...pins],
      [/poisson/, '--init', bar, ...pins, '--poisson', '0.5'],
      [/--young: "stiff" is not a number/, '--init', bar, ...pins, '--young', 'stiff'],
      [/--iterations: "1.5" is not a whole number/, '--init', bar, ...pins, '--iterations', '1.5'],
      [/energy.*neo-hookean/, '--init', bar, ...pins, '--energy', 'rubber'],
      [/method/, '--init', bar, ...pins, '--method', 'magic'],
      [/nowhere.*: its folder does not exist/, '--init', bar, ...pins, '--out', join(file('nowhere'), 'a.node')],
      [/a\.foo: the format is not known/, '--init', bar, ...pins, '--out', file('a.foo')],
    ]) {
      const { status, stderr } = foldfree('deform', ...args);
      assert.equal(status, 1, `${args}: ${stderr}`);
      assert.match(stderr, words);
      assert.equal(stderr.trim().split('\n').length, 1, stderr);
    }
    for (const [words, ...args] of [
      [/bar\.node: .*--rest/, 'check', bar],
      [/--global/, 'check', bar, '--rest', bar, '--global'],
      [/lonely\.node: has 20 vertices/, 'check', file('lonely.node'), '--rest', bar],
      [/bar\.foo/, 'generate', 'bar', '--out', file('bar.foo')],
      [/--tetrahedra/, 'generate', 'bar', '--tetrahedra', '0', '--out', file('b.node')],
    ]) {
      const { status, stderr } = foldfree(...args);
      assert.equal(status, 1, `${args}: ${stderr}`);
      assert.match(stderr, words);
    }
  });
});

describe('the command line untangles', () => {
  const n = 13;
  /** The unit grid with these vertices. */
  const grid = (points) => {
    const lines = points.map((point) => `v ${point.join(' ')}`);
    for (let j = 0; j + 1 < n; j += 1) {
      for (let i = 1; i < n; i += 1) {
        const a = j * n + i;
        lines.push(`f ${a} ${a + 1} ${a + n + 1}`, `f ${a} ${a + n + 1} ${a + n}`);
      }
    }
    return `${lines.join('\n')}\n`;
  };
  const rest = Array.from({ length: n * n }, (_, v) => [(v % n) / (n - 1), Math.floor(v / n) / (n - 1), 0]);
  const isRim = (v) => v % n === 0 || v % n === n - 1 || v < n || v >= n * n - n;
  const rim = rest.map((_, v) => v).filter(isRim);

  before(() => {
    let state = 3;
    const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32;
    writeFileSync(file('grid.obj'), grid(rest));
    writeFileSync(file('tangled.obj'), grid(rest.map((point, v) => (isRim(v) ? point : [random(), random(), 0]))));
    writeFileSync(file('rim.txt'), handleFile(rim));
  });

  it('triangles in a plane, with a report as the native program writes it', () => {
    const common = ['untangle', '--rest', file('grid.obj'), '--init', file('tangled.obj'), '--pins', file('rim.txt')];
    assert.equal(foldfree('check', file('tangled.obj'), '--rest', file('grid.obj'), '-q').status, 2);
    const ran = foldfree(...common, '--out', file('free.obj.gz'), '--report', file('u.json'), '--quiet');
    assert.equal(ran.status, 0, ran.stderr);
    assert.equal(ran.stderr, '');
    assert.equal(foldfree('check', file('free.obj.gz'), '--rest', file('grid.obj'), '--global', '-q').status, 0);
    const report = json('u.json');
    assert.deepEqual(Object.keys(report), [
      'program', 'rest', 'init', 'status', 'criterion', 'energy', 'options', 'threads', 'vertices', 'elements', 'pins', 'targets',
      'notes', 'setup_seconds', 'seconds', 'iterations', 'outcome', 'certificate', 'certificate_seconds', 'memory_bytes',
    ]);
    assert.deepEqual([report.status, report.criterion, report.energy], ['converged', 'injective', 'arap']);
    assert.deepEqual([report.elements, report.pins, report.targets], [2 * (n - 1) ** 2, rim.length, 0]);
    assert.deepEqual(Object.keys(report.options).sort(), [
      'contact_offset', 'max_iterations', 'max_polish_iterations', 'max_qp_iterations', 'offset', 'overlap', 'settle', 'target_stiffness',
    ]);
    assert.deepEqual(report.outcome.not_positive, []);
    assert.ok(report.outcome.smallest_measure > 0 && report.iterations[0].inverted > 50);
    assert.equal(report.certificate.globally_injective, true);
    const last = report.iterations.at(-1);
    assert.ok(last.inverted === 0 && last.gini.first_offset > 0 && Array.isArray(last.gini.polish));
    // a corner is taken elsewhere
    writeFileSync(file('corner.txt'), `${n * n - 1} 1.4 1.3\n`);
    assert.equal(foldfree(...common, '--targets', file('corner.txt'), '--hard', '--energy', 'symmetric-dirichlet', '--out', file('free.off')).status, 0);
    assert.match(readFileSync(file('free.off'), 'utf8'), /^1\.4 1\.3 0$/m);
  });

  it('minimizes what is free, and names the same options whether overlap counts or not', () => {
    const common = ['untangle', '--rest', file('grid.obj'), '--init', file('tangled.obj'), '--pins', file('rim.txt'), '--quiet'];
    const found = (...more) => {
      const ran = foldfree(...common, ...more, '--report', file('m.json'));
      assert.equal(ran.status, 0, ran.stderr);
      return json('m.json');
    };
    const dirichlet = ['--energy', 'symmetric-dirichlet'];
    const [free, least] = [found(...dirichlet), found(...dirichlet, '--minimize', '--tolerance', '1e-9', '--out', file('least.obj'))];
    assert.deepEqual([free.minimized_to, least.minimized_to, least.status], [undefined, 1e-9, 'converged']);
    for (const { outcome, certificate } of [free, least]) {
      assert.deepEqual([outcome.not_positive, certificate.inverted, certificate.degenerate], [[], [], []]);
      assert.ok(outcome.smallest_measure > 0);
    }
    assert.equal(foldfree('check', file('least.obj'), '--rest', file('grid.obj'), '-q').status, 0);
    const [before, after_] = [free, least].map(({ iterations }) => iterations.at(-1));
    assert.ok(after_.iteration > before.iteration && after_.energy < before.energy, `${after_.energy}, ${before.energy}`);
    assert.ok(before.gini && !after_.gini, 'the last steps are Newton’s');
    writeFileSync(file('calm.obj'), grid(rest));
    const calm = ['untangle', '--rest', file('grid.obj'), '--init', file('calm.obj'), '--quiet', '--report', file('o.json')];
    const options = (...more) => (assert.equal(foldfree(...calm, ...more).status, 0), Object.keys(json('o.json').options));
    assert.deepEqual(options('--overlap'), options());
    const refused = foldfree(...common, '--minimize');
    assert.equal(refused.status, 1);
    assert.match(refused.stderr, /arap/);
  });

  it('solids', () => {
    assert.equal(foldfree('generate', 'box', '--tetrahedra', '500', '--out', file('box.node')).status, 0);
    let state = 8;
    const random = () => (state = (Math.imul(state, 1664525) + 1013904223) >>> 0) / 2 ** 32 - 0.5;
    writeFileSync(file('shaken.node'), nodeFile(nodes('box.node').map((point) => point.map((x) => x + 0.5 * random()))));
    const common = ['untangle', '--rest', file('box.node'), '--init', file('shaken.node'), '--report', file('u.json')];
    assert.equal(foldfree('check', file('shaken.node'), '--rest', file('box.node')).status, 2);
    const ran = foldfree(...common, '--energy', 'neo-hookean', '--young', '2', '--out', file('calm.node'));
    assert.equal(ran.status, 0, ran.stderr);
    assert.match(ran.stderr, /converged after \d+ steps.*0 inverted or degenerate/);
    assert.equal(json('u.json').energy, 'neo-hookean');
    assert.equal(foldfree('check', file('calm.node'), '--rest', file('box.node')).status, 0);
    assert.equal(foldfree(...common, '--iterations', '0').status, 2);
    assert.deepEqual([json('u.json').status, json('u.json').iterations.length], ['max-iterations', 1]);
  });

  it('says what cannot be, and what is wrong', () => {
    writeFileSync(file('turned.obj'), grid(rest.map(([x, y, z]) => [1 - x, y, z])));
    const ran = foldfree('untangle', '--rest', file('grid.obj'), '--init', file('turned.obj'), '--pins', file('rim.txt'));
    assert.equal(ran.status, 2, ran.stderr);
    assert.match(ran.stderr, /pinned boundary encloses/);
    for (const [words, ...args] of [
      [/--init is needed/, '--rest', file('grid.obj')],
      [/--hard goes with --targets/, '--init', file('grid.obj'), '--hard'],
      [/--flow needs --overlap/, '--init', file('grid.obj'), '--flow'],
      [/energy/, '--init', file('grid.obj'), '--energy', 'neo-hookean'],
      [/energy.*arap/, '--init', file('grid.obj'), '--energy', 'rubber'],
      [/a\.node: the format is not known/, '--init', file('grid.obj'), '--out', file('a.node')],
      [/box\.node: the format is not known/, '--rest', file('grid.obj'), '--init', file('box.node')],
      [/rim\.txt: line 6: vertex \d+ of 3/, '--init', file('one.obj'), '--pins', file('rim.txt')],
    ]) {
      writeFileSync(file('one.obj'), 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n');
      const { status, stderr } = foldfree('untangle', ...args);
      assert.equal(status, 1, `${args}: ${stderr}`);
      assert.match(stderr, words);
      assert.equal(stderr.trim().split('\n').length, 1, stderr);
    }
  });
});
