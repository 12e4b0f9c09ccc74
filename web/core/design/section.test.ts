import { describe, expect, it } from "vitest";
import { capacity } from "./loadChart";
import cases from "./loadChart.fixture.json";
import { contourStep, paint } from "./paint";
import { postureAt, Rasteriser, type View } from "./section";
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

describe("section of a crane with three joints, which reach each point in many postures", () => {
  const three = cases.find(({ crane }) => crane.name === "dual-drag-link-60t")?.crane as unknown as Crane;
  const view: View = { width: 110, height: 130, x: -3, z: -12, cell: 0.3 };
  const rasteriser = new Rasteriser();
  let section = rasteriser.section(three, HARBOUR, view);
  const first = section.load.slice();
  while (!section.complete) section = rasteriser.refined(three, HARBOUR, view, 20);

  it("finds better postures step by step, and loses none", () => {
    let better = 0;
    for (let cell = 0; cell < first.length; cell += 1) {
      // a cell between two others may have been taken for as good as the better one
      if (first[cell] > section.load[cell]) expect(first[cell] - section.load[cell]).toBeLessThan(0.2 * first[cell]);
      if (section.load[cell] > 1.001 * first[cell]) better += 1;
    }
    expect(better).toBeGreaterThan(100);
  });

  it("comes near the best of a fine grid of postures, everywhere", () => {
    const fine = three.links.slice(1).map(({ joint }, k) => {
      const [low, high] = joint.limits ?? [0, 0];
      const count = [60, 120, 120][k];
      return Array.from({ length: count }, (_, i) => low + ((high - low) * i) / (count - 1));
    });
    const found = capacity(three, fine, HARBOUR);
    let short = 0;
    for (let i = 0; i < found.count; i += 1) {
      const column = Math.round((found.radius[i] - view.x) / view.cell);
      const row = Math.round((found.height[i] - view.z) / view.cell);
      if (column < 0 || column >= view.width || row < 0 || row >= view.height) continue;
      if (!(section.load[row * view.width + column] > 0.97 * found.load[i])) short += 1;
    }
    expect(short / found.count).toBeLessThan(1e-3);
  });

  it("tells the posture of a point, whichever of its grids that was in", () => {
    const joints = three.links.slice(1).map(({ joint }) => joint.name);
    let met = 0;
    for (let cell = 0; cell < section.load.length; cell += 97) {
      const x = view.x + (cell % view.width) * view.cell;
      const z = view.z + Math.floor(cell / view.width) * view.cell;
      const posture = postureAt(section, x, z);
      if (!posture) continue;
      const found = capacity(
        three,
        joints.map((name) => [posture[name]]),
        HARBOUR,
      );
      // one cell off where it was taken from a neighbour
      expect(Math.abs(found.radius[0] - x)).toBeLessThan(1.51 * view.cell);
      expect(Math.abs(found.height[0] - z)).toBeLessThan(1.51 * view.cell);
      expect(section.load[cell]).toBeCloseTo(found.load[0], 1);
      met += 1;
    }
    expect(met).toBeGreaterThan(30);
  });
});
