// Mass, centre and inertia of parts and links from the volume that their meshes enclose; as src/seacrane/design/mass.py.
import type { Vec3 } from "../../rpc/messages";
import { type Mesh, mesh } from "./mesh";
import { type Crane, type Link, type Part, STEEL } from "./types";

export interface MassProperties {
  /** [kg] */
  readonly mass: number;
  /** [m] */
  readonly centre: Vec3;
  /** About the centre: xx, yy, zz, xy, xz, yz of the inertia matrix [kg.m2]. */
  readonly inertia: readonly [number, number, number, number, number, number];
}

export function ofMesh({ vertices, faces }: Mesh, density: number): MassProperties {
  const pass = (origin: Vec3) => {
    let volume = 0;
    const first = [0, 0, 0];
    const second = [0, 0, 0, 0, 0, 0];
    const p = [new Float64Array(3), new Float64Array(3), new Float64Array(3), new Float64Array(3)];
    for (let f = 0; f < faces.length; f += 3) {
      for (let corner = 0; corner < 3; corner += 1)
        for (let k = 0; k < 3; k += 1) p[corner][k] = vertices[3 * faces[f + corner] + k] - origin[k];
      const [a, b, c] = p;
      const v =
        (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])) /
        6;
      volume += v;
      for (let k = 0; k < 3; k += 1) {
        p[3][k] = a[k] + b[k] + c[k];
        first[k] += (v * p[3][k]) / 4;
      }
      for (const q of p) {
        second[0] += (v * q[0] * q[0]) / 20;
        second[1] += (v * q[1] * q[1]) / 20;
        second[2] += (v * q[2] * q[2]) / 20;
        second[3] += (v * q[0] * q[1]) / 20;
        second[4] += (v * q[0] * q[2]) / 20;
        second[5] += (v * q[1] * q[2]) / 20;
      }
    }
    return { volume, first, second };
  };
  const rough = pass([0, 0, 0]);
  const centre = rough.first.map((moment) => moment / rough.volume) as unknown as Vec3;
  const { volume, second } = pass(centre);
  const [xx, yy, zz, xy, xz, yz] = second.map((value) => density * value);
  return { mass: density * volume, centre, inertia: [yy + zz, xx + zz, xx + yy, -xy, -xz, -yz] };
}

const known = new WeakMap<Part, MassProperties>();

export function ofPart(part: Part): MassProperties {
  const found = known.get(part) ?? ofMesh(mesh(part), part.density ?? STEEL);
  known.set(part, found);
  return found;
}

/** Several bodies fixed to each other as one; at least one. */
export function combined(bodies: readonly MassProperties[]): MassProperties {
  const mass = bodies.reduce((sum, body) => sum + body.mass, 0);
  const centre = [0, 1, 2].map((k) => bodies.reduce((sum, body) => sum + body.mass * body.centre[k], 0) / mass);
  const inertia = [0, 0, 0, 0, 0, 0];
  for (const body of bodies) {
    const [x, y, z] = body.centre.map((value, k) => value - centre[k]);
    const shift = [y * y + z * z, x * x + z * z, x * x + y * y, -x * y, -x * z, -y * z];
    for (let k = 0; k < 6; k += 1) inertia[k] += body.inertia[k] + body.mass * shift[k];
  }
  return {
    mass,
    centre: centre as unknown as Vec3,
    inertia: inertia as unknown as MassProperties["inertia"],
  };
}

/** Of the parts of a link together; a link without parts has those that the design gives it. */
export function ofLink(link: Link): MassProperties {
  if (link.parts?.length) return combined(link.parts.map(ofPart));
  const [xx, yy, zz] = link.inertia;
  return { mass: link.mass, centre: link.com, inertia: [xx, yy, zz, 0, 0, 0] };
}

/** The crane with mass, centre and moments of inertia of each link taken from its parts, where it has any. */
export function weighed(crane: Crane): Crane {
  return {
    ...crane,
    links: crane.links.map((link) => {
      if (!link.parts?.length) return link;
      const { mass, centre, inertia } = ofLink(link);
      return { ...link, mass, com: centre, inertia: [inertia[0], inertia[1], inertia[2]] };
    }),
  };
}
