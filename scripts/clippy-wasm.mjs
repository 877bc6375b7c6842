// clippy on both wasm builds; warnings are errors.
import { main, run } from './lib/progress.mjs';
import { buildStd, wasmClippy, wasmEnvironment } from './toolchain.mjs';

main(async () => {
  await wasmClippy();
  for (const threads of [false, true]) {
    const env = await wasmEnvironment({ threads });
    const args = ['clippy', '--lib', '--package', 'foldfree', '--target', 'wasm32-unknown-unknown', ...buildStd];
    args.push('--no-default-features', ...(threads ? ['--features', 'threads'] : []), '--', '-D', 'warnings');
    await run('cargo', args, { env, label: `clippy, wasm (${threads ? 'threads' : 'single'})`, echo: true });
  }
});
