// Messages, where the eye is.

const element = (id) => document.getElementById(id);
let hide;

/** Shows a message until it is dismissed; `plain` ones go by themselves. */
export function notice(title, text = '', { plain = false } = {}) {
  clearTimeout(hide);
  const box = element('notice');
  element('notice-title').textContent = title;
  element('notice-text').textContent = text;
  box.classList.toggle('plain', plain);
  box.hidden = false;
  if (plain) hide = setTimeout(() => clearNotice(), 5000);
}

/** Takes the message away, or only that of a `title`. */
export function clearNotice(title) {
  if (title !== undefined && element('notice-title').textContent !== title) return;
  element('notice').hidden = true;
}

/** What to do when the solver itself is gone. */
const ADVICE = {
  panic: 'It broke down. Press R to start again; what you see stays until then.',
  'worker-lost': 'It was ended, perhaps for want of memory. Press R to start again; what you see stays until then.',
  'out-of-memory': 'Choose fewer elements, or close other pages, and press R.',
};

/** What an error of the library says, with the place it names, and what to do where there is something. */
export function describe(error) {
  const advice = ADVICE[error?.code];
  const text = String(error?.message ?? error) + (advice ? `. ${advice}` : '');
  const place = error?.line !== undefined && !/\bline\b/i.test(text) ? `line ${error.line}: ` : '';
  const sentence = place + text;
  return sentence.charAt(0).toUpperCase() + sentence.slice(1) + (/[.!?]$/.test(sentence) ? '' : '.');
}

element('notice-close').addEventListener('click', () => clearNotice());
