import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { problems } from "../core/design/check";
import { curve, verdict } from "../core/design/curve";
import {
  differences,
  dragged,
  get,
  nudged,
  set,
  withCylinder,
  withKind,
  withLink,
  withoutLink,
} from "../core/design/edit";
import { fromData, read, text } from "../core/design/file";
import { endOf } from "../core/design/length";
import { capacity } from "../core/design/loadChart";
import { bare, newCrane, scaled } from "../core/design/newCrane";
import { firstItem } from "../core/design/newPart";
import { frames, outOf, tip } from "../core/design/plane";
import { furthestLoad } from "../core/design/rated";
import { furnished } from "../core/design/standard";
import { type Crane, HARBOUR, planeJoints } from "../core/design/types";
import { takenBy } from "./panels/Form";
import { placeOf } from "./panels/Problems";
import { unheld } from "./panels/Verdict";
import { grips } from "./section/handles";
import { framed, toMetres, toPixels, zoomed } from "./section/window";
import { createDesigner } from "./store";

const DEGREE = Math.PI / 180;
const STEPS = { length: 0.1, angle: DEGREE };
const FREE = { length: 0, angle: 0 };
const NAMES = ["offshore-100t", "gunnerus-pk65", "a-frame-30t", "dual-drag-link-60t", "gangway-24m"];
const cranes = new Map(
  NAMES.map((name) => [name, read(readFileSync(`../src/seacrane/design/cranes/${name}.json`, "utf8"))]),
);
const offshore = cranes.get("offshore-100t")!;
const posture = { slew: 0, luff: 50 * DEGREE, jib: -70 * DEGREE };

describe("design files", () => {
  it.each(NAMES)("%s is read with its units, has no problems, and is written so that it reads back equal", (name) => {
    const crane = cranes.get(name)!;
    expect(problems(crane)).toEqual([]);
    expect(read(text(crane))).toEqual(crane);
  });

  it("are in SI once read", () => {
    expect(offshore.cylinders[0].bore).toBeCloseTo(0.42, 12);
    expect(offshore.links[1].joint.limits?.[1]).toBeCloseTo(78 * DEGREE, 12);
    expect(cranes.get("gunnerus-pk65")!.links[3].joint.limits).toEqual([0, 16.98]);
  });

  it("tell all that is wrong, place by place", () => {
    const data = JSON.parse(text(offshore));
    data.links[0].mass = -5;
    data.cylinders[0].bore = "420 bar";
    data.hoist.colour = "yellow";
    data.links[1].parts = [{ kind: "spring", name: "odd" }];
    expect(() => fromData(data)).toThrow(
      /links\[column\]\.mass: must be above 0 t[\s\S]*parts\[odd\]: is of no known kind[\s\S]*bore: cannot be given in bar[\s\S]*hoist: colour is not a field here/,
    );
  });

  it("hold no more than a crane has, and no text that cannot be printed", () => {
    const data = JSON.parse(text(offshore));
    data.links = Array(13).fill(data.links[0]);
    data.rating.wave_heights = [1, -8];
    data.name = "two\nlines";
    data.about = "a bell \u0007";
    data.cylinders[0].name = "\ud800";
    expect(() => fromData(data)).toThrow(
      /^name: must be one line of at most 100 characters\nabout: has a character that cannot be printed\nlinks: must be a list of 1 to 12\ncylinders\[\ud800\]\.name: has a character that cannot be printed\nrating.wave_heights\[1\]: must be above 0 m$/,
    );
    data.links = data.links.slice(0, 3);
    data.rating.wave_heights = [1];
    data.cylinders[0].name = "main";
    data.name = "Kran № 5 – ÆØÅ 起重机";
    data.about = "two\r\nlines\tare well";
    expect(fromData(data).name).toBe(data.name);
  });

  it.each([
    ["{", "is not JSON"],
    ["[]", "does not hold a crane"],
    ["{}", "names no format"],
    ['{"format":"seacrane-crane/9"}', "cannot read"],
    ['{"format":"seacrane-crane/1","links":{"__proto__":1}}', "links: must be a list"],
    ["null", "does not hold a crane"],
  ])("refuse %s with the reason", (content, reason) => {
    expect(() => read(content)).toThrow(reason);
  });
});

describe("handles", () => {
  const scene = { crane: offshore, posture };

  it("turn a joint so that the link points at the pointer, in whole degrees", () => {
    const at = frames(offshore, posture).get("boom")!;
    const to = outOf({ ...at, c: Math.cos(0.71), s: Math.sin(0.71) }, 9, 0);
    const after = dragged(scene, { kind: "joint", link: 1 }, to, STEPS);
    expect(after.posture.luff).toBeCloseTo(41 * DEGREE, 12);
    expect(dragged(scene, { kind: "joint", link: 1 }, to, FREE).posture.luff).toBeCloseTo(0.71, 12);
    expect(after.crane).toBe(offshore);
  });

  it("stop a joint at its limits, from whichever side it is drawn", () => {
    const at = frames(offshore, posture).get("boom")!;
    for (const [angle, end] of [
      [2.4, 78 * DEGREE],
      [-1.2, 0],
    ])
      expect(
        dragged(scene, { kind: "joint", link: 1 }, [at.x + Math.cos(angle), at.z + Math.sin(angle)], STEPS).posture
          .luff,
      ).toBeCloseTo(end, 12);
  });

  it("put the end of a link where the pointer is, and with it the next joint or the tip", () => {
    const boom = frames(offshore, posture).get("boom")!;
    const longer = dragged(scene, { kind: "end", link: 1 }, outOf(boom, 19.04, 0.52), STEPS).crane;
    expect(longer.links[2].joint.origin).toEqual([19, 0, 0.5]);
    const jib = frames(offshore, posture).get("jib")!;
    const reaching = dragged(scene, { kind: "end", link: 2 }, outOf(jib, 15.26, 0), STEPS).crane;
    expect(reaching.hoist.sheaves.at(-1)).toEqual({ link: "jib", x: 15.3, z: 0 });
  });

  it("agree with what they drag: a handle taken to where it is changes nothing", () => {
    for (const crane of cranes.values()) {
      const held = Object.fromEntries(
        crane.links.map(({ joint }) => [joint.name, joint.limits ? 0.3 * joint.limits[0] + 0.7 * joint.limits[1] : 0]),
      );
      for (const grip of grips({ crane, posture: held }, () => 2)) {
        const after = dragged({ crane, posture: held }, grip.handle, grip.at, FREE);
        for (const { path, a, b } of differences({ crane, posture: held }, after))
          expect(Math.abs((a as number) - (b as number)), `${crane.name} ${grip.key} ${path.join(".")}`).toBeLessThan(
            grip.handle.kind === "joint" && crane.links[grip.handle.link].joint.kind === "prismatic" ? 10 : 1e-9,
          );
      }
    }
  });

  it("move limits, and the posture with them where it would be outside", () => {
    const pose = frames(offshore, posture).get("boom")!;
    const to = outOf({ ...pose, c: Math.cos(40 * DEGREE), s: Math.sin(40 * DEGREE) }, 3, 0);
    const after = dragged(scene, { kind: "limit", link: 1, end: 1 }, to, STEPS);
    expect(after.crane.links[1].joint.limits?.[1]).toBeCloseTo(40 * DEGREE, 12);
    expect(after.posture.luff).toBeCloseTo(40 * DEGREE, 12);
  });

  it("move by one step with an arrow", () => {
    expect(nudged(scene, { kind: "joint", link: 1 }, 0, 1, STEPS).posture.luff).toBeCloseTo(51 * DEGREE, 12);
    const crane = nudged(scene, { kind: "pin", cylinder: 0, end: "base" }, 1, 0, STEPS).crane;
    expect(crane.cylinders[0].base.x).toBe(1.9);
  });

  it("draw what cannot be built, and it is said in words", () => {
    const short = set(offshore, ["cylinders", 0, "stroke"], 1);
    expect(problems(short)[0].message).toContain("too short");
    const reversed = set(offshore, ["links", 1, "joint", "limits"], [1, 0.2]);
    expect(problems(reversed)[0].message).toContain("reversed");
    const folded = set(offshore, ["cylinders", 0, "eye"], { link: "boom", x: 0, z: 0 });
    const coincident = set(folded, ["cylinders", 0, "base"], { link: "column", x: 0, z: 4 });
    expect(
      problems(coincident)
        .map(({ message }) => message)
        .join(),
    ).toContain("coincide");
    for (const crane of [short, reversed, coincident]) {
      expect(grips({ crane, posture }, () => 2).length).toBeGreaterThan(8);
      expect(() => verdict(crane, posture, HARBOUR)).not.toThrow();
      expect(() => curve(crane, HARBOUR, 1)).not.toThrow();
    }
  });
});

describe("the window", () => {
  it("shows all that the crane reaches, and the pointer's place is kept when zooming", () => {
    const window = framed(offshore, 800, 600);
    const [x, y] = toPixels(window, tip(offshore, { luff: 78 * DEGREE, jib: 0 }));
    expect(x > 0 && x < 800 && y > 0 && y < 600).toBe(true);
    const before = toMetres(window, [123, 77]);
    const after = toMetres(zoomed(window, [123, 77], 1.7), [123, 77]);
    expect(Math.hypot(after[0] - before[0], after[1] - before[1])).toBeLessThan(1e-9);
  });
});

describe("undo and redo", () => {
  it("take back a drag in one step, whatever it passed through", () => {
    const designer = createDesigner(offshore);
    const before = designer.store.getState();
    designer.begin();
    for (let i = 1; i <= 30; i += 1)
      designer.change({
        ...designer.store.getState(),
        crane: set(offshore, ["hoist", "sheaves", 1, "x"], 14 + i / 10),
      });
    designer.end("tip");
    expect(designer.store.getState().past).toHaveLength(1);
    designer.undo();
    expect(designer.store.getState().crane).toBe(before.crane);
    designer.redo();
    expect(get(designer.store.getState().crane, ["hoist", "sheaves", 1, "x"])).toBe(17);
  });

  it("know nothing of a drag that changed nothing, or was taken back", () => {
    const designer = createDesigner(offshore);
    designer.begin();
    designer.end("nothing");
    designer.begin();
    designer.change({ ...designer.store.getState(), crane: set(offshore, ["name"], "other") });
    designer.cancel();
    expect(designer.store.getState().past).toHaveLength(0);
    expect(designer.store.getState().crane.name).toBe("offshore-100t");
  });

  it("forget what was undone once something else is done, and tell problems at once", () => {
    const designer = createDesigner(offshore);
    designer.edit("stroke", ["cylinders", 0, "stroke"], 1);
    expect(designer.store.getState().problems[0].path).toBe("cylinders[boom_cylinder].stroke");
    designer.undo();
    expect(designer.store.getState().problems).toEqual([]);
    designer.edit("mass", ["links", 0, "mass"], 1e5);
    expect(designer.store.getState().future).toEqual([]);
  });
});

describe("building a chain", () => {
  it("adds links and cylinders that can be built, and takes them away again", () => {
    let crane = withLink(offshore, "revolute");
    expect(crane.hoist.sheaves.at(-1)?.link).toBe("arm");
    crane = withCylinder(crane, 3);
    expect(problems(crane)).toEqual([]);
    crane = withLink(crane, "prismatic");
    expect(planeJoints(crane)).toHaveLength(4);
    const back = withoutLink(withoutLink(crane, 4)!, 3)!;
    expect(back.links).toEqual(offshore.links);
    expect(back.cylinders).toEqual(offshore.cylinders);
    expect(endOf(back, 2)).toEqual([14, 0]);
    expect(() => read(text(crane))).not.toThrow();
  });

  it("makes a turning joint slide, and turn again, in the plane and within limits of its kind", () => {
    const sliding = withKind(offshore, 2, "prismatic");
    expect(sliding.links[2].joint).toMatchObject({ kind: "prismatic", axis: [1, 0, 0], limits: [0, 7] });
    expect(problems(sliding).filter(({ path }) => path.startsWith("links"))).toEqual([]);
    const turning = withKind(sliding, 2, "revolute");
    expect(turning.links[2].joint).toMatchObject({ kind: "revolute", axis: [0, -1, 0] });
    expect(problems(turning).filter(({ path }) => path.startsWith("links"))).toEqual([]);
    expect(withKind(offshore, 0, "prismatic"), "slewing turns").toBe(offshore);
    const askew = set(offshore, ["links", 2, "joint", "axis"], [1, 0, 0]);
    expect(problems(askew)).toContainEqual({
      path: "links[jib].joint.axis",
      message: "turns out of the crane's plane",
    });
  });

  it("keeps a scaled crane similar: twice the size, and without its own weight four times the load", () => {
    const light: Crane = { ...offshore, links: offshore.links.map((link) => ({ ...link, mass: 1e-6 })) };
    const twice = scaled(light, 2);
    const [a, b] = [light, twice].map((crane) => capacity(crane, [[0.7], [-1]], HARBOUR));
    expect(b.radius[0]).toBeCloseTo(2 * a.radius[0], 9);
    expect(b.load[0] / a.load[0]).toBeCloseTo(4, 6);
    expect(problems(twice)).toEqual([]);
  });
});

describe("the place of a problem", () => {
  it("is where its fields are: part, link, cylinder, hoist, rating, or the crane", () => {
    const crane = furnished(offshore);
    const eye = crane.links[1].parts!.findIndex(({ name }) => name === "boom_cylinder eye 2");
    expect(placeOf(crane, "links[boom].parts[boom_cylinder eye 2].hole")).toEqual({
      kind: "link",
      index: 1,
      part: eye,
    });
    expect(placeOf(crane, "links[jib].joint.limits")).toEqual({ kind: "link", index: 2, part: undefined });
    expect(placeOf(crane, "cylinders[jib_cylinder].stroke")).toEqual({ kind: "cylinder", index: 1 });
    expect(placeOf(crane, "hoist.sheaves")).toEqual({ kind: "hoist" });
    expect(placeOf(crane, "rating.wave_heights")).toEqual({ kind: "rating" });
    expect(placeOf(crane, "capacity")).toEqual({ kind: "crane" });
  });
});

describe("names", () => {
  it("that others have are refused in words, those that are free are taken", () => {
    expect(takenBy(offshore, ["links", 1, "name"], "jib")).toBe("jib is the name of another link");
    expect(takenBy(offshore, ["links", 1, "name"], "foot")).toContain("ship");
    expect(takenBy(offshore, ["links", 1, "joint", "name"], "slew")).toBe("slew is the name of another joint");
    expect(takenBy(offshore, ["cylinders", 0, "name"], "jib_cylinder")).toBe(
      "jib_cylinder is the name of another cylinder",
    );
    expect(takenBy(offshore, ["links", 1, "name"], "mast")).toBe(null);
    expect(takenBy(offshore, ["cylinders", 0, "moves"], "jib")).toBe(null);
  });
});

describe("a new crane", () => {
  const load = (crane: Crane) => furthestLoad(crane)!;

  it.each([
    ["offshore-100t", 0.6, 0.2],
    ["offshore-100t", 1.4, 1.5],
    ["gunnerus-pk65", 1.2, 0.8],
    ["a-frame-30t", 0.7, 0.4],
    ["dual-drag-link-60t", 0.6, 0.3],
    ["gangway-24m", 1.3, 1.5],
  ])("like %s, %d times as long, lifts %d times as much as far out, and no less", (name, s, share) => {
    const like = cranes.get(name)!;
    const before = load(like);
    const crane = newCrane(like, s, share * before.mass);
    const after = load(crane);
    expect(after.radius / before.radius).toBeCloseTo(s, 1);
    expect(after.mass).toBeGreaterThan(0.97 * share * before.mass);
    expect(after.mass).toBeLessThan(1.2 * share * before.mass + 200);
    expect(problems(crane)).toEqual([]);
    expect(read(text(crane))).toEqual(crane);
  });

  it("has sizes as they are drawn", () => {
    const crane = newCrane(offshore, 0.777, 12_345);
    for (const { bore, rod, stroke } of crane.cylinders)
      for (const size of [bore / 0.005, rod / 0.005, stroke / 0.01]) expect(size).toBeCloseTo(Math.round(size), 6);
    for (const { joint } of crane.links)
      expect(100 * joint.origin[0]).toBeCloseTo(Math.round(100 * joint.origin[0]), 6);
  });

  it("is rated by its chart: outwards less and less, nowhere more than it lifts, as far as it reaches", () => {
    for (const name of ["offshore-100t", "a-frame-30t", "gangway-24m"]) {
      const crane = newCrane(cranes.get(name)!, 1.2);
      const rated = crane.capacity;
      const chart = curve(crane, HARBOUR, 0.5);
      expect(rated.length).toBeGreaterThan(1);
      expect(rated.at(-1)!.radius).toBe(load(crane).radius);
      rated.forEach(({ radius, mass }, i) => {
        expect(mass).toBeLessThanOrEqual(chart.load[Math.round(radius / 0.5)]);
        expect(mass).toBeGreaterThan(0.98 * chart.load[Math.round(radius / 0.5)]);
        if (i) expect(radius).toBeGreaterThan(rated[i - 1].radius);
      });
    }
  });

  it("grows by links that are selected, and by cylinders that can be built", () => {
    const designer = createDesigner(newCrane(bare(offshore), 1.2, 20_000));
    designer.addLink("revolute");
    expect(designer.store.getState().selection).toEqual({ kind: "link", index: 2 });
    expect(unheld(designer.store.getState().crane)).toEqual(["fold"]);
    designer.addCylinder(2);
    expect(designer.store.getState().selection).toEqual({ kind: "cylinder", index: 1 });
    expect(unheld(designer.store.getState().crane)).toEqual([]);
    expect(designer.store.getState().problems).toEqual([]);
    designer.rate();
    designer.undo();
    designer.undo();
    expect(unheld(designer.store.getState().crane)).toEqual(["fold"]);
  });

  it("has limits and sources to begin with that make sense", () => {
    const moment = firstItem("moment", offshore) as { joint: string; moment: number };
    const crane: Crane = { ...offshore, rating: { ...offshore.rating, structure: [moment] } };
    expect(problems(crane)).toEqual([]);
    expect(load(crane).mass).toBeGreaterThan(0.5 * load(offshore).mass);
    expect(fromData(JSON.parse(text({ ...offshore, sources: [firstItem("source", offshore) as never] })))).toBeTruthy();
  });
});

describe("the verdict on a posture", () => {
  it("is that of the limit that alone would allow the least", () => {
    for (const crane of cranes.values() as Iterable<Crane>) {
      const held = Object.fromEntries(
        crane.links.map(({ joint }) => [joint.name, joint.limits ? 0.5 * (joint.limits[0] + joint.limits[1]) : 0]),
      );
      const { load, governs, shares } = verdict(crane, held, HARBOUR);
      const least = Math.min(...shares.map((share) => share.load));
      expect(load).toBeCloseTo(least, 3);
      expect(shares.find((share) => share.limit === governs)?.load).toBeCloseTo(load, 3);
    }
  });
});
