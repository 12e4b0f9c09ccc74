/** Hears of a pointer until it is let go, or Escape takes the drag back. */
export function follow(
  element: Element,
  pointer: number,
  { move, done }: { move: (event: globalThis.PointerEvent) => void; done: (cancelled: boolean) => void },
): void {
  element.setPointerCapture(pointer);
  const moved = (event: Event) => move(event as globalThis.PointerEvent);
  const stop = (cancelled: boolean) => {
    element.removeEventListener("pointermove", moved);
    element.removeEventListener("pointerup", up);
    element.removeEventListener("pointercancel", cancel);
    globalThis.removeEventListener("keydown", abandon, true);
    done(cancelled);
  };
  const up = () => stop(false);
  const cancel = () => stop(true);
  const abandon = (event: globalThis.KeyboardEvent) => {
    if (event.key !== "Escape") return;
    event.stopPropagation();
    if (element.hasPointerCapture(pointer)) element.releasePointerCapture(pointer);
    stop(true);
  };
  element.addEventListener("pointermove", moved);
  element.addEventListener("pointerup", up);
  element.addEventListener("pointercancel", cancel);
  globalThis.addEventListener("keydown", abandon, true);
}
