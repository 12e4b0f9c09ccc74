// Keyboard shortcuts, written as people do: `Ctrl+Shift+Z`, `?`. Ctrl is Command on a Mac.

interface Pressed {
  readonly key: string;
  readonly ctrlKey: boolean;
  readonly metaKey: boolean;
  readonly altKey: boolean;
  readonly shiftKey: boolean;
}

/** Whether these keys were pressed. Of signs, such as `?`, it is left to the keyboard whether Shift makes them. */
export function matches(pressed: Pressed, keys: string): boolean {
  const held = keys.length > 1 ? keys.split("+") : [keys];
  const key = held.at(-1)!;
  const isLetter = /^[a-z]$/i.test(key);
  return (
    pressed.key.toLowerCase() === key.toLowerCase() &&
    (pressed.ctrlKey || pressed.metaKey) === held.includes("Ctrl") &&
    !pressed.altKey &&
    (!isLetter || pressed.shiftKey === held.includes("Shift"))
  );
}

/** Whether keys belong to the focused element: it is typed in, or chosen from. */
export function takesKeys(target: EventTarget | null): boolean {
  if (!(target instanceof HTMLElement)) return false;
  if (target instanceof HTMLInputElement) return !["checkbox", "button", "submit"].includes(target.type);
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement || target.isContentEditable;
}
