import { act } from "react";
import { createRoot, type Root } from "react-dom/client";
import { afterEach, beforeEach, describe, expect, it } from "vitest";
import { NumberField } from "./NumberField";

let root: Root;
let given: number[];

beforeEach(() => {
  Object.assign(globalThis, { IS_REACT_ACT_ENVIRONMENT: true });
  document.body.innerHTML = "<div></div>";
  root = createRoot(document.body.firstElementChild!);
  given = [];
});
afterEach(() => act(() => root.unmount()));

function show(value: number, more: Partial<Parameters<typeof NumberField>[0]> = {}) {
  act(() =>
    root.render(<NumberField label="Stroke" value={value} unit="m" onChange={(v) => given.push(v!)} {...more} />),
  );
  return { input: document.querySelector("input")!, label: document.querySelector("label")! };
}

/** Presses at x = 100 px, moves to each place in turn; what ends it comes after. */
function drag(element: HTMLElement, to: readonly (readonly [x: number, shiftKey?: boolean])[]) {
  Object.assign(element, { setPointerCapture: () => {}, hasPointerCapture: () => false });
  const pointer = (type: string, x: number, shiftKey = false) =>
    act(() => {
      const init = { bubbles: true, button: 0, clientX: x, shiftKey, pointerType: "mouse", pointerId: 1 };
      element.dispatchEvent(new PointerEvent(type, init));
    });
  pointer("pointerdown", 100);
  for (const [x, shift] of to) pointer("pointermove", x, shift);
  return {
    drop: () => pointer("pointerup", to.at(-1)![0]),
    escape: () => act(() => void globalThis.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" }))),
  };
}

describe("a number", () => {
  it("is dragged by itself or by its label: one step for four pixels, a tenth of it with Shift", () => {
    for (const name of ["input", "label"] as const) {
      given = [];
      const shown = show(3);
      drag(shown[name], [[112]]).drop();
      drag(shown[name], [[80, true]]).drop();
      expect(given[0], name).toBeCloseTo(3.3, 12);
      expect(given[1], name).toBeCloseTo(2.95, 12);
    }
  });

  it("is shown as it is dragged, given once, and as before after Escape", () => {
    const { input } = show(3);
    const one = drag(input, [[104], [108], [120]]);
    expect(input.value).toBe("3.5");
    expect(given).toEqual([]);
    one.escape();
    expect(input.value).toBe("3");
    expect(given).toEqual([]);
    drag(input, [[104], [120]]).drop();
    expect(given).toEqual([3.5]);
  });

  it("tells each value of the drag to those who draw it, and whether it was taken back", () => {
    const [seen, ends]: [number[], boolean[]] = [[], []];
    const { label } = show(3, { onDrag: (v) => seen.push(v), onDragged: (cancelled) => ends.push(cancelled) });
    drag(label, [[104], [108]]).escape();
    drag(label, [[104]]).drop();
    expect(seen).toEqual([3.1, 3.2, 3.1]);
    expect(ends).toEqual([true, false]);
    expect(given).toEqual([]);
  });

  it("stops at what cannot be, and is typed in where it is pressed and not moved", () => {
    const { input } = show(3, { check: (v) => (v > 3.15 ? "too long" : null) });
    drag(input, [[104], [140]]).drop();
    expect(given).toEqual([3.1]);
    drag(input, [[101]]).drop();
    expect(document.activeElement).toBe(input);
    drag(input, [[140]]).drop();
    expect(given).toEqual([3.1]);
  });
});
