import { describe, expect, it } from "vitest";
import { capacity } from "./loadChart";
import cases from "./loadChart.fixture.json";
import { contourStep, paint, postureAt, Rasteriser, type View } from "./section";
import { type Crane, HARBOUR } from "./types";

const crane = cases.find(({ crane }) => crane.name === "offshore-100t")?.crane as unknown as Crane;
const view: View = { width: 300, height: 400, x: 0, z: -12, cell: 0.12 };

describe("section", () => {
  const section = new Rasteriser().section(crane, HARBOUR, view);

  it("covers the area that two revolute links sweep, without holes", () => {
    const cells = section.load.reduce((count, load) => count + (load >= 0 ? 1 : 0), 0);
    const [low, high] = crane.links[1].joint.limits ?? [0, 0];
    const [folded, straight] = crane.links[2].joint.limits ?? [0, 0];
    const area = 18 * 14 * (high - low) * (Math.cos(straight) - Math.cos(folded));
    // a cell on the edge counts whole: half a cell along some 120 m of edge
    expect(cells * view.cell ** 2).toBeGreaterThan(area);
    expect(cells * view.cell ** 2).toBeLessThan(area + 0.5 * view.cell * 130 + 1);
  });

  it("tells the posture of a point, whose load is the one painted there", () => {
    const posture = postureAt(section, 20, 15);
    expect(posture).not.toBeNull();
    const found = capacity(crane, [[posture!.luff], [posture!.jib]], HARBOUR);
    expect(Math.hypot(found.radius[0] - 20, found.height[0] - 15)).toBeLessThan(view.cell);
    const cell = Math.round((15 - view.z) / view.cell) * view.width + Math.round((20 - view.x) / view.cell);
    expect(section.load[cell]).toBeCloseTo(found.load[0], 1);
    expect(postureAt(section, 35, 35)).toBeNull();
    expect(postureAt(section, -100, 0)).toBeNull();
  });

  it("paints what is out of reach transparent and contours white", () => {
    const pixels = new Uint8ClampedArray(4 * view.width * view.height);
    paint(section, 100e3, 20e3, pixels);
    expect(pixels[3]).toBe(0);
    let white = 0;
    for (let i = 0; i < pixels.length; i += 4) if (pixels[i] === 255 && pixels[i + 2] === 255) white += 1;
    expect(white).toBeGreaterThan(300);
  });

  it("steps contours by round numbers", () => {
    expect([100e3, 47e3, 2.1e3, 0].map(contourStep)).toEqual([10e3, 5e3, 500, 1]);
  });
});
