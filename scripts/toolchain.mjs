// Finds what building for the browser needs, and installs what it can into `.tools/` (or FOLDFREE_TOOLS).
// Run by itself it prints what it found.
import { existsSync, mkdirSync, readdirSync, readFileSync, rmSync, symlinkSync } from 'node:fs';
import { homedir } from 'node:os';
import { delimiter, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { ask, main, root, run, say, Unmet } from './lib/progress.mjs';

/** The folder that keeps the tools between runs. */
export const tools = process.env.FOLDFREE_TOOLS ?? join(root, '.tools');

const TARGET = 'wasm32-unknown-unknown';
const DEBIAN_RUST = ['rustc-web', 'cargo-web', 'rust-web-src', 'lld-22'];
const WASM_PACK = '0.15.1';
const CARGO_DENY = '0.20.2';
const isRoot = () => process.getuid?.() === 0;

/** PATH with our tools first. */
function pathWith(...folders) {
  return [...folders, join(tools, 'bin'), process.env.PATH].join(delimiter);
}

/** The first of `names` that is on PATH, as a full path. */
async function which(...names) {
  for (const name of names) {
    const found = await ask('sh', ['-c', 'command -v "$0"', name]);
    if (found) return found;
  }
  return undefined;
}

let aptUpdated = false;
/** Installs Debian packages, where this is a Debian and we are root; says whether it did. */
async function aptInstall(packages, label, estimate) {
  if (!isRoot() || !(await which('apt-get'))) return false;
  const env = { ...process.env, DEBIAN_FRONTEND: 'noninteractive' };
  const log = join(tools, 'logs', 'apt.log');
  if (!aptUpdated) {
    await run('apt-get', ['update', '-q'], { label: 'updating the package lists', env, log, check: false });
    aptUpdated = true;
  }
  if ((await ask('apt-cache', ['show', ...packages])) === undefined) return false;
  const { code } = await run('apt-get', ['install', '-qy', '--no-install-recommends', ...packages], {
    label, estimate, env, log, check: false,
  });
  return code === 0;
}

/** The native cargo; everything starts from it. */
async function nativeCargo() {
  if (!(await which('cargo'))) {
    throw new Unmet('cargo is not on PATH: install Rust (1.95 or newer) with rustup.');
  }
}

/** A rustup nightly that really has the sources of std and the wasm target. */
async function rustupNightly() {
  const list = await ask('rustup', ['toolchain', 'list']);
  for (const name of (list ?? '').split('\n').map((line) => line.split(' ')[0])) {
    if (!name.startsWith('nightly')) continue;
    const sysroot = await ask('rustc', [`+${name}`, '--print', 'sysroot']);
    if (!sysroot) continue;
    const lib = join(sysroot, 'lib', 'rustlib');
    if (existsSync(join(lib, 'src', 'rust', 'library', 'std')) && existsSync(join(lib, TARGET))) {
      return { name: `rustup ${name}`, env: { RUSTUP_TOOLCHAIN: name } };
    }
  }
  return undefined;
}

/** Debian's compiler, when it is there with the sources of std, a linker and a place for the target. */
async function debianRust() {
  const linkers = existsSync('/usr/bin') ? readdirSync('/usr/bin').filter((name) => /^wasm-ld-\d+$/.test(name)) : [];
  const linker = linkers.sort((a, b) => Number(b.split('-')[2]) - Number(a.split('-')[2]))[0];
  if (!existsSync('/usr/bin/rustc') || !existsSync('/usr/bin/cargo') || !linker) return undefined;
  const sysroot = await ask('/usr/bin/rustc', ['--print', 'sysroot']);
  const lib = sysroot && join(sysroot, 'lib', 'rustlib');
  if (!lib || !existsSync(join(lib, 'src', 'rust', 'library', 'std'))) return undefined;
  if (!existsSync(join(lib, TARGET, 'lib'))) {
    if (!isRoot()) return undefined;
    mkdirSync(join(lib, TARGET, 'lib'), { recursive: true }); // wasm-pack looks for it; build-std fills in for it
  }
  // A folder with just this cargo and rustc, to put before any others on PATH.
  const shims = join(tools, 'debian-rust');
  mkdirSync(shims, { recursive: true });
  for (const name of ['cargo', 'rustc', 'cargo-clippy', 'clippy-driver']) {
    rmSync(join(shims, name), { force: true });
    symlinkSync(`/usr/bin/${name}`, join(shims, name));
  }
  return {
    name: `Debian ${await ask('/usr/bin/rustc', ['--version'])}`,
    shims,
    env: {
      RUSTC: '/usr/bin/rustc',
      RUSTC_BOOTSTRAP: '1',
      RUSTUP_TOOLCHAIN: undefined,
      CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER: `/usr/bin/${linker}`,
    },
  };
}

let wasmRustFound;
/** The compiler for wasm: `{ name, env, shims? }`. */
export function wasmRust() {
  wasmRustFound ??= (async () => {
    const found = (await rustupNightly()) ?? (await debianRust());
    if (found) return found;
    if (await aptInstall(DEBIAN_RUST, "installing Debian's Rust for WebAssembly", '1 minute')) {
      const debian = await debianRust();
      if (debian) return debian;
    }
    throw new Unmet(
      'no Rust compiler for threaded WebAssembly was found: run ' +
        `\`rustup toolchain install nightly --component rust-src --target ${TARGET}\`` +
        ` (or, on Debian, \`apt-get install ${DEBIAN_RUST.join(' ')}\` as root).`,
    );
  })();
  return wasmRustFound;
}

/** The clippy that goes with that compiler. */
export async function wasmClippy() {
  const rust = await wasmRust();
  if (rust.shims) {
    if (existsSync('/usr/bin/cargo-clippy')) return;
    if (await aptInstall(['rust-web-clippy'], "installing Debian's clippy", '20 seconds')) return;
    throw new Unmet("Debian's clippy is needed: run `apt-get install rust-web-clippy` as root.");
  }
  const { RUSTUP_TOOLCHAIN: toolchain } = rust.env;
  if (!(await ask('cargo', [`+${toolchain}`, 'clippy', '--version']))) {
    throw new Unmet(`clippy is needed: run \`rustup component add clippy --toolchain ${toolchain}\`.`);
  }
}

/** The version of a crate in Cargo.lock. */
export function lockedVersion(name) {
  const lock = readFileSync(join(root, 'Cargo.lock'), 'utf8');
  const match = lock.match(new RegExp(`name = "${name}"\\nversion = "([^"]+)"`));
  if (!match) throw new Unmet(`Cargo.lock does not name ${name}: run \`cargo metadata\` once.`);
  return match[1];
}

/** A binary of ours at exactly `version`, built by cargo when it is missing. */
async function cargoTool(crate, binary, version, estimate) {
  const path = join(tools, 'bin', binary);
  const has = async (file) => (await ask(file, ['--version']))?.split(/\s+/).includes(version);
  if (await has(path)) return path;
  const elsewhere = await which(binary);
  if (elsewhere && (await has(elsewhere))) return elsewhere;
  await nativeCargo();
  const env = { ...process.env, CARGO_TARGET_DIR: join(tools, 'build') };
  const options = { env, log: join(tools, 'logs', `${crate}.log`), label: `installing ${crate} ${version} into ${tools}`, estimate };
  const args = ['install', '--root', tools, crate, '--version', version, '--force'];
  // The tool's own lock file first; where a registry does not have all of it, the newest that fit.
  const locked = await run('cargo', [...args, '--locked'], { ...options, check: false });
  if (locked.code !== 0) await run('cargo', args, { ...options, label: `${options.label}, without its lock file` });
  rmSync(join(tools, 'build'), { recursive: true, force: true });
  return path;
}

export const wasmBindgen = () => cargoTool('wasm-bindgen-cli', 'wasm-bindgen', lockedVersion('wasm-bindgen'), '3 minutes');
export const wasmPack = () => cargoTool('wasm-pack', 'wasm-pack', WASM_PACK, '3 minutes');
export const cargoDeny = () => cargoTool('cargo-deny', 'cargo-deny', CARGO_DENY, '4 minutes');

/** Chromium and its driver, for the tests and the browser half of the benchmark. */
export async function chromium() {
  const find = async () => ({
    browser: process.env.CHROME ?? (await which('chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable')),
    driver: process.env.CHROMEDRIVER ?? (await which('chromedriver')),
  });
  let found = await find();
  if (!(found.browser && found.driver)) {
    await aptInstall(['chromium', 'chromium-driver'], 'installing Chromium and its driver', '1 minute');
    found = await find();
  }
  if (!(found.browser && found.driver)) {
    throw new Unmet('Chromium and chromedriver are needed: install both (or set CHROME and CHROMEDRIVER to them).');
  }
  return found;
}

const cargoHome = process.env.CARGO_HOME ?? join(homedir(), '.cargo');
const SHARED_MEMORY = 1 << 30; // modest: phones reserve all of it

/** What keeps LLVM from making code longer. The kernels, whose vectors and inlining are written out, lose nothing. */
const SHORT_CODE = ['inline-threshold=60', 'unroll-runtime=false', 'force-vector-interleave=1'];

/**
 * Code generation and linking of the two builds. Little is inlined that does not ask for it, and panics name
 * no source lines: a sixth smaller, a tenth slower. No loop is unrolled or interleaved but as it is written: four
 * per cent smaller, no slower. No path of this machine gets into the wasm.
 */
function wasmFlags(threads) {
  const features = threads ? '+atomics,+bulk-memory,+mutable-globals,+simd128' : '+bulk-memory,+simd128';
  const short = SHORT_CODE.flatMap((option) => ['-C', `llvm-args=-${option}`]);
  const flags = ['-C', `target-feature=${features}`, ...short, '-Z', 'location-detail=none'];
  for (const [from, to] of [[cargoHome, 'cargo'], [root, 'foldfree']]) flags.push(`--remap-path-prefix=${from}=${to}`);
  const link = threads
    ? [
        '--shared-memory', '--import-memory', `--max-memory=${SHARED_MEMORY}`,
        '--export=__wasm_init_tls', '--export=__tls_size', '--export=__tls_align', '--export=__tls_base',
      ]
    : [];
  for (const argument of link) flags.push('-C', `link-arg=${argument}`);
  return flags;
}

/** Arguments every wasm cargo call takes: std from its sources, small, and without backtraces. */
export const buildStd = ['-Z', 'build-std=std,panic_abort', '-Z', 'build-std-features=optimize_for_size'];

/**
 * The environment in which `cargo … --target wasm32-unknown-unknown` and wasm-pack build for wasm:
 * compiler, linker, flags, target folder, and PATH with wasm-bindgen.
 */
export async function wasmEnvironment({ threads = false } = {}) {
  const [rust, bindgen] = [await wasmRust(), await wasmBindgen()];
  const env = {
    ...process.env,
    ...rust.env,
    PATH: pathWith(...(rust.shims ? [rust.shims] : []), join(bindgen, '..')),
    CARGO_ENCODED_RUSTFLAGS: undefined,
    RUSTFLAGS: undefined,
    CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_RUSTFLAGS: wasmFlags(threads).join(' '),
    // a folder each, so that the two builds can run side by side
    CARGO_TARGET_DIR: join(root, 'target', threads ? 'wasm-threads' : 'wasm'),
    CARGO_PROFILE_RELEASE_DEBUG: '0',
    CARGO_PROFILE_RELEASE_LTO: 'fat',
  };
  for (const key of Object.keys(env)) if (env[key] === undefined) delete env[key];
  return env;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  main(async () => {
    const ci = process.argv.includes('--ci');
    say(`tools: ${tools}`);
    say(`rust for wasm: ${(await wasmRust()).name}`);
    say(`wasm-bindgen: ${await wasmBindgen()}`);
    say(`wasm-pack: ${await wasmPack()}`);
    const { browser, driver } = await chromium();
    say(`chromium: ${browser}, ${driver}`);
    if (ci) {
      say(`cargo-deny: ${await cargoDeny()}`);
      await wasmClippy();
    }
  });
}
