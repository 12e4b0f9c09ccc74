import { describe, expect, it } from "vitest";
import { capacity, limitNames } from "./loadChart";
import cases from "./loadChart.fixture.json";
import { type Crane, modes } from "./types";

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
    }
  }
});
