// Parts for a crane that has none yet; as src/seacrane/design/standard.py, which says how they are chosen.
import { ofPart } from "./mass";
import type { Attachment, Box, Crane, Cylinder, Drum, Girder, Link, Lug, Part, Sheave, Tube } from "./types";

const THINNEST = 0.006;
const THICKEST = 0.08;

type Point = readonly [number, number];

/** The crane with standard parts in every link that has none; masses stay those of the design. */
export function furnished(crane: Crane): Crane {
  return { ...crane, links: crane.links.map((link, i) => (link.parts?.length ? link : built(crane, i))) };
}

function built(crane: Crane, index: number): Link {
  const link = crane.links[index];
  const [start, end] = ends(crane, index);
  const upright = Math.abs(end[1] - start[1]) > Math.abs(end[0] - start[0]);
  const fittings: Part[] = [...lugs(crane, link, start, end), ...rope(crane, link, start, end)];
  if (upright && index === 0) fittings.push(...upperWorks(crane, end[1]));
  const body = upright ? column(crane, link, start, end) : girder(crane, link, start, end);
  const rest = fittings.reduce((sum, part) => sum + ofPart(part).mass, 0);
  return { ...link, parts: [weighing(body, link.mass - rest), ...fittings] };
}

/** Where the body of a link begins and ends (x, z), in its frame. */
export function ends(crane: Crane, index: number): [Point, Point] {
  const { joint } = crane.links[index];
  const next = crane.links[index + 1]?.joint.origin;
  const tip = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  const [x, z] = next ? [next[0], next[2]] : [tip.x, tip.z];
  if (joint.kind === "revolute")
    return [
      [0, 0],
      [x, z],
    ];
  const travel = joint.limits ? joint.limits[1] - joint.limits[0] : 1;
  return [
    [x - 1.1 * travel, z],
    [x, z],
  ];
}

/** Length of all links together [m]. */
function scale(crane: Crane): number {
  return crane.links.reduce((sum, _, i) => {
    const [[x0, z0], [x1, z1]] = ends(crane, i);
    return sum + Math.hypot(x1 - x0, z1 - z0);
  }, 0);
}

function column(crane: Crane, link: Link, start: Point, end: Point): Tube {
  const diameter = Math.max(0.075 * scale(crane), 0.3 * Math.abs(end[1] - start[1]));
  return {
    kind: "tube",
    name: link.name,
    start: [start[0], 0, start[1]],
    end: [end[0], 0, end[1]],
    diameter,
    end_diameter: 0.75 * diameter,
    thickness: THINNEST,
  };
}

function girder(crane: Crane, link: Link, start: Point, end: Point): Girder {
  const length = end[0] - start[0];
  const eye = crane.cylinders.find((c) => c.eye.link === link.name && c.moves === link.joint.name)?.eye.x;
  const slides = link.joint.kind === "prismatic";
  const push = Math.min(Math.max(eye === undefined ? 0.35 : (eye - start[0]) / length, 0.2), 0.6);
  const depth = Math.min(length, 0.6 * scale(crane)) * (slides ? 0.6 : 1);
  const shape = slides
    ? [
        [0, 0.028, 0.028],
        [1, 0.028, 0.028],
      ]
    : [
        [-0.03, 0.024, 0.024],
        [0.03, 0.034, 0.03],
        [push, 0.056, 0.034],
        [0.8, 0.046, 0.034],
        [1, 0.026, 0.026],
      ];
  const stations = shape.map(([along, top, bottom]) => {
    const axis = start[1] + (end[1] - start[1]) * Math.min(Math.max(along, 0), 1);
    return {
      x: start[0] + along * length,
      top: axis + top * depth,
      bottom: axis - bottom * depth,
      width: 0.075 * depth * (1 - 0.15 * Math.max(along, 0)),
    };
  });
  return { kind: "girder", name: link.name, stations, thickness: THINNEST };
}

/** The body with plates as thick as makes it weigh `mass` [kg], as far as plates of cranes go. */
function weighing<Body extends Girder | Tube>(body: Body, mass: number): Body {
  const smallest =
    body.kind === "girder"
      ? Math.min(...body.stations.map((s) => Math.min(s.top - s.bottom, s.width)))
      : Math.min(body.diameter, body.end_diameter);
  let [low, high] = [Math.min(THINNEST, 0.2 * smallest), Math.min(THICKEST, 0.4 * smallest)];
  for (let i = 0; i < 40; i += 1) {
    const middle = 0.5 * (low + high);
    if (ofPart({ ...body, thickness: middle }).mass < mass) low = middle;
    else high = middle;
  }
  return { ...body, thickness: Math.round(high * 1e6) / 1e6 };
}

function lugs(crane: Crane, link: Link, start: Point, end: Point): Lug[] {
  return crane.cylinders.flatMap((cylinder) =>
    [cylinder.base, cylinder.eye]
      .filter((pin) => pin.link === link.name)
      .flatMap((pin) => Array.from({ length: cylinder.count ?? 1 }, (_, side) => lug(cylinder, pin, side, start, end))),
  );
}

function lug(cylinder: Cylinder, pin: Attachment, side: number, start: Point, end: Point): Lug {
  const [root_x, root_z] = root(pin, start, end);
  const count = cylinder.count ?? 1;
  const gap = 1.1 * cylinder.bore;
  return {
    kind: "lug",
    name: `${cylinder.name} ${pin === cylinder.base ? "base" : "eye"}${count === 1 ? "" : ` ${side + 1}`}`,
    x: pin.x,
    z: pin.z,
    root_x,
    root_z,
    root_width: 2.4 * cylinder.bore,
    radius: 0.55 * cylinder.bore,
    hole: 0.5 * cylinder.bore,
    thickness: 0.12 * cylinder.bore,
    gap,
    y: (side - 0.5 * (count - 1)) * 1.6 * gap,
  };
}

function root(pin: Attachment, start: Point, end: Point): Point {
  const [dx, dz] = [end[0] - start[0], end[1] - start[1]];
  const length = Math.hypot(dx, dz);
  const along = Math.min(Math.max(((pin.x - start[0]) * dx + (pin.z - start[1]) * dz) / length ** 2, 0), 1);
  return [start[0] + along * dx, start[1] + along * dz];
}

/** A plate to either side, from the link's axis to a pin of a sheave or drum of this size [m] that stands off it. */
function bearer(name: string, pin: Attachment, size: number, gap: number, start: Point, end: Point): Lug[] {
  const [root_x, root_z] = root(pin, start, end);
  if (!(Math.hypot(pin.x - root_x, pin.z - root_z) > 0.6 * size)) return [];
  return [
    {
      kind: "lug",
      name: `${name} bracket`,
      x: pin.x,
      z: pin.z,
      root_x,
      root_z,
      root_width: 1.8 * size,
      radius: 0.4 * size,
      hole: 0.25 * size,
      thickness: 0.05 * size,
      gap,
    },
  ];
}

function rope({ hoist }: Crane, link: Link, start: Point, end: Point): (Sheave | Drum | Lug)[] {
  const d = hoist.rope.diameter;
  const fittings: (Sheave | Drum | Lug)[] = hoist.sheaves.flatMap((pin, i) =>
    pin.link === link.name
      ? [
          {
            kind: "sheave" as const,
            name: `sheave ${i + 1}`,
            x: pin.x,
            z: pin.z,
            radius: 10 * d,
            groove: 1.5 * d,
            width: 2.2 * d,
            hole: 2.5 * d,
          },
          ...bearer(`sheave ${i + 1}`, pin, 10 * d, 3 * d, start, end),
        ]
      : [],
  );
  if (hoist.drum.link === link.name) {
    const r = hoist.drum_radius;
    const { x, z } = hoist.drum;
    fittings.push(...bearer("drum", hoist.drum, r, 2.8 * r, start, end), {
      kind: "drum",
      name: "drum",
      x,
      z,
      radius: r,
      length: 2.6 * r,
      flange: 1.5 * r,
      thickness: 0.06 * r,
    });
  }
  return fittings;
}

/** Cabin on the starboard side, machinery house behind. */
function upperWorks(crane: Crane, height: number): Box[] {
  const size = Math.min(Math.max(0.06 * scale(crane), 0.9), 2.2);
  return [
    {
      kind: "box",
      name: "cabin",
      centre: [0.6 * size, -1.4 * size, 0.55 * height],
      size: [1.1 * size, 0.9 * size, 1.2 * size],
      thickness: 0.006,
    },
    {
      kind: "box",
      name: "machinery house",
      centre: [-1.5 * size, 0, 0.35 * height],
      size: [1.4 * size, 1.6 * size, 0.9 * size],
      thickness: 0.006,
    },
  ];
}
