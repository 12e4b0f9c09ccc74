// How far the eye must be to see all of a box.
import { type Box3, Vector3 } from "three";

export const FIELD = 32;

const MARGIN = 1.08;

/** The distance of the eye from the middle of a box, `towards` which it stands, that shows all of it in a picture. */
export function distanceToSee(box: Box3, towards: Vector3, aspect: number): number {
  const middle = box.getCenter(new Vector3());
  const across = new Vector3(0, 0, 1).cross(towards).normalize();
  const up = towards.clone().cross(across);
  const half = Math.tan((0.5 * FIELD * Math.PI) / 180);
  let away = 0;
  for (let corner = 0; corner < 8; corner += 1) {
    const from = new Vector3(
      corner & 1 ? box.max.x : box.min.x,
      corner & 2 ? box.max.y : box.min.y,
      corner & 4 ? box.max.z : box.min.z,
    ).sub(middle);
    const wide = Math.abs(from.dot(across)) / (half * aspect);
    const high = Math.abs(from.dot(up)) / half;
    away = Math.max(away, from.dot(towards) + MARGIN * Math.max(wide, high));
  }
  return away;
}
