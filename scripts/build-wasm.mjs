// Builds the package: Rust → wasm twice (single-thread, threads), TypeScript → JavaScript, all into pkg/.
// Each part is built only when the contents of its sources have changed. `--force` builds all.
import { existsSync, mkdirSync, readFileSync, renameSync, rmSync, statSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { gzipSync } from 'node:zlib';
import { all, main, root, run, say } from './lib/progress.mjs';
import { hash, isStamped, stamp } from './lib/stamp.mjs';
import { buildStd, tools, wasmEnvironment, wasmPack } from './toolchain.mjs';

const RUST_SOURCES = ['Cargo.toml', 'Cargo.lock', 'src', 'scripts/build-wasm.mjs', 'scripts/toolchain.mjs'];
const JS_SOURCES = ['src/js', 'tsconfig.json', 'package-lock.json'];
const WASM_FEATURES = [
  'bulk-memory', 'mutable-globals', 'nontrapping-float-to-int', 'reference-types', 'sign-ext', 'simd', 'multivalue',
];

// faer's dense kernels are explicit SIMD: optimising them for size costs the factorisation nothing.
const SMALL = ['gemm-f64', 'gemm-common'].flatMap((name) => ['--config', `profile.release.package.${name}.opt-level="s"`]);

/** Runs a program of an npm package with this Node. */
export function npmTool(path, args, options) {
  return run(process.execPath, [join(root, 'node_modules', path), ...args], options);
}

/** Shrinks and speeds up a wasm file in place. */
export async function optimise(file, { threads = false, level = '-O3' } = {}) {
  const features = [...WASM_FEATURES, ...(threads ? ['threads'] : [])].map((name) => `--enable-${name}`);
  await npmTool('binaryen/bin/wasm-opt', [file, '-o', file, level, ...features]);
}

function sizeOf(file) {
  const bytes = readFileSync(file);
  return `${Math.round(bytes.length / 1000)} KB, ${Math.round(gzipSync(bytes, { level: 9 }).length / 1000)} KB gzipped`;
}

async function buildOne(threads, force) {
  const name = threads ? 'threads' : 'single';
  const sources = hash(RUST_SOURCES, { skip: ['js'], salt: name });
  const folder = join('pkg', name);
  const wasm = join(root, folder, 'foldfree_bg.wasm');
  if (!force && isStamped(join('pkg', `.${name}.stamp`), sources) && existsSync(wasm)) return;
  const [env, pack] = [await wasmEnvironment({ threads }), await wasmPack()];
  // Built beside its place, and moved when it is good.
  const building = join('target', 'pkg', name);
  rmSync(join(root, building), { recursive: true, force: true });
  const args = [
    'build', '.', '--release', '--target', 'web', '--mode', 'no-install', '--no-opt', '--no-pack',
    '--out-dir', building, '--out-name', 'foldfree', '--',
    ...buildStd, ...SMALL, '--no-default-features', ...(threads ? ['--features', 'threads'] : []),
  ];
  await run(pack, args, {
    env, label: `building wasm (${name})`, estimate: '2 minutes', log: join(tools, 'logs', `wasm-${name}.log`),
  });
  await optimise(join(root, building, 'foldfree_bg.wasm'), { threads });
  rmSync(join(root, building, '.gitignore'), { force: true }); // wasm-pack's; it would keep npm from packing
  rmSync(join(root, folder), { recursive: true, force: true });
  mkdirSync(join(root, 'pkg'), { recursive: true });
  renameSync(join(root, building), join(root, folder));
  stamp(join('pkg', `.${name}.stamp`), sources);
  say(`  pkg/${name}: ${sizeOf(wasm)}`);
}

async function buildScripts(force) {
  const types = statSync(join(root, 'pkg/single/foldfree.d.ts')).size;
  const sources = hash(JS_SOURCES, { salt: String(types) });
  if (!force && isStamped('pkg/.js.stamp', sources) && existsSync(join(root, 'pkg/index.js'))) return;
  await npmTool('typescript/bin/tsc', ['-p', 'tsconfig.json'], { label: 'compiling TypeScript' });
  stamp('pkg/.js.stamp', sources);
}

/** Builds what is out of date; `threads: false` leaves the threaded build out. */
export async function buildPackage({ force = false, threads = true } = {}) {
  // What is missing is installed once, before the two builds ask for it side by side: most of each is the
  // optimisation of one large unit, on one core.
  await wasmEnvironment();
  await wasmPack();
  await all(buildOne(false, force), ...(threads ? [buildOne(true, force)] : []));
  await buildScripts(force);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  main(() => buildPackage({ force: process.argv.includes('--force') }));
}
