// How the rope of the design is laid over round things. The design gives the points of the rope's path without sizes.

import { isKnuckleBoom } from "../../core/crane";
import { apply, type Frame, unapply } from "../../core/frames";
import type { Disc, Point2 } from "../../core/rope";
import { ropePath, slackBow } from "../../core/rope";
import type { CraneDesign, Vec3 } from "../../rpc/messages";

/** Pitch radius of the sheaves of a knuckle boom crane that are drawn [m]; those of others are parts of their design. */
const SHEAVE_RADIUS = 0.6;

/** Pitch radius over rope diameter of a sheave that is a standard part. */
const PITCH = 10;

// The design's tip is where the rope leaves the last sheave. That point moves round the sheave with the jib; it is met
// exactly with the jib 20 degrees below the horizontal and within 0.15 m for 40 degrees more or less.
const HANG = (-20 * Math.PI) / 180;

/** Centre of the tip sheave from the tip, in the frame of the last link. */
export const TIP_SHEAVE: Point2 = [-SHEAVE_RADIUS * Math.cos(HANG), SHEAVE_RADIUS * Math.sin(HANG)];

/** Centre and radius of drum and sheaves in the frame of their links, from the drum to the tip. */
export function reels(crane: CraneDesign): { link: string; x: number; z: number; radius: number }[] {
  const { drum, drum_radius: radius, sheaves, rope } = crane.hoist;
  const own = isKnuckleBoom(crane);
  return [
    { link: drum.link, x: drum.x, z: drum.z - radius, radius },
    ...sheaves.map(({ link, x, z }, i) => {
      const [dx, dz] = own && i === sheaves.length - 1 ? TIP_SHEAVE : [0, 0];
      return { link, x: x + dx, z: z + dz, radius: own ? SHEAVE_RADIUS : PITCH * rope.diameter };
    }),
  ];
}

/** The rope's polyline in the frame of the foot, drum to hook, sagging where it is slack. */
export function ropePoints(crane: CraneDesign, frames: ReadonlyMap<string, Frame>, hook: Vec3, slack: number): Vec3[] {
  const column = frames.get(crane.links[0].name);
  if (!column) return [];
  const discs = reels(crane).map(({ link, x, z, radius }): Disc => {
    const frame = frames.get(link);
    const [px, , pz] = frame ? unapply(column, apply(frame, [x, 0, z])) : [0, 0, 0];
    return { x: px, z: pz, radius, turn: -1 };
  });
  const end = unapply(column, hook);
  const flat = ropePath(discs, [end[0], end[2]]);
  const points = flat.slice(0, -1).map(([x, z]): Vec3 => [x, 0, z]);
  const leave = points[points.length - 1];
  const straight = Math.hypot(end[0] - leave[0], end[1] - leave[1], end[2] - leave[2]);
  const bow = slackBow(straight, straight + slack);
  const pieces = bow > 0 ? 24 : 1;
  for (let i = 1; i <= pieces; i += 1) {
    const u = i / pieces;
    const aside = bow * 4 * u * (1 - u);
    points.push([
      leave[0] + (end[0] - leave[0]) * u + aside * 0.8,
      leave[1] + (end[1] - leave[1]) * u + aside * 0.6,
      leave[2] + (end[2] - leave[2]) * u,
    ]);
  }
  return points.map((p) => apply(column, p));
}
