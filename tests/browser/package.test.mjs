// The package (pkg/) in headless Chromium: threads and their fall-back, panics, big meshes.
import assert from 'node:assert/strict';
import { after, before, describe, it } from 'node:test';
import { mkdtempSync, cpSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { browser as launch } from '../../scripts/lib/browser.mjs';
import { serve } from '../../scripts/serve.mjs';

const site = mkdtempSync(join(tmpdir(), 'foldfree-site-'));
cpSync(fileURLToPath(new URL('../../pkg', import.meta.url)), join(site, 'pkg'), { recursive: true });
writeFileSync(join(site, 'index.html'), '<!doctype html><title>foldfree</title>');
writeFileSync(join(site, 'not-wasm.html'), '<!doctype html><title>not found</title>');

describe('the package in the browser', () => {
  let browser, isolated, plain;
  const pages = [];
  /** Runs `body` (which gets the package and `argument`) in a page of its own. */
  async function inPage(server, body, argument) {
    const page = await browser.newPage();
    pages.push(page);
    await page.goto(server.url);
    return page.evaluate(
      `(async () => { const foldfree = await import('/pkg/index.js'); return (${body})(foldfree, ${JSON.stringify(argument)}); })()`,
    ).finally(() => page.close());
  }

  before(async () => {
    browser = await launch();
    isolated = await serve(site);
    plain = await serve(site, { isolation: false });
  });
  after(async () => {
    await browser?.close();
    await isolated?.close();
    await plain?.close();
    rmSync(site, { recursive: true, force: true });
  });

  it('uses threads where it may, with the same bits as one thread', async () => {
    const { threads, one, equal, progressed } = await inPage(isolated, async ({ load }) => {
      const map = async (options) => {
        const foldfree = await load(options);
        const mesh = await foldfree.generate('bumpy-cap', 20_000);
        const solver = await foldfree.parameterize(mesh, { maxIterations: 10 });
        const last = await solver.run();
        foldfree.terminate();
        return { threads: foldfree.threads, positions: last.positions };
      };
      let progressed = 0;
      const many = await map({ threads: 2, onProgress: (loaded) => (progressed = loaded) });
      const single = await map({ threads: false });
      const [a, b] = [many.positions, single.positions].map((x) => new BigUint64Array(x.buffer));
      return { threads: many.threads, one: single.threads, equal: a.length > 0 && a.every((bits, i) => bits === b[i]), progressed };
    });
    assert.deepEqual({ threads, one }, { threads: 2, one: 1 });
    assert.ok(equal);
    assert.ok(progressed > 100_000);
  });

  it('falls back to one thread without COOP and COEP', async () => {
    const result = await inPage(plain, async ({ load }) => {
      const foldfree = await load({ threads: 4 });
      const solver = await foldfree.parameterize(await foldfree.generate('terrain', 500));
      const last = await solver.run();
      return { threads: foldfree.threads, inverted: last.inverted, isolated: crossOriginIsolated };
    });
    assert.deepEqual(result, { threads: 1, inverted: 0, isolated: false });
  });

  it('falls back to one thread when the pool does not start in time, or its wasm is missing', async () => {
    const result = await inPage(isolated, async ({ load }) => {
      const late = await load({ threads: 2, threadTimeoutMs: 0 });
      const missing = await load({
        threads: 2,
        wasmUrl: '/pkg/single/foldfree_bg.wasm',
        threadsWasmUrl: '/nowhere.wasm',
      });
      return [late.threads, missing.threads];
    });
    assert.deepEqual(result, [1, 1]);
  });

  it('says so when the wasm is a page of HTML or not there', async () => {
    const codes = await inPage(isolated, async ({ load, FoldfreeError }) => {
      const code = (wasmUrl) => load({ threads: false, wasmUrl }).then(
        () => 'loaded',
        (error) => (error instanceof FoldfreeError ? `${error.code}: ${error.message}` : String(error)),
      );
      return [await code('/not-wasm.html'), await code('/nowhere.wasm')];
    });
    assert.match(codes[0], /^wasm-unavailable: .*HTML/);
    assert.match(codes[1], /^wasm-unavailable: .*404/);
  });

  it('errors on the page are typed and the page goes on', async () => {
    const result = await inPage(isolated, async ({ load }) => {
      const foldfree = await load();
      const error = await foldfree.mesh('v 0 0 0\nv 1 0 0\nf 1 2 7\n', 'obj').catch((caught) => caught);
      const mesh = await foldfree.generate('torus', 400);
      return { name: error.name, code: error.code, line: error.line, triangles: mesh.triangleCount > 0 };
    });
    assert.deepEqual(result, { name: 'FoldfreeError', code: 'parse', line: 3, triangles: true });
  });

  it('flattens 100 000 triangles in at most 300 MB of wasm memory', async (context) => {
    for (const threads of [false, 2]) {
      const { bytes, seconds, energy, inverted } = await inPage(isolated, async ({ load }, threads) => {
        const foldfree = await load({ threads });
        const mesh = await foldfree.generate('bumpy-cap', 100_000);
        const began = performance.now();
        const solver = await foldfree.parameterize(mesh, { frames: 'f32', maxIterations: 20 });
        const last = await solver.run();
        const seconds = (performance.now() - began) / 1000;
        await solver.result();
        return { bytes: await foldfree.memoryBytes(), seconds, energy: last.energy, inverted: last.inverted };
      }, threads);
      context.diagnostic(`threads ${threads}: ${(bytes / 1e6).toFixed(0)} MB, ${seconds.toFixed(2)} s for 20 iterations, energy ${energy}`);
      assert.ok(bytes <= 300e6, `${bytes} bytes`);
      assert.equal(inverted, 0);
    }
  });
});
