// Kinematics of a crane from its design: link frames, cylinder pins, points of attachment. Everything in the frame of
// the crane foot (centre of the slew ring, fixed to the ship: x forward, y port, z up).
import type { Attachment, CraneDesign, Cylinder, Vec3 } from "../rpc/messages";
import { FOOT } from "./design/types";
import { apply, compose, distance, type Frame, IDENTITY, rotation } from "./frames";

export type JointValues = Readonly<Record<string, number>>;

/** Frame of every link by name, and of the foot; a joint without a value stands at zero. */
export function linkFrames(crane: CraneDesign, q: JointValues): Map<string, Frame> {
  const frames = new Map<string, Frame>([[FOOT, IDENTITY]]);
  let frame = IDENTITY;
  for (const { name, joint } of crane.links) {
    const value = q[joint.name] ?? 0;
    const { origin } = joint;
    const size = Math.hypot(...joint.axis);
    const axis: Vec3 = [joint.axis[0] / size, joint.axis[1] / size, joint.axis[2] / size];
    const moved: Frame =
      joint.kind === "revolute"
        ? { R: rotation(axis, value), p: origin }
        : {
            R: IDENTITY.R,
            p: [origin[0] + axis[0] * value, origin[1] + axis[1] * value, origin[2] + axis[2] * value],
          };
    frame = compose(frame, moved);
    frames.set(name, frame);
  }
  return frames;
}

export function attachmentPoint(frames: ReadonlyMap<string, Frame>, at: Attachment, y = 0): Vec3 {
  const frame = frames.get(at.link);
  if (!frame) throw new RangeError(`no link is called ${at.link}; there are ${[...frames.keys()].join(", ")}`);
  return apply(frame, [at.x, y, at.z]);
}

/** Distance between the pins of a cylinder [m]. */
export function cylinderLength(cylinder: Cylinder, frames: ReadonlyMap<string, Frame>): number {
  return distance(attachmentPoint(frames, cylinder.base), attachmentPoint(frames, cylinder.eye));
}

/** Point where the rope leaves the last sheave [m]. */
export function tip(crane: CraneDesign, frames: ReadonlyMap<string, Frame>): Vec3 {
  const { sheaves } = crane.hoist;
  return attachmentPoint(frames, sheaves[sheaves.length - 1]);
}

/** Horizontal distance of the tip from the slew axis [m]. */
export function radius(tipPoint: Vec3): number {
  return Math.hypot(tipPoint[0], tipPoint[1]);
}

/** Whether it is a column that slews with a boom and a jib that turn, and nothing else: what has a picture of its own. */
export function isKnuckleBoom({ links }: CraneDesign): boolean {
  const [column, ...others] = links;
  const turn = links.every(({ joint }) => joint.kind === "revolute");
  return turn && others.length === 2 && Math.abs(column.joint.axis[2]) > 0.9;
}

/** Where link `index` ends, in its own frame: the joint of the next link, or the last sheave. */
export function linkEnd(crane: CraneDesign, index: number): Vec3 {
  const next = crane.links[index + 1];
  if (next) return next.joint.origin;
  const last = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  return [last.x, 0, last.z];
}

/** Length between the pins with the rod fully in [m]: as designed, or so that the travel is centred in the stroke. */
export function retractedLength(crane: CraneDesign, cylinder: Cylinder): number {
  if (cylinder.retracted) return cylinder.retracted;
  const limits = crane.links.find((link) => link.joint.name === cylinder.moves)?.joint.limits;
  if (!limits) return cylinder.stroke + 0.6;
  const samples = 240;
  const lengths = Array.from({ length: samples + 1 }, (_, i) => {
    const value = limits[0] + ((limits[1] - limits[0]) * i) / samples;
    return cylinderLength(cylinder, linkFrames(crane, { [cylinder.moves]: value }));
  });
  return (Math.min(...lengths) + Math.max(...lengths) - cylinder.stroke) / 2;
}

/** Rated load [kg] at a radius [m]: linear between the given points, the first inside them, none beyond the last. */
export function ratedLoad(crane: CraneDesign, atRadius: number): number | null {
  const points = crane.capacity ?? [];
  if (points.length === 0 || !Number.isFinite(atRadius)) return null;
  if (atRadius <= points[0].radius) return points[0].mass;
  for (let i = 1; i < points.length; i += 1) {
    const [a, b] = [points[i - 1], points[i]];
    if (atRadius <= b.radius) return a.mass + ((b.mass - a.mass) * (atRadius - a.radius)) / (b.radius - a.radius);
  }
  return null;
}
