// What a crane is: the design file (docs/design-file.md), in SI. The Python package reads and checks the same.
import type { Vec3 } from "../../rpc/messages";

export const FORMAT = "seacrane-crane/1";
export const FOOT = "foot";
export const STEEL = 7850;
export const GRAVITY = 9.81;

export type Limits = readonly [number, number];

export interface Joint {
  readonly name: string;
  readonly kind: "revolute" | "prismatic";
  readonly axis: Vec3;
  readonly origin: Vec3;
  readonly limits?: Limits | null;
}

export interface Station {
  readonly x: number;
  readonly top: number;
  readonly bottom: number;
  readonly width: number;
}

interface Named {
  readonly name: string;
  readonly density?: number;
}

export interface Girder extends Named {
  readonly kind: "girder";
  readonly stations: readonly Station[];
  readonly thickness: number;
  readonly y?: number;
}

export interface Tube extends Named {
  readonly kind: "tube";
  readonly start: Vec3;
  readonly end: Vec3;
  readonly diameter: number;
  readonly end_diameter: number;
  readonly thickness: number;
}

export interface Lug extends Named {
  readonly kind: "lug";
  readonly x: number;
  readonly z: number;
  readonly root_x: number;
  readonly root_z: number;
  readonly root_width: number;
  readonly radius: number;
  readonly hole: number;
  readonly thickness: number;
  readonly gap: number;
  readonly y?: number;
}

export interface Sheave extends Named {
  readonly kind: "sheave";
  readonly x: number;
  readonly z: number;
  readonly radius: number;
  readonly groove: number;
  readonly width: number;
  readonly hole: number;
}

export interface Drum extends Named {
  readonly kind: "drum";
  readonly x: number;
  readonly z: number;
  readonly radius: number;
  readonly length: number;
  readonly flange: number;
  readonly thickness: number;
}

export interface Box extends Named {
  readonly kind: "box";
  readonly centre: Vec3;
  readonly size: Vec3;
  readonly thickness?: number | null;
}

export interface Imported extends Named {
  readonly kind: "mesh";
  /** The file it came from. */
  readonly source: string;
  /** Binary STL in m, z up, in the frame of the link, as base64. */
  readonly surface: string;
}

export type Part = Girder | Tube | Lug | Sheave | Drum | Box | Imported;

export interface Link {
  readonly name: string;
  readonly joint: Joint;
  readonly mass: number;
  readonly com: Vec3;
  readonly inertia: Vec3;
  readonly parts?: readonly Part[];
}

export interface Attachment {
  readonly link: string;
  readonly x: number;
  readonly z: number;
}

export interface Cylinder {
  readonly name: string;
  readonly moves: string;
  readonly count?: number;
  readonly bore: number;
  readonly rod: number;
  readonly stroke: number;
  readonly pressure: number;
  readonly base: Attachment;
  readonly eye: Attachment;
  readonly retracted?: number | null;
  readonly efficiency?: number;
}

export interface Rope {
  readonly diameter: number;
  readonly EA: number;
  readonly mass_per_length: number;
  readonly damping_ratio: number;
  readonly breaking_load?: number | null;
  readonly safety_factor?: number;
}

export interface Hoist {
  readonly drum: Attachment;
  readonly drum_radius: number;
  readonly sheaves: readonly Attachment[];
  readonly rope: Rope;
  readonly speed: number;
  readonly compensation_speed: number;
  readonly falls?: number;
  readonly sheave_efficiency?: number;
  readonly line_pull?: number | null;
  readonly hook_mass?: number;
}

export interface Rating {
  readonly harbour_factor?: number;
  readonly wave_heights?: readonly number[];
  readonly tip_speed_per_height?: number;
  readonly heel?: number;
  readonly trim?: number;
  readonly slew_moment?: number | null;
  readonly slew_torque?: number | null;
  readonly load_moment?: number | null;
  readonly heeling_moment?: number | null;
  readonly structure?: readonly { readonly joint: string; readonly moment: number }[];
}

export interface Crane {
  readonly format: typeof FORMAT;
  readonly name: string;
  readonly about: string;
  readonly links: readonly Link[];
  readonly cylinders: readonly Cylinder[];
  readonly hoist: Hoist;
  readonly slew?: { readonly joint: string; readonly speed: number } | null;
  readonly rating?: Rating;
  readonly bulk_modulus: number;
  readonly pedestal: Vec3;
  readonly capacity: readonly { readonly radius: number; readonly mass: number }[];
  readonly sources?: readonly { readonly of: string; readonly kind: string; readonly note: string }[];
}

export interface Mode {
  readonly name: string;
  /** Significant wave height [m]; 0 in harbour. */
  readonly waveHeight: number;
}

export const HARBOUR: Mode = { name: "harbour", waveHeight: 0 };
export const WAVE_HEIGHTS: readonly number[] = [1, 1.5, 2, 2.5];

/** Harbour, and one mode for each wave height of the design. */
export function modes(crane: Crane): Mode[] {
  const heights = crane.rating?.wave_heights ?? WAVE_HEIGHTS;
  return [HARBOUR, ...heights.map((height) => ({ name: `hs${height.toFixed(1)}`, waveHeight: height }))];
}

/** A mode as a person says it. */
export function modeLabel({ waveHeight }: Mode): string {
  return waveHeight ? `Hs ${waveHeight.toFixed(waveHeight % 0.5 ? 2 : 1)} m` : "Harbour";
}

/** How steeply the deck falls, heel and trim together [rad]. */
export function tilt({ rating }: Crane): number {
  return Math.atan(Math.hypot(Math.tan(rating?.heel ?? 0), Math.tan(rating?.trim ?? 0)));
}

/** The joints that move the crane in its plane, from the foot to the tip: all but slewing. */
export function planeJoints(crane: Crane): Joint[] {
  return crane.links.map((link) => link.joint).filter((joint) => joint.name !== crane.slew?.joint);
}
