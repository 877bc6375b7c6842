// Content hashes: is what was built still what the sources say?
import { createHash } from 'node:crypto';
import { existsSync, mkdirSync, readdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join, relative } from 'node:path';
import { root } from './progress.mjs';

function* files(path, skip) {
  if (!existsSync(path)) return;
  if (statSync(path).isFile()) {
    yield path;
    return;
  }
  for (const name of readdirSync(path).sort()) {
    if (!skip.includes(name)) yield* files(join(path, name), skip);
  }
}

/** One hash over the names and bytes of all files under `inputs` (relative to the top folder). */
export function hash(inputs, { skip = [], salt = '' } = {}) {
  const sum = createHash('sha256').update(salt);
  for (const input of inputs) {
    for (const file of files(join(root, input), ['node_modules', 'target', '.git', ...skip])) {
      sum.update(`\0${relative(root, file)}\0`).update(readFileSync(file));
    }
  }
  return sum.digest('hex');
}

/** Does the stamp file say `value`? */
export function isStamped(file, value) {
  const path = join(root, file);
  return existsSync(path) && readFileSync(path, 'utf8') === value;
}

/** Writes `value` into the stamp file. */
export function stamp(file, value) {
  const path = join(root, file);
  mkdirSync(dirname(path), { recursive: true });
  writeFileSync(path, value);
}
