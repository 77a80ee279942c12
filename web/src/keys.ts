// The keyboard: keys that move while held, and keys that do something once. The help overlay is made from the same lists.

export interface Held {
  keys: string[];
  label: string;
  help: string;
  move(seconds: number): void;
}

export interface Pressed {
  keys: string[];
  label: string;
  help: string;
  act(): void;
}

const FIRST_SECONDS = 1 / 30; // a tap moves this much at once
const LONGEST_SECONDS = 0.1;

const isTyping = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement && (target.matches("input, select, textarea, [contenteditable]") || target.closest("dialog") !== null);
// Shift turns + into itself on most layouts: it tells keys apart only where its name is written.
const nameOf = (event: KeyboardEvent): string => (event.shiftKey && event.key.startsWith("Arrow") ? `Shift+${event.key}` : event.key);

export function listenKeys(held: Held[], pressed: Pressed[]): void {
  const down = new Map<string, Held>();
  let before = 0;
  const tick = (now: number): void => {
    if (down.size === 0) return;
    const seconds = Math.min(LONGEST_SECONDS, Math.max(0, now - before) / 1000);
    before = now;
    for (const one of new Set(down.values())) one.move(seconds);
    requestAnimationFrame(tick);
  };
  window.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey || event.defaultPrevented || isTyping(event.target)) return;
    const name = nameOf(event);
    const once = pressed.find((p) => p.keys.includes(name));
    const holding = held.find((h) => h.keys.includes(name));
    if (!once && !holding) return;
    event.preventDefault();
    if (event.repeat) return;
    once?.act();
    if (!holding) return;
    holding.move(FIRST_SECONDS);
    down.set(event.code, holding);
    if (down.size > 1) return;
    before = performance.now();
    requestAnimationFrame(tick);
  });
  window.addEventListener("keyup", (event) => down.delete(event.code));
  window.addEventListener("blur", () => down.clear());
}
