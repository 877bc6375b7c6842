// npm run build: the package (pkg/) and the page (www/dist/). `--force` builds everything anew.
import { fileURLToPath } from 'node:url';
import { installDependencies } from './lib/dependencies.mjs';
import { main, say } from './lib/progress.mjs';
import { buildPackage } from './build-wasm.mjs';
import { buildPage } from '../www/build.mjs';

/** Builds what is out of date. */
export async function build(options) {
  await installDependencies();
  await buildPackage(options);
  await buildPage(options);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  main(async () => {
    await build({ force: process.argv.includes('--force') });
    say('built: pkg/ and www/dist/');
  });
}
