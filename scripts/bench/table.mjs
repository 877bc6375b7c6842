// Numbers as a table that people read.

/** Three digits or so; a dash where there is no number. */
export function digits(value, unit = '') {
  if (value === undefined || Number.isNaN(value)) return '–';
  return `${value < 10 ? value.toFixed(2) : value.toFixed(value < 100 ? 1 : 0)}${unit}`;
}

/** How many times `b` goes into `a`. */
export const ratio = (a, b) => (a && b ? `${(a / b).toFixed(2)} ×` : '–');

/** A Markdown table; the first row is its head. */
export function table(rows) {
  const widths = rows[0].map((_, i) => Math.max(...rows.map((row) => row[i].length)));
  const line = (row) => `| ${row.map((cell, i) => (i ? cell.padStart(widths[i]) : cell.padEnd(widths[i]))).join(' | ')} |`;
  return [line(rows[0]), `|${widths.map((width) => '-'.repeat(width + 2)).join('|')}|`, ...rows.slice(1).map(line)].join('\n');
}
