// A crane's plane along rows of postures: one joint of the plane runs through its coordinates, the others stand.
//
// A point beyond the running joint then is at one + u cos(q) + v sin(q), with coefficients of the row; on a slide, at
// one + u q. So is the moment of a force on it about any joint: a posture costs no trigonometry.
import { ORIGIN, type PlaneJoint, type Pose, planar, pointX, pointZ, type Span, span } from "./plane";
import type { Attachment, Crane } from "./types";

/** A quantity along a row: one + u U + v V. Mutable, since there are dozens for each row. */
export class Along {
  // as a table: numbers in an object would each be allocated anew
  readonly terms = new Float64Array(3);

  set(one: number, u = 0, v = 0): this {
    this.terms[0] = one;
    this.terms[1] = u;
    this.terms[2] = v;
    return this;
  }
}

export class AlongPoint {
  readonly x = new Along();
  readonly z = new Along();

  /** The first point and a multiple of the other. */
  sum(first: AlongPoint, other: AlongPoint, times: number): this {
    for (let i = 0; i < 3; i += 1) {
      this.x.terms[i] = first.x.terms[i] + times * other.x.terms[i];
      this.z.terms[i] = first.z.terms[i] + times * other.z.terms[i];
    }
    return this;
  }
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
  private readonly running: PlaneJoint;
  private readonly places: readonly { readonly k: number; readonly x: number; readonly z: number }[];
  /** Of the standing joints: coordinate, cosine and sine. */
  private readonly q: Float64Array;
  private readonly c: Float64Array;
  private readonly s: Float64Array;
  /** Of the links, with the running joint at zero. */
  private readonly poses: readonly Pose[];
  private readonly outer = new AlongPoint();
  private readonly inner = new AlongPoint();
  private readonly gap = new AlongPoint();
  private readonly axis = new AlongPoint();
  private readonly byX = new Along();
  private readonly byZ = new Along();

  constructor(
    private readonly crane: Crane,
    private readonly runs: number,
    coordinates: ArrayLike<number>,
  ) {
    this.joints = planar(crane);
    this.running = this.joints[runs];
    const { turns, sign } = this.running;
    this.count = coordinates.length;
    for (let j = 0; j < this.count; j += 1) {
      U[j] = turns ? Math.cos(coordinates[j]) : coordinates[j];
      V[j] = turns ? Math.sin(coordinates[j]) * sign : 0;
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

  /** Put another joint than the running one to a coordinate. */
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
    const runs = joints.includes(this.runs);
    return { ...item, joints, runs, same: runs && joints.length === 1 };
  }

  /** A point of a link. */
  point(link: number, x: number, z: number, into: AlongPoint): AlongPoint {
    const pose = link < 0 ? ORIGIN : this.poses[link];
    const px = pointX(pose, x, z);
    const pz = pointZ(pose, x, z);
    const { link: first, turns, slideX, slideZ } = this.running;
    const axis = this.poses[first];
    if (link < first) {
      into.x.set(px);
      into.z.set(pz);
    } else if (turns) {
      into.x.set(axis.x, px - axis.x, axis.z - pz);
      into.z.set(axis.z, pz - axis.z, px - axis.x);
    } else {
      into.x.set(px, slideX * axis.c - slideZ * axis.s);
      into.z.set(pz, slideX * axis.s + slideZ * axis.c);
    }
    return into;
  }

  /**
   * What a force (fx, fz) on each of `times` points with this sum does on joint k, by virtual work: its moment about a
   * revolute joint, or about the slewing axis in the foot (null); its component along a slide.
   */
  work(k: number | null, { x, z }: AlongPoint, fx: number, fz: number, times: number, into: Along): Along {
    if (k !== null && !this.joints[k].turns) return this.slid(k, times * fx, times * fz, into);
    const sign = k === null ? 1 : this.joints[k].sign;
    const share = k === null ? 0 : times;
    const about = this.point(k === null ? -1 : this.joints[k].link, 0, 0, this.axis);
    for (let i = 0; i < 3; i += 1)
      into.terms[i] =
        sign * (fz * (x.terms[i] - share * about.x.terms[i]) - fx * (z.terms[i] - share * about.z.terms[i]));
    return into;
  }

  /** The component of a force along the slide of joint k, which turns with the running joint if that is before it. */
  private slid(k: number, fx: number, fz: number, into: Along): Along {
    const { link, slideX, slideZ } = this.joints[k];
    const { c, s } = this.poses[link];
    const dx = slideX * c - slideZ * s;
    const dz = slideX * s + slideZ * c;
    if (k > this.runs && this.running.turns) return into.set(0, fx * dx + fz * dz, fz * dx - fx * dz);
    return into.set(fx * dx + fz * dz);
  }

  /** Length of a line [m] in the first `into.length` postures. */
  span(line: Line, into: Float64Array): void {
    const { x, z } = this.parted(line);
    for (let j = 0; j < into.length; j += 1) {
      const ex = at(x, j);
      const ez = at(z, j);
      into[j] = Math.sqrt(ex * ex + ez * ez);
    }
  }

  /** Derivative of that length by joint k [m/rad, or 1]. */
  lever(line: Line, k: number, length: Float64Array, into: Float64Array): void {
    const { x, z } = this.parted(line);
    const byX = this.work(k, this.outer, 1, 0, 1, this.byX);
    const byZ = this.work(k, this.outer, 0, 1, 1, this.byZ);
    for (let j = 0; j < into.length; j += 1)
      into[j] = length[j] > 0 ? (at(x, j) * at(byX, j) + at(z, j) * at(byZ, j)) / length[j] : 0;
  }

  /** From the inner pin of a line to its outer one. */
  private parted({ outerLink, outer, innerLink, inner }: Line): AlongPoint {
    this.point(outerLink, outer.x, outer.z, this.outer);
    this.point(innerLink, inner.x, inner.z, this.inner);
    return this.gap.sum(this.outer, this.inner, -1);
  }
}

function at({ terms }: Along, j: number): number {
  return terms[0] + terms[1] * U[j] + terms[2] * V[j];
}
