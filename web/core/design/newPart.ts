// What is added to a design begins with: parts of the size of their link, items of lists that make sense.
import { fresh } from "./edit";
import type { PartKind, ShapeName } from "./fields";
import { endOf } from "./length";
import type { UnitSymbol } from "./quantity";
import { type Crane, GRAVITY, type Part, planeJoints } from "./types";

/** A part of a kind to begin with, of the size of its link. */
export function newPart(kind: Exclude<PartKind, "mesh">, crane: Crane, index: number): Part {
  const link = crane.links[index];
  const [x, z] = endOf(crane, index);
  const length = Math.max(1, Math.hypot(x, z));
  const name = fresh(
    kind,
    (link.parts ?? []).map((part) => part.name),
  );
  const depth = 0.04 * length;
  switch (kind) {
    case "girder":
      return {
        kind,
        name,
        thickness: 0.015,
        stations: [0, 0.4 * length, length].map((at) => ({ x: at, top: depth, bottom: -depth, width: 1.5 * depth })),
      };
    case "tube":
      return {
        kind,
        name,
        start: [0, 0, 0],
        end: [x, 0, z],
        diameter: 2 * depth,
        end_diameter: 2 * depth,
        thickness: 0.015,
      };
    case "lug":
      return {
        kind,
        name,
        x: 0.3 * x,
        z: 0.3 * z - 2.5 * depth,
        root_x: 0.3 * x,
        root_z: 0.3 * z,
        root_width: 3 * depth,
        radius: 0.6 * depth,
        hole: 0.5 * depth,
        thickness: 0.03,
        gap: depth,
      };
    case "sheave":
      return { kind, name, x, z, radius: depth, groove: 0.2 * depth, width: 0.3 * depth, hole: 0.4 * depth };
    case "drum":
      return {
        kind,
        name,
        x: 0.5 * x,
        z: 0.5 * z + depth,
        radius: depth,
        length: 2.6 * depth,
        flange: 1.5 * depth,
        thickness: 0.03,
      };
    case "box":
      return { kind, name, centre: [0.5 * x, 0, 0.5 * z], size: [2 * depth, 2 * depth, 2 * depth], thickness: 0.01 };
  }
}

/** The first item of a list that is empty. */
export function firstItem(of: ShapeName | UnitSymbol, crane: Crane): unknown {
  if (of === "moment") {
    const joint = planeJoints(crane)[0]?.name ?? crane.links[0].joint.name;
    // what holds the heaviest moment of the rated loads, and the crane itself, about twice
    const heaviest = Math.max(...crane.capacity.map(({ radius, mass }) => radius * mass * GRAVITY));
    return { joint, moment: Number((2.5 * heaviest).toPrecision(2)) };
  }
  if (of === "source") return { of: "all numbers", kind: "assumption", note: "to be replaced by what is known" };
  return 1;
}
