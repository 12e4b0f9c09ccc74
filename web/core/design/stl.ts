import type { Mesh } from "./mesh";

const HEADER = 80;
const TRIANGLE = 50;

/** Meshes as one binary STL, in metres with z up. */
export function stl(meshes: readonly Mesh[]): ArrayBuffer {
  const count = meshes.reduce((sum, { faces }) => sum + faces.length / 3, 0);
  const buffer = new ArrayBuffer(HEADER + 4 + TRIANGLE * count);
  const view = new DataView(buffer);
  view.setUint32(HEADER, count, true);
  let at = HEADER + 4;
  for (const { vertices, faces } of meshes)
    for (let i = 0; i < faces.length; i += 3) {
      const [a, b, c] = [0, 1, 2].map((k) => vertices.subarray(3 * faces[i + k], 3 * faces[i + k] + 3));
      const [ux, uy, uz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
      const [vx, vy, vz] = [c[0] - a[0], c[1] - a[1], c[2] - a[2]];
      const normal = [uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx];
      const size = Math.hypot(...normal) || 1;
      const values = [...normal.map((value) => value / size), ...a, ...b, ...c];
      for (let k = 0; k < 12; k += 1) view.setFloat32(at + 4 * k, values[k], true);
      at += TRIANGLE;
    }
  return buffer;
}
