// Where the links, pins and centre of mass of a crane are in a posture, in the axes of its foot.
import { Quaternion, Vector3 } from "three";
import type { Posture } from "../../core/design/plane";
import { type Attachment, type Crane, FOOT } from "../../core/design/types";

export interface Place {
  readonly at: Vector3;
  readonly turn: Quaternion;
}

/** The frames of the links, and of the foot. */
export function places(crane: Crane, posture: Posture): Map<string, Place> {
  let now: Place = { at: new Vector3(), turn: new Quaternion() };
  const found = new Map([[FOOT, now]]);
  for (const { name, joint } of crane.links) {
    const q = posture[joint.name] ?? 0;
    const axis = new Vector3(...joint.axis).normalize();
    const at = new Vector3(...joint.origin).applyQuaternion(now.turn).add(now.at);
    now =
      joint.kind === "revolute"
        ? { at, turn: now.turn.clone().multiply(new Quaternion().setFromAxisAngle(axis, q)) }
        : { at: at.add(axis.multiplyScalar(q).applyQuaternion(now.turn)), turn: now.turn };
    found.set(name, now);
  }
  return found;
}

/** A point fixed to a link. */
export interface Mark {
  readonly link: string;
  /** In the link's frame [m]. */
  readonly local: readonly [number, number, number];
  readonly name: string;
}

export function placed(at: ReadonlyMap<string, Place>, { link, local }: Pick<Mark, "link" | "local">): Vector3 {
  const { at: origin, turn } = at.get(link) ?? at.get(FOOT)!;
  return new Vector3(...local).applyQuaternion(turn).add(origin);
}

/** What distances are wanted between: joints, pins of the cylinders, drum, sheaves and tip. */
export function marks(crane: Crane): Mark[] {
  const pin = (name: string, { link, x, z }: Attachment): Mark => ({ link, local: [x, 0, z], name });
  const { drum, sheaves } = crane.hoist;
  return [
    ...crane.links.map(({ name, joint }): Mark => ({ link: name, local: [0, 0, 0], name: `joint ${joint.name}` })),
    ...crane.cylinders.flatMap(({ name, base, eye }) => [pin(`${name} base`, base), pin(`${name} eye`, eye)]),
    pin("drum", drum),
    ...sheaves.slice(0, -1).map((sheave, i) => pin(`sheave ${i + 1}`, sheave)),
    pin("tip", sheaves[sheaves.length - 1]),
  ];
}

/** Centre of mass of all links [m]. */
export function wholeCentre(crane: Crane, at: ReadonlyMap<string, Place>): Vector3 {
  const sum = new Vector3();
  let mass = 0;
  for (const link of crane.links) {
    sum.addScaledVector(placed(at, { link: link.name, local: link.com }), link.mass);
    mass += link.mass;
  }
  return sum.divideScalar(mass);
}
