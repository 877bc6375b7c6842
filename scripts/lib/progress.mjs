// Running commands with progress lines: what runs, since when, how long it usually takes.
import { spawn } from 'node:child_process';
import { createWriteStream, mkdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

/** The repository's top folder. */
export const root = join(dirname(fileURLToPath(import.meta.url)), '..', '..');

const began = Date.now();
const elapsed = (since = began) => `${Math.round((Date.now() - since) / 1000)} s`;

/** One line with the time since the script began. */
export function say(text) {
  console.log(`[${elapsed().padStart(5)}] ${text}`);
}

/** A failure that is the user's to mend: printed as one sentence, without a stack. */
export class Unmet extends Error {}

/** A command that ended badly; `output` is its last lines. */
export class CommandFailed extends Error {
  constructor(command, code, output) {
    super(`${command} ended with ${code}\n${output}`);
    this.code = code;
  }
}

/**
 * Runs a command and resolves with its output.
 * label: print a line at the start, one every 15 s with the newest line of output, and one at the end.
 * estimate: how long it usually takes, in words. echo: pass the output through. timeout: milliseconds.
 * log: file that takes the whole output.
 */
export function run(command, args, { label, estimate, echo = false, timeout, log, check = true, env, cwd = root } = {}) {
  return new Promise((resolve, reject) => {
    const start = Date.now();
    if (label) say(`${label}${estimate ? ` (about ${estimate} the first time)` : ''} …`);
    const child = spawn(command, args, { cwd, env: env ?? process.env, stdio: ['ignore', 'pipe', 'pipe'], timeout });
    let output = '';
    let newest = '';
    let file;
    if (log) {
      mkdirSync(dirname(log), { recursive: true });
      file = createWriteStream(log);
    }
    const take = (stream) => (data) => {
      const text = data.toString();
      output += text;
      const lines = text.split(/[\r\n]+/).filter((line) => line.trim());
      if (lines.length) newest = lines.at(-1).trim();
      file?.write(text);
      if (echo) stream.write(text);
    };
    child.stdout.on('data', take(process.stdout));
    child.stderr.on('data', take(process.stderr));
    const beat = label && !echo
      ? setInterval(() => say(`  … ${label}: ${elapsed(start)}, ${newest.slice(0, 90)}`), 15_000)
      : undefined;
    const finish = (code) => {
      clearInterval(beat);
      file?.end();
      if (code !== 0 && check) {
        reject(new CommandFailed([command, ...args].join(' '), code, output.split('\n').slice(-60).join('\n')));
        return;
      }
      if (label && Date.now() - start > 2000) say(`  ${label}: ${code === 0 ? 'done' : `ended with ${code}`} in ${elapsed(start)}`);
      resolve({ code, output });
    };
    child.on('error', (error) => {
      clearInterval(beat);
      if (check) reject(error);
      else finish(error.code ?? -1);
    });
    child.on('close', (code, signal) => finish(code ?? signal));
  });
}

/** Waits for all; then fails as the first that failed did. */
export async function all(...promises) {
  const ends = await Promise.allSettled(promises);
  const failed = ends.find(({ status }) => status === 'rejected');
  if (failed) throw failed.reason;
}

/** The trimmed output of a command, or undefined when it cannot be run or fails. */
export async function ask(command, args, options = {}) {
  const { code, output } = await run(command, args, { ...options, check: false });
  return code === 0 ? output.trim() : undefined;
}

/** Runs a script's main function: an `Unmet` is one sentence on stderr, anything else has its stack. */
export function main(body) {
  body().catch((error) => {
    console.error(error instanceof Unmet || error instanceof CommandFailed ? `error: ${error.message}` : error);
    process.exitCode = 1;
  });
}
