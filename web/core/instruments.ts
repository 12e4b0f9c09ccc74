// From the variables of a frame to what the operator reads, in engineering units; null where a variable is absent.
import type { CraneDesign } from "../rpc/messages";
import { ratedLoad } from "./crane";
import { BAR, DEGREE, GRAVITY, TONNE } from "./units";

export type Read = (name: string) => number | null;

export interface Readings {
  slew: number | null;
  boom: number | null;
  jib: number | null;
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

/** Variables the scene and the instruments read. */
export function wanted(crane: CraneDesign): string[] {
  return [
    ...crane.links.map(({ joint }) => `crane.${joint.name}`),
    ..."load.x load.y load.z tip.x tip.y tip.z rope.tension rope.unstretched_length rope.stretch radius hook_height drum.speed"
      .split(" ")
      .map((name) => `crane.${name}`),
    ...crane.cylinders.map(({ name }) => `crane.${name}.length`),
    ..."x y z qw qx qy qz".split(" ").map((name) => `ship.${name}`),
    ...drives(crane).flatMap(({ drive }) => [`${drive}.cylinder.pressure_a`, `${drive}.cylinder.pressure_b`]),
    ..."slew boom jib winch".split(" ").map((name) => `joystick.spool.${name}`),
  ];
}

function drives(crane: CraneDesign): { label: string; drive: string }[] {
  return crane.cylinders.map(({ name }) => {
    const label = name.replace(/_cylinder$/, "");
    return { label, drive: `${label}_drive` };
  });
}

const LIMITS: Readonly<Record<string, readonly [upper: string, lower: string]>> = {
  luff: ["Boom at its upper end", "Boom at its lower end"],
  jib: ["Jib at its outer end", "Jib at its inner end"],
  two_block: ["Hook close to the jib head", "Hook close to the jib head"],
  rope: ["Rope nearly all out", "Rope nearly all in"],
  slack: ["Slack rope: lowering stopped", "Slack rope: lowering stopped"],
};

/** What an active limit means to the operator; it has the sign of the side on which it holds back. */
export function limitText(name: string, side: number): string {
  const key = name.slice(name.lastIndexOf(".") + 1);
  const known = LIMITS[key];
  if (known) return known[side > 0 ? 0 : 1];
  return key[0].toUpperCase() + key.slice(1).replaceAll("_", " ");
}

export function readings(crane: CraneDesign, read: Read, limitNames: readonly string[]): Readings {
  const scaled = (name: string, factor: number) => {
    const value = read(name);
    return value === null ? null : value / factor;
  };
  const tension = read("crane.rope.tension");
  const load = tension === null ? null : tension / GRAVITY / TONNE;
  const radius = read("crane.radius");
  const rated = radius === null ? null : ratedLoad(crane, radius);
  const drumSpeed = read("crane.drum.speed");
  const slew = scaled("crane.slew", DEGREE);
  return {
    slew: slew === null ? null : ((slew % 360) + 360) % 360,
    boom: scaled("crane.luff", DEGREE),
    jib: scaled("crane.jib", DEGREE),
    radius,
    hookHeight: read("crane.hook_height"),
    load,
    rated: rated === null ? null : rated / TONNE,
    utilisation: load === null || !rated ? null : (100 * load * TONNE) / rated,
    wireSpeed: drumSpeed === null ? null : drumSpeed * crane.hoist.drum_radius,
    pressures: drives(crane).map(({ label, drive }) => ({
      label,
      piston: scaled(`${drive}.cylinder.pressure_a`, BAR),
      rod: scaled(`${drive}.cylinder.pressure_b`, BAR),
    })),
    limits: limitNames.flatMap((name) => {
      const side = read(name);
      return side ? [limitText(name, side)] : [];
    }),
    slack: tension !== null && tension <= 0,
  };
}
