// Meshes of parts, cylinders and the workspace for three.js; all in metres, z up.
import { BufferAttribute, BufferGeometry } from "three";
import { type Mesh, mesh } from "../../core/design/mesh";
import type { Part } from "../../core/design/types";

const kept = new WeakMap<Part, BufferGeometry>();

/** The mesh of a part, kept as long as the part is. */
export function shapeOf(part: Part): BufferGeometry {
  const known = kept.get(part);
  if (known) return known;
  const made = geometry(mesh(part));
  kept.set(part, made);
  return made;
}

function geometry({ vertices, faces }: Mesh): BufferGeometry {
  const shape = new BufferGeometry();
  const at = new Float32Array(3 * faces.length);
  faces.forEach((vertex, i) => {
    at.set(vertices.subarray(3 * vertex, 3 * vertex + 3), 3 * i);
  });
  shape.setAttribute("position", new BufferAttribute(at, 3));
  shape.computeVertexNormals();
  return shape;
}

const SLICES = 72;

/** Segments of the plane turned about the vertical from `start` by `turn` [rad]. */
export function revolved(segments: Float32Array, start: number, turn: number): BufferGeometry {
  const slices = Math.max(2, Math.ceil((SLICES * turn) / (2 * Math.PI)));
  const count = segments.length / 4;
  const at = new Float32Array(count * slices * 18);
  let k = 0;
  const put = (x: number, z: number, c: number, s: number) => {
    at[k] = x * c;
    at[k + 1] = x * s;
    at[k + 2] = z;
    k += 3;
  };
  for (let j = 0; j < slices; j += 1) {
    const [a, b] = [start + (turn * j) / slices, start + (turn * (j + 1)) / slices];
    const [ca, sa, cb, sb] = [Math.cos(a), Math.sin(a), Math.cos(b), Math.sin(b)];
    for (let i = 0; i < segments.length; i += 4) {
      const [x0, z0, x1, z1] = segments.subarray(i, i + 4);
      put(x0, z0, ca, sa);
      put(x1, z1, ca, sa);
      put(x1, z1, cb, sb);
      put(x0, z0, ca, sa);
      put(x1, z1, cb, sb);
      put(x0, z0, cb, sb);
    }
  }
  const shape = new BufferGeometry();
  shape.setAttribute("position", new BufferAttribute(at, 3));
  shape.computeVertexNormals();
  return shape;
}
