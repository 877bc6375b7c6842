// The keyboard: one key, one act, never while a person types or chooses.

/** Calls `acts[key]` for keys pressed; `Shift+` is spelled out for the arrow keys. Those of `once` do not repeat. */
export function listenToKeys(acts, once = []) {
  window.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented) return;
    const target = event.target;
    const open = document.querySelector('dialog[open]');
    if (open && event.key !== '?') return;
    const choosing = target instanceof HTMLSelectElement || target instanceof HTMLTextAreaElement
      || (target instanceof HTMLInputElement && target.id !== 'history');
    if (choosing) return;
    const name = (event.shiftKey && event.key.startsWith('Arrow') ? 'Shift+' : '')
      + (event.key.length === 1 ? event.key.toLowerCase() : event.key);
    // Space and Enter belong to the button in focus; the arrows of a tab list to the list, those of a handle to it.
    if ((name === ' ' || name === 'Enter') && target instanceof HTMLButtonElement) return;
    if (name.includes('Arrow') && target instanceof Element && target.closest('[role="tablist"], [role="slider"]')) return;
    const act = acts[name];
    if (!act) return;
    event.preventDefault();
    if (!event.repeat || !once.includes(name)) act();
  }, { capture: true });
}
