// Where the frames, pins and tip of a crane are in its own plane: x outboard from the slewing axis, z up from the foot.
import { type Attachment, type Crane, type Cylinder, FOOT, type Joint, planeJoints } from "./types";

const LENGTH_SAMPLES = 241;

/** A frame in the plane: its origin [m], cosine and sine of the angle of its x above the horizontal. */
export interface Pose {
  x: number;
  z: number;
  c: number;
  s: number;
}

/** A joint of the plane: its place among the links, the way it turns or slides. */
export interface PlaneJoint {
  readonly joint: Joint;
  readonly link: number;
  readonly turns: boolean;
  /** +1 if a growing coordinate turns x towards z. */
  readonly sign: number;
  readonly slideX: number;
  readonly slideZ: number;
}

export function planar(crane: Crane): PlaneJoint[] {
  const joints = planeJoints(crane);
  return joints.map((joint) => {
    const size = Math.hypot(...joint.axis);
    return {
      joint,
      link: crane.links.findIndex((link) => link.joint.name === joint.name),
      turns: joint.kind === "revolute",
      sign: -joint.axis[1] / size,
      slideX: joint.axis[0] / size,
      slideZ: joint.axis[2] / size,
    };
  });
}

/** Why the crane does not move in one plane, in words; empty if it does. */
export function planeProblems(crane: Crane): string[] {
  const problems: string[] = [];
  crane.links.forEach(({ name, joint }, index) => {
    const size = Math.hypot(...joint.axis);
    const [, y, z] = joint.axis.map((value) => value / size);
    if (joint.name === crane.slew?.joint) {
      if (index > 0 || joint.kind !== "revolute" || Math.abs(z) < 1 - 1e-9)
        problems.push(`${name}: the slewing joint must be the first, turning about the vertical`);
      return;
    }
    if (joint.kind === "revolute" && Math.abs(y) < 1 - 1e-9) problems.push(`${name}: turns out of the crane's plane`);
    if (joint.kind === "prismatic" && Math.abs(y) > 1e-9) problems.push(`${name}: slides out of the crane's plane`);
    if (!joint.limits) problems.push(`${name}: the joint needs limits, only slewing may be endless`);
  });
  return problems;
}

/** Frames of the links for coordinates of the plane's joints; a joint that is missing stands at zero. */
export function posed(crane: Crane, joints: readonly PlaneJoint[], q: readonly number[]): Pose[] {
  let before: Pose = { x: 0, z: 0, c: 1, s: 0 };
  return crane.links.map((link, index) => {
    const [ox, , oz] = link.joint.origin;
    const at: Pose = {
      x: before.x + ox * before.c - oz * before.s,
      z: before.z + ox * before.s + oz * before.c,
      c: before.c,
      s: before.s,
    };
    const k = joints.findIndex((joint) => joint.link === index);
    if (k >= 0) {
      const value = q[k] ?? 0;
      const joint = joints[k];
      if (joint.turns) {
        const [c, s] = [Math.cos(value), Math.sin(value) * joint.sign];
        at.c = before.c * c - before.s * s;
        at.s = before.s * c + before.c * s;
      } else {
        at.x += value * (joint.slideX * before.c - joint.slideZ * before.s);
        at.z += value * (joint.slideX * before.s + joint.slideZ * before.c);
      }
    }
    before = at;
    return at;
  });
}

export const ORIGIN: Pose = { x: 0, z: 0, c: 1, s: 0 };

export function pointX(pose: Pose, x: number, z: number): number {
  return pose.x + x * pose.c - z * pose.s;
}

export function pointZ(pose: Pose, x: number, z: number): number {
  return pose.z + x * pose.s + z * pose.c;
}

/** Two pins of which the last link may carry one: a cylinder, or a free length of rope. */
export interface Span {
  readonly outer: Attachment;
  readonly inner: Attachment;
  /** Place of the inner pin's link; -1 is the foot. */
  readonly innerLink: number;
  readonly outerLink: number;
}

export function span(crane: Crane, a: Attachment, b: Attachment): Span {
  const place = (at: Attachment) => (at.link === FOOT ? -1 : crane.links.findIndex((link) => link.name === at.link));
  const [pa, pb] = [place(a), place(b)];
  return pa >= pb
    ? { outer: a, outerLink: pa, inner: b, innerLink: pb }
    : { outer: b, outerLink: pb, inner: a, innerLink: pa };
}

/** Lengths between the pins [m], evenly over the limits of the joint that the cylinder moves; none if it has no limits. */
function lengthsOverTravel(crane: Crane, cylinder: Cylinder): number[] {
  const joints = planar(crane);
  const k = joints.findIndex((joint) => joint.joint.name === cylinder.moves);
  const limits = joints[k]?.joint.limits;
  if (!limits) return [];
  const { inner, outer, innerLink, outerLink } = span(crane, cylinder.base, cylinder.eye);
  // the outer pin moves on a circle about the joint, or along its slide; the other joints stand at zero
  const { link, turns, sign, slideX, slideZ } = joints[k];
  const poses = posed(crane, joints, []);
  const [axis, a, b] = [poses[link], poses[outerLink] ?? ORIGIN, poses[innerLink] ?? ORIGIN];
  const moves = innerLink < link && link <= outerLink;
  const [x, z] = [pointX(a, outer.x, outer.z) - axis.x, pointZ(a, outer.x, outer.z) - axis.z];
  const [dx, dz] = [axis.x - pointX(b, inner.x, inner.z), axis.z - pointZ(b, inner.x, inner.z)];
  const [alongX, alongZ] = [slideX * axis.c - slideZ * axis.s, slideX * axis.s + slideZ * axis.c];
  return Array.from({ length: LENGTH_SAMPLES }, (_, i) => {
    const q = moves ? limits[0] + (i * (limits[1] - limits[0])) / (LENGTH_SAMPLES - 1) : 0;
    const [c, s] = turns ? [Math.cos(q), Math.sin(q) * sign] : [1, 0];
    const slid = turns ? 0 : q;
    const [ex, ez] = [dx + x * c - z * s + slid * alongX, dz + x * s + z * c + slid * alongZ];
    return Math.sqrt(ex * ex + ez * ez);
  });
}

/** Shortest and longest length between the pins [m] over the limits of the joint that the cylinder moves. */
export function cylinderLengths(crane: Crane, cylinder: Cylinder): [shortest: number, longest: number] {
  const lengths = lengthsOverTravel(crane, cylinder);
  return lengths.length ? [Math.min(...lengths), Math.max(...lengths)] : [Number.NaN, Number.NaN];
}

/** Whether the cylinder loses its lever on the way from limit to limit: it shortens first and then lengthens, or reversed. */
export function passesDeadPoint(crane: Crane, cylinder: Cylinder): boolean {
  const lengths = lengthsOverTravel(crane, cylinder);
  const steps = lengths.slice(1).map((length, i) => length - lengths[i]);
  return !steps.every((step) => step > 0) && !steps.every((step) => step < 0);
}

/** Length between the pins with the rod fully in [m], as in Python: as given, or the travel centred in the stroke. */
export function retracted(crane: Crane, cylinder: Cylinder): number {
  if (cylinder.retracted != null) return cylinder.retracted;
  const [shortest, longest] = cylinderLengths(crane, cylinder);
  return 0.5 * (shortest + longest - cylinder.stroke);
}

/** Coordinates by joint name [rad, m]; a joint that is left out stands at zero. */
export type Posture = Readonly<Record<string, number>>;

/** The frame of each link by its name, and of the foot. */
export function frames(crane: Crane, posture: Posture): Map<string, Pose> {
  const joints = planar(crane);
  const poses = posed(
    crane,
    joints,
    joints.map(({ joint }) => posture[joint.name] ?? 0),
  );
  return new Map([[FOOT, ORIGIN], ...crane.links.map((link, i) => [link.name, poses[i]] as const)]);
}

export type Point = readonly [x: number, z: number];

/** A point of a frame, in the crane's plane. */
export function outOf(pose: Pose, x: number, z: number): Point {
  return [pointX(pose, x, z), pointZ(pose, x, z)];
}

/** A point of the crane's plane, in a frame. */
export function into(pose: Pose, [x, z]: Point): Point {
  const [dx, dz] = [x - pose.x, z - pose.z];
  return [dx * pose.c + dz * pose.s, dz * pose.c - dx * pose.s];
}

/** Where an attachment is; on a link that the crane does not have, at the foot. */
export function pin(at: ReadonlyMap<string, Pose>, { link, x, z }: Attachment): Point {
  return outOf(at.get(link) ?? ORIGIN, x, z);
}

/** The tip sheave. */
export function tip(crane: Crane, posture: Posture): Point {
  return pin(frames(crane, posture), crane.hoist.sheaves[crane.hoist.sheaves.length - 1]);
}

/** Length between the pins of a cylinder [m]. */
export function cylinderLength(crane: Crane, cylinder: Cylinder, posture: Posture): number {
  const at = frames(crane, posture);
  const [a, b] = [pin(at, cylinder.base), pin(at, cylinder.eye)];
  return Math.hypot(a[0] - b[0], a[1] - b[1]);
}
