import { describe, expect, it } from "vitest";
import { closeness } from "./fuzzy";

const best = (typed: string, ...texts: string[]) =>
  texts
    .map((text) => ({ text, how: closeness(text, typed) }))
    .filter((item): item is { text: string; how: number } => item.how !== null)
    .sort((a, b) => b.how - a.how)
    .map(({ text }) => text);

describe("a line found by a few letters", () => {
  it("has them in order, in any case, each word by itself", () => {
    expect(closeness("Save the design file (JSON)", "sdf")).not.toBeNull();
    expect(closeness("Save the design file (JSON)", "JSON save")).not.toBeNull();
    expect(closeness("Save the design file (JSON)", "fds")).toBeNull();
    expect(closeness("Undo", "undone")).toBeNull();
    expect(closeness("Undo", "  ")).toBe(0);
  });

  it("comes first where the letters begin words, or stand together", () => {
    expect(best("sf", "Transform", "Save the front")).toEqual(["Save the front", "Transform"]);
    expect(best("boom", "Begin or open many", "Fields of boom_cylinder")[0]).toBe("Fields of boom_cylinder");
    expect(best("cyl", "Cannot your list", "Add a cylinder to boom")[0]).toBe("Add a cylinder to boom");
  });

  it("is found by its best place, not by its first", () => {
    const [late, early] = [closeness("a xb open", "op"), closeness("oxxp", "op")];
    expect(late!).toBeGreaterThan(early!);
  });
});
