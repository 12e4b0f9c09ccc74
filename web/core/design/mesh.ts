// Surfaces of parts as triangles, closed and with their normals outward; a hollow part has its inner surface too. The
// same as src/seacrane/design/mesh.py, vertex by vertex; a shared fixture holds the masses of both equal.
import type { Vec3 } from "../../rpc/messages";
import type { Box, Drum, Girder, Imported, Lug, Part, Sheave, Tube } from "./types";

/** Corners of a circle. */
export const SIDES = 48;

export interface Mesh {
  /** x, y, z of each vertex [m]. */
  readonly vertices: Float64Array;
  /** Three indices of vertices for each triangle, counter-clockwise seen from outside. */
  readonly faces: Uint32Array;
}

type Ring = readonly Vec3[];

export function mesh(part: Part): Mesh {
  switch (part.kind) {
    case "girder":
      return girder(part);
    case "tube":
      return tube(part);
    case "lug":
      return lug(part);
    case "sheave":
      return sheave(part);
    case "drum":
      return drum(part);
    case "box":
      return box(part);
    case "mesh":
      return read(part);
  }
}

const known = new WeakMap<Imported, Mesh>();

/** The mesh of a part, decoded once: a page asks for it in every frame. */
function read(part: Imported): Mesh {
  const found = known.get(part) ?? decoded(part.surface);
  known.set(part, found);
  return found;
}

/** Several meshes as one, side by side. */
export function joined(meshes: readonly Mesh[]): Mesh {
  const vertices = new Float64Array(meshes.reduce((sum, one) => sum + one.vertices.length, 0));
  const faces = new Uint32Array(meshes.reduce((sum, one) => sum + one.faces.length, 0));
  let [at, to] = [0, 0];
  for (const one of meshes) {
    vertices.set(one.vertices, at);
    for (let i = 0; i < one.faces.length; i += 1) faces[to + i] = one.faces[i] + at / 3;
    at += one.vertices.length;
    to += one.faces.length;
  }
  return { vertices, faces };
}

// ---------------------------------------------------------------- parts
function girder(part: Girder): Mesh {
  const { stations, thickness: t } = part;
  const [first, last] = [stations[0].x, stations[stations.length - 1].x];
  const outer = stations.map(({ x }) => section(part, x, 0));
  const between = stations.map(({ x }) => x).filter((x) => first + t < x && x < last - t);
  const inner = [first + t, ...between, last - t].map((x) => section(part, x, t));
  return joined([loft(outer), insideOut(loft(inner))]);
}

function section({ stations, y = 0 }: Girder, x: number, inset: number): Ring {
  const at = (read: (station: Girder["stations"][number]) => number) => {
    if (x <= stations[0].x) return read(stations[0]);
    for (let i = 1; i < stations.length; i += 1)
      if (x <= stations[i].x) {
        const [a, b] = [stations[i - 1], stations[i]];
        return read(a) + ((read(b) - read(a)) * (x - a.x)) / (b.x - a.x);
      }
    return read(stations[stations.length - 1]);
  };
  const top = at((station) => station.top) - inset;
  const bottom = at((station) => station.bottom) + inset;
  const half = 0.5 * at((station) => station.width) - inset;
  return [
    [x, y - half, bottom],
    [x, y + half, bottom],
    [x, y + half, top],
    [x, y - half, top],
  ];
}

function tube({ start, end, diameter, end_diameter, thickness: t }: Tube): Mesh {
  const way: Vec3 = [end[0] - start[0], end[1] - start[1], end[2] - start[2]];
  const length = Math.hypot(...way);
  const along: Vec3 = [way[0] / length, way[1] / length, way[2] / length];
  let aside = cross(along, [0, 1, 0]);
  if (Math.hypot(...aside) < 1e-6) aside = cross(along, [0, 0, 1]);
  const size = Math.hypot(...aside);
  aside = [aside[0] / size, aside[1] / size, aside[2] / size];
  const across = cross(along, aside);
  const [r0, r1] = [0.5 * diameter, 0.5 * end_diameter];
  const turned = lathe([
    [r0, 0],
    [r1, length],
    [r1 - t, length],
    [r0 - t, 0],
  ]);
  return moved(turned, aside, across, along, start);
}

function lug(part: Lug): Mesh {
  const [outline, hole] = eye(part);
  const { gap, thickness, y = 0 } = part;
  const half = 0.5 * gap;
  const plates = [
    [half, half + thickness],
    [-half - thickness, -half],
  ].map(([near, far]) =>
    torus([atY(outline, y + far), atY(outline, y + near), atY(hole, y + near), atY(hole, y + far)]),
  );
  return joined(plates);
}

type Point = readonly [number, number];

/** Outline and hole of an eye plate in x and z: the hull of a circle and the root, ray by ray. */
function eye({ x, z, root_x, root_z, root_width, radius, hole }: Lug): [Point[], Point[]] {
  const [dx, dz] = [root_x - x, root_z - z];
  const reach = Math.hypot(dx, dz);
  const along: Point = reach > 0 ? [dx / reach, dz / reach] : [0, -1];
  const aside: Point = [-along[1], along[0]];
  const corners: Point[] = [
    [reach, 0.5 * root_width],
    [reach, -0.5 * root_width],
  ];
  const outline: Point[] = [];
  const inside: Point[] = [];
  for (let i = 0; i < SIDES; i += 1) {
    const angle = (2 * Math.PI * i) / SIDES;
    const ray: Point = [Math.cos(angle), Math.sin(angle)];
    const far = reach > radius ? hullDistance(ray, radius, corners) : radius;
    const place = (r: number): Point => [
      x + r * (ray[0] * along[0] + ray[1] * aside[0]),
      z + r * (ray[0] * along[1] + ray[1] * aside[1]),
    ];
    outline.push(place(far));
    inside.push(place(0.5 * hole));
  }
  return [outline, inside];
}

/** How far the hull of a circle about the origin and two corners reaches along a unit vector. */
function hullDistance(ray: Point, radius: number, corners: readonly Point[]): number {
  let best = radius;
  const edges: [Point, Point][] = [[corners[0], corners[1]]];
  for (const [cx, cy] of corners) {
    const size = Math.hypot(cx, cy);
    if (size <= radius) continue;
    const angle = Math.atan2(cy, cx) + Math.acos(radius / size) * (cy > 0 ? 1 : -1);
    edges.push([
      [cx, cy],
      [radius * Math.cos(angle), radius * Math.sin(angle)],
    ]);
  }
  for (const [[x0, y0], [x1, y1]] of edges) {
    const [ex, ey] = [x1 - x0, y1 - y0];
    const turn = ray[0] * ey - ray[1] * ex;
    if (Math.abs(turn) < 1e-15) continue;
    const distance = (x0 * ey - y0 * ex) / turn;
    const where = (x0 * ray[1] - y0 * ray[0]) / turn;
    if (distance > best && where >= -1e-12 && where <= 1 + 1e-12) best = distance;
  }
  return best;
}

function sheave({ x, z, radius, groove, width, hole }: Sheave): Mesh {
  const [half, inner] = [0.5 * width, 0.5 * hole];
  const turned = lathe([
    [inner, -half],
    [radius, -half],
    [radius - groove, 0],
    [radius, half],
    [inner, half],
  ]);
  return across(turned, x, z);
}

function drum({ x, z, radius, length, flange, thickness: t }: Drum): Mesh {
  const half = 0.5 * length;
  const turned = lathe([
    [radius - t, -half],
    [flange, -half],
    [flange, -half + t],
    [radius, -half + t],
    [radius, half - t],
    [flange, half - t],
    [flange, half],
    [radius - t, half],
  ]);
  return across(turned, x, z);
}

function box({ centre, size, thickness }: Box): Mesh {
  const outer = block(centre, size);
  if (thickness == null) return outer;
  const [a, b, c] = size.map((side) => side - 2 * thickness);
  return joined([outer, insideOut(block(centre, [a, b, c]))]);
}

/** The mesh in a binary STL in base64; a `RangeError` if it is none. */
export function decoded(surface: string): Mesh {
  let text = "";
  try {
    text = atob(surface);
  } catch {
    throw new RangeError("is not base64");
  }
  const content = Uint8Array.from(text, (character) => character.charCodeAt(0));
  const view = new DataView(content.buffer);
  const count = content.length >= 84 ? view.getUint32(80, true) : -1;
  if (content.length !== 84 + 50 * count) throw new RangeError("is not a binary STL");
  const corners = new Map<string, number>();
  const vertices: number[] = [];
  const faces = new Uint32Array(3 * count);
  for (let i = 0; i < 3 * count; i += 1) {
    const at = 84 + 50 * Math.floor(i / 3) + 12 + 12 * (i % 3);
    const point = [view.getFloat32(at, true), view.getFloat32(at + 4, true), view.getFloat32(at + 8, true)];
    if (!point.every(Number.isFinite)) throw new RangeError("has a corner that is no place");
    const key = point.join(" ");
    let index = corners.get(key);
    if (index === undefined) {
      index = vertices.length / 3;
      corners.set(key, index);
      vertices.push(...point);
    }
    faces[i] = index;
  }
  return { vertices: Float64Array.from(vertices), faces };
}

/** A mesh as binary STL, coordinates to single precision. */
export function stl({ vertices, faces }: Mesh): Uint8Array {
  const content = new Uint8Array(84 + (50 * faces.length) / 3);
  const view = new DataView(content.buffer);
  new TextEncoder().encodeInto("seacrane".padEnd(80), content);
  view.setUint32(80, faces.length / 3, true);
  for (let i = 0; i < faces.length; i += 1)
    for (let k = 0; k < 3; k += 1)
      view.setFloat32(84 + 50 * Math.floor(i / 3) + 12 + 12 * (i % 3) + 4 * k, vertices[3 * faces[i] + k], true);
  return content;
}

// ---------------------------------------------------------------- surfaces
function block([x, y, z]: Vec3, size: Vec3): Mesh {
  const [a, b, c] = size.map((side) => 0.5 * side);
  const ring = (u: number): Ring => [
    [u, y - b, z - c],
    [u, y + b, z - c],
    [u, y + b, z + c],
    [u, y - b, z + c],
  ];
  return loft([ring(x - a), ring(x + a)]);
}

/** The skin over rings one after the other, closed by a fan at both ends. */
function loft(rings: readonly Ring[]): Mesh {
  const n = rings[0].length;
  const faces: number[] = [];
  for (let k = 0; k + 1 < rings.length; k += 1) band(faces, k * n, (k + 1) * n, n);
  const last = (rings.length - 1) * n;
  for (let i = 1; i + 1 < n; i += 1) faces.push(0, i + 1, i);
  for (let i = 1; i + 1 < n; i += 1) faces.push(last, last + i, last + i + 1);
  return { vertices: flat(rings), faces: Uint32Array.from(faces) };
}

/** The skin over rings one after the other, and from the last back to the first. */
function torus(rings: readonly Ring[]): Mesh {
  const n = rings[0].length;
  const faces: number[] = [];
  for (let k = 0; k < rings.length; k += 1) band(faces, k * n, ((k + 1) % rings.length) * n, n);
  return { vertices: flat(rings), faces: Uint32Array.from(faces) };
}

function band(faces: number[], near: number, far: number, n: number): void {
  for (let i = 0; i < n; i += 1) {
    const j = (i + 1) % n;
    faces.push(near + i, near + j, far + j, near + i, far + j, far + i);
  }
}

/** A closed profile of (radius, height) turned about z. */
function lathe(profile: readonly Point[]): Mesh {
  return torus(
    profile.map(
      ([r, z]): Ring =>
        Array.from({ length: SIDES }, (_, i): Vec3 => {
          const angle = (2 * Math.PI * i) / SIDES;
          return [r * Math.cos(angle), r * Math.sin(angle), z];
        }),
    ),
  );
}

/** What was turned about z, with its axle across the link at (x, z). */
function across(turned: Mesh, x: number, z: number): Mesh {
  return moved(turned, [1, 0, 0], [0, 0, -1], [0, 1, 0], [x, 0, z]);
}

/** Each vertex (a, b, c) at origin + a x + b y + c z. */
function moved({ vertices, faces }: Mesh, x: Vec3, y: Vec3, z: Vec3, origin: Vec3): Mesh {
  const to = new Float64Array(vertices.length);
  for (let i = 0; i < vertices.length; i += 3)
    for (let k = 0; k < 3; k += 1)
      to[i + k] = origin[k] + vertices[i] * x[k] + vertices[i + 1] * y[k] + vertices[i + 2] * z[k];
  return { vertices: to, faces };
}

function insideOut({ vertices, faces }: Mesh): Mesh {
  const turned = new Uint32Array(faces.length);
  for (let i = 0; i < faces.length; i += 3) {
    turned[i] = faces[i + 2];
    turned[i + 1] = faces[i + 1];
    turned[i + 2] = faces[i];
  }
  return { vertices, faces: turned };
}

function atY(ring: readonly Point[], y: number): Ring {
  return ring.map(([x, z]): Vec3 => [x, y, z]);
}

function flat(rings: readonly Ring[]): Float64Array {
  return Float64Array.from(rings.flat(2) as number[]);
}

function cross(a: Vec3, b: Vec3): Vec3 {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
