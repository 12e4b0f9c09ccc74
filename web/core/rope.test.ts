import { describe, expect, it } from "vitest";
import { arc, type Disc, type Point2, ropePath, slackBow, tangent } from "./rope";

const turned = (radius: number, x: number, z: number, turn: 1 | -1 = -1): Disc => ({ x, z, radius, turn });

function length(path: readonly Point2[]): number {
  return path.slice(1).reduce((sum, p, i) => sum + Math.hypot(p[0] - path[i][0], p[1] - path[i][1]), 0);
}

describe("a rope over sheaves", () => {
  it("touches both discs and meets their radii at a right angle", () => {
    for (const [a, b] of [
      [turned(0.8, -2, 2), turned(0.6, 11, 18)],
      [turned(0.8, -2, 2), turned(0.6, 11, 18, 1)],
      [turned(0.3, 4, 1, 1), turned(0, -5, -9)],
    ]) {
      const [p, q] = tangent(a, b)!;
      expect(Math.hypot(p[0] - a.x, p[1] - a.z)).toBeCloseTo(a.radius, 9);
      expect(Math.hypot(q[0] - b.x, q[1] - b.z)).toBeCloseTo(b.radius, 9);
      const along = [q[0] - p[0], q[1] - p[1]];
      expect(along[0] * (p[0] - a.x) + along[1] * (p[1] - a.z)).toBeCloseTo(0, 9);
      expect(along[0] * (q[0] - b.x) + along[1] * (q[1] - b.z)).toBeCloseTo(0, 9);
    }
  });

  it("leaves over the top of drum and sheave when it turns clockwise", () => {
    const [p, q] = tangent(turned(1, 0, 0), turned(1, 10, 0))!;
    expect(p[1]).toBeCloseTo(1, 9);
    expect(q[1]).toBeCloseTo(1, 9);
  });

  it("has no tangent from inside a disc", () => {
    expect(tangent(turned(2, 0, 0), turned(0.5, 1, 0))).toBeNull();
  });

  it("runs a quarter round the last sheave to a hook below, and hangs from it plumb", () => {
    const path = ropePath([turned(1, 0, 0), turned(1, 10, 0)], [11, -8]);
    expect(length(path)).toBeCloseTo(10 + Math.PI / 2 + 8, 2);
    const leave = path[path.length - 2];
    expect(leave[0]).toBeCloseTo(11, 9);
    expect(leave[1]).toBeCloseTo(0, 9);
  });

  it("stays outside every sheave it bends over", () => {
    const discs = [turned(0.8, -2, 2.2), turned(0.6, 10.6, 18.5), turned(0.6, 24, 13)];
    for (const [x, z] of ropePath(discs, [24.7, -3])) {
      for (const disc of discs) expect(Math.hypot(x - disc.x, z - disc.z)).toBeGreaterThan(disc.radius - 1e-9);
    }
  });

  it("does not wind a full turn where it just fails to touch", () => {
    const disc = turned(1, 0, 0);
    expect(arc(disc, [0, 1], [-1e-9, 1]).length).toBe(2);
  });

  it("bows a slack span to the length of rope that is in it", () => {
    const [straight, slack] = [20, 0.5];
    const bow = slackBow(straight, straight + slack);
    const path = Array.from({ length: 201 }, (_, i): Point2 => {
      const u = i / 200;
      return [straight * u, 4 * bow * u * (1 - u)];
    });
    expect(length(path)).toBeCloseTo(straight + slack, 1);
    expect(slackBow(20, 19.99)).toBe(0);
  });
});
