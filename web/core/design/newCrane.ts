// A crane to begin with: a ready one in another size, for the reach and the load that are wanted, in round numbers.
import { problems } from "./check";
import { withoutLink, withStroke } from "./edit";
import { cylinderLengths } from "./plane";
import { furthestLoad, ratedByChart } from "./rated";
import type { Attachment, Crane, Cylinder } from "./types";

/**
 * The crane in another size: lengths by s, forces by k, and with them areas; masses and moments by k s. With k = s^2 it is
 * geometrically similar. In one size, all that it lifts in harbour goes with k.
 */
export function scaled(crane: Crane, s: number, k = s ** 2): Crane {
  const lengths = (point: readonly number[]) => point.map((value) => value * s);
  const at = (pin: Attachment): Attachment => ({ ...pin, x: pin.x * s, z: pin.z * s });
  const by = (value: number | null | undefined, factor: number) => (value == null ? value : value * factor);
  const across = Math.sqrt(k);
  const { hoist, rating } = crane;
  return JSON.parse(
    JSON.stringify({
      ...crane,
      links: crane.links.map((link) => ({
        ...link,
        parts: undefined,
        joint: {
          ...link.joint,
          origin: lengths(link.joint.origin),
          limits: link.joint.kind === "prismatic" && link.joint.limits ? lengths(link.joint.limits) : link.joint.limits,
        },
        mass: link.mass * k * s,
        com: lengths(link.com),
        inertia: link.inertia.map((value) => value * k * s ** 3),
      })),
      cylinders: crane.cylinders.map((item) => ({
        ...item,
        bore: item.bore * across,
        rod: item.rod * across,
        stroke: item.stroke * s,
        retracted: by(item.retracted, s),
        base: at(item.base),
        eye: at(item.eye),
      })),
      hoist: {
        ...hoist,
        drum: at(hoist.drum),
        drum_radius: hoist.drum_radius * s,
        sheaves: hoist.sheaves.map(at),
        line_pull: by(hoist.line_pull, k),
        hook_mass: by(hoist.hook_mass, k),
        rope: {
          ...hoist.rope,
          diameter: hoist.rope.diameter * across,
          EA: hoist.rope.EA * k,
          mass_per_length: hoist.rope.mass_per_length * k,
          breaking_load: by(hoist.rope.breaking_load, k),
        },
      },
      rating: rating && {
        ...rating,
        slew_moment: by(rating.slew_moment, k * s),
        slew_torque: by(rating.slew_torque, k * s),
        load_moment: by(rating.load_moment, k * s),
        heeling_moment: by(rating.heeling_moment, k * s),
        structure: rating.structure?.map((item) => ({ ...item, moment: item.moment * k * s })),
      },
      capacity: crane.capacity.map(({ radius, mass }) => ({ radius: radius * s, mass: mass * k })),
      sources: [
        {
          of: "all numbers",
          kind: "derived",
          note: `${crane.name}, lengths scaled by ${s.toPrecision(4)}, forces by ${k.toPrecision(4)}`,
        },
      ],
    }),
  );
}

/** The column and the boom of a crane alone. */
export function bare(crane: Crane): Crane {
  let short = crane;
  while (short.links.length > 2) short = withoutLink(short, short.links.length - 1)!;
  return short;
}

/**
 * A crane like another, scaled by s, that lifts `load` [kg] at its largest radius in harbour; without a load, of
 * geometrically similar strength. Sizes are rounded as they are drawn, strengths upwards, and it is rated by its chart.
 */
export function newCrane(like: Crane, s: number, load?: number): Crane {
  const similar = scaled(like, s);
  const lifts = furthestLoad(similar)?.mass;
  const wanted = load !== undefined && lifts ? scaled(like, s, (s ** 2 * load) / lifts) : similar;
  const crane = fitted(rounded(wanted));
  return { ...crane, capacity: ratedByChart(crane) };
}

const CENTIMETRE = 0.01;
const BORES = 0.005;

const to = (step: number) => (value: number) => Number((Math.round(value / step) * step).toPrecision(10));
const up = (step: number) => (value: number) => Number((Math.ceil(value / step - 1e-9) * step).toPrecision(10));
const place = to(CENTIMETRE);
const digits = (value: number) => Number(value.toPrecision(3));
const upDigits = (value: number) => up(10 ** (Math.floor(Math.log10(value)) - 2))(value);

function rounded(crane: Crane): Crane {
  const at = (pin: Attachment): Attachment => ({ ...pin, x: place(pin.x), z: place(pin.z) });
  const some = (value: number | null | undefined, round: (value: number) => number) =>
    value == null ? value : round(value);
  const { hoist, rating } = crane;
  const { rope } = hoist;
  return {
    ...crane,
    links: crane.links.map((link) => ({
      ...link,
      joint: {
        ...link.joint,
        origin: [place(link.joint.origin[0]), place(link.joint.origin[1]), place(link.joint.origin[2])],
        limits:
          link.joint.kind === "prismatic" && link.joint.limits
            ? [place(link.joint.limits[0]), place(link.joint.limits[1])]
            : link.joint.limits,
      },
      mass: digits(link.mass),
      com: [place(link.com[0]), place(link.com[1]), place(link.com[2])],
      inertia: [digits(link.inertia[0]), digits(link.inertia[1]), digits(link.inertia[2])],
    })),
    cylinders: crane.cylinders.map((item) => {
      const bore = up(BORES)(item.bore);
      return {
        ...item,
        bore,
        rod: Math.min(Math.max(to(BORES)(item.rod), BORES), bore - BORES),
        stroke: up(CENTIMETRE)(item.stroke),
        retracted: some(item.retracted, place),
        base: at(item.base),
        eye: at(item.eye),
      };
    }),
    hoist: {
      ...hoist,
      drum: at(hoist.drum),
      drum_radius: up(CENTIMETRE)(hoist.drum_radius),
      sheaves: hoist.sheaves.map(at),
      line_pull: some(hoist.line_pull, upDigits),
      hook_mass: hoist.hook_mass ? digits(hoist.hook_mass) : hoist.hook_mass,
      rope: {
        ...rope,
        diameter: up(0.001)(rope.diameter),
        EA: digits(rope.EA),
        mass_per_length: digits(rope.mass_per_length),
        breaking_load: some(rope.breaking_load, upDigits),
      },
    },
    rating: rating && {
      ...rating,
      slew_moment: some(rating.slew_moment, upDigits),
      slew_torque: some(rating.slew_torque, upDigits),
      load_moment: some(rating.load_moment, upDigits),
      heeling_moment: some(rating.heeling_moment, upDigits),
      structure: rating.structure?.map((item) => ({ ...item, moment: upDigits(item.moment) })),
    },
  };
}

/** With strokes that reach the limits again after pins were rounded. */
function fitted(crane: Crane): Crane {
  const wrong = new Set(problems(crane).map(({ path }) => path));
  const fit = (cylinder: Cylinder): Cylinder => {
    const at = `cylinders[${cylinder.name}]`;
    if (!wrong.has(`${at}.stroke`) && !wrong.has(`${at}.retracted`)) return cylinder;
    const [shortest, longest] = cylinderLengths(crane, cylinder);
    if (longest - shortest <= cylinder.stroke) return { ...cylinder, retracted: null };
    return { ...withStroke(crane, cylinder), stroke: up(CENTIMETRE)(longest - shortest) };
  };
  return { ...crane, cylinders: crane.cylinders.map(fit) };
}
