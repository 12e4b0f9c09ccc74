// What the cylinders of a crane bear in a posture with a load on the hook: pressures from moments over lever arms, by the
// same laws as the load chart (src/seacrane/design/chart.py).
import { areas, offlead } from "./loadChart";
import { frames, type Posture, pin } from "./plane";
import { type Attachment, type Crane, GRAVITY, type Mode, tilt } from "./types";

/** For slopes by joint coordinate, to either side [rad, m]. */
const STEP = 1e-5;
/** As in the load chart [m]. */
const LEAST_HANG = 1;
const LEAST_LEVER = 1e-9;

export interface Held {
  readonly cylinder: string;
  /** Between the pins [m]. */
  readonly length: number;
  /** How much the cylinder lengthens as its joint turns [m/rad], or slides [1]: its lever arm. */
  readonly lever: number;
  /** Of the side that bears, the other at none [Pa]; infinite where there is no lever. */
  readonly pressure: number;
  readonly side: "bore" | "rod";
}

/**
 * What each cylinder bears of the crane's own weight and of a weight on the hook [N], dynamics in: hanging plumb and, at
 * sea, led outboard, whichever is worse.
 */
export function holding(crane: Crane, posture: Posture, weight: number, mode: Mode): Held[] {
  const now = stateOf(crane, posture);
  const lead = offlead(mode) / Math.max(now.height + crane.pedestal[2], LEAST_HANG);
  return crane.cylinders.map((cylinder, i) => {
    const q = posture[cylinder.moves] ?? 0;
    const [after, before] = [STEP, -STEP].map((by) => stateOf(crane, { ...posture, [cylinder.moves]: q + by }));
    const slope = (of: (state: State) => number) => (of(after) - of(before)) / (2 * STEP);
    const own = slope((state) => state.own);
    const plumb = slope((state) => state.plumb);
    const led = plumb + lead * slope((state) => state.led);
    const lever = slope((state) => state.lengths[i]);
    const [bore, annulus] = areas(cylinder);
    const [worst] = [plumb, led]
      .map((load): Pick<Held, "pressure" | "side"> => {
        const force = (own + weight * load) / lever / (cylinder.efficiency ?? 1);
        return force < 0 ? { pressure: -force / annulus, side: "rod" } : { pressure: force / bore, side: "bore" };
      })
      .sort((a, b) => b.pressure - a.pressure);
    const dead = Math.abs(lever) < LEAST_LEVER;
    return {
      cylinder: cylinder.name,
      length: now.lengths[i],
      lever: Math.abs(lever),
      pressure: dead ? Number.POSITIVE_INFINITY : worst.pressure,
      side: worst.side,
    };
  });
}

type State = ReturnType<typeof stateOf>;

function stateOf(crane: Crane, posture: Posture) {
  const { hoist, links } = crane;
  const at = frames(crane, posture);
  const falling = tilt(crane);
  const [upX, upZ] = [-Math.sin(falling), Math.cos(falling)];
  const between = (a: Attachment, b: Attachment) => {
    const [p, q] = [pin(at, a), pin(at, b)];
    return Math.hypot(p[0] - q[0], p[1] - q[1]);
  };
  const [x, z] = pin(at, hoist.sheaves[hoist.sheaves.length - 1]);
  const path = [hoist.drum, ...hoist.sheaves];
  const rope = path.slice(1).reduce((sum, to, i) => sum + between(path[i], to), 0);
  return {
    /** Energy of the crane's own weight [J]. */
    own: links.reduce((sum, { name, com, mass }) => {
      const [cx, cz] = pin(at, { link: name, x: com[0], z: com[2] });
      return sum + mass * GRAVITY * (upX * cx + upZ * cz);
    }, 0),
    /** What a newton on the hook is lifted [m], the drum held, and how far inboard of its lead it comes. */
    plumb: upX * x + upZ * z + rope / (hoist.falls ?? 1),
    led: upX * z - upZ * x,
    height: z,
    lengths: crane.cylinders.map(({ base, eye }) => between(base, eye)),
  };
}
