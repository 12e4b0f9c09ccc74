import { BufferAttribute, BufferGeometry, ExtrudeGeometry, Float32BufferAttribute, Shape, Vector2 } from "three";
import { mergeVertices, toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
import type { Point2, Triangles } from "../../core/solids";

/** Flat-shaded, or with edges sharper than `crease` [rad] kept and the rest smooth. */
export function solid(triangles: Triangles, crease = 0): BufferGeometry {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(triangles.corners, 3));
  if (crease === 0) {
    geometry.computeVertexNormals();
    return geometry;
  }
  const joined = mergeVertices(geometry, 1e-4);
  return toCreasedNormals(joined, crease);
}

/** A plate cut to an outline in the plane of the crane (x along, z up), its thickness along y about y = 0. */
export function plate(outline: readonly Point2[], thickness: number): BufferGeometry {
  const shape = new Shape();
  shape.setFromPoints(outline.map(([x, z]) => new Vector2(x, z)));
  const bevel = Math.min(0.02, thickness / 4);
  const geometry = new ExtrudeGeometry(shape, {
    depth: thickness - 2 * bevel,
    bevelEnabled: true,
    bevelThickness: bevel,
    bevelSize: bevel,
    bevelSegments: 1,
  });
  geometry.translate(0, 0, -(thickness - 2 * bevel) / 2);
  geometry.rotateX(Math.PI / 2);
  return geometry;
}

/** A round tube along a polyline that is set anew each frame; `most` points at the most. */
export class Tube {
  readonly geometry = new BufferGeometry();
  private readonly positions: Float32Array;
  private readonly normals: Float32Array;

  constructor(
    private readonly most: number,
    private readonly sides = 6,
  ) {
    this.positions = new Float32Array(most * sides * 3);
    this.normals = new Float32Array(most * sides * 3);
    const index: number[] = [];
    for (let i = 0; i + 1 < most; i += 1) {
      for (let s = 0; s < sides; s += 1) {
        const [a, b] = [i * sides + s, i * sides + ((s + 1) % sides)];
        index.push(a, b, a + sides, b, b + sides, a + sides);
      }
    }
    this.geometry.setIndex(index);
    this.geometry.setAttribute("position", new BufferAttribute(this.positions, 3));
    this.geometry.setAttribute("normal", new BufferAttribute(this.normals, 3));
  }

  set(points: readonly (readonly [number, number, number])[], radius: number): void {
    const count = Math.min(points.length, this.most);
    const { sides } = this;
    for (let i = 0; i < count; i += 1) {
      const p = points[i];
      const [a, b] = [points[Math.max(0, i - 1)], points[Math.min(count - 1, i + 1)]];
      let [tx, ty, tz] = [b[0] - a[0], b[1] - a[1], b[2] - a[2]];
      const size = Math.hypot(tx, ty, tz) || 1;
      [tx, ty, tz] = [tx / size, ty / size, tz / size];
      // Two directions across the rope: from y, which it seldom follows, or from x where it does.
      const alongY = Math.abs(ty) > 0.9;
      let [ux, uy, uz] = alongY ? [0, tz, -ty] : [-tz, 0, tx];
      const across = Math.hypot(ux, uy, uz) || 1;
      [ux, uy, uz] = [ux / across, uy / across, uz / across];
      const [vx, vy, vz] = [ty * uz - tz * uy, tz * ux - tx * uz, tx * uy - ty * ux];
      for (let s = 0; s < sides; s += 1) {
        const angle = (2 * Math.PI * s) / sides;
        const [c, d] = [Math.cos(angle), Math.sin(angle)];
        const at = 3 * (i * sides + s);
        const n = [c * ux + d * vx, c * uy + d * vy, c * uz + d * vz];
        for (let k = 0; k < 3; k += 1) {
          this.normals[at + k] = n[k];
          this.positions[at + k] = p[k] + radius * n[k];
        }
      }
    }
    this.geometry.setDrawRange(0, Math.max(0, count - 1) * sides * 6);
    this.geometry.attributes.position.needsUpdate = true;
    this.geometry.attributes.normal.needsUpdate = true;
  }
}
