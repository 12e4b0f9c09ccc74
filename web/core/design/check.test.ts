import { describe, expect, it } from "vitest";
import { problems } from "./check";
import cases from "./loadChart.fixture.json";
import type { Crane, Cylinder } from "./types";

const cranes = cases.map(({ crane }) => crane as unknown as Crane);
const crane = cranes.find(({ name }) => name === "offshore-100t") as Crane;

function withCylinder(change: Partial<Cylinder>): Crane {
  return { ...crane, cylinders: [{ ...crane.cylinders[0], ...change }, crane.cylinders[1]] };
}

describe("problems of a crane", () => {
  it("are none in the designs that come with the package", () => {
    for (const one of cranes) expect(problems(one)).toEqual([]);
  });

  it("name a stroke that is too short with what it must be", () => {
    const [problem] = problems(withCylinder({ stroke: 4 }));
    expect(problem.path).toBe("cylinders[boom_cylinder].stroke");
    expect(problem.message).toMatch(
      /^4\.000 m is too short: the pins are 5\.371 m to 9\.764 m apart .* needs 4\.393 m$/,
    );
  });

  it("name a cylinder over two joints, and two sets on one joint", () => {
    const [main, jib] = crane.cylinders;
    const over = { ...jib, base: { ...jib.base, link: "column" } };
    expect(problems({ ...crane, cylinders: [main, over] })).toEqual([
      { path: "cylinders[jib_cylinder].moves", message: "more than one joint lies between its pins: luff, jib" },
    ]);
    expect(problems({ ...crane, cylinders: [main, { ...main, name: "another" }, jib] })).toEqual([
      { path: "cylinders", message: "luff is moved by two sets; cylinders side by side are one set" },
    ]);
  });

  it("name reversed limits once, and nothing that follows from them", () => {
    const links = crane.links.map((link) =>
      link.name === "jib" ? { ...link, joint: { ...link.joint, limits: [0, -2] as const } } : link,
    );
    expect(problems({ ...crane, links }).map(({ path }) => path)).toEqual(["links[jib].joint.limits"]);
  });

  it("name pins on one side of their joint, coinciding pins and a rod as thick as its bore", () => {
    const { base, eye } = crane.cylinders[0];
    expect(problems(withCylinder({ eye: { ...eye, link: "column" } }))[0].message).toContain(
      "not on both sides of luff",
    );
    expect(problems(withCylinder({ rod: 0.42 }))[0].message).toBe("must be thinner than the bore of 420 mm");
    const heel = crane.links[1].joint.origin;
    const both = { base: { ...base, x: heel[0] + 1, z: heel[2] }, eye: { ...eye, x: 1, z: 0 } };
    expect(problems(withCylinder({ ...both, stroke: 20 }))[0].message).toContain("coincide");
  });

  it("name a cylinder that passes its dead point, or has no lever at all", () => {
    const { base, eye } = crane.cylinders[0];
    const heel = crane.links[1].joint.origin;
    // in line with the joint when the boom stands at 45 degrees
    const ahead = { ...base, x: heel[0] + 3, z: heel[2] + 3 };
    const still = { ...eye, x: 0, z: 0 };
    for (const pins of [{ base: ahead }, { eye: still }]) {
      const found = problems(withCylinder({ ...pins, stroke: 9, retracted: null })).map(({ message }) => message);
      expect(found.join()).toContain("passes a dead point within the limits of luff");
    }
    // the dead point just outside the limits is none of theirs
    const angle = -0.02;
    const behind = { ...base, x: heel[0] + 12 * Math.cos(angle), z: heel[2] + 12 * Math.sin(angle) };
    const near = problems(withCylinder({ base: behind, eye: { ...eye, x: 4, z: 0 }, stroke: 30 }));
    expect(near.map(({ message }) => message).join()).not.toContain("dead point");
  });
});
