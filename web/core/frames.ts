// Rigid frames: rotation (row-major 3 x 3) and origin. Right-handed, SI.
import type { Vec3 } from "../rpc/messages";

export type Matrix3 = readonly [number, number, number, number, number, number, number, number, number];

/** Pose of a frame: a point `r` in it is at `R r + p` in the frame it is given in. */
export interface Frame {
  readonly R: Matrix3;
  readonly p: Vec3;
}

export const IDENTITY: Frame = { R: [1, 0, 0, 0, 1, 0, 0, 0, 1], p: [0, 0, 0] };

/** Rotation by `angle` about a unit `axis` (Rodrigues). */
export function rotation(axis: Vec3, angle: number): Matrix3 {
  const [x, y, z] = axis;
  const c = Math.cos(angle);
  const s = Math.sin(angle);
  const v = 1 - c;
  return [
    c + x * x * v,
    x * y * v - z * s,
    x * z * v + y * s,
    y * x * v + z * s,
    c + y * y * v,
    y * z * v - x * s,
    z * x * v - y * s,
    z * y * v + x * s,
    c + z * z * v,
  ];
}

/** Rotation matrix of a quaternion, scaled to unit length first; the identity for the zero quaternion. */
export function fromQuaternion(w: number, x: number, y: number, z: number): Matrix3 {
  const n = w * w + x * x + y * y + z * z;
  if (!(n > 0)) return IDENTITY.R;
  const s = 2 / n;
  return [
    1 - s * (y * y + z * z),
    s * (x * y - w * z),
    s * (x * z + w * y),
    s * (x * y + w * z),
    1 - s * (x * x + z * z),
    s * (y * z - w * x),
    s * (x * z - w * y),
    s * (y * z + w * x),
    1 - s * (x * x + y * y),
  ];
}

export function rotate(R: Matrix3, v: Vec3): Vec3 {
  return [
    R[0] * v[0] + R[1] * v[1] + R[2] * v[2],
    R[3] * v[0] + R[4] * v[1] + R[5] * v[2],
    R[6] * v[0] + R[7] * v[1] + R[8] * v[2],
  ];
}

export function apply(frame: Frame, point: Vec3): Vec3 {
  const [x, y, z] = rotate(frame.R, point);
  return [x + frame.p[0], y + frame.p[1], z + frame.p[2]];
}

/** The point of the parent frame, seen in `frame`. */
export function unapply(frame: Frame, point: Vec3): Vec3 {
  const { R, p } = frame;
  const d: Vec3 = [point[0] - p[0], point[1] - p[1], point[2] - p[2]];
  return rotate([R[0], R[3], R[6], R[1], R[4], R[7], R[2], R[5], R[8]], d);
}

export function compose(a: Frame, b: Frame): Frame {
  const A = a.R;
  const B = b.R;
  const entry = (i: number, j: number) => A[3 * i] * B[j] + A[3 * i + 1] * B[3 + j] + A[3 * i + 2] * B[6 + j];
  return {
    R: [
      entry(0, 0),
      entry(0, 1),
      entry(0, 2),
      entry(1, 0),
      entry(1, 1),
      entry(1, 2),
      entry(2, 0),
      entry(2, 1),
      entry(2, 2),
    ],
    p: apply(a, b.p),
  };
}

export function distance(a: Vec3, b: Vec3): number {
  return Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}
