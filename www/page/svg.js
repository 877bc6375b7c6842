// Drawing with SVG: elements and texts in a line each.
const SPACE = 'http://www.w3.org/2000/svg';

/** An element with attributes and children; what is `undefined` is left out. */
export function svg(name, attributes = {}, ...children) {
  const element = document.createElementNS(SPACE, name);
  for (const [key, value] of Object.entries(attributes)) if (value !== undefined) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** A number in an attribute: no more digits than a screen has. */
export const px = (value) => Math.round(value * 100) / 100;

/** Points as an SVG list. */
export const list = (points) => points.map(([x, y]) => `${px(x)},${px(y)}`).join(' ');

/** A straight arrow from one point to another, as a path: its head is `size` long (0: none). */
export function arrow([x0, y0], [x1, y1], size = 7) {
  const length = Math.hypot(x1 - x0, y1 - y0);
  if (length < 1e-6) return '';
  if (size === 0) return `M${px(x0)} ${px(y0)}L${px(x1)} ${px(y1)}`;
  const [u, v] = [(x1 - x0) / length, (y1 - y0) / length];
  const head = Math.min(size, length / 2);
  const wing = (side) => `${px(x1 - head * u - 0.5 * head * side * v)} ${px(y1 - head * v + 0.5 * head * side * u)}`;
  return `M${px(x0)} ${px(y0)}L${px(x1)} ${px(y1)}M${wing(1)}L${px(x1)} ${px(y1)}L${wing(-1)}`;
}

/** Follows a finger or the mouse on `surface`: `grab(point)` says whether there is something, `drag(point)` where it goes. */
export function followPointer(surface, { grab, drag, drop }) {
  let dragging = false;
  const at = (event) => {
    const box = surface.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  };
  surface.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || !grab(at(event))) return;
    dragging = true;
    surface.setPointerCapture(event.pointerId);
    event.preventDefault();
  });
  surface.addEventListener('pointermove', (event) => { if (dragging) drag(at(event)); });
  const end = () => {
    if (dragging) drop?.();
    dragging = false;
  };
  surface.addEventListener('pointerup', end);
  surface.addEventListener('pointercancel', end);
}

/** The arrow keys of a handle: `move(dx, dy)` in steps of the key. */
export function followArrows(handle, move) {
  handle.addEventListener('keydown', (event) => {
    const [dx, dy] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key] ?? [];
    if (dx === undefined) return;
    event.preventDefault();
    event.stopPropagation();
    move(dx, dy);
  });
}
