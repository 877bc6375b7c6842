// npm test: everything, one suite after the other; installs what is missing. Ends with one line of counts.
// node scripts/test.mjs [suite …] runs some: rust, wasm, wasm-threads, node, browser, page. `--list` names them.
import { existsSync, readdirSync } from 'node:fs';
import { join } from 'node:path';
import { installDependencies } from './lib/dependencies.mjs';
import { ask, main, root, run, say, Unmet } from './lib/progress.mjs';
import { build } from './build.mjs';
import { buildStd, chromium, tools, wasmEnvironment, wasmPack } from './toolchain.mjs';

const log = (name) => join(tools, 'logs', `test-${name}.log`);

/** Adds up the counts of every line that matches. */
function count(output, pattern) {
  const sum = { passed: 0, failed: 0 };
  for (const { groups } of output.matchAll(pattern)) {
    sum.passed += Number(groups.passed ?? 0);
    sum.failed += Number(groups.failed ?? 0);
  }
  return sum;
}

const LIBTEST = /test result: \w+\. (?<passed>\d+) passed; (?<failed>\d+) failed/g;
const NEXTEST = /Summary \[.*?\]\s+\d+ tests? run: (?<passed>\d+) passed(?: \(.*?\))?(?:, (?<failed>\d+) failed)?/g;

/** Native tests: nextest where it is installed, else cargo's own; then the examples in the documentation. */
async function rust() {
  const nextest = (await ask('cargo', ['nextest', '--version'])) !== undefined;
  const args = nextest ? ['nextest', 'run', '--no-fail-fast'] : ['test', '--no-fail-fast', '--lib', '--bins', '--tests'];
  const env = { ...process.env, CARGO_TERM_COLOR: 'never' };
  const { output } = await run('cargo', [...args, '--workspace', '--features', 'foldfree/cli'], {
    label: 'native tests', estimate: '4 minutes', env, echo: true, check: false, log: log('rust'),
  });
  const docs = await run('cargo', ['test', '--doc', '--package', 'foldfree'], {
    label: 'documentation tests', env, echo: true, check: false, log: log('doc'),
  });
  const [a, b] = [count(output, nextest ? NEXTEST : LIBTEST), count(docs.output, LIBTEST)];
  return { passed: a.passed + b.passed, failed: a.failed + b.failed };
}

/** wasm-pack, headless: `threads` with a pool of two. */
async function wasm(threads) {
  const name = threads ? 'wasm-threads' : 'wasm';
  const [{ browser, driver }, pack, env] = [await chromium(), await wasmPack(), await wasmEnvironment({ threads })];
  Object.assign(env, {
    CHROMEDRIVER: driver,
    CHROME: browser,
    // The release profile, whose build scripts and macros are there already; tests do not link with fat LTO.
    CARGO_PROFILE_RELEASE_LTO: 'off',
    CARGO_PROFILE_RELEASE_DEBUG_ASSERTIONS: 'true',
    CARGO_PROFILE_RELEASE_CODEGEN_UNITS: '16',
    WASM_BINDGEN_TEST_TIMEOUT: '300',
  });
  const args = ['test', '--release', '--mode', 'no-install', '--headless', '--chrome', '--chromedriver', driver, '--', ...buildStd];
  args.push(...(threads ? ['--features', 'threads'] : []), '--test', threads ? 'threads' : 'single');
  const { code, output } = await run(pack, args, {
    label: `wasm-pack tests (${name})`, estimate: '3 minutes', env, cwd: join(root, 'tests', 'wasm'), check: false, log: log(name),
  });
  if (code !== 0) console.log(output.split('\n').slice(-40).join('\n'));
  else console.log(output.split('\n').filter((line) => /^test |test result|panicked|error/.test(line.trim())).join('\n'));
  return count(output, LIBTEST);
}

/** Node's test runner on a folder of test files. */
async function nodeTests(label, folder) {
  const files = existsSync(join(root, folder))
    ? readdirSync(join(root, folder)).filter((name) => /\.test\.m?js$/.test(name)).map((name) => join(folder, name))
    : [];
  if (files.length === 0) return { passed: 0, failed: 0 };
  const { browser } = folder === 'tests/node' ? {} : await chromium();
  const env = { ...process.env, ...(browser && { CHROME: browser }) };
  const args = ['--test', '--test-reporter', 'spec', '--test-concurrency', '1', '--test-timeout', '600000', ...files];
  const { output } = await run(process.execPath, args, { label, env, echo: true, check: false, log: log(folder.replaceAll('/', '-')) });
  // The last counts are those of the whole run.
  const total = (what) => Number(output.match(new RegExp(`^ℹ ${what} (\\d+)$`, 'm'))?.[1] ?? 0);
  return { passed: total('pass'), failed: total('fail') + total('cancelled') };
}

const SUITES = {
  rust: { run: rust },
  wasm: { run: () => wasm(false) },
  'wasm-threads': { run: () => wasm(true) },
  node: { run: () => nodeTests('Node tests', 'tests/node'), built: true },
  browser: { run: () => nodeTests('package in the browser', 'tests/browser'), built: true },
  page: { run: () => nodeTests('page, end to end', 'www/tests'), built: true },
};

main(async () => {
  const wanted = process.argv.slice(2);
  if (wanted.includes('--list')) return console.log(Object.keys(SUITES).join('\n'));
  for (const name of wanted) if (!SUITES[name]) throw new Unmet(`there is no suite ${name}: ${Object.keys(SUITES).join(', ')}`);
  await installDependencies();
  const results = [];
  let built = false;
  for (const [name, suite] of Object.entries(SUITES)) {
    if (wanted.length && !wanted.includes(name)) continue;
    const start = Date.now();
    let result;
    try {
      if (suite.built && !built) {
        await build();
        built = true;
      }
      result = await suite.run();
      // A suite that ran nothing did not even compile.
      if (result.passed + result.failed === 0) result.failed = 1;
    } catch (error) {
      console.error(error instanceof Unmet ? `error: ${error.message}` : error);
      result = { passed: 0, failed: 1 };
    }
    results.push({ name, ...result, seconds: Math.round((Date.now() - start) / 1000) });
  }
  say('summary');
  for (const { name, passed, failed, seconds } of results) {
    console.log(`  ${name.padEnd(13)} ${String(passed).padStart(4)} passed, ${failed} failed  (${seconds} s)`);
  }
  const sum = (key) => results.reduce((total, result) => total + result[key], 0);
  console.log(`${sum('passed')} passed, ${sum('failed')} failed`);
  process.exitCode = sum('failed') ? 1 : 0;
});
