// The fields of a design file: what each means, its unit and its bounds. Files are read by them, forms are drawn by them.
import { decoded } from "./mesh";
import type { UnitSymbol } from "./quantity";
import { WAVE_HEIGHTS } from "./types";

interface About {
  readonly label: string;
  readonly hint?: string;
  readonly optional?: boolean;
  /** What an absent value means, as a placeholder. */
  readonly absent?: string;
}

export interface QuantityField extends About {
  readonly kind: "quantity";
  readonly unit: UnitSymbol;
  /** The value must be above this, or at least `least` [SI]. */
  readonly above?: number;
  readonly least?: number;
  readonly most?: number;
  readonly whole?: boolean;
}

export interface TextField extends About {
  readonly kind: "text";
  readonly choices?: readonly string[];
  /** Sentences rather than a word. */
  readonly long?: boolean;
  /** Why a text cannot be, in words; null if it can. */
  readonly check?: (value: string) => string | null;
  /** Names of links (with the foot) or joints of the crane. */
  readonly names?: "places" | "joints";
}

export interface VectorField extends About {
  readonly kind: "vector";
  readonly unit: UnitSymbol;
  readonly count: 2 | 3;
  readonly parts: readonly string[];
}

export interface ShapeField extends About {
  readonly kind: "shape";
  readonly shape: ShapeName;
}

export interface ListField extends About {
  readonly kind: "list";
  readonly of: ShapeName | UnitSymbol;
  readonly least?: number;
  readonly most?: number;
  /** Bounds of the items, if they are quantities [SI]. */
  readonly each?: Pick<QuantityField, "above" | "most">;
  /** What an absent list stands for [SI]. */
  readonly usual?: readonly number[];
}

export type ShapeName =
  | "crane"
  | "link"
  | "joint"
  | "cylinder"
  | "attachment"
  | "hoist"
  | "rope"
  | "slew"
  | "rating"
  | "moment"
  | "rated"
  | "source"
  | "station"
  | "part"
  | PartKind;

export const PART_KINDS = ["girder", "tube", "lug", "sheave", "drum", "box", "mesh"] as const;
export type PartKind = (typeof PART_KINDS)[number];

export type Field = QuantityField | TextField | VectorField | ShapeField | ListField;
export type Shape = Readonly<Record<string, Field>>;

const q = (unit: UnitSymbol, label: string, more: Partial<QuantityField> = {}): QuantityField => ({
  kind: "quantity",
  unit,
  label,
  ...more,
});
const size = (unit: UnitSymbol, label: string, more: Partial<QuantityField> = {}) =>
  q(unit, label, { above: 0, ...more });
const text = (label: string, more: Partial<TextField> = {}): TextField => ({ kind: "text", label, ...more });
const xyz = (unit: UnitSymbol, label: string, hint?: string): VectorField => ({
  kind: "vector",
  unit,
  label,
  count: 3,
  parts: ["x", "y", "z"],
  hint,
});
const shape = (of: ShapeName, label: string, more: Partial<ShapeField> = {}): ShapeField => ({
  kind: "shape",
  shape: of,
  label,
  ...more,
});
const list = (of: ShapeName | UnitSymbol, label: string, more: Partial<ListField> = {}): ListField => ({
  kind: "list",
  of,
  label,
  optional: true,
  ...more,
});

const PART = {
  kind: text("Kind"),
  name: text("Name"),
  density: q("kg/m3", "Density", { above: 0, optional: true, absent: "7850" }),
};
const surfaceProblem = (value: string) => {
  try {
    decoded(value);
    return null;
  } catch (error) {
    return (error as RangeError).message;
  }
};
const across = q("m", "y", { optional: true, absent: "0", hint: "of the middle, to port" });

const shapes: Readonly<Record<Exclude<ShapeName, "part">, Shape>> = {
  crane: {
    format: text("Format"),
    name: text("Name"),
    about: text("About", { long: true }),
    links: list("link", "Links", { optional: false, least: 1, most: 12 }),
    cylinders: list("cylinder", "Cylinders", { optional: false }),
    hoist: shape("hoist", "Hoist"),
    slew: shape("slew", "Slewing", { optional: true }),
    rating: shape("rating", "Rating", { optional: true }),
    bulk_modulus: size("MPa", "Bulk modulus", { hint: "effective, of oil with its hoses" }),
    pedestal: xyz("m", "Pedestal", "the foot in the ship's frame, from midship at the waterline"),
    capacity: list("rated", "Rated loads", { optional: false, least: 1 }),
    sources: list("source", "Sources"),
  },
  link: {
    name: text("Name"),
    joint: shape("joint", "Joint"),
    mass: size("t", "Mass", { hint: "with all that is fixed to the link" }),
    com: xyz("m", "Centre of mass", "in the link's frame"),
    inertia: xyz("kg.m2", "Inertia", "about the centre of mass, along the link's axes"),
    parts: list("part", "Parts"),
  },
  joint: {
    name: text("Joint"),
    kind: text("Kind", { choices: ["revolute", "prismatic"] }),
    axis: xyz("1", "Axis", "in the frame of the link before; (0, \u22121, 0) raises"),
    origin: xyz("m", "Origin", "in the frame of the link before"),
    limits: {
      kind: "vector",
      unit: "deg",
      label: "Limits",
      count: 2,
      parts: ["from", "to"],
      optional: true,
      absent: "endless",
    },
  },
  cylinder: {
    name: text("Name"),
    moves: text("Moves", { names: "joints" }),
    count: q("1", "Side by side", { least: 1, most: 16, whole: true, optional: true, absent: "1" }),
    bore: size("mm", "Bore"),
    rod: size("mm", "Rod"),
    stroke: size("m", "Stroke"),
    pressure: size("bar", "Working pressure"),
    base: shape("attachment", "Base pin"),
    eye: shape("attachment", "Eye pin"),
    retracted: size("m", "Retracted", { optional: true, absent: "travel centred", hint: "pin to pin, rod fully in" }),
    efficiency: q("1", "Efficiency", { above: 0, most: 1, optional: true, absent: "1" }),
  },
  attachment: { link: text("On", { names: "places" }), x: q("m", "x"), z: q("m", "z") },
  hoist: {
    falls: q("1", "Falls", {
      least: 1,
      most: 16,
      whole: true,
      optional: true,
      absent: "1",
      hint: "parts of rope at the hook",
    }),
    line_pull: size("kN", "Line pull", { optional: true, absent: "no limit" }),
    hook_mass: q("t", "Hook block", { least: 0, optional: true, absent: "0" }),
    speed: size("m/min", "Hoisting speed", { hint: "of the rope, with the rated load" }),
    compensation_speed: size("m/min", "Speed in heave compensation"),
    sheave_efficiency: q("1", "Sheave efficiency", { above: 0, most: 1, optional: true, absent: "1" }),
    drum_radius: size("m", "Drum radius"),
    drum: shape("attachment", "Drum"),
    sheaves: list("attachment", "Sheaves", { optional: false, least: 1, hint: "from the drum; the last is the tip" }),
    rope: shape("rope", "Rope"),
  },
  rope: {
    diameter: size("mm", "Diameter"),
    EA: size("MN", "Stiffness EA"),
    mass_per_length: size("kg/m", "Mass per length"),
    damping_ratio: q("1", "Damping ratio", { least: 0, most: 1 }),
    breaking_load: size("kN", "Breaking load", { optional: true, absent: "no limit" }),
    safety_factor: q("1", "Safety factor", { least: 1, optional: true, absent: "3" }),
  },
  slew: { joint: text("Joint", { names: "joints" }), speed: size("rpm", "Speed") },
  rating: {
    harbour_factor: q("1", "Dynamic factor in harbour", { least: 1, most: 3, optional: true, absent: "1" }),
    wave_heights: list("m", "Sea states Hs", { usual: WAVE_HEIGHTS, most: 12, each: { above: 0, most: 20 } }),
    tip_speed_per_height: q("1/s", "Tip speed per Hs", {
      least: 0,
      optional: true,
      absent: "0",
      hint: "from the ship's motion",
    }),
    heel: q("deg", "Heel", { least: 0, most: 0.35, optional: true, absent: "0", hint: "to whichever side is worse" }),
    trim: q("deg", "Trim", { least: 0, most: 0.35, optional: true, absent: "0", hint: "by whichever end is worse" }),
    slew_moment: size("kN.m", "Slewing ring moment", { optional: true, absent: "no limit" }),
    slew_torque: size("kN.m", "Slewing gear torque", { optional: true, absent: "no limit" }),
    load_moment: size("kN.m", "Load moment", { optional: true, absent: "no limit" }),
    heeling_moment: size("kN.m", "Heeling moment of the ship", { optional: true, absent: "no limit" }),
    structure: list("moment", "Structure"),
  },
  moment: { joint: text("About", { names: "joints" }), moment: size("kN.m", "Moment") },
  rated: { radius: size("m", "Radius"), mass: size("t", "Load") },
  source: {
    of: text("Of"),
    kind: text("Kind", { choices: ["published", "measured", "derived", "fitted", "assumption"] }),
    note: text("Note", { long: true }),
  },
  station: { x: q("m", "x"), top: q("m", "Top"), bottom: q("m", "Bottom"), width: size("m", "Width") },
  girder: {
    ...PART,
    thickness: size("mm", "Plate"),
    y: across,
    stations: list("station", "Stations", { optional: false, least: 2 }),
  },
  tube: {
    ...PART,
    start: xyz("m", "Start"),
    end: xyz("m", "End"),
    diameter: size("mm", "Diameter at the start"),
    end_diameter: size("mm", "Diameter at the end"),
    thickness: size("mm", "Wall"),
  },
  lug: {
    ...PART,
    x: q("m", "Pin x"),
    z: q("m", "Pin z"),
    root_x: q("m", "Root x"),
    root_z: q("m", "Root z"),
    root_width: size("m", "Root width"),
    radius: size("mm", "Radius about the pin"),
    hole: size("mm", "Pin hole"),
    thickness: size("mm", "Plate"),
    gap: size("mm", "Gap"),
    y: across,
  },
  sheave: {
    ...PART,
    x: q("m", "x"),
    z: q("m", "z"),
    radius: size("mm", "Radius"),
    groove: size("mm", "Groove"),
    width: size("mm", "Width"),
    hole: size("mm", "Pin hole"),
  },
  drum: {
    ...PART,
    x: q("m", "x"),
    z: q("m", "z"),
    radius: size("m", "Radius"),
    length: size("m", "Length"),
    flange: size("m", "Flange radius"),
    thickness: size("mm", "Wall"),
  },
  box: {
    ...PART,
    centre: xyz("m", "Centre"),
    size: xyz("m", "Size"),
    thickness: size("mm", "Plate", { optional: true, absent: "solid" }),
  },
  mesh: { ...PART, source: text("From"), surface: text("Surface", { check: surfaceProblem }) },
};

/** The fields of a shape; those of a part follow from its kind. */
export function fieldsOf(name: ShapeName, value?: unknown): Shape | null {
  if (name !== "part") return shapes[name];
  const kind = (value as { kind?: unknown } | null)?.kind;
  return PART_KINDS.includes(kind as PartKind) ? shapes[kind as PartKind] : null;
}

/** Whether the items of a list are shapes, not quantities. */
export function ofShapes(of: ShapeName | UnitSymbol): of is ShapeName {
  return of === "part" || Object.hasOwn(shapes, of);
}

/** The unit of a field: limits of a sliding joint are lengths. */
export function unitOf(name: string, field: QuantityField | VectorField, owner: unknown): UnitSymbol {
  return name === "limits" && (owner as { kind?: string } | null)?.kind === "prismatic" ? "m" : field.unit;
}

/** Why a value is out of the bounds of its field, in words; null if it is not. */
export function bound(
  field: Omit<QuantityField, keyof About | "kind" | "unit">,
  value: number,
  shown: (value: number) => string,
): string | null {
  if (!Number.isFinite(value)) return "must be a finite number";
  if (field.whole && !Number.isInteger(value)) return "must be a whole number";
  if (field.above !== undefined && value <= field.above) return `must be above ${shown(field.above)}`;
  if (field.least !== undefined && value < field.least) return `must be at least ${shown(field.least)}`;
  if (field.most !== undefined && value > field.most) return `must be at most ${shown(field.most)}`;
  return null;
}
