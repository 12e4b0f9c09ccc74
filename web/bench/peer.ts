// The load chart's law for one posture at a time, written down as in a textbook: what the page's tables are measured
// against, in time and in value.
import { areas, cylinderForces, meetingSpeed, reeving } from "../core/design/loadChart";
import { ORIGIN, type PlaneJoint, type Pose, planar, pointX, pointZ, posed, retracted } from "../core/design/plane";
import { type Attachment, type Crane, FOOT, GRAVITY, type Mode, tilt } from "../core/design/types";

/** What tells the load of a posture [kg]. */
export function peer(crane: Crane, mode: Mode): (q: readonly number[]) => number {
  const joints = planar(crane);
  const closed = crane.cylinders.map((item) => retracted(crane, item));
  return (q) => load(crane, mode, joints, closed, posed(crane, joints, q));
}

function load(
  crane: Crane,
  mode: Mode,
  joints: readonly PlaneJoint[],
  closed: readonly number[],
  poses: readonly Pose[],
): number {
  const { hoist, rating, links, cylinders } = crane;
  const up = [-Math.sin(tilt(crane)), Math.cos(tilt(crane))];
  const falls = hoist.falls ?? 1;
  const atSea = mode.waveHeight > 0;
  const place = (at: Attachment) => (at.link === FOOT ? -1 : links.findIndex(({ name }) => name === at.link));
  const pose = (link: number): Pose => poses[link] ?? ORIGIN;
  const pin = (at: Attachment) => [pointX(pose(place(at)), at.x, at.z), pointZ(pose(place(at)), at.x, at.z)];
  const joint = (name: string) => joints.findIndex((item) => item.joint.name === name);
  const derivative = (k: number, [x, z]: number[]) => {
    const { link, turns, sign, slideX, slideZ } = joints[k];
    if (turns) return [-sign * (z - pose(link).z), sign * (x - pose(link).x)];
    const { c, s } = pose(link);
    return [slideX * c - slideZ * s, slideX * s + slideZ * c];
  };
  const distance = (a: Attachment, b: Attachment) => Math.hypot(pin(a)[0] - pin(b)[0], pin(a)[1] - pin(b)[1]);
  const distanceBy = (k: number, a: Attachment, b: Attachment) => {
    const [outer, inner] = place(a) >= place(b) ? [a, b] : [b, a];
    if (place(inner) >= joints[k].link || place(outer) < joints[k].link) return 0;
    const [dx, dz] = derivative(k, pin(outer));
    const [ex, ez] = [pin(outer)[0] - pin(inner)[0], pin(outer)[1] - pin(inner)[1]];
    return (ex * dx + ez * dz) / Math.hypot(ex, ez);
  };

  const tip = pin(hoist.sheaves[hoist.sheaves.length - 1]);
  const path = [hoist.drum, ...hoist.sheaves];
  const hang = Math.max(tip[1] + crane.pedestal[2], 1);
  const lead = atSea ? (2.5 + 1.5 * mode.waveHeight) / hang : 0;
  const own = (k: number) => {
    let sum = 0;
    links.forEach(({ com, mass }, i) => {
      if (i < joints[k].link) return;
      const [dx, dz] = derivative(k, [pointX(pose(i), com[0], com[2]), pointZ(pose(i), com[0], com[2])]);
      sum += GRAVITY * mass * (up[0] * dx + up[1] * dz);
    });
    return sum;
  };
  const levers = (k: number) => {
    const [dx, dz] = derivative(k, tip);
    const rope = path.slice(1).reduce((sum, to, i) => sum + distanceBy(k, path[i], to), 0);
    const plumb = up[0] * dx + up[1] * dz + rope / falls;
    return [plumb, plumb - lead * (up[1] * dx - up[0] * dz)];
  };

  let borne = Number.POSITIVE_INFINITY;
  const bear = (self: number, loads: number[], low: number, high: number) => {
    if (!(self >= low && self <= high)) borne = 0;
    for (const load of loads)
      if (load !== 0) borne = Math.min(borne, Math.max(0, ((load > 0 ? high : low) - self) / load));
  };
  for (const item of cylinders) {
    const k = joint(item.moves);
    const lever = distanceBy(k, item.base, item.eye);
    const [push, pull] = cylinderForces(item);
    bear(
      own(k) / lever,
      levers(k).map((load) => load / lever),
      -pull,
      push,
    );
  }
  for (const { joint: name, moment } of rating?.structure ?? [])
    bear(own(joint(name)), levers(joint(name)), -moment, moment);
  if (rating?.slew_moment != null) {
    let self = 0;
    links.forEach(({ com, mass }, i) => {
      self += GRAVITY * mass * (up[1] * pointX(pose(i), com[0], com[2]) - up[0] * pointZ(pose(i), com[0], com[2]));
    });
    const plumb = up[1] * tip[0] - up[0] * tip[1];
    bear(self, [plumb, plumb + lead * (up[0] * tip[0] + up[1] * tip[1])], -rating.slew_moment, rating.slew_moment);
  }
  if (rating?.slew_torque != null) {
    const own = links.reduce((sum, { com, mass }, i) => sum + mass * pointX(pose(i), com[0], com[2]), 0);
    const side = 0.5 * lead * up[1];
    const loads = [side, -side].map((slope) => tip[0] * (slope - up[0]));
    bear(-GRAVITY * up[0] * own, loads, -rating.slew_torque, rating.slew_torque);
  }
  const carried = falls * reeving(falls, hoist.sheave_efficiency ?? 1);
  if (hoist.rope.breaking_load != null)
    borne = Math.min(borne, (carried * hoist.rope.breaking_load) / (hoist.rope.safety_factor ?? 3));
  if (hoist.line_pull != null) borne = Math.min(borne, carried * hoist.line_pull);

  let mass = borne / GRAVITY / (rating?.harbour_factor ?? 1);
  if (atSea && borne < Number.POSITIVE_INFINITY) {
    const length = path.slice(1).reduce((sum, to, i) => sum + distance(path[i], to), 0);
    let compliance = (length / falls ** 2 + hang / falls) / hoist.rope.EA;
    for (const [i, item] of cylinders.entries()) {
      const k = joint(item.moves);
      const [bore, annulus] = areas(item);
      const margin = 0.01 * item.stroke;
      const out = distance(item.base, item.eye) - closed[i];
      const extension = Math.min(Math.max(out, margin), item.stroke - margin);
      const oil = crane.bulk_modulus * (bore / extension + annulus / (item.stroke - extension));
      compliance += (levers(k)[0] / distanceBy(k, item.base, item.eye)) ** 2 / oil;
    }
    const b = (((0.5 * hoist.speed) / falls + meetingSpeed(crane, mode)) / GRAVITY) * Math.sqrt(1 / compliance);
    mass = Math.min(mass, (0.5 * (Math.sqrt(b * b + (4 * borne) / GRAVITY) - b)) ** 2);
  }
  const radius = Math.max(tip[0], 1e-9);
  if (rating?.load_moment != null) mass = Math.min(mass, rating.load_moment / radius / GRAVITY);
  if (rating?.heeling_moment != null)
    mass = Math.min(mass, rating.heeling_moment / (radius + Math.abs(crane.pedestal[1])) / GRAVITY);
  return Math.max(0, mass - (hoist.hook_mass ?? 0));
}
