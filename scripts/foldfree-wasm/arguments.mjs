// What a person types, as values.
import { Failure } from './failure.mjs';

export const text = { type: 'string' };
export const flag = { type: 'boolean', default: false };
export const quiet = { ...flag, short: 'q' };

/** The number behind `--name`, or undefined where it was left out. */
export function number(name, value) {
  if (value === undefined) return undefined;
  const parsed = Number(value);
  if (value.trim() === '' || Number.isNaN(parsed)) throw new Failure(`--${name}: "${value}" is not a number`);
  return parsed;
}

/** The same of whole numbers, within limits. */
export function whole(name, value, least = 0, most = 2 ** 32 - 1) {
  const parsed = number(name, value);
  if (parsed === undefined || (Number.isInteger(parsed) && parsed >= least && parsed <= most)) return parsed;
  throw new Failure(`--${name}: "${value}" is not a whole number from ${least} to ${most}`);
}

/** The fields that are not undefined. */
export function given(fields) {
  return Object.fromEntries(Object.entries(fields).filter(([, value]) => value !== undefined));
}
