// Changes to a crane, each a new crane: by path for the forms, by what is dragged for the drawing.
import { endedAt, endOf } from "./length";
import { cylinderLengths, frames, into, type Point, type Posture } from "./plane";
import { sized } from "./sizing";
import { type Attachment, type Crane, type Cylinder, FOOT, type Joint, type Limits, type Link } from "./types";

export type Path = readonly (string | number)[];

/** The value at a path; undefined where there is none. */
export function get(of: unknown, path: Path): unknown {
  return path.reduce<unknown>((value, key) => (value as Record<string | number, unknown> | null)?.[key], of);
}

/** A copy with the value at a path; `undefined` takes a field, or an item of a list, away. */
export function set<T>(of: T, path: Path, value: unknown): T {
  if (path.length === 0) return value as T;
  const [key, ...rest] = path;
  if (Array.isArray(of)) {
    const items = [...of];
    if (rest.length === 0 && value === undefined) items.splice(key as number, 1);
    else items[key as number] = set(items[key as number], rest, value);
    return items as T;
  }
  const copy: Record<string | number, unknown> = { ...(of as object) };
  const next = set(copy[key], rest, value);
  if (next === undefined) delete copy[key];
  else copy[key] = next;
  return copy as T;
}

/** The coordinate brought within the joint's limits. */
export function within(joint: Joint, value: number): number {
  if (!joint.limits) return value;
  const [low, high] = joint.limits;
  return Math.min(Math.max(value, Math.min(low, high)), Math.max(low, high));
}

/** The posture with every joint of the crane, and no other, within its limits. */
export function fitting(crane: Crane, posture: Posture): Posture {
  return Object.fromEntries(
    crane.links.map(({ joint }) => [
      joint.name,
      within(joint, Object.hasOwn(posture, joint.name) ? posture[joint.name] : resting(joint)),
    ]),
  );
}

function resting({ limits, kind }: Joint): number {
  if (!limits) return 0;
  return limits[0] + (kind === "prismatic" ? 0.4 : 0.6) * (limits[1] - limits[0]);
}

/** To the next whole multiple of a step. */
export function snapped(value: number, step: number): number {
  return step > 0 ? Number((Math.round(value / step) * step).toPrecision(12)) : value;
}

// ---------------------------------------------------------------- what is dragged in the drawing
export type Handle =
  | { readonly kind: "joint"; readonly link: number }
  | { readonly kind: "end"; readonly link: number }
  | { readonly kind: "limit"; readonly link: number; readonly end: 0 | 1 }
  | { readonly kind: "pin"; readonly cylinder: number; readonly end: "base" | "eye" }
  | { readonly kind: "sheave"; readonly index: number }
  | { readonly kind: "drum" };

export interface Scene {
  readonly crane: Crane;
  readonly posture: Posture;
}

export interface Steps {
  /** [m] and [rad]; 0 does not snap. */
  readonly length: number;
  readonly angle: number;
}

/** What a drag of a handle to a point of the crane's plane makes of crane and posture. */
export function dragged(scene: Scene, handle: Handle, to: Point, steps: Steps): Scene {
  const { crane, posture } = scene;
  const at = frames(crane, posture);
  const local = (link: string): Point => {
    const [x, z] = into(at.get(link) ?? at.get(FOOT)!, to);
    return [snapped(x, steps.length), snapped(z, steps.length)];
  };
  switch (handle.kind) {
    case "joint": {
      const { joint } = crane.links[handle.link];
      const value = within(joint, snappedCoordinate(joint, coordinate(scene, handle.link, to), steps));
      return { crane, posture: { ...posture, [joint.name]: value } };
    }
    case "limit": {
      const { joint } = crane.links[handle.link];
      const value = snappedCoordinate(joint, coordinate(scene, handle.link, to, false), steps);
      return { ...scene, ...limited(scene, handle.link, handle.end, value) };
    }
    case "end":
      return { crane: endedAt(crane, handle.link, local(crane.links[handle.link].name)), posture };
    case "pin": {
      const { link } = crane.cylinders[handle.cylinder][handle.end];
      const [x, z] = local(link);
      return { crane: set(crane, ["cylinders", handle.cylinder, handle.end], { link, x, z }), posture };
    }
    case "sheave": {
      const { link } = crane.hoist.sheaves[handle.index];
      const [x, z] = local(link);
      return { crane: set(crane, ["hoist", "sheaves", handle.index], { link, x, z }), posture };
    }
    case "drum": {
      const { link } = crane.hoist.drum;
      const [x, z] = local(link);
      return { crane: set(crane, ["hoist", "drum"], { link, x, z }), posture };
    }
  }
}

/** What an arrow key does to a handle: by `dx`, `dz` metres, or along the joint by as many steps. */
export function nudged(scene: Scene, handle: Handle, dx: number, dz: number, steps: Steps): Scene {
  const { crane, posture } = scene;
  if (handle.kind === "joint" || handle.kind === "limit") {
    const { joint } = crane.links[handle.link];
    const by = (dx + dz) * (joint.kind === "revolute" ? steps.angle : steps.length);
    if (handle.kind === "limit") return limited(scene, handle.link, handle.end, (joint.limits?.[handle.end] ?? 0) + by);
    return { crane, posture: { ...posture, [joint.name]: within(joint, (posture[joint.name] ?? 0) + by) } };
  }
  const [path, [x, z]] = placed(crane, handle);
  const moved: Point = [
    Number((x + dx * steps.length).toPrecision(12)),
    Number((z + dz * steps.length).toPrecision(12)),
  ];
  if (handle.kind === "end") return { crane: endedAt(crane, handle.link, moved), posture };
  return { crane: set(set(crane, [...path, "x"], moved[0]), [...path, "z"], moved[1]), posture };
}

/** Path and place, in its link's frame, of a handle that is a point. */
function placed(crane: Crane, handle: Exclude<Handle, { kind: "joint" | "limit" }>): [Path, Point] {
  if (handle.kind === "end") return [[], endOf(crane, handle.link)];
  const path: Path =
    handle.kind === "pin"
      ? ["cylinders", handle.cylinder, handle.end]
      : handle.kind === "sheave"
        ? ["hoist", "sheaves", handle.index]
        : ["hoist", "drum"];
  const { x, z } = get(crane, path) as Attachment;
  return [path, [x, z]];
}

function limited({ crane, posture }: Scene, link: number, end: 0 | 1, value: number): Scene {
  const { joint } = crane.links[link];
  const limits: Limits = end === 0 ? [value, joint.limits?.[1] ?? value] : [joint.limits?.[0] ?? value, value];
  const changed = set(crane, ["links", link, "joint", "limits"], limits);
  return { crane: changed, posture: fitting(changed, posture) };
}

function snappedCoordinate(joint: Joint, value: number, steps: Steps): number {
  return snapped(value, joint.kind === "revolute" ? steps.angle : steps.length);
}

/**
 * The coordinate of a link's joint that brings its end in line with a point (`toEnd`), or its own x axis, as the limits
 * are drawn. Of the turns that do so, the one nearest to the coordinate now.
 */
function coordinate({ crane, posture }: Scene, link: number, to: Point, toEnd = true): number {
  const { joint } = crane.links[link];
  const now = posture[joint.name] ?? 0;
  const at = frames(crane, { ...posture, [joint.name]: 0 }).get(crane.links[link].name)!;
  const [x, z] = into(at, to);
  const [ex, ez] = endOf(crane, link);
  if (joint.kind === "prismatic") {
    const size = Math.hypot(...joint.axis);
    return ((x - ex) * joint.axis[0] + (z - ez) * joint.axis[2]) / size;
  }
  const sign = -Math.sign(joint.axis[1]) || 1;
  const angle = sign * (Math.atan2(z, x) - (toEnd ? Math.atan2(ez, ex) : 0));
  const around = toEnd ? now : 0.5 * ((joint.limits?.[0] ?? 0) + (joint.limits?.[1] ?? 0));
  return angle + 2 * Math.PI * Math.round((around - angle) / (2 * Math.PI));
}

// ---------------------------------------------------------------- links and cylinders
/** A name that none of `taken` is. */
export function fresh(wanted: string, taken: readonly string[]): string {
  let name = wanted;
  for (let i = 2; taken.includes(name); i += 1) name = `${wanted} ${i}`;
  return name;
}

/** Limits of a link that folds below the one before [rad]. */
const FOLDING: Limits = [(-110 * Math.PI) / 180, 0];

/** The crane with a link more at its end, half as long as the last one; the tip moves to it. */
export function withLink(crane: Crane, kind: "revolute" | "prismatic"): Crane {
  const last = crane.links.length - 1;
  const [x, z] = endOf(crane, last);
  const length = Math.max(1, Number((0.5 * Math.hypot(x, z)).toFixed(1)));
  const turns = kind === "revolute";
  const mass = Math.max(100, Math.round(0.4 * crane.links[last].mass));
  const slim = (mass * length ** 2) / 12;
  const link: Link = {
    name: fresh(turns ? "arm" : "extension", [FOOT, ...crane.links.map((item) => item.name)]),
    joint: {
      name: fresh(
        turns ? "fold" : "extend",
        crane.links.map((item) => item.joint.name),
      ),
      kind,
      axis: turns ? [0, -1, 0] : [1, 0, 0],
      origin: [x, 0, z],
      limits: turns ? FOLDING : [0, length],
    },
    mass,
    com: [turns ? 0.45 * length : -0.5 * length, 0, 0],
    inertia: [0.02 * slim, slim, slim],
  };
  const tip: Attachment = { link: link.name, x: turns ? length : 0, z: 0 };
  const sheaves = [...crane.hoist.sheaves.slice(0, -1), ...(turns ? [crane.hoist.sheaves.at(-1)!] : []), tip];
  return { ...crane, links: [...crane.links, link], hoist: { ...crane.hoist, sheaves } };
}

/** The crane with a joint of the other kind: in the plane, with limits of that kind; a slewing joint only turns. */
export function withKind(crane: Crane, index: number, kind: Joint["kind"]): Crane {
  const { joint } = crane.links[index];
  if (joint.kind === kind || joint.name === crane.slew?.joint) return crane;
  const travel = Math.max(1, Number((0.5 * Math.hypot(...endOf(crane, index))).toFixed(1)));
  return set(crane, ["links", index, "joint"], {
    ...joint,
    kind,
    axis: kind === "revolute" ? [0, -1, 0] : [1, 0, 0],
    limits: kind === "revolute" ? FOLDING : [0, travel],
  });
}

/** The crane without a link and all that hangs on it alone; null where it is the only one. */
export function withoutLink(crane: Crane, index: number): Crane | null {
  if (crane.links.length < 2) return null;
  const gone = crane.links[index];
  const links = crane.links.filter((_, i) => i !== index);
  const before = crane.links[index - 1]?.name ?? FOOT;
  const [x, z] = endOf(crane, index);
  const kept = (at: Attachment): Attachment => (at.link === gone.name ? { ...at, link: before } : at);
  const joined = links.map((link, i) =>
    i === index && index < links.length ? { ...link, joint: { ...link.joint, origin: gone.joint.origin } } : link,
  );
  const isLast = index === crane.links.length - 1;
  const [ox, , oz] = gone.joint.origin;
  const inner = crane.hoist.sheaves.slice(0, -1).filter((at) => at.link !== gone.name);
  const tip = isLast ? { link: before, x: ox, z: oz } : crane.hoist.sheaves.at(-1)!;
  const doubled = (at: Attachment) =>
    at.link === tip.link && Math.hypot(at.x - tip.x, at.z - tip.z) < 0.5 * Math.hypot(x, z);
  return {
    ...crane,
    links: joined,
    cylinders: crane.cylinders.filter(
      ({ moves, base, eye }) => moves !== gone.joint.name && base.link !== gone.name && eye.link !== gone.name,
    ),
    hoist: {
      ...crane.hoist,
      drum: kept(crane.hoist.drum),
      sheaves: [...inner.filter((at) => !(isLast && doubled(at))), tip],
    },
    ...(crane.slew?.joint === gone.joint.name ? { slew: null } : {}),
    ...(crane.rating?.structure
      ? { rating: { ...crane.rating, structure: crane.rating.structure.filter((s) => s.joint !== gone.joint.name) } }
      : {}),
  };
}

const MARGIN = 1.02;

/** The cylinder with just the stroke that its joint's limits ask for. */
export function withStroke(crane: Crane, cylinder: Cylinder): Cylinder {
  const [shortest, longest] = cylinderLengths(crane, cylinder);
  const travel = longest - shortest;
  return travel > 0 ? { ...cylinder, stroke: Number((MARGIN * travel).toFixed(3)), retracted: null } : cylinder;
}

/** The crane with a pair of cylinders below the joint of a link, pins a fifth of the links away, as strong as the rest. */
export function withCylinder(crane: Crane, index: number): Crane {
  const link = crane.links[index];
  const before = crane.links[index - 1]?.name ?? FOOT;
  const turns = link.joint.kind === "revolute";
  const [ex, ez] = endOf(crane, index);
  const [ox, , oz] = link.joint.origin;
  const back = Math.max(1, Math.hypot(ox, oz));
  const out = Math.max(1, Math.hypot(ex, ez));
  const round = (value: number) => Number(value.toFixed(2));
  const draft: Cylinder = {
    name: fresh(
      `${link.joint.name}_cylinder`,
      crane.cylinders.map((item) => item.name),
    ),
    moves: link.joint.name,
    count: 2,
    bore: 0.2,
    rod: 0.14,
    stroke: 1,
    pressure: 280e5,
    base: turns
      ? { link: before, x: round(ox - 0.35 * ox), z: round(oz - 0.08 * back - 0.3 * Math.abs(oz)) }
      : { link: before, x: round(ox - 0.9 * back), z: round(oz) },
    eye: turns ? { link: link.name, x: round(0.18 * out), z: round(-0.07 * out) } : { link: link.name, x: 0, z: 0 },
  };
  return { ...crane, cylinders: [...crane.cylinders, withStroke(crane, sized(crane, draft))] };
}

// ---------------------------------------------------------------- the whole crane
/** Where two cranes differ: path and both values, SI; undefined where one has none. */
export function differences(a: unknown, b: unknown, path: Path = []): { path: Path; a: unknown; b: unknown }[] {
  if (a === b || (a == null && b == null)) return [];
  const tree = (value: unknown) => typeof value === "object" && value !== null;
  if (!tree(a) || !tree(b)) return [{ path, a, b }];
  const keys = new Set([...Object.keys(a as object), ...Object.keys(b as object)]);
  return [...keys].flatMap((key) => differences(get(a, [key]), get(b, [key]), [...path, key]));
}
