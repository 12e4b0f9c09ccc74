// The search for better designs as the server takes it and tells of it: sizes that may change, goals, the front. The same
// names as src/seacrane/studies/optimisation.py.
import { fixed, TONNE } from "../units";
import { endOf } from "./length";
import type { UnitSymbol } from "./quantity";
import { type Crane, HARBOUR, modes } from "./types";

/** A size of a crane that a search may change. */
export interface Size {
  /** As the package writes it, such as `cylinders[boom_cylinder].base.x`. */
  readonly path: string;
  /** The link or cylinder that it belongs to. */
  readonly owner: string;
  readonly label: string;
  readonly unit: UnitSymbol;
  /** Whether only values above 0 m make sense. */
  readonly positive: boolean;
  /** As it stands [m]. */
  readonly now: number;
}

export interface Variable {
  readonly path: string;
  /** Bounds [m]. */
  readonly low: number;
  readonly high: number;
}

export type GoalKind = "reach" | "weight" | "capacity";

export interface Goal {
  readonly kind: GoalKind;
  /** Of a capacity [m]. */
  readonly radius: number;
  readonly mode: string;
}

export interface Specification {
  readonly variables: readonly Variable[];
  readonly goals: readonly Goal[];
  readonly population: number;
  readonly generations: number;
}

/** The candidates after a generation; a row of `values` and `results` for each. */
export interface Front {
  readonly generation: number;
  readonly variables: readonly Variable[];
  readonly goals: readonly (Goal & { readonly name: string })[];
  /** [m], a column for each variable. */
  readonly values: readonly (readonly number[])[];
  /** SI, a column for each goal. */
  readonly results: readonly (readonly number[])[];
  /** 0 for a crane that can be built. */
  readonly violation: readonly number[];
  /** Whether no other beats it in every goal. */
  readonly best: readonly boolean[];
  /** What the search began with. */
  readonly crane: Crane;
}

const PIN_SPAN = 0.2;
const SHARE = 0.25;
const PINS = [
  ["base", "x"],
  ["base", "z"],
  ["eye", "x"],
  ["eye", "z"],
] as const;

export const MOST = 1000;
export const LEAST_POPULATION = 4;

/** All sizes of a crane that can be searched: lengths of links along their x, bores, and places of pins. */
export function sizes(crane: Crane): Size[] {
  const lengths = crane.links.flatMap(({ name }, index): Size[] => {
    const now = endOf(crane, index)[0];
    if (!(now > 0)) return [];
    return [{ path: `links[${name}].length`, owner: name, label: "length", unit: "m", positive: true, now }];
  });
  const ofCylinders = crane.cylinders.flatMap((cylinder): Size[] => {
    const at = `cylinders[${cylinder.name}]`;
    const owner = cylinder.name;
    return [
      { path: `${at}.bore`, owner, label: "bore", unit: "mm", positive: true, now: cylinder.bore },
      ...PINS.map(
        ([end, axis]): Size => ({
          path: `${at}.${end}.${axis}`,
          owner,
          label: `${end} ${axis}`,
          unit: "m",
          positive: false,
          now: cylinder[end][axis],
        }),
      ),
    ];
  });
  return [...lengths, ...ofCylinders];
}

/** The size with the bounds that the server gives it too: a quarter of the value to both sides, of a pin 0.2 m or more. */
export function bounded({ path, positive, now }: Size): Variable {
  const span = Math.max(SHARE * Math.abs(now), positive ? 0 : PIN_SPAN);
  return { path, low: now - span, high: now + span };
}

/**
 * What one would ask first of a crane: lighter, able to lift more at three fifths of its largest rated radius, and no
 * shorter for it.
 */
export function usual(crane: Crane): Specification {
  const furthest = Math.max(...crane.capacity.map(({ radius }) => radius));
  return {
    variables: sizes(crane)
      .filter(({ positive }) => positive)
      .map(bounded),
    goals: [
      { kind: "weight", radius: 0, mode: HARBOUR.name },
      { kind: "capacity", radius: Math.max(1, Math.round(0.6 * furthest)), mode: HARBOUR.name },
      { kind: "reach", radius: 0, mode: HARBOUR.name },
    ],
    population: 40,
    generations: 30,
  };
}

/** What of a specification fits a crane: sizes that it has, modes that it knows. */
export function fitting(wanted: Specification, crane: Crane): Specification {
  const paths = new Set(sizes(crane).map(({ path }) => path));
  const known = new Set(modes(crane).map(({ name }) => name));
  return {
    ...wanted,
    variables: wanted.variables.filter(({ path }) => paths.has(path)),
    goals: wanted.goals.map((goal) => (known.has(goal.mode) ? goal : { ...goal, mode: HARBOUR.name })),
  };
}

/** What keeps a search from being begun, in words; null if nothing does. */
export function lacking({ variables, goals }: Specification): string | null {
  if (variables.length === 0) return "Choose at least one size that may change.";
  if (goals.length < 2) return "Choose at least two goals: one alone has no front.";
  if (new Set(goals.map(({ kind, radius, mode }) => `${kind} ${radius} ${mode}`)).size < goals.length)
    return "Two goals are the same.";
  return null;
}

/** Which goal is served by the larger value. */
export function largerIsBetter(kind: GoalKind): boolean {
  return kind !== "weight";
}

export function unitOfGoal(kind: GoalKind): UnitSymbol {
  return kind === "reach" ? "m" : "t";
}

/** A result in the unit of its goal, without the unit. */
export function result(kind: GoalKind, value: number): string {
  if (kind === "reach") return fixed(value, 2);
  return fixed(value / TONNE, Math.abs(value) < 10 * TONNE ? 2 : 1);
}

/** A size in its unit, with it. */
export function sized(value: number, unit: UnitSymbol): string {
  return unit === "mm" ? `${fixed(1e3 * value, 0)} mm` : `${fixed(value, 2)} m`;
}

/** The sizes of a candidate by path [m], as the server changes a design. */
export function changes({ variables, values }: Front, index: number): Record<string, number> {
  return Object.fromEntries(variables.map(({ path }, i) => [path, values[index][i]]));
}

/** Candidates that no other beats, by growing result in a goal; equal ones once. */
export function best(front: Front, goal: number): number[] {
  const seen = new Set<string>();
  return front.best
    .flatMap((good, index) => (good ? [index] : []))
    .sort((a, b) => front.results[a][goal] - front.results[b][goal])
    .filter((index) => {
      const key = front.values[index].join(" ");
      return !seen.has(key) && Boolean(seen.add(key));
    });
}

/** The range of some values with a margin to both sides, so that points at its ends are seen whole. */
export function range(values: readonly number[]): readonly [low: number, high: number] {
  const [low, high] = [Math.min(...values), Math.max(...values)];
  const margin = high > low ? 0.07 * (high - low) : Math.max(0.02 * Math.abs(low), 1e-3);
  return [low - margin, high + margin];
}

/** A specification that was kept as JSON, for a crane of this name; null if it is another's, or none. */
export function readSearch(kept: string | null, crane: Crane): Specification | null {
  try {
    const data = JSON.parse(kept ?? "null");
    if (data?.crane !== crane.name) return null;
    const { variables, goals, population, generations } = data;
    const whole =
      variables.every(({ path, low, high }: Variable) => typeof path === "string" && finite(low, high)) &&
      goals.every(
        ({ kind, radius, mode }: Goal) =>
          ["reach", "weight", "capacity"].includes(kind) && finite(radius) && typeof mode === "string",
      ) &&
      finite(population, generations);
    return whole ? fitting({ variables, goals, population, generations }, crane) : null;
  } catch {
    return null;
  }
}

/** A specification as JSON, with the name of its crane. */
export function searchText(wanted: Specification, crane: Crane): string {
  return JSON.stringify({ crane: crane.name, ...wanted });
}

function finite(...values: unknown[]): boolean {
  return values.every(Number.isFinite);
}
