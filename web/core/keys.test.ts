import { describe, expect, it } from "vitest";
import { matches, takesKeys } from "./keys";

const press = (key: string, held: Partial<KeyboardEventInit> = {}) => new KeyboardEvent("keydown", { key, ...held });

describe("a shortcut", () => {
  it("is its keys and no others", () => {
    expect(matches(press("z", { ctrlKey: true }), "Ctrl+Z")).toBe(true);
    expect(matches(press("z", { metaKey: true }), "Ctrl+Z")).toBe(true);
    expect(matches(press("Z", { ctrlKey: true, shiftKey: true }), "Ctrl+Z")).toBe(false);
    expect(matches(press("Z", { ctrlKey: true, shiftKey: true }), "Ctrl+Shift+Z")).toBe(true);
    expect(matches(press("z"), "Ctrl+Z")).toBe(false);
    expect(matches(press("z", { ctrlKey: true, altKey: true }), "Ctrl+Z")).toBe(false);
  });

  it("leaves it to the keyboard how signs are made", () => {
    expect(matches(press("?", { shiftKey: true }), "?")).toBe(true);
    expect(matches(press("?"), "?")).toBe(true);
    expect(matches(press("+", { shiftKey: true }), "+")).toBe(true);
    expect(matches(press("-"), "-")).toBe(true);
  });
});

describe("keys belong", () => {
  it("to what is typed in or chosen from, not to buttons", () => {
    for (const name of ["input", "textarea", "select"])
      expect(takesKeys(document.createElement(name)), name).toBe(true);
    expect(takesKeys(document.createElement("button"))).toBe(false);
    expect(takesKeys(null)).toBe(false);
  });
});
