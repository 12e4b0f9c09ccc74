// From the variables of a frame to what the operator reads, in engineering units; null where a variable is absent.
import type { ModelDescription } from "../rpc/messages";
import { type CraneAxis, craneAxes, endText } from "./axes";
import { ratedLoad } from "./crane";
import { BAR, DEGREE, GRAVITY, TONNE } from "./units";

export type Read = (name: string) => number | null;

export interface Readings {
  /** Position of each joint, in the order of the chain; slewing from 0 to 360 deg. */
  joints: readonly { axis: string; label: string; value: number | null; unit: "deg" | "m" }[];
  radius: number | null;
  hookHeight: number | null;
  load: number | null;
  rated: number | null;
  /** Load over rated load at this radius [%]: the load moment, since both act at the same radius. */
  utilisation: number | null;
  wireSpeed: number | null;
  pressures: readonly { label: string; piston: number | null; rod: number | null }[];
  limits: readonly string[];
  slack: boolean;
}

/** What the scene and the instruments need of a model. */
export type Described = Pick<ModelDescription, "axes" | "crane">;

/** Variables the scene and the instruments read. */
export function wanted(model: Described): string[] {
  const { crane } = model;
  return [
    ...crane.links.map(({ joint }) => `crane.${joint.name}`),
    ..."load.x load.y load.z tip.x tip.y tip.z rope.tension rope.unstretched_length rope.stretch radius hook_height drum.speed"
      .split(" ")
      .map((name) => `crane.${name}`),
    ...crane.cylinders.map(({ name }) => `crane.${name}.length`),
    ..."x y z qw qx qy qz".split(" ").map((name) => `ship.${name}`),
    ...linear(model).flatMap(({ name }) => [`${name}_drive.cylinder.pressure_a`, `${name}_drive.cylinder.pressure_b`]),
    ...craneAxes(model).map(({ name, joint }) => `joystick.spool.${joint ? name : "winch"}`),
  ];
}

/** The axes that cylinders move. */
function linear(model: Described): CraneAxis[] {
  return craneAxes(model).filter(({ name, joint }) => joint && name !== "slew");
}

const LIMITS: Readonly<Record<string, readonly [upper: string, lower: string]>> = {
  two_block: ["Hook close to the tip", "Hook close to the tip"],
  rope: ["Rope nearly all out", "Rope nearly all in"],
  slack: ["Slack rope: lowering stopped", "Slack rope: lowering stopped"],
};

/** What an active limit means to the operator; it has the sign of the side on which it holds back. */
export function limitText(axes: readonly CraneAxis[], name: string, side: number): string {
  const key = name.slice(name.lastIndexOf(".") + 1);
  const axis = axes.find(({ joint }) => joint?.name === key);
  if (axis) return endText(axis, side);
  const known = LIMITS[key];
  if (known) return known[side > 0 ? 0 : 1];
  return key[0].toUpperCase() + key.slice(1).replaceAll("_", " ");
}

export function readings(model: Described, read: Read, limitNames: readonly string[]): Readings {
  const { crane } = model;
  const axes = craneAxes(model);
  const scaled = (name: string, factor: number) => {
    const value = read(name);
    return value === null ? null : value / factor;
  };
  const tension = read("crane.rope.tension");
  const load = tension === null ? null : tension / GRAVITY / TONNE;
  const radius = read("crane.radius");
  const rated = radius === null ? null : ratedLoad(crane, radius);
  const drumSpeed = read("crane.drum.speed");
  return {
    joints: axes.flatMap(({ name, joint, label }) => {
      if (!joint) return [];
      const turns = joint.kind === "revolute";
      const value = scaled(`crane.${joint.name}`, turns ? DEGREE : 1);
      const shown = value !== null && name === "slew" ? ((value % 360) + 360) % 360 : value;
      return [{ axis: name, label, value: shown, unit: turns ? ("deg" as const) : ("m" as const) }];
    }),
    radius,
    hookHeight: read("crane.hook_height"),
    load,
    rated: rated === null ? null : rated / TONNE,
    utilisation: load === null || !rated ? null : (100 * load * TONNE) / rated,
    wireSpeed: drumSpeed === null ? null : drumSpeed * crane.hoist.drum_radius,
    pressures: linear(model).map(({ name }) => ({
      label: name,
      piston: scaled(`${name}_drive.cylinder.pressure_a`, BAR),
      rod: scaled(`${name}_drive.cylinder.pressure_b`, BAR),
    })),
    limits: limitNames.flatMap((name) => {
      const side = read(name);
      return side ? [limitText(axes, name, side)] : [];
    }),
    slack: tension !== null && tension <= 0,
  };
}
