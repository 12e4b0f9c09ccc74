// What can be dragged in the drawing: where each handle is, what it is called, and what it says of its value.
import type { Handle, Scene } from "../../core/design/edit";
import { endOf } from "../../core/design/length";
import { frames, outOf, type Point, pin } from "../../core/design/plane";
import { fixed } from "../../core/units";

export interface Grip {
  readonly key: string;
  readonly handle: Handle;
  /** In the crane's plane [m]. */
  readonly at: Point;
  readonly label: string;
  readonly value: string;
  /** The value as one number, for assistive technology. */
  readonly now: number;
}

const degrees = (value: number) => `${fixed((value * 180) / Math.PI, 1)}\u00b0`;
const metres = (value: number) => `${fixed(value, 2)} m`;
const place = (x: number, z: number) => `x ${metres(x)}, z ${metres(z)}`;

/** The handles of a crane in its posture, in the order of the tabulator; `arc` is the radius of the limits' arcs [m]. */
export function grips({ crane, posture }: Scene, arc: (link: number) => number): Grip[] {
  const at = frames(crane, posture);
  const found: Grip[] = [];
  crane.links.forEach((link, index) => {
    const { joint } = link;
    const pose = at.get(link.name)!;
    const [ex, ez] = endOf(crane, index);
    const turns = joint.kind === "revolute";
    if (joint.name !== crane.slew?.joint) {
      const q = posture[joint.name] ?? 0;
      found.push({
        key: `joint-${link.name}`,
        handle: { kind: "joint", link: index },
        at: outOf(
          pose,
          ...(turns ? ([0.55 * ex, 0.55 * ez] as const) : ([ex - 0.35 * Math.abs(ex || 3), ez] as const)),
        ),
        label: `${joint.name}: posture`,
        value: turns ? degrees(q) : metres(q),
        now: turns ? (q * 180) / Math.PI : q,
      });
      for (const end of [0, 1] as const) {
        const value = joint.limits?.[end];
        if (value === undefined) continue;
        const there = frames(crane, { ...posture, [joint.name]: value }).get(link.name)!;
        found.push({
          key: `limit-${link.name}-${end}`,
          handle: { kind: "limit", link: index, end },
          at: turns ? outOf(there, arc(index), 0) : outOf(there, ex, ez),
          label: `${joint.name}: ${end === 0 ? "lower" : "upper"} limit`,
          value: turns ? degrees(value) : metres(value),
          now: turns ? (value * 180) / Math.PI : value,
        });
      }
    }
  });
  crane.cylinders.forEach((cylinder, index) => {
    for (const end of ["base", "eye"] as const)
      found.push({
        key: `pin-${cylinder.name}-${end}`,
        handle: { kind: "pin", cylinder: index, end },
        at: pin(at, cylinder[end]),
        label: `${cylinder.name}: ${end} pin on ${cylinder[end].link}`,
        value: place(cylinder[end].x, cylinder[end].z),
        now: cylinder[end].x,
      });
  });
  crane.hoist.sheaves.slice(0, -1).forEach((sheave, index) => {
    found.push({
      key: `sheave-${index}`,
      handle: { kind: "sheave", index },
      at: pin(at, sheave),
      label: `sheave ${index + 1} on ${sheave.link}`,
      value: place(sheave.x, sheave.z),
      now: sheave.x,
    });
  });
  const { drum } = crane.hoist;
  found.push({
    key: "drum",
    handle: { kind: "drum" },
    at: pin(at, drum),
    label: `drum on ${drum.link}`,
    value: place(drum.x, drum.z),
    now: drum.x,
  });
  // over the sheaves, which often are where a link ends
  crane.links.forEach((link, index) => {
    const [x, z] = endOf(crane, index);
    const next = crane.links[index + 1];
    found.push({
      key: `end-${link.name}`,
      handle: { kind: "end", link: index },
      at: outOf(at.get(link.name)!, x, z),
      label: next ? `${link.name}: end, joint ${next.joint.name}` : `${link.name}: tip`,
      value: `${place(x, z)}, length ${metres(Math.hypot(x, z))}`,
      now: Math.hypot(x, z),
    });
  });
  return found;
}
