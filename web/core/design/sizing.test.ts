import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { withCylinder, withLink } from "./edit";
import { read } from "./file";
import { capacity, limitNames } from "./loadChart";
import { newCrane } from "./newCrane";
import { sized } from "./sizing";
import { type Crane, HARBOUR, planeJoints } from "./types";

const offshore = read(readFileSync("../src/seacrane/design/cranes/offshore-100t.json", "utf8"));
const small = newCrane(offshore, 0.7, 5_000);

/** In how many of the postures a limit governs. */
function share(crane: Crane, limit: string): number {
  const coordinates = planeJoints(crane).map(({ limits }) =>
    Array.from({ length: 12 }, (_, i) => limits![0] + ((i + 0.5) / 12) * (limits![1] - limits![0])),
  );
  const { governs } = capacity(crane, coordinates, HARBOUR);
  const index = limitNames(crane).indexOf(limit);
  return governs.reduce((sum, one) => sum + Number(one === index), 0) / governs.length;
}

describe("a cylinder that is added", () => {
  it("is as strong as the rest of its crane: it governs here and there, not everywhere and not nowhere", () => {
    for (const crane of [offshore, small]) {
      const more = withCylinder(withLink(crane, "revolute"), 3);
      const { name } = more.cylinders[2];
      expect(share(more, name)).toBeLessThan(0.35);
      const weaker = { ...more.cylinders[2], bore: 0.7 * more.cylinders[2].bore, rod: 0.7 * more.cylinders[2].rod };
      const weak = { ...more, cylinders: [...crane.cylinders, weaker] };
      expect(share(weak, name)).toBeGreaterThan(share(more, name));
    }
  });

  it("has the same bore whatever it was drawn with", () => {
    const more = withCylinder(withLink(small, "revolute"), 3);
    const cylinder = more.cylinders[2];
    const thick = { ...cylinder, bore: 3 * cylinder.bore, rod: 3 * cylinder.rod };
    expect(sized(more, thick).bore).toBeCloseTo(sized(more, cylinder).bore, 6);
    expect(cylinder.rod).toBeLessThan(cylinder.bore);
  });
});
