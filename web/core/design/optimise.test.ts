import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { set } from "./edit";
import { read } from "./file";
import {
  best,
  bounded,
  changes,
  type Front,
  fitting,
  lacking,
  range,
  readSearch,
  result,
  searchText,
  sizes,
  usual,
} from "./optimise";

const load = (name: string) => read(readFileSync(`../src/seacrane/design/cranes/${name}.json`, "utf8"));
const offshore = load("offshore-100t");
const NAMES = ["offshore-100t", "gunnerus-pk65", "a-frame-30t", "dual-drag-link-60t", "gangway-24m"];

describe("the sizes of a crane that can be searched", () => {
  it("are lengths, bores and places of pins, as they stand", () => {
    const found = new Map(sizes(offshore).map(({ path, now }) => [path, now]));
    expect(found.get("cylinders[boom_cylinder].bore")).toBeCloseTo(0.42, 12);
    expect(found.get("links[jib].length")).toBe(offshore.hoist.sheaves.at(-1)!.x);
    expect(found.get("links[boom].length")).toBe(offshore.links.at(-1)!.joint.origin[0]);
    expect(found.has("links[column].length")).toBe(offshore.links[1].joint.origin[0] > 0);
    expect(found.get("cylinders[jib_cylinder].eye.z")).toBe(offshore.cylinders[1].eye.z);
  });

  it("vary by a quarter, pins by 0.2 m at the least, as the server has it", () => {
    const pin = sizes(offshore).find(({ path }) => path === "cylinders[jib_cylinder].eye.x")!;
    expect(bounded({ ...pin, now: -0.4 })).toMatchObject({ low: -0.6000000000000001, high: -0.2 });
    expect(bounded({ ...pin, now: 4 })).toMatchObject({ low: 3, high: 5 });
    const bore = sizes(offshore).find(({ path }) => path === "cylinders[boom_cylinder].bore")!;
    expect(bounded(bore).low).toBeCloseTo(0.315, 12);
  });
});

describe("a specification", () => {
  it.each(NAMES)("to begin with lacks nothing for %s", (name) => {
    const wanted = usual(load(name));
    expect(lacking(wanted)).toBeNull();
    expect(wanted.variables.every(({ low, high }) => 0 < low && low < high)).toBe(true);
  });

  it("says what it lacks", () => {
    const wanted = usual(offshore);
    expect(lacking({ ...wanted, variables: [] })).toMatch("at least one size");
    expect(lacking({ ...wanted, goals: wanted.goals.slice(2) })).toMatch("at least two goals");
    expect(lacking({ ...wanted, goals: [wanted.goals[1], wanted.goals[1]] })).toMatch("the same");
  });

  it("outlives a reload, for its crane alone", () => {
    const wanted = { ...usual(offshore), population: 12 };
    const kept = searchText(wanted, offshore);
    expect(readSearch(kept, offshore)).toEqual(wanted);
    expect(readSearch(kept, load("a-frame-30t"))).toBeNull();
    for (const bad of [null, "{", "3", searchText({ ...wanted, goals: [{ kind: "price" }] as never }, offshore)])
      expect(readSearch(bad, offshore)).toBeNull();
  });

  it("keeps of its sizes and modes those that the crane has", () => {
    const wanted = { ...usual(offshore), goals: [{ kind: "capacity", radius: 9, mode: "hs2.0" } as const] };
    const renamed = set(set(offshore, ["cylinders", 0, "name"], "lift"), ["rating"], { wave_heights: [1] });
    const fitted = fitting(wanted, renamed);
    expect(fitted.variables.map(({ path }) => path)).not.toContain("cylinders[boom_cylinder].bore");
    expect(fitted.variables).toHaveLength(wanted.variables.length - 1);
    expect(fitted.goals[0].mode).toBe("harbour");
  });
});

describe("a front", () => {
  const front: Front = {
    generation: 3,
    variables: [{ path: "links[jib].length", low: 10, high: 16 }],
    goals: [
      { kind: "weight", radius: 0, mode: "harbour", name: "weight" },
      { kind: "reach", radius: 0, mode: "harbour", name: "reach" },
    ],
    values: [[12], [11], [15], [11]],
    results: [
      [190e3, 30],
      [180e3, 29],
      [220e3, 28],
      [180e3, 29],
    ],
    violation: [0, 0, 0, 0],
    best: [true, true, false, true],
    crane: offshore,
  };

  it("lists what none beats, in order, equal ones once", () => {
    expect(best(front, 0)).toEqual([1, 0]);
    expect(changes(front, 0)).toEqual({ "links[jib].length": 12 });
  });

  it("is shown in tonnes and metres on ranges that hold every point", () => {
    expect(result("weight", 190_340)).toBe("190.3");
    expect(result("capacity", 4_238)).toBe("4.24");
    expect(result("reach", 29.996)).toBe("30.00");
    const [low, high] = range([3, 5]);
    expect(low).toBeLessThan(3);
    expect(high).toBeGreaterThan(5);
    expect(range([7])[1]).toBeGreaterThan(7);
  });
});
