// Loads to rate a crane at: read from its load chart in harbour, at round radii, rounded down.
import { curve } from "./curve";
import { type Crane, HARBOUR } from "./types";

const BAND = 0.5;
const STEPS = [0.5, 1, 2, 2.5, 5, 10, 20];
const POINTS = 6;
/** Of the largest radius: closer to the slewing axis a crane is not rated. */
const INNERMOST = 0.2;

/** What the crane may lift at the largest radius it reaches [m, kg]; null where it lifts nothing. */
export function furthestLoad(crane: Crane): { radius: number; mass: number } | null {
  return lifted(crane).at(-1) ?? null;
}

function lifted(crane: Crane): { radius: number; mass: number }[] {
  const { radius, load } = curve(crane, HARBOUR, BAND);
  return Array.from(radius, (at, i) => ({ radius: at, mass: load[i] })).filter(({ mass }) => mass > 0);
}

/** Rated loads by the chart in harbour; those that the crane has where it lifts nothing. */
export function ratedByChart(crane: Crane): Crane["capacity"] {
  const all = lifted(crane);
  const last = all.at(-1);
  if (!last) return crane.capacity;
  const heaviest = Math.max(...all.map(({ mass }) => mass));
  // the radius up to which the heaviest load is lifted is the first that matters
  const full = all.findLast(({ mass }) => mass > 0.99 * heaviest)!.radius;
  if (full === last.radius) return [all[0], last].map(({ radius, mass }) => ({ radius, mass: floored(mass) }));
  const first = Math.max(full, INNERMOST * last.radius);
  const step = STEPS.find((one) => (last.radius - first) / one < POINTS) ?? 50;
  const inner = all.filter(({ radius }) => radius >= first && radius < last.radius && radius % step === 0);
  const points = all.filter((point) => point.radius === full && full >= first);
  return [...new Set([...points, ...inner, last])].map(({ radius, mass }) => ({ radius, mass: floored(mass) }));
}

/** Down to three digits. */
function floored(mass: number): number {
  const digit = 10 ** (Math.floor(Math.log10(mass)) - 2);
  return Number((Math.floor(mass / digit) * digit).toPrecision(6));
}
