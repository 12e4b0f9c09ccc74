// Where links end, and a link that ends elsewhere: what goes with its end, what it then weighs. The laws of
// src/seacrane/design/changes.py, for any direction in the plane.
import type { Vec3 } from "../../rpc/messages";
import type { Point } from "./plane";
import type { Attachment, Crane, Link, Part } from "./types";

/** Below this a link has no direction to stretch in [m]. */
export const SHORTEST = 0.01;

/** Where a link ends, in its frame: at the joint of the next, or at the tip. */
export function endOf(crane: Crane, link: number): Point {
  const next = crane.links[link + 1];
  if (next) return [next.joint.origin[0], next.joint.origin[2]];
  const { x, z } = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  return [x, z];
}

export function lengthOf(crane: Crane, link: number): number {
  return Math.hypot(...endOf(crane, link));
}

/** The crane with a link of another length [m] in the direction that it has; a link without one stays as it is. */
export function lengthened(crane: Crane, index: number, length: number): Crane {
  const [x, z] = endOf(crane, index);
  const ratio = length / Math.hypot(x, z);
  return Number.isFinite(ratio) ? endedAt(crane, index, [tidy(x * ratio), tidy(z * ratio)]) : crane;
}

/**
 * The crane with a link that ends elsewhere, of the same section: the next joint, or the tip, moves there, and with it all
 * that is beyond the middle of the link. What turns grows in mass with its length, its centre stays at its share of the
 * length, moments of inertia across it grow with its cube; what slides keeps its mass, for its tip alone has moved. Parts of
 * its own are stretched, or moved with the end.
 */
export function endedAt(crane: Crane, index: number, to: Point): Crane {
  const from = endOf(crane, index);
  const by: Point = [to[0] - from[0], to[1] - from[1]];
  if (Math.hypot(...by) < 1e-9) return crane;
  const { name } = crane.links[index];
  const [old, length] = [Math.hypot(...from), Math.hypot(...to)];
  const shaped = Math.min(old, length) >= SHORTEST;
  const carried = (x: number, z: number) => shaped && x * from[0] + z * from[1] > 0.5 * old ** 2;
  const pin = (at: Attachment): Attachment =>
    at.link === name && carried(at.x, at.z) ? { ...at, x: tidy(at.x + by[0]), z: tidy(at.z + by[1]) } : at;
  const { drum, sheaves } = crane.hoist;
  const isLast = index === crane.links.length - 1;
  return {
    ...crane,
    links: crane.links.map((link, i) => {
      if (i === index && shaped) return stretched(link, from, to, carried);
      if (i !== index + 1) return link;
      const [, y] = link.joint.origin;
      return { ...link, joint: { ...link.joint, origin: [to[0], y, to[1]] } };
    }),
    cylinders: crane.cylinders.map((item) => ({ ...item, base: pin(item.base), eye: pin(item.eye) })),
    hoist: {
      ...crane.hoist,
      drum: pin(drum),
      sheaves: sheaves.map((sheave, i) =>
        isLast && i === sheaves.length - 1 ? { ...sheave, x: to[0], z: to[1] } : pin(sheave),
      ),
    },
  };
}

function stretched(link: Link, from: Point, to: Point, carried: (x: number, z: number) => boolean): Link {
  const turns = link.joint.kind === "revolute";
  const [old, length] = [Math.hypot(...from), Math.hypot(...to)];
  const ratio = turns ? length / old : 1;
  // along and across the link before, along and across it now
  const along = ([x, z]: Point): Point => {
    const a = ((x * from[0] + z * from[1]) / old) * ratio;
    const b = (z * from[0] - x * from[1]) / old;
    return [tidy((a * to[0] - b * to[1]) / length), tidy((a * to[1] + b * to[0]) / length)];
  };
  const lying = Math.abs(from[0]) > Math.abs(from[1]) ? 0 : 2;
  const [cx, cz] = along([link.com[0], link.com[2]]);
  const inertia = link.inertia.map((value, axis) => round(value * ratio ** (axis === lying ? 1 : 3)));
  const parts = link.parts?.map((part) => stretchedPart(part, turns ? along : null, from, to, carried));
  return {
    ...link,
    ...(parts && { parts }),
    ...(turns && {
      mass: round(link.mass * ratio),
      com: [round(cx), link.com[1], round(cz)],
      inertia: [inertia[0], inertia[1], inertia[2]],
    }),
  };
}

/** `along` is where points of a body that stretches go; what does not stretch moves if it is `carried`. */
function stretchedPart(
  part: Part,
  along: ((point: Point) => Point) | null,
  from: Point,
  to: Point,
  carried: (x: number, z: number) => boolean,
): Part {
  const [dx, dz] = [to[0] - from[0], to[1] - from[1]];
  switch (part.kind) {
    case "girder": {
      if (!along || Math.abs(from[0]) < SHORTEST) return part;
      const rise = (to[1] - from[1]) / from[0];
      const stations = part.stations.map(({ x, top, bottom, width }) => ({
        x: tidy((x * to[0]) / from[0]),
        top: tidy(top + x * rise),
        bottom: tidy(bottom + x * rise),
        width,
      }));
      return { ...part, stations };
    }
    case "tube": {
      if (!along) return part;
      const end = ([x, y, z]: Vec3): Vec3 => {
        const [px, pz] = along([x, z]);
        return [px, y, pz];
      };
      return { ...part, start: end(part.start), end: end(part.end) };
    }
    case "lug":
      if (!carried(part.x, part.z)) return part;
      return {
        ...part,
        x: tidy(part.x + dx),
        z: tidy(part.z + dz),
        root_x: tidy(part.root_x + dx),
        root_z: tidy(part.root_z + dz),
      };
    case "sheave":
    case "drum":
      return carried(part.x, part.z) ? { ...part, x: tidy(part.x + dx), z: tidy(part.z + dz) } : part;
    case "box": {
      const [x, y, z] = part.centre;
      return carried(x, z) ? { ...part, centre: [tidy(x + dx), y, tidy(z + dz)] } : part;
    }
    case "mesh":
      return part;
  }
}

/** Without the last digits of a computer: lengths. */
const tidy = (value: number) => Number(value.toPrecision(12));
/** To as many digits as a weight is known: masses and inertias. */
const round = (value: number) => Number(value.toPrecision(6));
