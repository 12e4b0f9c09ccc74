import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { get, type Path, set } from "./edit";
import { read } from "./file";
import { endOf, lengthened, lengthOf } from "./length";
import { ofPart, weighed } from "./mass";
import { furnished } from "./standard";
import { followsParts, inStep } from "./together";
import type { Crane, Girder, Lug } from "./types";

const crane = (name: string) => read(readFileSync(`../src/seacrane/design/cranes/${name}.json`, "utf8"));
const offshore = crane("offshore-100t");
const built = furnished(offshore);
const partOf = <Kind>(of: Crane, link: number, name: string) =>
  of.links[link].parts?.find((part) => part.name === name) as Kind;

describe("a longer link", () => {
  const longer = lengthened(offshore, 1, 20);

  it("weighs as its section and has its centre and inertia where a beam has them", () => {
    const [boom, was] = [longer.links[1], offshore.links[1]];
    expect(boom.mass / was.mass).toBeCloseTo(20 / 18, 5);
    expect(boom.com[0]).toBeCloseTo((8.5 * 20) / 18, 5);
    expect(boom.com[2]).toBe(0.3);
    expect(boom.inertia[0] / was.inertia[0]).toBeCloseTo(20 / 18, 5);
    expect(boom.inertia[1] / was.inertia[1]).toBeCloseTo((20 / 18) ** 3, 5);
    expect(boom.inertia[2] / was.inertia[2]).toBeCloseTo((20 / 18) ** 3, 5);
  });

  it("takes what is beyond its middle with its end, and leaves the rest", () => {
    expect(longer.links[2].joint.origin).toEqual([20, 0, 0]);
    expect(longer.hoist.sheaves[0]).toEqual({ link: "boom", x: 20, z: 1.2 });
    expect(longer.cylinders[1].base.x).toBe(12.5);
    expect(longer.cylinders[0].eye.x).toBe(6.5);
    expect(longer.links[2].mass).toBe(offshore.links[2].mass);
  });

  it("comes back to what it was", () => {
    const back = lengthened(longer, 1, 18);
    expect(back.cylinders).toEqual(offshore.cylinders);
    expect(back.links[1].mass).toBeCloseTo(48_000, 0);
  });

  it("grows upright where it stands upright", () => {
    const higher = lengthened(offshore, 0, 6);
    expect(endOf(higher, 0)).toEqual([0, 6]);
    expect(higher.links[0].com).toEqual([-1.5, 0, 3]);
    expect(higher.links[0].inertia[2] / offshore.links[0].inertia[2]).toBeCloseTo(1.5, 5);
    expect(higher.links[0].inertia[0] / offshore.links[0].inertia[0]).toBeCloseTo(1.5 ** 3, 5);
  });

  it("that slides keeps its mass: its tip alone has moved", () => {
    const gunnerus = crane("gunnerus-pk65");
    const last = gunnerus.links.length - 1;
    expect(gunnerus.links[last].joint.kind).toBe("prismatic");
    expect(lengthened(gunnerus, last, lengthOf(gunnerus, last) + 0.5).links[last].mass).toBe(gunnerus.links[last].mass);
  });

  it("has parts of its own as long as itself, of the same plates", () => {
    const with20 = lengthened(built, 1, 20);
    const [was, is] = [partOf<Girder>(built, 1, "boom"), partOf<Girder>(with20, 1, "boom")];
    expect(is.stations.at(-1)!.x).toBeCloseTo(20, 9);
    expect(is.thickness).toBe(was.thickness);
    expect(ofPart(is).mass / ofPart(was).mass).toBeCloseTo(20 / 18, 2);
    expect(partOf<Lug>(with20, 1, "jib_cylinder base 1")).toMatchObject({ x: 12.5, z: -1.6 });
    expect(partOf<Lug>(with20, 1, "boom_cylinder eye 1")).toMatchObject({ x: 6.5, z: -1 });
  });
});

describe("what belongs together", () => {
  const changed = (of: Crane, path: Path, value: unknown) => inStep(of, set(of, path, value));

  it("lugs go with the pin of their cylinder, all of them and no other", () => {
    const after = changed(built, ["cylinders", 0, "eye", "x"], 7);
    for (const side of [1, 2]) expect(partOf<Lug>(after, 1, `boom_cylinder eye ${side}`).x).toBe(7);
    expect(partOf<Lug>(after, 1, "boom_cylinder eye 1").root_x).toBeCloseTo(7, 6);
    expect(partOf<Lug>(after, 1, "jib_cylinder base 1")).toEqual(partOf<Lug>(built, 1, "jib_cylinder base 1"));
  });

  it("a pin goes with its lug, and the lug on the other side with it", () => {
    const index = built.links[1].parts!.findIndex(({ name }) => name === "boom_cylinder eye 1");
    const after = changed(built, ["links", 1, "parts", index, "z"], -1.2);
    expect(after.cylinders[0].eye.z).toBe(-1.2);
    expect(partOf<Lug>(after, 1, "boom_cylinder eye 2").z).toBe(-1.2);
  });

  it("sheaves and drum are where the rope runs", () => {
    const after = changed(changed(built, ["hoist", "sheaves", 0, "z"], 1.5), ["hoist", "drum", "x"], -2.5);
    expect(partOf<Lug>(after, 1, "sheave 1").z).toBe(1.5);
    expect(partOf<Lug>(after, 0, "drum").x).toBe(-2.5);
  });

  it("a link that weighs what its parts weigh goes on doing so, and one that does not keeps its own mass", () => {
    const plate: Path = [
      "links",
      1,
      "parts",
      built.links[1].parts!.findIndex(({ name }) => name === "boom"),
      "thickness",
    ];
    const thicker = 1.1 * (get(built, plate) as number);
    expect(followsParts(built.links[1])).toBe(false);
    expect(changed(built, plate, thicker).links[1].mass).toBe(48_000);
    const light = weighed(built);
    const after = changed(light, plate, thicker);
    expect(followsParts(light.links[1])).toBe(true);
    expect(after.links[1].mass).toBeGreaterThan(light.links[1].mass + 3000);
    expect(followsParts(after.links[1])).toBe(true);
  });

  it("sizes that nothing can be made from leave the mass as it was", () => {
    const light = weighed(built);
    const after = changed(light, ["links", 1, "parts", 0], { ...light.links[1].parts![0], thickness: -1 });
    expect(after.links[1].mass).toBe(light.links[1].mass);
    const thick = changed(light, ["links", 1, "parts", 0], { ...light.links[1].parts![0], thickness: 2 });
    expect(thick.links[1].mass).toBe(light.links[1].mass);
  });
});
