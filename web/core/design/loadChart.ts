// What a crane may lift in each of a grid of postures, and what keeps it from more. The same laws as
// src/seacrane/design/chart.py, which says where they come from; a shared fixture holds both equal.
//
// The last joint runs in the innermost loop. All that it moves is tabulated once in the frame of the link before it,
// so that a posture costs no trigonometry, only a turn of the tables.
import { ORIGIN, type PlaneJoint, type Pose, planar, pointX, pointZ, posed, retracted, type Span, span } from "./plane";
import { type Attachment, type Crane, type Cylinder, GRAVITY, type Mode } from "./types";

const STROKE_MARGIN = 0.01;
const LEAST_HANG = 1.0;
const SAFETY_FACTOR = 3;

/** Loads of a grid of postures; the last joint runs fastest. */
export interface Capacity {
  readonly count: number;
  /** Of the tip, from the slewing axis and above the foot [m]. */
  readonly radius: Float64Array;
  readonly height: Float64Array;
  /** [kg]; 0 where not even the hook is held. */
  readonly load: Float64Array;
  /** Index into `limits`. */
  readonly governs: Uint8Array;
}

/** The names of the limits of a crane in their order. */
export function limitNames(crane: Crane): string[] {
  const { rating, hoist } = crane;
  const names = crane.cylinders.map((cylinder) => cylinder.name);
  for (const item of rating?.structure ?? []) names.push(`structure at ${item.joint}`);
  if (rating?.slew_moment != null) names.push("slew moment");
  if (hoist.rope.breaking_load != null) names.push("rope");
  if (hoist.line_pull != null) names.push("winch");
  if (rating?.load_moment != null) names.push("load moment");
  if (rating?.heeling_moment != null) names.push("ship stability");
  return names.length > 0 ? names : ["nothing"];
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

/** Push and pull of a cylinder set at its working pressure, the other side empty [N]. */
export function cylinderForces(cylinder: Cylinder): [push: number, pull: number] {
  const [bore, annulus] = areas(cylinder);
  const force = (cylinder.efficiency ?? 1) * cylinder.pressure;
  return [force * bore, force * annulus];
}

function areas(cylinder: Cylinder): [bore: number, annulus: number] {
  const quarter = ((cylinder.count ?? 1) * Math.PI) / 4;
  return [quarter * cylinder.bore ** 2, quarter * (cylinder.bore ** 2 - cylinder.rod ** 2)];
}

/** Vertical speed with which a load in these waves is met [m/s]. */
export function meetingSpeed(crane: Crane, mode: Mode): number {
  const deck = (6 * mode.waveHeight) / (mode.waveHeight + 8);
  return Math.hypot(deck, (crane.rating?.tip_speed_per_height ?? 0) * mode.waveHeight);
}

export function hookSpeedNeeded(crane: Crane, mode: Mode): number {
  return ((crane.hoist.falls ?? 1) === 1 ? 0.5 : 0.28) * meetingSpeed(crane, mode);
}

/** Weight on the hook over (falls times tension at the winch), each sheave turning. */
function reeving(falls: number, sheave: number): number {
  let sum = 0;
  for (let i = 0; i < falls; i += 1) sum += sheave ** i;
  return sum / falls;
}

/**
 * Loads on the grid of `coordinates`, one array for each joint of the plane. `out` is filled if it is large enough, so
 * that nothing is allocated while dragging.
 */
export function capacity(
  crane: Crane,
  coordinates: readonly ArrayLike<number>[],
  mode: Mode,
  out?: Capacity,
): Capacity {
  const joints = planar(crane);
  const n = joints.length;
  const count = coordinates.reduce((product, values) => product * values.length, 1);
  const result = out && out.load.length >= count ? { ...out, count } : allocate(count);
  if (n === 0 || count === 0) return result;
  const sweep = new Sweep(crane, joints, coordinates[n - 1], mode);
  const outer = coordinates.slice(0, -1);
  const index = outer.map(() => 0);
  const q = outer.map((values) => values[0]);
  for (let at = 0; at < count; at += coordinates[n - 1].length) {
    sweep.row(q, at, result);
    for (let k = outer.length - 1; k >= 0; k -= 1) {
      index[k] = (index[k] + 1) % outer[k].length;
      q[k] = outer[k][index[k]];
      if (index[k] > 0) break;
    }
  }
  return result;
}

function allocate(count: number): Capacity {
  return {
    count,
    radius: new Float64Array(count),
    height: new Float64Array(count),
    load: new Float64Array(count),
    governs: new Uint8Array(count),
  };
}

/** A limit that a cylinder (`cylinder` >= 0), or the structure, sets to the moment about a joint. */
interface Held {
  readonly joint: number;
  readonly cylinder: number;
  readonly low: number;
  readonly high: number;
}

/** Of two pins, for each posture of a row: length between them, and its derivative by a joint. */
interface Reach {
  readonly length: Float64Array;
  readonly lever: Float64Array;
}

function reach(count: number): Reach {
  return { length: new Float64Array(count), lever: new Float64Array(count) };
}

/** One row of postures after the other: all coordinates of the last joint, for fixed ones of those before it. */
class Sweep {
  private readonly n: number;
  private readonly inner: number;
  private readonly last: PlaneJoint;
  private readonly lastMass: number;
  private readonly held: readonly Held[];
  private readonly rope: readonly Span[];
  private readonly cylinders: readonly Span[];
  private readonly tip: Float64Array;
  private readonly mass: Float64Array;
  private readonly tables = new Map<Attachment, Float64Array>();
  // Of the row, for each posture: what each joint bears of the crane [N.m] and of a newton on the hook, plumb and by its lead [m].
  private readonly own: Float64Array[];
  private readonly plumb: Float64Array[];
  private readonly lead: Float64Array[];
  private readonly massX: Float64Array;
  private readonly massZ: Float64Array;
  private readonly borne: Float64Array;
  private readonly leading: Float64Array;
  private readonly compliance: Float64Array;
  private readonly scratch: Reach;
  private readonly unit: Reach;
  private readonly retracted: readonly number[];
  private readonly reaches = new Map<Span, Reach>();
  // Of the links before the last one, for the row.
  private poses: Pose[] = [];

  constructor(
    private readonly crane: Crane,
    private readonly joints: readonly PlaneJoint[],
    private readonly coordinates: ArrayLike<number>,
    private readonly mode: Mode,
  ) {
    const { hoist, rating, cylinders } = crane;
    this.n = joints.length;
    this.inner = coordinates.length;
    this.last = joints[this.n - 1];
    this.lastMass = crane.links[this.last.link].mass;
    const place = (name: string) => joints.findIndex((joint) => joint.joint.name === name);
    const path = [hoist.drum, ...hoist.sheaves];
    this.rope = path.slice(1).map((to, i) => span(crane, path[i], to));
    this.cylinders = cylinders.map((cylinder) => span(crane, cylinder.base, cylinder.eye));
    this.held = [
      ...cylinders.map((cylinder, i) => {
        const [push, pull] = cylinderForces(cylinder);
        return { joint: place(cylinder.moves), cylinder: i, low: -pull, high: push };
      }),
      ...(rating?.structure ?? []).map(({ joint, moment }) => ({
        joint: place(joint),
        cylinder: -1,
        low: -moment,
        high: moment,
      })),
    ];
    const end = hoist.sheaves[hoist.sheaves.length - 1];
    const { com } = crane.links[this.last.link];
    this.tip = this.table(end.x, end.z);
    this.mass = this.table(com[0], com[2]);
    const row = () => new Float64Array(this.inner);
    this.own = joints.map(row);
    this.plumb = joints.map(row);
    this.lead = joints.map(row);
    this.massX = row();
    this.massZ = row();
    this.borne = row();
    this.leading = row();
    this.compliance = row();
    this.scratch = reach(this.inner);
    this.unit = reach(this.inner);
    this.unit.lever.fill(1);
    this.retracted = cylinders.map((cylinder) => retracted(crane, cylinder));
  }

  row(q: readonly number[], at: number, out: Capacity): void {
    this.poses = posed(this.crane, this.joints, q);
    const x = out.radius.subarray(at, at + this.inner);
    const z = out.height.subarray(at, at + this.inner);
    const governs = out.governs.subarray(at, at + this.inner);
    this.place(x, z);
    for (let k = 0; k < this.n; k += 1) this.moments(k, x, z);
    const atSea = this.mode.waveHeight > 0;
    if (atSea) this.leads(x, z);
    this.ropes(z);
    this.borne.fill(Number.POSITIVE_INFINITY);
    governs.fill(0);
    this.held.forEach((held, index) => {
      this.hold(held, index, governs);
    });
    this.rest(x, z, governs, out.load.subarray(at, at + this.inner));
  }

  private get parent(): Pose {
    return this.poses[this.last.link - 1] ?? ORIGIN;
  }

  /** The table of a pin on the last link, made once. */
  private pin(at: Attachment): Float64Array {
    const kept = this.tables.get(at) ?? this.table(at.x, at.z);
    this.tables.set(at, kept);
    return kept;
  }

  /** A point of the last link and its derivative, in the frame of the link before: x, z, dx, dz for each coordinate. */
  private table(x: number, z: number): Float64Array {
    const { joint, turns, sign, slideX, slideZ } = this.last;
    const [ox, , oz] = joint.origin;
    const values = new Float64Array(4 * this.inner);
    for (let j = 0; j < this.inner; j += 1) {
      const q = this.coordinates[j];
      if (turns) {
        const [c, s] = [Math.cos(q), Math.sin(q) * sign];
        const [tx, tz] = [x * c - z * s, x * s + z * c];
        values.set([ox + tx, oz + tz, -sign * tz, sign * tx], 4 * j);
      } else values.set([ox + x + q * slideX, oz + z + q * slideZ, slideX, slideZ], 4 * j);
    }
    return values;
  }

  /** Where the tip and the last link's centre of mass are. */
  private place(x: Float64Array, z: Float64Array): void {
    const { inner, massX, massZ, tip, mass } = this;
    const { x: px, z: pz, c, s } = this.parent;
    for (let j = 0, t = 0; j < inner; j += 1, t += 4) {
      x[j] = px + c * tip[t] - s * tip[t + 1];
      z[j] = pz + s * tip[t] + c * tip[t + 1];
      massX[j] = px + c * mass[t] - s * mass[t + 1];
      massZ[j] = pz + s * mass[t] + c * mass[t + 1];
    }
  }

  private get up(): [number, number] {
    const heel = this.crane.rating?.heel ?? 0;
    return [-Math.sin(heel), Math.cos(heel)];
  }

  /** What joint k bears of the crane itself, and its lever for a plumb load without the rope. */
  private moments(k: number, x: Float64Array, z: Float64Array): void {
    const { inner, massX, massZ, lastMass, crane, joints, last, poses } = this;
    const [own, plumb] = [this.own[k], this.plumb[k]];
    const [u0, u1] = this.up;
    const { turns, sign } = joints[k];
    const weight = GRAVITY * lastMass;
    if (k === this.n - 1) {
      const { tip, mass } = this;
      const { c, s } = this.parent;
      const [a, b] = [u0 * c + u1 * s, u1 * c - u0 * s];
      for (let j = 0, t = 2; j < inner; j += 1, t += 4) {
        own[j] = weight * (a * mass[t] + b * mass[t + 1]);
        plumb[j] = a * tip[t] + b * tip[t + 1];
      }
      return;
    }
    let before = 0;
    for (let i = joints[k].link; i < last.link; i += 1) {
      const { com, mass } = crane.links[i];
      const [dx, dz] = this.byJoint(k, pointX(poses[i], com[0], com[2]), pointZ(poses[i], com[0], com[2]));
      before += GRAVITY * mass * (u0 * dx + u1 * dz);
    }
    if (!turns) {
      const [dx, dz] = this.byJoint(k, 0, 0);
      own.fill(before + weight * (u0 * dx + u1 * dz));
      plumb.fill(u0 * dx + u1 * dz);
      return;
    }
    const { x: jx, z: jz } = poses[joints[k].link];
    const [a, b] = [sign * u1, -sign * u0];
    for (let j = 0; j < inner; j += 1) {
      own[j] = before + weight * (a * (massX[j] - jx) + b * (massZ[j] - jz));
      plumb[j] = a * (x[j] - jx) + b * (z[j] - jz);
    }
  }

  /** Derivative by joint k of a point that it carries. */
  private byJoint(k: number, x: number, z: number): [number, number] {
    const { link, turns, sign, slideX, slideZ } = this.joints[k];
    if (turns) return [-sign * (z - this.poses[link].z), sign * (x - this.poses[link].x)];
    const { c, s } = this.poses[link - 1] ?? ORIGIN;
    return [slideX * c - slideZ * s, slideX * s + slideZ * c];
  }

  /** How the load's lead outboard changes the lever of each joint. */
  private leads(x: Float64Array, z: Float64Array): void {
    const { inner, leading, crane, mode, n, tip } = this;
    const [u0, u1] = this.up;
    const offlead = 2.5 + 1.5 * mode.waveHeight;
    for (let j = 0; j < inner; j += 1) leading[j] = offlead / Math.max(z[j] + crane.pedestal[2], LEAST_HANG);
    const { c, s } = this.parent;
    for (let k = 0; k < n; k += 1) {
      const lead = this.lead[k];
      const { turns, sign, link } = this.joints[k];
      if (k === n - 1) {
        const [a, b] = [u1 * c - u0 * s, -u1 * s - u0 * c];
        for (let j = 0, t = 2; j < inner; j += 1, t += 4) lead[j] = leading[j] * (a * tip[t] + b * tip[t + 1]);
      } else if (turns) {
        const { x: jx, z: jz } = this.poses[link];
        const [a, b] = [-sign * u0, -sign * u1];
        for (let j = 0; j < inner; j += 1) lead[j] = leading[j] * (a * (x[j] - jx) + b * (z[j] - jz));
      } else {
        const [dx, dz] = this.byJoint(k, 0, 0);
        for (let j = 0; j < inner; j += 1) lead[j] = leading[j] * (u1 * dx - u0 * dz);
      }
    }
  }

  /** Add the rope that each joint pulls in; at sea, begin the compliance with that of the rope. */
  private ropes(z: Float64Array): void {
    const { inner, n, joints, last, crane, mode, compliance } = this;
    const share = 1 / (crane.hoist.falls ?? 1);
    const { EA } = crane.hoist.rope;
    if (mode.waveHeight > 0)
      for (let j = 0; j < inner; j += 1) compliance[j] = (Math.max(z[j] + crane.pedestal[2], LEAST_HANG) * share) / EA;
    for (const item of this.rope) {
      const moving = item.outerLink === last.link && item.innerLink < last.link;
      for (let k = 0; k < n; k += 1) {
        if (joints[k].link > item.outerLink || joints[k].link <= item.innerLink) continue;
        const plumb = this.plumb[k];
        const { lever } = this.span(item, k);
        for (let j = 0; j < inner; j += 1) plumb[j] += lever[j] * share;
      }
      if (mode.waveHeight > 0) {
        const soft = (share * share) / EA;
        if (moving) {
          const { length } = this.span(item, n - 1);
          for (let j = 0; j < inner; j += 1) compliance[j] += length[j] * soft;
        } else {
          const still = this.distance(item) * soft;
          for (let j = 0; j < inner; j += 1) compliance[j] += still;
        }
      }
    }
  }

  /** Length between two pins that the last joint does not part. */
  private distance(item: Span): number {
    const [a, b] = [this.poses[item.outerLink] ?? ORIGIN, this.poses[item.innerLink] ?? ORIGIN];
    return Math.hypot(
      pointX(a, item.outer.x, item.outer.z) - pointX(b, item.inner.x, item.inner.z),
      pointZ(a, item.outer.x, item.outer.z) - pointZ(b, item.inner.x, item.inner.z),
    );
  }

  /** Length between two pins, and its derivative by joint k, for each posture of the row; valid until the next call. */
  private span(item: Span, k: number): Reach {
    const { inner, scratch, poses, last, n } = this;
    const { length, lever } = scratch;
    const base = poses[item.innerLink] ?? ORIGIN;
    if (item.outerLink < last.link) {
      const outer = poses[item.outerLink] ?? ORIGIN;
      const [px, pz] = [pointX(outer, item.outer.x, item.outer.z), pointZ(outer, item.outer.x, item.outer.z)];
      const distance = this.distance(item);
      const [dx, dz] = this.byJoint(k, px, pz);
      const [ex, ez] = [px - pointX(base, item.inner.x, item.inner.z), pz - pointZ(base, item.inner.x, item.inner.z)];
      length.fill(distance);
      lever.fill(distance > 0 ? (ex * dx + ez * dz) / distance : 0);
      return scratch;
    }
    if (k === n - 1) return this.byLast(item);
    const [ix, iz] = [pointX(base, item.inner.x, item.inner.z), pointZ(base, item.inner.x, item.inner.z)];
    const pin = this.pin(item.outer);
    const { x: px, z: pz, c, s } = this.parent;
    for (let j = 0, t = 0; j < inner; j += 1, t += 4) {
      const [ox, oz] = [px + c * pin[t] - s * pin[t + 1], pz + s * pin[t] + c * pin[t + 1]];
      const [dx, dz] = this.byJoint(k, ox, oz);
      const [ex, ez] = [ox - ix, oz - iz];
      length[j] = Math.sqrt(ex * ex + ez * ez);
      lever[j] = length[j] > 0 ? (ex * dx + ez * dz) / length[j] : 0;
    }
    return scratch;
  }

  /**
   * Length and derivative by the last joint of a span whose outer pin is on the last link, for all its coordinates.
   * Kept from row to row where the inner pin is on the link before: then the joints before have no part in it.
   */
  private byLast(item: Span): Reach {
    const kept = this.reaches.get(item);
    if (kept) return kept;
    const fixed = item.innerLink === this.last.link - 1;
    let [bx, bz] = [item.inner.x, item.inner.z];
    if (!fixed) {
      const { x, z, c, s } = this.parent;
      const base = this.poses[item.innerLink] ?? ORIGIN;
      const [gx, gz] = [pointX(base, bx, bz) - x, pointZ(base, bx, bz) - z];
      [bx, bz] = [gx * c + gz * s, gz * c - gx * s];
    }
    const pin = this.pin(item.outer);
    const values = fixed ? reach(this.inner) : this.scratch;
    for (let j = 0, t = 0; j < this.inner; j += 1, t += 4) {
      const [ex, ez] = [pin[t] - bx, pin[t + 1] - bz];
      const length = Math.sqrt(ex * ex + ez * ez);
      values.length[j] = length;
      values.lever[j] = length > 0 ? (ex * pin[t + 2] + ez * pin[t + 3]) / length : 0;
    }
    if (fixed) this.reaches.set(item, values);
    return values;
  }

  /** Let a cylinder or the structure bound what is borne; at sea, add the oil's share of the compliance. */
  private hold(held: Held, index: number, governs: Uint8Array): void {
    const { inner, borne, compliance, crane } = this;
    const [own, plumb, lead] = [this.own[held.joint], this.plumb[held.joint], this.lead[held.joint]];
    const { low, high } = held;
    const atSea = this.mode.waveHeight > 0;
    const { length, lever } = held.cylinder < 0 ? this.unit : this.span(this.cylinders[held.cylinder], held.joint);
    if (!atSea) {
      // low <= (own + W plumb) / lever <= high, times the lever, which may be negative: one division instead of three.
      for (let j = 0; j < inner; j += 1) {
        const arm = lever[j];
        const least = arm > 0 ? low * arm : high * arm;
        const largest = arm > 0 ? high * arm : low * arm;
        const a = own[j];
        const b = plumb[j];
        let most = 0;
        if (a >= least && a <= largest && arm !== 0)
          most = b > 0 ? (largest - a) / b : b < 0 ? (least - a) / b : Number.POSITIVE_INFINITY;
        if (most < borne[j]) {
          borne[j] = most;
          governs[j] = index;
        }
      }
      return;
    }
    for (let j = 0; j < inner; j += 1) {
      const arm = lever[j];
      const bound = arm > 0 ? high * arm : low * arm;
      const other = arm > 0 ? low * arm : high * arm;
      const most = arm === 0 ? 0 : between(own[j], plumb[j], plumb[j] - lead[j], other, bound);
      if (most < borne[j]) {
        borne[j] = most;
        governs[j] = index;
      }
    }
    if (held.cylinder < 0) return;
    const cylinder = crane.cylinders[held.cylinder];
    const [bore, annulus] = areas(cylinder);
    const { stroke } = cylinder;
    const [least, most] = [STROKE_MARGIN * stroke, stroke - STROKE_MARGIN * stroke];
    const shortest = this.retracted[held.cylinder];
    for (let j = 0; j < inner; j += 1) {
      const extension = Math.min(Math.max(length[j] - shortest, least), most);
      const oil = crane.bulk_modulus * (bore / extension + annulus / (stroke - extension));
      const ratio = plumb[j] / lever[j];
      if (Number.isFinite(ratio)) compliance[j] += (ratio * ratio) / oil;
    }
  }

  /** The limits of slewing ring, rope and winch; dynamics; the limits that take none; the hook. */
  private rest(x: Float64Array, z: Float64Array, governs: Uint8Array, load: Float64Array): void {
    const { inner, borne, massX, massZ, lastMass, leading, compliance, crane, mode } = this;
    const { hoist, rating } = crane;
    const [u0, u1] = this.up;
    const atSea = mode.waveHeight > 0;
    let index = this.held.length;
    if (rating?.slew_moment != null) {
      const moment = rating.slew_moment;
      let before = 0;
      for (let i = 0; i < this.last.link; i += 1) {
        const { com, mass } = crane.links[i];
        const pose = this.poses[i];
        before += GRAVITY * mass * (u1 * pointX(pose, com[0], com[2]) - u0 * pointZ(pose, com[0], com[2]));
      }
      for (let j = 0; j < inner; j += 1) {
        const own = before + GRAVITY * lastMass * (u1 * massX[j] - u0 * massZ[j]);
        const arm = u1 * x[j] - u0 * z[j];
        const led = atSea ? arm + leading[j] * (u0 * x[j] + u1 * z[j]) : arm;
        const most = between(own, arm, led, -moment, moment);
        if (most < borne[j]) {
          borne[j] = most;
          governs[j] = index;
        }
      }
      index += 1;
    }
    const falls = hoist.falls ?? 1;
    const carried = falls * reeving(falls, hoist.sheave_efficiency ?? 1);
    const constants = [
      hoist.rope.breaking_load == null
        ? null
        : (carried * hoist.rope.breaking_load) / (hoist.rope.safety_factor ?? SAFETY_FACTOR),
      hoist.line_pull == null ? null : carried * hoist.line_pull,
    ].filter((value) => value !== null);
    const constant = Math.min(Number.POSITIVE_INFINITY, ...constants);
    const constantIndex = index + constants.indexOf(constant);
    index += constants.length;
    const perBorne = 1 / GRAVITY / (rating?.harbour_factor ?? 1);
    const moments = rating?.load_moment != null || rating?.heeling_moment != null;
    const hook = hoist.hook_mass ?? 0;
    const speed = (0.5 * hoist.speed) / falls + meetingSpeed(crane, mode);
    const loadMoment = rating?.load_moment ?? Number.POSITIVE_INFINITY;
    const heelingMoment = rating?.heeling_moment ?? Number.POSITIVE_INFINITY;
    const heelingIndex = rating?.load_moment == null ? index : index + 1;
    const aside = Math.abs(crane.pedestal[1]);
    for (let j = 0; j < inner; j += 1) {
      let most = borne[j];
      if (constant < most) {
        most = constant;
        governs[j] = constantIndex;
      }
      let mass = most * perBorne;
      if (atSea && most < Number.POSITIVE_INFINITY) {
        const impact = (speed * Math.sqrt(1 / compliance[j])) / GRAVITY;
        const root = 0.5 * (Math.sqrt(impact * impact + (4 * most) / GRAVITY) - impact);
        mass = Math.min(mass, root * root);
      }
      if (moments) {
        const reach = Math.max(x[j], 1e-9);
        const moment = loadMoment / reach / GRAVITY;
        if (moment < mass) {
          mass = moment;
          governs[j] = index;
        }
        const heeling = heelingMoment / (reach + aside) / GRAVITY;
        if (heeling < mass) {
          mass = heeling;
          governs[j] = heelingIndex;
        }
      }
      load[j] = mass > hook ? mass - hook : 0;
    }
  }
}

/** The largest W >= 0 with low <= own + W load <= high for both loads; 0 where `own` alone is outside. */
function between(own: number, first: number, second: number, low: number, high: number): number {
  if (!(own >= low && own <= high)) return 0;
  const up = first > second ? first : second;
  const down = first > second ? second : first;
  let most = Number.POSITIVE_INFINITY;
  if (up > 0) most = (high - own) / up;
  if (down < 0) most = Math.min(most, (low - own) / down);
  return most > 0 ? most : 0;
}
