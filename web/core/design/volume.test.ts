import { describe, expect, it } from "vitest";
import cases from "./loadChart.fixture.json";
import type { Crane } from "./types";
import { reach } from "./volume";

const crane = cases.find(({ crane }) => crane.name === "offshore-100t")?.crane as unknown as Crane;

describe("what a crane reaches", () => {
  const { area, volume, edge } = reach(crane);
  const [boom, jib] = [18, 14];
  const [low, high] = crane.links[1].joint.limits ?? [0, 0];
  const [folded, straight] = crane.links[2].joint.limits ?? [0, 0];

  it("has the area that two links sweep", () => {
    const swept = boom * jib * (high - low) * (Math.cos(straight) - Math.cos(folded));
    expect(Math.abs(area / swept - 1)).toBeLessThan(0.005);
  });

  it("sweeps the volume that the section's radius integrates to", () => {
    // dA = boom * jib * |sin(fold)| over luff and fold; this crane's tip never comes behind the axis
    const n = 400;
    let moment = 0;
    for (let i = 0; i < n; i += 1)
      for (let k = 0; k < n; k += 1) {
        const luff = low + ((high - low) * (i + 0.5)) / n;
        const fold = folded + ((straight - folded) * (k + 0.5)) / n;
        const radius = boom * Math.cos(luff) + jib * Math.cos(luff + fold);
        moment += Math.max(0, radius) * boom * jib * Math.abs(Math.sin(fold));
      }
    const swept = 2 * Math.PI * moment * ((high - low) / n) * ((straight - folded) / n);
    expect(Math.abs(volume / swept - 1)).toBeLessThan(0.005);
  });

  it("is bounded by an edge on which every segment has a next one", () => {
    const ends = new Map<string, number>();
    for (let i = 0; i < edge.length; i += 2) {
      const key = `${edge[i].toFixed(3)} ${edge[i + 1].toFixed(3)}`;
      ends.set(key, (ends.get(key) ?? 0) + 1);
    }
    expect([...ends.values()].filter((count) => count % 2)).toEqual([]);
  });
});
