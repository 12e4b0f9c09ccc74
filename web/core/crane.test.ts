import { describe, expect, it } from "vitest";
import fixture from "../../tests/fixtures/crane_kinematics.json";
import type { CraneDesign, WaveComponent } from "../rpc/messages";
import { cylinderLength, linkFrames, radius, ratedLoad, retractedLength, tip } from "./crane";
import { apply, fromQuaternion, rotate, unapply } from "./frames";
import { elevation, SeaGrid, widening } from "./sea";

const crane = fixture.crane as unknown as CraneDesign;
const waves = fixture.waves as unknown as WaveComponent[];

function closeTo(actual: readonly number[], expected: readonly number[], digits = 9): void {
  expect(actual).toHaveLength(expected.length);
  actual.forEach((value, i) => {
    expect(value).toBeCloseTo(expected[i], digits);
  });
}

describe("the kinematics of the page", () => {
  it.each(fixture.postures)("puts links, tip and pins where the physics has them at $joints", (posture) => {
    const frames = linkFrames(crane, posture.joints);
    for (const [name, { R, p }] of Object.entries(posture.frames)) {
      closeTo(frames.get(name)!.R, R);
      closeTo(frames.get(name)!.p, p);
    }
    closeTo(tip(crane, frames), posture.tip);
    expect(radius(tip(crane, frames))).toBeCloseTo(posture.radius, 9);
    for (const cylinder of crane.cylinders) {
      const length = posture.cylinders[cylinder.name as keyof typeof posture.cylinders];
      expect(cylinderLength(cylinder, frames)).toBeCloseTo(length, 9);
    }
  });

  it("has the radius and pin distances published for the reference posture", () => {
    const frames = linkFrames(crane, fixture.postures[0].joints);
    expect(radius(tip(crane, frames))).toBeCloseTo(24.73, 2);
    expect(cylinderLength(crane.cylinders[0], frames)).toBeCloseTo(8.54, 2);
    expect(cylinderLength(crane.cylinders[1], frames)).toBeCloseTo(7.14, 2);
  });

  it("retracts cylinders to the length that the physics uses", () => {
    for (const cylinder of crane.cylinders) {
      const length = fixture.retracted[cylinder.name as keyof typeof fixture.retracted];
      expect(retractedLength(crane, cylinder)).toBeCloseTo(length, 6);
    }
  });

  it("slides a telescope along its axis, whatever the length of the axis as given", () => {
    const boom = crane.links[1];
    const telescope = {
      ...boom,
      name: "telescope",
      joint: {
        name: "reach",
        kind: "prismatic" as const,
        axis: [4, 0, 0] as const,
        origin: [2, 0, 0] as const,
        limits: null,
      },
    };
    const frames = linkFrames({ ...crane, links: [boom, telescope] }, { luff: Math.PI / 2, reach: 3 });
    closeTo(frames.get("telescope")!.p, [0, 0, 4 + 2 + 3]);
  });

  it("rates loads between the points of the chart and none beyond it", () => {
    expect(ratedLoad(crane, 10)).toBe(100e3);
    expect(ratedLoad(crane, 22.5)).toBeCloseTo(54e3, 6);
    expect(ratedLoad(crane, 32)).toBe(25e3);
    expect(ratedLoad(crane, 32.1)).toBeNull();
  });
});

describe("frames", () => {
  it("undo what they do", () => {
    const frame = linkFrames(crane, { slew: 1, luff: 0.5, jib: -1 }).get("jib")!;
    closeTo(unapply(frame, apply(frame, [1, -2, 3])), [1, -2, 3]);
  });

  it("turn by a quaternion of any length", () => {
    const half = Math.SQRT1_2 * 3;
    closeTo(rotate(fromQuaternion(half, 0, 0, half), [1, 0, 0]), [0, 1, 0]);
  });
});

describe("the sea of the page", () => {
  it.each(fixture.elevations)(
    "has the elevation of the physics at $x, $y after $t s, within a tenth of a millimetre",
    ({ x, y, t, eta }) => {
      expect(Math.abs(elevation(waves, x, y, t) - eta)).toBeLessThan(1e-4);
      const drawn = new SeaGrid(waves, [x], [y]).at(t, new Float32Array(1))[0];
      expect(Math.abs(drawn - eta)).toBeLessThan(1e-4);
    },
  );

  it("puts each elevation at its own place on an uneven grid", () => {
    const [xs, ys] = [widening(9, 2, 500), [-30, 5]];
    const grid = new SeaGrid(waves, xs, ys).at(123.4, new Float32Array(18));
    xs.forEach((x, i) => {
      ys.forEach((y, j) => {
        expect(grid[j * 9 + i]).toBeCloseTo(elevation(waves, x, y, 123.4), 4);
      });
    });
  });

  it("is finest in the middle and reaches the horizon", () => {
    const line = widening(129, 1.6, 4500);
    expect(line[64]).toBeCloseTo(0, 9);
    expect(line[128]).toBeCloseTo(4500, 3);
    expect(line[65] - line[64]).toBeCloseTo(1.6, 2);
    expect(line[128] - line[127]).toBeGreaterThan(100);
  });
});
