// The piece of the crane's plane that is drawn, and how its metres become pixels.
import { frames, type Point, pin } from "../../core/design/plane";
import type { View } from "../../core/design/section";
import { type Crane, planeJoints } from "../../core/design/types";

export interface Window {
  /** Middle [m], and pixels per metre. */
  readonly x: number;
  readonly z: number;
  readonly scale: number;
  /** Of the drawing [px]. */
  readonly width: number;
  readonly height: number;
}

export function toPixels({ x, z, scale, width, height }: Window, [px, pz]: Point): Point {
  return [0.5 * width + (px - x) * scale, 0.5 * height - (pz - z) * scale];
}

export function toMetres({ x, z, scale, width, height }: Window, [px, py]: Point): Point {
  return [x + (px - 0.5 * width) / scale, z - (py - 0.5 * height) / scale];
}

const SAMPLES = 9;
const MARGIN = 1.12;

/** Corners of what the crane reaches, with all its joints. */
export function bounds(crane: Crane): { low: Point; high: Point } {
  const joints = planeJoints(crane);
  const low: [number, number] = [-3, -1];
  const high: [number, number] = [3, 3];
  const take = ([x, z]: Point) => {
    if (!Number.isFinite(x + z)) return;
    low[0] = Math.min(low[0], x);
    low[1] = Math.min(low[1], z);
    high[0] = Math.max(high[0], x);
    high[1] = Math.max(high[1], z);
  };
  const end = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  const per = Math.max(3, Math.floor(SAMPLES ** (2 / Math.max(2, joints.length))));
  for (let i = 0; i < per ** joints.length; i += 1) {
    const posture = Object.fromEntries(
      joints.map((joint, k) => {
        const [a, b] = joint.limits ?? [0, 0];
        return [joint.name, a + ((b - a) * (Math.floor(i / per ** k) % per)) / (per - 1)];
      }),
    );
    const at = frames(crane, posture);
    for (const pose of at.values()) take([pose.x, pose.z]);
    take(pin(at, end));
    for (const { base, eye } of crane.cylinders) for (const one of [base, eye]) take(pin(at, one));
  }
  return { low, high };
}

/** The window that shows all that the cranes reach. */
export function framed(cranes: Crane | readonly Crane[], width: number, height: number): Window {
  const all = (Array.isArray(cranes) ? cranes : [cranes]).map(bounds);
  const low = [0, 1].map((k) => Math.min(...all.map((one) => one.low[k])));
  const high = [0, 1].map((k) => Math.max(...all.map((one) => one.high[k])));
  const scale = Math.min(width / (MARGIN * (high[0] - low[0])), (height - 20) / (MARGIN * (high[1] - low[1])));
  return { x: 0.5 * (low[0] + high[0]), z: 0.5 * (low[1] + high[1]), scale, width, height };
}

/** The same window about a fixed pixel, closer by a factor. */
export function zoomed(window: Window, about: Point, by: number): Window {
  const scale = Math.min(Math.max(window.scale * by, 1), 2000);
  const [x, z] = toMetres(window, about);
  return {
    ...window,
    scale,
    x: x - (x - window.x) * (window.scale / scale),
    z: z - (z - window.z) * (window.scale / scale),
  };
}

/** The raster over a window: at most `cells` by `cells`. */
export function raster(window: Window, cells: number): View {
  const [left, top] = toMetres(window, [0, 0]);
  const [right, bottom] = toMetres(window, [window.width, window.height]);
  const cell = Math.max((right - left) / cells, (top - bottom) / cells);
  return {
    cell,
    width: Math.max(2, Math.ceil((right - left) / cell)),
    height: Math.max(2, Math.ceil((top - bottom) / cell)),
    x: left + 0.5 * cell,
    z: bottom + 0.5 * cell,
  };
}

/** A round distance between grid lines that is at least `pixels` wide. */
export function gridStep(scale: number, pixels: number): number {
  const least = pixels / scale;
  const power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => step >= least) ?? 10 * power;
}
