// What one looks up in a load chart: the best load at each radius in each mode, and what each limit alone would allow.
import { type Held, holding } from "./holding";
import { capacity, limitNames } from "./loadChart";
import type { Posture } from "./plane";
import { postures } from "./section";
import { type Crane, GRAVITY, type Mode, planeJoints } from "./types";

export interface Curve {
  readonly mode: string;
  /** [m], growing. */
  readonly radius: Float64Array;
  /** Of the best posture within the band about the radius [kg]; NaN where there is none. */
  readonly load: Float64Array;
  /** The name of the limit that governs. */
  readonly governs: readonly string[];
}

/** Load over radius in bands of `width` metres; each load is scaled to the middle of its band by the moment. */
export function curve(crane: Crane, mode: Mode, width: number): Curve {
  const found = capacity(crane, postures(crane, width), mode);
  const names = limitNames(crane);
  let most = 0;
  for (let i = 0; i < found.count; i += 1) if (found.radius[i] > most) most = found.radius[i];
  const count = Math.floor(most / width + 0.5) + 1;
  const radius = Float64Array.from({ length: count }, (_, i) => i * width);
  const load = new Float64Array(count).fill(Number.NaN);
  const governs: string[] = new Array(count).fill("");
  for (let i = 0; i < found.count; i += 1) {
    const band = Math.round(found.radius[i] / width);
    if (band < 1 || band >= count) continue;
    const value = found.load[i] * Math.min(1, found.radius[i] / radius[band]);
    if (!(value <= load[band])) {
      load[band] = value;
      governs[band] = names[found.governs[i]];
    }
  }
  return { mode: mode.name, radius, load, governs };
}

export interface Share {
  readonly limit: string;
  /** What this limit alone would allow [kg]; infinite where it does not bind here. */
  readonly load: number;
}

export interface Verdict {
  readonly radius: number;
  readonly height: number;
  readonly load: number;
  readonly governs: string;
  readonly shares: readonly Share[];
  /** What the load is taken for, over what it weighs: dynamic factor of the mode. */
  readonly dynamic: number;
  /** What the cylinders bear with that load and factor. */
  readonly held: readonly Held[];
}

/** What the crane may lift in one posture, all limits together and each alone. */
export function verdict(crane: Crane, posture: Posture, mode: Mode): Verdict {
  const coordinates = planeJoints(crane).map((joint) => [posture[joint.name] ?? 0]);
  const names = limitNames(crane);
  const all = capacity(crane, coordinates, mode);
  const hooked = all.load[0] + (crane.hoist.hook_mass ?? 0);
  const factor = all.load[0] > 0 ? dynamic(crane, coordinates, mode, hooked) : 1;
  return {
    radius: all.radius[0],
    height: all.height[0],
    load: all.load[0],
    governs: names[all.governs[0]],
    shares: names.map((limit) => ({ limit, load: capacity(alone(crane, limit), coordinates, mode).load[0] })),
    dynamic: factor,
    held: holding(crane, posture, all.load[0] > 0 ? factor * hooked * GRAVITY : 0, mode),
  };
}

/** A crane this much softer meets its load without a shock. */
const SOFT = 1e-18;

/**
 * The dynamic factor of a mass on the hook, 1 + sqrt(b / m), or that of the harbour where it is more. What b is shows from
 * the mass that the limits bear with dynamics and from the one that they would bear on a crane without stiffness.
 */
function dynamic(crane: Crane, coordinates: readonly ArrayLike<number>[], mode: Mode, mass: number): number {
  const least = crane.rating?.harbour_factor ?? 1;
  if (mode.waveHeight === 0) return least;
  const { hoist, rating } = crane;
  const stiff: Crane = { ...crane, rating: { ...rating, load_moment: null, heeling_moment: null } };
  const rope = { ...hoist.rope, EA: SOFT * hoist.rope.EA };
  const soft: Crane = { ...stiff, bulk_modulus: SOFT * crane.bulk_modulus, hoist: { ...hoist, rope } };
  const hook = hoist.hook_mass ?? 0;
  const [shaken, borne] = [stiff, soft].map((one) => capacity(one, coordinates, mode).load[0] + hook);
  const root = ((least * borne) / shaken - 1) * Math.sqrt(shaken);
  return Number.isFinite(root) ? Math.max(least, 1 + root / Math.sqrt(mass)) : least;
}

const BOUNDLESS = 1e6;

/** The crane with all limits but one out of the way: pressures and moments a million times as large, the others absent. */
function alone(crane: Crane, limit: string): Crane {
  const only = <T>(name: string, value: T): T | null => (limit === name ? value : null);
  const { rating, hoist } = crane;
  return {
    ...crane,
    cylinders: crane.cylinders.map((item) =>
      item.name === limit ? item : { ...item, pressure: item.pressure * BOUNDLESS },
    ),
    rating: rating && {
      ...rating,
      structure: rating.structure?.filter(({ joint }) => limit === `structure at ${joint}`),
      slew_moment: only("slew moment", rating.slew_moment),
      slew_torque: only("slew torque", rating.slew_torque),
      load_moment: only("load moment", rating.load_moment),
      heeling_moment: only("ship stability", rating.heeling_moment),
    },
    hoist: {
      ...hoist,
      line_pull: only("winch", hoist.line_pull),
      rope: { ...hoist.rope, breaking_load: only("rope", hoist.rope.breaking_load) },
    },
  };
}
