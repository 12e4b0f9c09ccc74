// What one looks up in a load chart: the best load at each radius in each mode, and what each limit alone would allow.
import { capacity, limitNames } from "./loadChart";
import type { Posture } from "./plane";
import { postures } from "./section";
import { type Crane, type Mode, planeJoints } from "./types";

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
}

/** What the crane may lift in one posture, all limits together and each alone. */
export function verdict(crane: Crane, posture: Posture, mode: Mode): Verdict {
  const coordinates = planeJoints(crane).map((joint) => [posture[joint.name] ?? 0]);
  const names = limitNames(crane);
  const all = capacity(crane, coordinates, mode);
  return {
    radius: all.radius[0],
    height: all.height[0],
    load: all.load[0],
    governs: names[all.governs[0]],
    shares: names.map((limit) => ({ limit, load: capacity(alone(crane, limit), coordinates, mode).load[0] })),
  };
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
