// A crane's plane along rows of postures: the last joint of the plane runs through its coordinates, the others stand.
//
// A point of the last link then is at one + u cos(q) + v sin(q), with coefficients of the row; on a slide, at one + u q.
// So is the moment of a force on it about any joint: a posture costs no trigonometry.
import { ORIGIN, type PlaneJoint, type Pose, planar, pointX, pointZ, type Span, span } from "./plane";
import type { Attachment, Crane } from "./types";

/** A quantity along a row: one + u * U + v * V. */
export interface Along {
  readonly one: number;
  readonly u: number;
  readonly v: number;
}

export interface AlongPoint {
  readonly x: Along;
  readonly z: Along;
}

/** A free length between two pins, a cylinder or a rope, and the joints of the plane between them. */
export interface Line extends Span {
  readonly joints: readonly number[];
  /** Whether the running joint is between them; and whether it alone is, so that the line is the same in all rows. */
  readonly runs: boolean;
  readonly same: boolean;
}

/** Postures of a row at most. */
export const ROW = 640;

// Of the running joint: cosine and sine of its angle, or its travel and nothing. Like all that is tabulated along a row
// they lie at one place: loops are compiled to half the instructions if they know where their tables are.
export const U = new Float64Array(ROW);
export const V = new Float64Array(ROW);

/** The rows of a grid; the tables are theirs until the next ones are made. */
export class Rows {
  readonly joints: readonly PlaneJoint[];
  readonly count: number;
  private readonly last: PlaneJoint;
  private readonly places: readonly { readonly k: number; readonly x: number; readonly z: number }[];
  /** Of the standing joints: coordinate, cosine and sine. */
  private readonly q: Float64Array;
  private readonly c: Float64Array;
  private readonly s: Float64Array;
  /** Of the links; the last one as at zero of its joint. */
  private readonly poses: readonly Pose[];

  constructor(
    private readonly crane: Crane,
    running: ArrayLike<number>,
  ) {
    this.joints = planar(crane);
    this.last = this.joints[this.joints.length - 1];
    const { turns, sign } = this.last;
    this.count = running.length;
    for (let j = 0; j < running.length; j += 1) {
      U[j] = turns ? Math.cos(running[j]) : running[j];
      V[j] = turns ? Math.sin(running[j]) * sign : 0;
    }
    this.places = crane.links.map(({ joint: { origin } }, i) => {
      return { k: this.joints.findIndex(({ link }) => link === i), x: origin[0], z: origin[2] };
    });
    this.q = new Float64Array(this.joints.length);
    this.c = new Float64Array(this.joints.length).fill(1);
    this.s = new Float64Array(this.joints.length);
    this.poses = crane.links.map(() => ({ ...ORIGIN }));
    this.pose();
  }

  /** Put a joint before the running one to a coordinate. */
  stand(k: number, q: number): void {
    this.q[k] = q;
    this.c[k] = Math.cos(q);
    this.s[k] = Math.sin(q) * this.joints[k].sign;
  }

  /** The frames of the links, once all joints stand. */
  pose(): void {
    const { places, joints, poses, q, c, s } = this;
    let before: Pose = ORIGIN;
    for (let i = 0; i < poses.length; i += 1) {
      const { k, x, z } = places[i];
      const at = poses[i];
      const turns = k >= 0 && joints[k].turns;
      const slid = k >= 0 && !turns ? q[k] : 0;
      const dx = slid ? x + slid * joints[k].slideX : x;
      const dz = slid ? z + slid * joints[k].slideZ : z;
      at.x = pointX(before, dx, dz);
      at.z = pointZ(before, dx, dz);
      at.c = turns ? before.c * c[k] - before.s * s[k] : before.c;
      at.s = turns ? before.s * c[k] + before.c * s[k] : before.s;
      before = at;
    }
  }

  line(a: Attachment, b: Attachment): Line {
    const item = span(this.crane, a, b);
    const joints = this.joints.flatMap(({ link }, k) => (item.innerLink < link && link <= item.outerLink ? [k] : []));
    const runs = joints.includes(this.joints.length - 1);
    return { ...item, joints, runs, same: runs && joints.length === 1 };
  }

  /** A point of a link, of the last one or another. */
  point(link: number, x: number, z: number): AlongPoint {
    const pose = this.poses[link] ?? ORIGIN;
    const { link: last, turns, slideX, slideZ } = this.last;
    if (link < last) return { x: still(pointX(pose, x, z)), z: still(pointZ(pose, x, z)) };
    const a = x * pose.c - z * pose.s;
    const b = x * pose.s + z * pose.c;
    if (turns) return { x: { one: pose.x, u: a, v: -b }, z: { one: pose.z, u: b, v: a } };
    return {
      x: { one: pose.x + a, u: slideX * pose.c - slideZ * pose.s, v: 0 },
      z: { one: pose.z + b, u: slideX * pose.s + slideZ * pose.c, v: 0 },
    };
  }

  /**
   * What a force (fx, fz) on each of `times` points with this sum does on joint k, by virtual work: its moment about a
   * revolute joint, or about the slewing axis in the foot (null); its component along a slide.
   */
  work(k: number | null, { x, z }: AlongPoint, fx: number, fz: number, times = 1): Along {
    if (k === null) return { one: fz * x.one - fx * z.one, u: fz * x.u - fx * z.u, v: fz * x.v - fx * z.v };
    const { link, turns, sign, slideX, slideZ } = this.joints[k];
    const { x: jx, z: jz, c, s } = this.poses[link];
    if (!turns) return still(times * (fx * (slideX * c - slideZ * s) + fz * (slideX * s + slideZ * c)));
    return {
      one: sign * (fz * (x.one - times * jx) - fx * (z.one - times * jz)),
      u: sign * (fz * x.u - fx * z.u),
      v: sign * (fz * x.v - fx * z.v),
    };
  }

  /** Length of a line [m] in the first `into.length` postures. */
  span(line: Line, into: Float64Array): void {
    const { x, z } = this.parted(line);
    for (let j = 0; j < into.length; j += 1) {
      const ex = x.one + x.u * U[j] + x.v * V[j];
      const ez = z.one + z.u * U[j] + z.v * V[j];
      into[j] = Math.sqrt(ex * ex + ez * ez);
    }
  }

  /** Derivative of that length by joint k [m/rad, or 1]. */
  lever(line: Line, k: number, length: Float64Array, into: Float64Array): void {
    const { x, z } = this.parted(line);
    const outer = this.point(line.outerLink, line.outer.x, line.outer.z);
    const byX = this.work(k, outer, 1, 0);
    const byZ = this.work(k, outer, 0, 1);
    for (let j = 0; j < into.length; j += 1) {
      const alongX = (x.one + x.u * U[j] + x.v * V[j]) * (byX.one + byX.u * U[j] + byX.v * V[j]);
      const alongZ = (z.one + z.u * U[j] + z.v * V[j]) * (byZ.one + byZ.u * U[j] + byZ.v * V[j]);
      into[j] = length[j] > 0 ? (alongX + alongZ) / length[j] : 0;
    }
  }

  /** From the inner pin of a line to its outer one. */
  private parted({ outerLink, outer, innerLink, inner }: Line): AlongPoint {
    return plus(this.point(outerLink, outer.x, outer.z), this.point(innerLink, inner.x, inner.z), -1);
  }
}

/** The first point and a multiple of the other. */
export function plus(first: AlongPoint, { x, z }: AlongPoint, times: number): AlongPoint {
  return {
    x: { one: first.x.one + times * x.one, u: first.x.u + times * x.u, v: first.x.v + times * x.v },
    z: { one: first.z.one + times * z.one, u: first.z.u + times * z.u, v: first.z.v + times * z.v },
  };
}

function still(one: number): Along {
  return { one, u: 0, v: 0 };
}
