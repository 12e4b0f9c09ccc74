// Parts to begin with: of the size of the link that they are added to.
import { fresh } from "./edit";
import type { PartKind } from "./fields";
import { endOf } from "./length";
import type { Crane, Part } from "./types";

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
