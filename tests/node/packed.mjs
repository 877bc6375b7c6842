// Packs the package as `npm publish` would, and installs it into a temporary folder, once a test file.
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { after } from 'node:test';
import { pathToFileURL } from 'node:url';

export const top = new URL('../../', import.meta.url);

/** The folder it was installed into, and the tarball. */
export function installPacked() {
  const folder = mkdtempSync(join(tmpdir(), 'foldfree-'));
  after(() => rmSync(folder, { recursive: true, force: true }));
  const packed = execFileSync('npm', ['pack', '--json', '--ignore-scripts', '--pack-destination', folder], { cwd: top, stdio: ['ignore', 'pipe', 'ignore'] });
  const parsed = JSON.parse(packed);
  const { filename, files } = Array.isArray(parsed) ? parsed[0] : Object.values(parsed)[0];
  const tarball = join(folder, filename);
  const home = join(folder, 'node_modules', 'foldfree');
  mkdirSync(home, { recursive: true });
  execFileSync('tar', ['-xzf', tarball, '-C', home, '--strip-components=1']);
  writeFileSync(join(folder, 'package.json'), '{ "type": "module" }');
  return { folder, tarball, home, files: files.map((file) => file.path) };
}

/** Imports an export of the installed package, by its name. */
export async function importPacked(folder, name) {
  const script = join(folder, `import-${name.replaceAll('/', '-')}.mjs`);
  writeFileSync(script, `export * from '${name}'; export const wasm = import.meta.resolve('foldfree/foldfree.wasm');`);
  return import(pathToFileURL(script).href);
}
