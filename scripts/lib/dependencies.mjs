// Installs the npm packages of the lock file when node_modules is not from it.
import { existsSync } from 'node:fs';
import { join } from 'node:path';
import { root, run } from './progress.mjs';
import { hash, isStamped, stamp } from './stamp.mjs';

export async function installDependencies() {
  const lock = hash(['package.json', 'package-lock.json']);
  if (existsSync(join(root, 'node_modules', 'typescript')) && isStamped('node_modules/.foldfree.stamp', lock)) return;
  await run('npm', ['ci', '--no-audit', '--no-fund'], { label: 'installing npm packages', estimate: '20 seconds' });
  stamp('node_modules/.foldfree.stamp', lock);
}
