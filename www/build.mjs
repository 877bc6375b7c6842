// Builds the page: www (Rust, egui) → wasm → www/dist/, a static folder with its own copy of pkg/.
// Each part is built only when the contents of its sources have changed. `--force` builds all.
import { cpSync, existsSync, mkdirSync, readFileSync, rmSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { optimise } from '../scripts/build-wasm.mjs';
import { main, root, run, say } from '../scripts/lib/progress.mjs';
import { hash, isStamped, stamp } from '../scripts/lib/stamp.mjs';
import { buildStd, tools, wasmBindgen, wasmEnvironment } from '../scripts/toolchain.mjs';

const dist = join(root, 'www/dist');
const CANVAS_SOURCES = ['Cargo.lock', 'www/Cargo.toml', 'www/src', 'www/assets/fonts', 'www/build.mjs', 'scripts/toolchain.mjs'];
// The canvas is large and not hot: small, and quick to build. The profile in Cargo.toml is the solver's.
const PROFILE = {
  CARGO_PROFILE_RELEASE_OPT_LEVEL: 's', CARGO_PROFILE_RELEASE_DEBUG: 'false',
  CARGO_PROFILE_RELEASE_LTO: 'false', CARGO_PROFILE_RELEASE_CODEGEN_UNITS: '16',
};
const CANVAS = 'www/dist/canvas/foldfree_www_bg.wasm';

async function buildCanvas(force) {
  const sources = hash(CANVAS_SOURCES);
  if (!force && isStamped('www/dist/.canvas.stamp', sources) && existsSync(join(root, CANVAS))) return;
  const env = await wasmEnvironment();
  Object.assign(env, PROFILE);
  const args = ['build', '--release', '--package', 'foldfree-www', '--target', 'wasm32-unknown-unknown', ...buildStd];
  await run('cargo', args, {
    env, label: 'building the canvas', estimate: '4 minutes', log: join(tools, 'logs', 'canvas.log'),
  });
  const wasm = join(env.CARGO_TARGET_DIR, 'wasm32-unknown-unknown/release/foldfree_www.wasm');
  await run(await wasmBindgen(), ['--target', 'web', '--no-typescript', '--out-dir', join(dist, 'canvas'), wasm]);
  await optimise(join(root, CANVAS), { level: '-Os' });
  stamp('www/dist/.canvas.stamp', sources);
  const bytes = readFileSync(join(root, CANVAS));
  say(`  www/dist/canvas: ${Math.round(bytes.length / 1000)} KB, ${Math.round(gzipSync(bytes).length / 1000)} KB gzipped`);
}

/** Copies what needs no building. */
function assemble() {
  const copy = (from, to = from.replace(/^www\//, '')) => cpSync(join(root, from), join(dist, to), { recursive: true });
  for (const name of ['index.html', 'style.css', 'round.css', 'icon.svg', 'page']) copy(`www/${name}`);
  copy('www/assets/fonts', 'fonts');
  for (const name of ['start.bin', 'start-deform.bin']) if (existsSync(join(root, 'www/assets', name))) copy(`www/assets/${name}`, name);
  rmSync(join(dist, 'fonts/subset.py'), { force: true });
  if (existsSync(join(root, 'pkg/index.js'))) {
    rmSync(join(dist, 'pkg'), { recursive: true, force: true });
    cpSync(join(root, 'pkg'), join(dist, 'pkg'), { recursive: true, filter: (path) => !/\.(d\.ts|stamp)$/.test(path) });
  }
}

/** Builds what is out of date. The package (pkg/) has to be there. */
export async function buildPage({ force = false } = {}) {
  mkdirSync(dist, { recursive: true });
  await buildCanvas(force);
  assemble();
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  main(() => buildPage({ force: process.argv.includes('--force') }));
}
