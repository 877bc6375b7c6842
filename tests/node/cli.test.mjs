// scripts/foldfree-wasm.mjs: the command line on the wasm build.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after, describe, it } from 'node:test';
import { fileURLToPath } from 'node:url';
import { gunzipSync } from 'node:zlib';

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
