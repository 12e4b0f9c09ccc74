// The load over the crane's plane as a raster: every posture of a grid, fine enough that none of the reachable cells is
// missed, brings its load to the cell where its tip is; the best posture of a cell counts.
import { type Capacity, sweep } from "./loadChart";
import { type Crane, type Joint, type Mode, planeJoints } from "./types";

export interface View {
  readonly width: number;
  readonly height: number;
  /** Of the middle of the lower left cell [m]. */
  readonly x: number;
  readonly z: number;
  /** Width and height of a cell [m]. */
  readonly cell: number;
}

export interface Section {
  readonly view: View;
  /** By cell, rows from below [kg]; NaN out of reach. */
  readonly load: Float32Array;
  /** By cell: load and index of the best posture in one number, for `postureAt`; negative out of reach. */
  readonly best: Float64Array;
  readonly coordinates: readonly Float64Array[];
  readonly joints: readonly string[];
}

const MOST_POSTURES = 1_000_000;

// The load in 1/64 kg and the index of its posture share a number, so that the better of two postures is the larger number.
const INDICES = 2 ** 24;
const PER_KILOGRAM = 64;
const LARGEST = 2 ** 29 - 1;

/** Coordinates of a joint, so close that the tip, `arm` metres away, moves by less than a cell. */
function spread(joint: Joint, arm: number, cell: number, least: number, most: number): Float64Array {
  const [low, high] = joint.limits ?? [0, 0];
  const travel = (high - low) * (joint.kind === "revolute" ? arm : 1);
  const count = Math.min(Math.max(Math.ceil(travel / (0.8 * cell)) + 1, least), most);
  return Float64Array.from({ length: count }, (_, i) => low + ((high - low) * i) / Math.max(count - 1, 1));
}

/** How far the tip can be from each joint of the plane [m]. */
export function arms(crane: Crane): number[] {
  const joints = planeJoints(crane);
  const ends = crane.links.map((link, i) => {
    const next = crane.links[i + 1];
    const end = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
    const travel =
      link.joint.kind === "prismatic" && link.joint.limits ? Math.max(...link.joint.limits.map(Math.abs)) : 0;
    return (next ? Math.hypot(next.joint.origin[0], next.joint.origin[2]) : Math.hypot(end.x, end.z)) + travel;
  });
  return joints.map((joint) => {
    const from = crane.links.findIndex((link) => link.joint.name === joint.name);
    return ends.slice(from).reduce((sum, length) => sum + length, 0);
  });
}

/** The grid of postures for a raster: fine in the last two joints, coarser in those before. */
export function postures(crane: Crane, cell: number): Float64Array[] {
  const joints = planeJoints(crane);
  const reach = arms(crane);
  const fine = joints.map((joint, k) => spread(joint, reach[k], cell, 2, 1200));
  const product = () => fine.reduce((count, values) => count * values.length, 1);
  for (let k = 0; k < joints.length && product() > MOST_POSTURES; k += 1) {
    const others = product() / fine[k].length;
    const least = k < joints.length - 2 ? 9 : 64;
    const most = Math.max(least, Math.floor(MOST_POSTURES / others));
    if (fine[k].length > most) fine[k] = spread(joints[k], Number.POSITIVE_INFINITY, cell, most, most);
  }
  return fine;
}

/** Buffers that a raster uses again from one drag event to the next. */
export class Rasteriser {
  private load = new Float32Array(0);
  private best = new Float64Array(0);

  section(crane: Crane, mode: Mode, view: View): Section {
    const coordinates = postures(crane, view.cell);
    const cells = view.width * view.height;
    if (this.load.length !== cells) {
      this.load = new Float32Array(cells);
      this.best = new Float64Array(cells);
    }
    const { load, best } = this;
    best.fill(-1);
    sweep(crane, coordinates, mode, (row, at) => take(row, at, view, best));
    fillHoles(best, view);
    for (let cell = 0; cell < cells; cell += 1) load[cell] = loadOf(best[cell]);
    return { view, load, best, coordinates, joints: planeJoints(crane).map((joint) => joint.name) };
  }
}

/** Bring the loads of a row to the cells where its tips are. */
function take({ count, radius, height, load }: Capacity, at: number, view: View, best: Float64Array): void {
  const { width, height: lines, x, z, cell } = view;
  const scale = 1 / cell;
  const [left, low] = [0.5 - x * scale, 0.5 - z * scale];
  for (let j = 0; j < count; j += 1) {
    const column = radius[j] * scale + left;
    const line = height[j] * scale + low;
    if (!(column >= 0 && column < width && line >= 0 && line < lines)) continue;
    const to = (line | 0) * width + (column | 0);
    const weight = load[j] * PER_KILOGRAM;
    const value = (weight < LARGEST ? Math.floor(weight) : LARGEST) * INDICES + at + j;
    best[to] = Math.max(best[to], value);
  }
}

function loadOf(best: number): number {
  return best < 0 ? Number.NaN : Math.floor(best / INDICES) / PER_KILOGRAM;
}

/** A cell that no posture met, with neighbours left and right, or above and below, is like its better neighbour. */
function fillHoles(best: Float64Array, { width, height }: View): void {
  for (let row = 1; row + 1 < height; row += 1)
    for (let cell = row * width + 1; cell + 1 < (row + 1) * width; cell += 1) {
      if (best[cell] >= 0) continue;
      if (best[cell - 1] >= 0 && best[cell + 1] >= 0) best[cell] = Math.max(best[cell - 1], best[cell + 1]);
      else if (best[cell - width] >= 0 && best[cell + width] >= 0)
        best[cell] = Math.max(best[cell - width], best[cell + width]);
    }
}

/** The posture of a cell by joint [rad, m]; null out of reach. */
export function postureAt(section: Section, x: number, z: number): Record<string, number> | null {
  const { view, best, coordinates, joints } = section;
  const column = Math.round((x - view.x) / view.cell);
  const row = Math.round((z - view.z) / view.cell);
  if (column < 0 || column >= view.width || row < 0 || row >= view.height) return null;
  const value = best[row * view.width + column];
  if (value < 0) return null;
  let index = value % INDICES;
  const posture: Record<string, number> = {};
  for (let k = joints.length - 1; k >= 0; k -= 1) {
    const count = coordinates[k].length;
    posture[joints[k]] = coordinates[k][index % count];
    index = Math.floor(index / count);
  }
  return posture;
}

// ---------------------------------------------------------------- colours
/** Cividis, by nine of its colours: readable in all kinds of colour vision and in grey. */
const COLOURS: readonly (readonly [number, number, number])[] = [
  [0, 32, 77],
  [0, 52, 110],
  [57, 72, 107],
  [87, 93, 109],
  [112, 113, 115],
  [138, 134, 120],
  [166, 157, 117],
  [196, 182, 107],
  [255, 234, 70],
];

export function colour(share: number): [number, number, number] {
  const at = Math.min(Math.max(share, 0), 1) * (COLOURS.length - 1);
  const i = Math.min(Math.floor(at), COLOURS.length - 2);
  const [a, b] = [COLOURS[i], COLOURS[i + 1]];
  return [0, 1, 2].map((k) => Math.round(a[k] + (b[k] - a[k]) * (at - i))) as [number, number, number];
}

/** A round step that divides `most` into five to ten. */
export function contourStep(most: number): number {
  if (!(most > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(most / 5));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => most / step <= 10) ?? 10 * power;
}

const LINE = 0xff;
const HALF_WIDTH = 1.25;

/** RGBA of a section, top row first, with contours each `step` [kg]; `most` [kg] has the brightest colour. */
export function paint(section: Section, most: number, step: number, pixels: Uint8ClampedArray): void {
  const { width, height } = section.view;
  const { load } = section;
  const palette = Array.from({ length: 256 }, (_, i) => colour(i / 255));
  const packed = Uint32Array.from(palette, ([r, g, b]) => (255 << 24) | (b << 16) | (g << 8) | r);
  const out = new Uint32Array(pixels.buffer, pixels.byteOffset, width * height);
  const [scale, bands] = [255 / Math.max(most, 1e-9), 1 / step];
  for (let row = 0; row < height; row += 1)
    for (let column = 0; column < width; column += 1) {
      const cell = row * width + column;
      const to = (height - 1 - row) * width + column;
      const value = load[cell];
      if (!(value >= 0)) {
        out[to] = 0;
        continue;
      }
      const index = Math.min(255, Math.floor(value * scale));
      const white = line(load, cell, width, value * bands, bands);
      if (white > 0) {
        const [r, g, b] = palette[index];
        const mixed = (channel: number) => channel + (LINE - channel) * white;
        out[to] = (255 << 24) | (mixed(b) << 16) | (mixed(g) << 8) | mixed(r);
      } else out[to] = packed[index];
    }
}

/** How much of a cell a contour covers, 0 to 1: from how far it is away, in cells, by the slope of the load. */
function line(load: Float32Array, cell: number, width: number, level: number, bands: number): number {
  const off = Math.abs(level - Math.round(level));
  if (level < 0.5 || off > 0.25) return 0;
  const slopeX = 0.5 * bands * (load[cell + 1] - load[cell - 1]);
  const slopeZ = 0.5 * bands * (load[cell + width] - load[cell - width]);
  const slope = Math.sqrt(slopeX * slopeX + slopeZ * slopeZ);
  // beside the edge of the section, and on plateaus, there is no contour to draw
  if (!(slope > 1e-4)) return 0;
  const away = off / slope;
  return away < HALF_WIDTH ? Math.min(1, HALF_WIDTH - away) : 0;
}
