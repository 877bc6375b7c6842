// clippy on both wasm builds; warnings are errors.
import { all, main, run } from './lib/progress.mjs';
import { buildStd, wasmClippy, wasmEnvironment } from './toolchain.mjs';

main(async () => {
  await wasmClippy();
  await wasmEnvironment();
  const check = async (threads) => {
    const env = await wasmEnvironment({ threads });
    const args = ['clippy', '--lib', '--package', 'foldfree', '--target', 'wasm32-unknown-unknown', ...buildStd];
    args.push('--no-default-features', ...(threads ? ['--features', 'threads'] : []), '--', '-D', 'warnings');
    await run('cargo', args, { env, label: `clippy, wasm (${threads ? 'threads' : 'single'})`, echo: true });
  };
  await all(check(false), check(true));
});
