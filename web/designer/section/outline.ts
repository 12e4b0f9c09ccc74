// Parts as seen from the side, in the plane of their link.
import { mesh } from "../../core/design/mesh";
import type { Point } from "../../core/design/plane";
import type { Imported, Part } from "../../core/design/types";

export interface Outline {
  readonly points: readonly Point[];
  /** A round one instead: [x, z, radius]. */
  readonly circle?: readonly [number, number, number];
}

/** The silhouette of a part, what is in front last. */
export function outline(part: Part): Outline[] {
  switch (part.kind) {
    case "girder": {
      const top = part.stations.map(({ x, top }): Point => [x, top]);
      const bottom = part.stations.map(({ x, bottom }): Point => [x, bottom]).reverse();
      return [{ points: [...top, ...bottom] }];
    }
    case "tube": {
      const [a, b] = [part.start, part.end];
      const [dx, dz] = [b[0] - a[0], b[2] - a[2]];
      const length = Math.hypot(dx, dz);
      if (length < 1e-6) return [round(a[0], a[2], 0.5 * Math.max(part.diameter, part.end_diameter))];
      const [nx, nz] = [-dz / length, dx / length];
      const [ra, rb] = [0.5 * part.diameter, 0.5 * part.end_diameter];
      return [
        {
          points: [
            [a[0] + nx * ra, a[2] + nz * ra],
            [b[0] + nx * rb, b[2] + nz * rb],
            [b[0] - nx * rb, b[2] - nz * rb],
            [a[0] - nx * ra, a[2] - nz * ra],
          ],
        },
      ];
    }
    case "lug": {
      const [dx, dz] = [part.x - part.root_x, part.z - part.root_z];
      const length = Math.hypot(dx, dz) || 1;
      const [nx, nz] = [-dz / length, dx / length];
      const [w, r] = [0.5 * part.root_width, part.radius];
      return [
        {
          points: [
            [part.root_x + nx * w, part.root_z + nz * w],
            [part.x + nx * r, part.z + nz * r],
            [part.x - nx * r, part.z - nz * r],
            [part.root_x - nx * w, part.root_z - nz * w],
          ],
        },
        round(part.x, part.z, r),
      ];
    }
    case "sheave":
      return [round(part.x, part.z, part.radius), round(part.x, part.z, part.radius - part.groove)];
    case "drum":
      return [round(part.x, part.z, part.flange), round(part.x, part.z, part.radius)];
    case "mesh":
      return [{ points: hullOf(part) }];
    case "box": {
      const [x, , z] = part.centre;
      const [w, h] = [0.5 * part.size[0], 0.5 * part.size[2]];
      return [
        {
          points: [
            [x - w, z - h],
            [x + w, z - h],
            [x + w, z + h],
            [x - w, z + h],
          ],
        },
      ];
    }
  }
}

function round(x: number, z: number, radius: number): Outline {
  return { points: [], circle: [x, z, Math.max(radius, 0)] };
}

const hulls = new WeakMap<Imported, Point[]>();

/** Made once for each mesh: it is drawn in every frame. */
function hullOf(part: Imported): Point[] {
  const found = hulls.get(part) ?? hull(mesh(part).vertices);
  hulls.set(part, found);
  return found;
}

/** The convex hull of vertices seen along y (monotone chain). */
function hull(vertices: Float64Array): Point[] {
  const points: Point[] = [];
  for (let i = 0; i < vertices.length; i += 3) points.push([vertices[i], vertices[i + 2]]);
  points.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (sorted: readonly Point[]) => {
    const chain: Point[] = [];
    for (const p of sorted) {
      while (chain.length > 1) {
        const [a, b] = chain.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        chain.pop();
      }
      chain.push(p);
    }
    return chain.slice(0, -1);
  };
  return [...half(points), ...half([...points].reverse())];
}
