import { describe, expect, it } from "vitest";
import { namesOn } from "./curveNames";

const radius = Float64Array.from({ length: 41 }, (_, i) => 0.5 * i);
const line = (name: string, load: (radius: number) => number) => ({
  name,
  curve: { mode: name, radius, load: radius.map(load), governs: [] },
});
const pixels = (load: number) => 200 - load;

describe("names of curves", () => {
  it("stand on their curves where these are furthest apart", () => {
    // closest at both ends of the plot, 40 apart in the middle
    const lines = [0, 1, 2].map((i) => line(`Hs ${i}`, (at) => 50 + i * 4 * Math.max(0, 10 - Math.abs(at - 10))));
    const names = namesOn(lines, pixels, 1, 19);
    expect(names.map(({ name, radius, load }) => [name, radius, load])).toEqual([
      ["Hs 0", 10, 50],
      ["Hs 1", 10, 90],
      ["Hs 2", 10, 130],
    ]);
    expect(namesOn(lines, pixels, 1, 8).every((name) => name.radius === 8)).toBe(true);
  });

  it("do not lie over each other: the first that are given have the room", () => {
    const lines = [line("a", () => 50), line("b", () => 55), line("c", () => 90)];
    expect(namesOn(lines, pixels, 1, 19).map(({ name }) => name)).toEqual(["a", "c"]);
  });

  it("stand only where all curves have loads", () => {
    const short = line("short", (at) => (at < 6 ? Number.NaN : 20));
    const names = namesOn([line("whole", (at) => 200 - at), short], pixels, 0, 20);
    expect(names[0].radius).toBe(6);
    expect(namesOn([line("none", () => Number.NaN)], pixels, 0, 20)).toEqual([]);
    expect(namesOn([], pixels, 0, 20)).toEqual([]);
  });
});
