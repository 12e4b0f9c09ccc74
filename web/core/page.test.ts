import { describe, expect, it } from "vitest";
import fixture from "../../tests/fixtures/crane_kinematics.json";
import type { CraneDesign, VariableInfo } from "../rpc/messages";
import { craneAxes } from "./axes";
import { History, toCsv } from "./history";
import { limitText, readings, wanted } from "./instruments";
import { search, variableTree } from "./tree";
import { clock, fixed, shown, symbol } from "./units";

const model = { crane: fixture.crane as unknown as CraneDesign, axes: ["slew", "boom", "jib", "hoist"] };
const variable = (name: string, unit = "m", shownIn = unit, factor = 1, about = ""): VariableInfo => ({
  name,
  unit,
  shown: shownIn,
  factor,
  about,
});

describe("what was plotted", () => {
  it("keeps the window and drops what is older", () => {
    const history = new History(10, 4);
    history.keep(["a"]);
    for (let t = 0; t <= 100; t += 1) history.push(t, () => 2 * t);
    const { time, columns } = history.slice();
    expect([...time]).toEqual([90, 91, 92, 93, 94, 95, 96, 97, 98, 99, 100]);
    expect([...columns.get("a")!]).toEqual([...time].map((t) => 2 * t));
  });

  it("has gaps before a variable was ticked, and keeps the past of one that stays", () => {
    const history = new History(100);
    history.keep(["a"]);
    history.push(1, () => 10);
    history.keep(["a", "b"]);
    history.push(2, () => 20);
    const { columns } = history.slice();
    expect([...columns.get("a")!]).toEqual([10, 20]);
    expect([...columns.get("b")!]).toEqual([Number.NaN, 20]);
  });

  it("starts anew when time goes back, and ignores a frame seen twice", () => {
    const history = new History(100);
    history.keep(["a"]);
    for (const t of [5, 6, 6, 0.5]) history.push(t, () => t);
    expect([...history.slice().time]).toEqual([0.5]);
  });

  it("is cut to the part that is looked at", () => {
    const history = new History(100);
    history.keep(["a"]);
    for (let t = 0; t < 10; t += 1) history.push(t, () => t);
    expect([...history.slice(2.5, 5).time]).toEqual([3, 4, 5]);
  });

  it("is written in SI with names and units, as recordings are", () => {
    const history = new History(100);
    history.keep(["crane.luff", 'odd "name", indeed']);
    history.push(0.02, (name) => (name === "crane.luff" ? 0.8726646259971648 : null));
    expect(toCsv(history.slice(), (name) => (name === "crane.luff" ? "rad" : "1"))).toBe(
      'time [s],crane.luff [rad],"odd ""name"", indeed [1]"\n0.02,0.8726646259971648,nan\n',
    );
  });
});

describe("the tree of variables", () => {
  const variables = [
    variable("crane.luff", "rad", "deg", 180 / Math.PI, "boom angle"),
    variable("crane.rope.tension", "N", "kN", 1e-3),
    variable("ship.z"),
  ];

  it("groups by slave and by dots", () => {
    const tree = variableTree(variables);
    expect(tree.branches.map((b) => [b.path, b.size])).toEqual([
      ["crane", 2],
      ["ship", 1],
    ]);
    expect(tree.branches[0].branches[0].path).toBe("crane.rope");
    expect(tree.branches[0].leaves.map((v) => v.name)).toEqual(["crane.luff"]);
  });

  it("is searched by all words, in names, units and descriptions", () => {
    expect(search(variables, "CRANE kn").map((v) => v.name)).toEqual(["crane.rope.tension"]);
    expect(search(variables, "boom").map((v) => v.name)).toEqual(["crane.luff"]);
    expect(search(variables, "  ")).toEqual(variables);
    expect(search(variables, "nothing")).toEqual([]);
  });
});

describe("instruments", () => {
  const values: Record<string, number> = {
    "crane.slew": -Math.PI / 2,
    "crane.luff": (50 * Math.PI) / 180,
    "crane.radius": 20,
    "crane.rope.tension": 65e3 * 9.81,
    "crane.drum.speed": 1.25,
    "boom_drive.cylinder.pressure_a": 191e5,
    "joystick.limit.luff": -1,
    "joystick.limit.jib": 0,
  };
  const read = (name: string) => values[name] ?? null;

  it("read in the units of the trade", () => {
    const r = readings(model, read, ["joystick.limit.luff", "joystick.limit.jib"]);
    const joint = (axis: string) => r.joints.find((one) => one.axis === axis);
    expect(joint("slew")?.value).toBeCloseTo(270, 9);
    expect(joint("boom")).toMatchObject({ label: "Main boom", unit: "deg" });
    expect(joint("boom")?.value).toBeCloseTo(50, 9);
    expect(r.load).toBeCloseTo(65, 9);
    expect(r.utilisation).toBeCloseTo(100, 9);
    expect(r.wireSpeed).toBeCloseTo(1, 9);
    expect(r.pressures[0]).toEqual({ label: "boom", piston: 191, rod: null });
    expect(r.limits).toEqual(["Boom at its lower end"]);
  });

  it("show nothing, and fail at nothing, where variables are absent", () => {
    const r = readings(model, () => null, []);
    expect([r.joints[0].value, r.load, r.rated, r.utilisation, r.hookHeight, r.wireSpeed]).toEqual(Array(6).fill(null));
    expect(r.slack).toBe(false);
  });

  it("show a telescope in metres, with its ends, its pressures and what its lever does", () => {
    const slide = { name: "telescope", kind: "prismatic" as const, axis: [1, 0, 0] as const };
    const link = { ...model.crane.links[2], name: "outer", joint: { ...model.crane.links[2].joint, ...slide } };
    const other = { crane: { ...model.crane, links: [...model.crane.links, link] }, axes: [...model.axes] };
    other.axes.splice(3, 0, "telescope");
    const at: Record<string, number> = { "crane.telescope": 2.5, "joystick.limit.telescope": 1 };
    const r = readings(other, (name) => at[name] ?? null, ["joystick.limit.telescope"]);
    expect(r.joints[3]).toEqual({ axis: "telescope", label: "Telescope", value: 2.5, unit: "m" });
    expect(r.limits).toEqual(["Telescope at its outer end"]);
    expect(wanted(other)).toContain("telescope_drive.cylinder.pressure_a");
    expect(craneAxes(other).map(({ senses }) => senses[0])).toEqual([
      "slew left",
      "boom up",
      "jib out",
      "telescope out",
      "hoist",
    ]);
  });

  it("say plainly what a limit is that they have never heard of", () => {
    expect(limitText([], "joystick.limit.wind_speed", 1)).toBe("Wind speed");
  });

  it("name a variable for every joint and cylinder of the design", () => {
    for (const name of ["crane.luff", "crane.jib_cylinder.length", "jib_drive.cylinder.pressure_b", "ship.qw"]) {
      expect(wanted(model)).toContain(name);
    }
  });
});

describe("numbers on the page", () => {
  it("have a true minus, no negative zero, and a dash for nothing", () => {
    expect(fixed(-1.25, 1)).toMatch(/^\u22121\.[23]$/);
    expect(fixed(-0.001, 1)).toBe("0.0");
    expect(fixed(null, 1)).toBe("\u2013");
    expect(fixed(Number.NaN, 1)).toBe("\u2013");
  });

  it("are shown in engineering units to about four digits", () => {
    expect(shown(191.04e5, variable("p", "Pa", "bar", 1e-5))).toBe("191.0");
    expect(shown(-0.0123456, variable("v", "m/s"))).toBe("\u22120.01235");
    expect(shown(0, variable("x"))).toBe("0.000");
    expect(shown(3.2e9, variable("k", "N/m"))).toBe("3.20e+9");
  });

  it("carry typeset units", () => {
    expect(["m/s2", "kN.m", "deg", "deg/s", "kg/m3"].map(symbol)).toEqual([
      "m/s\u00b2",
      "kN\u00b7m",
      "\u00b0",
      "\u00b0/s",
      "kg/m\u00b3",
    ]);
  });

  it("tell the time", () => {
    expect([0, 59.96, 75.3, 3600, null].map(clock)).toEqual(["0:00.0", "0:59.9", "1:15.3", "1:00:00.0", "\u2013"]);
  });
});
