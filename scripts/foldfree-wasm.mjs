#!/usr/bin/env node
// The command line of the native program on the single-thread wasm build, in this Node: the same arguments,
// the same REPORT.json, the same exit codes (0: done, 2: not reached, 1: an error, one line on stderr).
import { parseArgs } from 'node:util';
import * as check from './foldfree-wasm/check.mjs';
import * as deform from './foldfree-wasm/deform.mjs';
import { Failure } from './foldfree-wasm/failure.mjs';
import * as generate from './foldfree-wasm/generate.mjs';
import * as parameterize from './foldfree-wasm/parameterize.mjs';
import * as untangle from './foldfree-wasm/untangle.mjs';

const COMMANDS = { parameterize, deform, untangle, check, generate };

try {
  const [name, ...rest] = process.argv.slice(2);
  const command = Object.hasOwn(COMMANDS, name ?? '') ? COMMANDS[name] : undefined;
  if (!command) throw new Failure(`which command? ${Object.keys(COMMANDS).join(', ')}`);
  const { values, positionals } = parseArgs({ args: rest, options: command.options, allowPositionals: true });
  const { operands = 1 } = command;
  if (positionals.length !== operands) {
    const takes = command === generate ? 'one shape' : operands === 1 ? 'one file' : 'nothing but options';
    throw new Failure(`${name} takes ${takes}, and was given ${positionals.length}`);
  }
  process.exitCode = command.run(positionals[0], values);
} catch (error) {
  const own = error instanceof Failure || error.code;
  console.error(`error: ${own ? error.message.replace(/\s+/g, ' ') : error.stack}`);
  process.exitCode = 1;
}
