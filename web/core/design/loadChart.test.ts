import { describe, expect, it } from "vitest";
import { capacity, limitNames } from "./loadChart";
import cases from "./loadChart.fixture.json";
import { type Crane, modes } from "./types";

describe("a grid with longer rows than are computed at once", () => {
  const crane = cases[0].crane as unknown as Crane;
  const joints = cases[0].coordinates;

  it("has the loads of its postures, in their order", () => {
    const [low, high] = [joints[1][0], joints[1][joints[1].length - 1]];
    const long = Array.from({ length: 1500 }, (_, i) => low + ((high - low) * i) / 1499);
    const found = capacity(crane, [joints[0], long], modes(crane)[1]);
    for (const i of [0, 749, 750, 1499, 1500, 4321]) {
      const one = capacity(crane, [[joints[0][Math.floor(i / 1500)]], [long[i % 1500]]], modes(crane)[1]);
      expect(found.load[i]).toBeCloseTo(one.load[0], 6);
      expect(found.height[i]).toBeCloseTo(one.height[0], 9);
    }
  });
});

describe("a crane whose cylinder moves no joint of its plane", () => {
  const crane = cases[0].crane as unknown as Crane;

  it("is refused by the name of that joint", () => {
    const cylinders = crane.cylinders.map((cylinder) => ({ ...cylinder, moves: "yaw" }));
    const one = cases[0].coordinates.map(([first]) => [first]);
    expect(() => capacity({ ...crane, cylinders }, one, modes(crane)[0])).toThrow("no joint yaw");
  });
});

describe("a crane of too many parts", () => {
  const { hoist, ...crane } = cases[0].crane as unknown as Crane;
  const turns = [hoist.sheaves[hoist.sheaves.length - 1], hoist.drum];
  const reeved = (sheaves: number) => {
    const path = Array.from({ length: sheaves }, (_, i) => turns[i % 2]);
    return { ...crane, hoist: { ...hoist, sheaves: path } };
  };
  const long = cases[0].coordinates.map(() => Array.from({ length: 640 }, (_, i) => 0.1 + 1e-3 * i));

  it("is refused in words, and the next one is charted as ever", () => {
    expect(() => capacity(reeved(10_001), long, modes(crane as Crane)[1])).toThrow("more cylinders and sheaves");
    const one = cases[0].coordinates.map(([first]) => [first]);
    expect(capacity(reeved(1), one, modes(crane as Crane)[1]).load[0]).toBeGreaterThan(0);
  });
});

describe("the load chart of the page is that of the Python package", () => {
  for (const { crane: raw, coordinates, radius, height, modes: expected } of cases) {
    const crane = raw as unknown as Crane;
    const names = limitNames(crane);
    for (const mode of modes(crane)) {
      const want = expected[mode.name as keyof typeof expected];
      if (!want) continue;
      it(`${crane.name}, ${mode.name}`, () => {
        const found = capacity(crane, coordinates, mode);
        expect(found.count).toBe(want.load.length);
        want.load.forEach((load, i) => {
          expect(Math.abs(found.radius[i] - radius[i])).toBeLessThan(1e-9);
          expect(Math.abs(found.height[i] - height[i])).toBeLessThan(1e-9);
          expect(Math.abs(found.load[i] - load), `posture ${i}`).toBeLessThanOrEqual(1e-9 * Math.max(load, 1));
          if (load > 0) expect(names[found.governs[i]]).toBe(want.governs[i]);
        });
      });

      it(`${crane.name}, ${mode.name}: the same whichever joint runs along a row`, () => {
        for (let k = 0; k < coordinates.length; k += 1) {
          // the joints from k + 1 on stand at their second coordinate: joint k is the last with more than one
          const standing = coordinates.map((values, i) => (i > k ? [values[1]] : values));
          const found = capacity(crane, standing, mode);
          const behind = coordinates.slice(k + 1);
          const stride = behind.reduce((product, values) => product * values.length, 1);
          const offset = behind.reduce((sum, values) => sum * values.length + 1, 0);
          for (let i = 0; i < found.count; i += 1) {
            const load = want.load[i * stride + offset];
            expect(Math.abs(found.load[i] - load), `posture ${i}, joint ${k}`).toBeLessThanOrEqual(
              1e-9 * Math.max(load, 1),
            );
            expect(Math.abs(found.radius[i] - radius[i * stride + offset])).toBeLessThan(1e-9);
          }
        }
      });
    }
  }
});
