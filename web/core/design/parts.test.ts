import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { read as readDesign } from "./file";
import { combined, ofLink, ofPart, weighed } from "./mass";
import { mesh, stl } from "./mesh";
import cases from "./parts.fixture.json";
import { furnished } from "./standard";
import type { Crane, Part } from "./types";

interface Expected {
  readonly vertices: number;
  readonly faces: number;
  readonly mass: number;
  readonly centre: number[];
  readonly inertia: number[];
}

function near(found: readonly number[], expected: readonly number[], scale: number): void {
  expect(found.length).toBe(expected.length);
  found.forEach((value, i) => {
    expect(Math.abs(value - expected[i])).toBeLessThanOrEqual(1e-9 * scale);
  });
}

for (const { crane: raw, links, bodies } of cases) {
  const crane = raw as unknown as Crane;
  describe(`the parts of ${crane.name} are those of the Python package`, () => {
    const whole = furnished(crane);
    it("in shape", () => {
      whole.links.forEach((link, i) => {
        const expected = links[i].parts as unknown as Part[];
        expect(link.parts?.map(({ kind, name }) => [kind, name])).toEqual(
          expected.map(({ kind, name }) => [kind, name]),
        );
      });
    });
    for (const link of whole.links)
      it(`${link.name}, in mass, centre and inertia`, () => {
        const expected = (bodies as unknown as Record<string, Expected[]>)[link.name];
        link.parts?.forEach((part, i) => {
          const want = expected[i];
          const surface = mesh(part);
          expect(surface.vertices.length).toBe(3 * want.vertices);
          expect(surface.faces.length).toBe(3 * want.faces);
          const found = ofPart(part);
          near([found.mass], [want.mass], want.mass);
          near(found.centre, want.centre, 10);
          near(found.inertia, want.inertia, Math.max(...want.inertia));
        });
      });
  });
}

describe("masses", () => {
  it("of two cubes side by side are those of one box", () => {
    const cube = (x: number): Part => ({ kind: "box", name: "cube", centre: [x, 0, 0], size: [1, 1, 1] });
    const both = combined([ofPart(cube(0)), ofPart(cube(1))]);
    const whole = ofPart({ kind: "box", name: "box", centre: [0.5, 0, 0], size: [2, 1, 1] });
    near([both.mass], [whole.mass], whole.mass);
    near(both.inertia, whole.inertia, whole.inertia[1]);
  });

  it("of a part that went through STL stay the same", () => {
    const box: Part = { kind: "box", name: "box", centre: [1, 2, 3], size: [1, 2, 4], thickness: 0.25 };
    const surface = btoa(String.fromCharCode(...stl(mesh(box))));
    const found = ofPart({ kind: "mesh", name: "read", source: "box.stl", surface });
    near([found.mass], [ofPart(box).mass], found.mass);
    near(found.centre, ofPart(box).centre, 10);
    expect(() => ofPart({ kind: "mesh", name: "words", source: "x", surface: btoa("words") })).toThrow("binary STL");
    const text = readFileSync("../src/seacrane/design/cranes/offshore-100t.json", "utf8");
    const withSurface = (held: string) => {
      const design = JSON.parse(text);
      design.links[0].parts = [{ kind: "mesh", name: "house", source: "house.stl", surface: held }];
      return JSON.stringify(design);
    };
    expect(readDesign(withSurface(surface)).links[0].parts).toHaveLength(1);
    expect(() => readDesign(withSurface(btoa("words")))).toThrow("parts[house].surface: is not a binary STL");
    expect(() => readDesign(withSurface("%"))).toThrow("parts[house].surface: is not base64");
  });

  it("are taken from the parts where a link has any", () => {
    const crane = cases.find(({ crane }) => crane.name === "a-frame-30t")?.crane as unknown as Crane;
    const frame = weighed(crane).links[0];
    expect(frame.mass).toBeCloseTo(ofLink(crane.links[0]).mass, 6);
    const bare = cases.find(({ crane }) => crane.name === "offshore-100t")?.crane as unknown as Crane;
    expect(weighed(bare)).toEqual(bare);
  });
});
