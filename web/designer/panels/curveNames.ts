// Where the names of curves stand: each on its curve, at the radius at which the curves are furthest apart.
import type { Curve } from "../../core/design/curve";

export interface Named {
  readonly curve: Curve;
  readonly name: string;
}

export interface Name {
  readonly name: string;
  /** [m] and [kg] */
  readonly radius: number;
  readonly load: number;
}

/** Between the middles of two names [px]. */
const LEAST_APART = 11;

/**
 * The names that find room, the first ones first. `toPixels` is the height of a load [px]; only radii between `from` and
 * `to` [m] are asked.
 */
export function namesOn(lines: readonly Named[], toPixels: (load: number) => number, from: number, to: number): Name[] {
  let best: { index: number; apart: number } | null = null;
  const longest = Math.max(0, ...lines.map(({ curve }) => curve.radius.length));
  for (let index = 0; index < longest; index += 1) {
    const radius = lines[0].curve.radius[index];
    if (!(radius >= from && radius <= to)) continue;
    const heights = lines.map(({ curve }) => toPixels(curve.load[index])).sort((a, b) => a - b);
    if (!heights.every(Number.isFinite)) continue;
    const apart = Math.min(...heights.slice(1).map((height, i) => height - heights[i]));
    if (!best || apart > best.apart) best = { index, apart };
  }
  if (!best) return [];
  const { index } = best;
  const taken: number[] = [];
  return lines.flatMap(({ curve, name }) => {
    const height = toPixels(curve.load[index]);
    if (taken.some((other) => Math.abs(other - height) < LEAST_APART)) return [];
    taken.push(height);
    return [{ name, radius: curve.radius[index], load: curve.load[index] }];
  });
}
