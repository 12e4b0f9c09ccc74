// The load over the crane's plane as a raster: every posture of a grid, fine enough that none of the reachable cells is
// missed, brings its load to the cell where its tip is; the best posture of a cell counts. Where more than two joints leave
// a choice of postures to each point, further grids fill in between, best done while nobody drags.
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
  /** The grids of postures, one index running through all of them. */
  readonly grids: readonly Grid[];
  readonly joints: readonly string[];
  /** Whether no further postures would be looked at. */
  readonly complete: boolean;
}

/** Coordinates of each joint of the plane [rad, m]. */
export type Grid = readonly ArrayLike<number>[];

const MOST_POSTURES = 1_000_000;
const MOST_COORDINATES = 1200;
/** So that fewer cells are fewer postures, where any number of them could be looked at. */
const POSTURES_PER_CELL = 2.8;

// The load in 1/32 kg and the index of its posture share a number, so that the better of two postures is the larger number.
const INDICES = 2 ** 25;
const PER_KILOGRAM = 32;
const LARGEST = 2 ** 28 - 1;

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

function finest(crane: Crane, cell: number, most = MOST_COORDINATES): Float64Array[] {
  const reach = arms(crane);
  return planeJoints(crane).map((joint, k) => spread(joint, reach[k], cell, 2, most));
}

/** The grid of postures for a raster: fine in the last two joints, coarser in those before. */
export function postures(crane: Crane, cell: number, atMost = MOST_POSTURES): Float64Array[] {
  const joints = planeJoints(crane);
  const fine = finest(crane, cell);
  for (let k = 0; k < joints.length && size(fine) > atMost; k += 1) {
    const others = size(fine) / fine[k].length;
    const least = k < joints.length - 2 ? 9 : 64;
    const most = Math.max(least, Math.floor(atMost / others));
    if (fine[k].length > most) fine[k] = spread(joints[k], Number.POSITIVE_INFINITY, cell, most, most);
  }
  return fine;
}

// Three joints leave a choice of postures for each point. The best one is where a joint is at its end, or where two limits
// bind at once, which coordinates far apart miss, in places by half the load.

/** Of three joints: either of the last two at its ends, the others fine, with so many coordinates each at most. */
function ends(crane: Crane, cell: number, most: number): Grid[] {
  const joints = planeJoints(crane);
  if (joints.length !== 3) return [];
  const fine = finest(crane, LOOSE * cell, most);
  return [1, 2].flatMap((k) => (joints[k].limits ?? []).map((end) => fine.map((all, i) => (i === k ? [end] : all))));
}

/** Of three joints and more: the ends, then ever more coordinates before the last two, between all before (Halton's sequence). */
function* layers(crane: Crane, cell: number): Generator<Grid> {
  const joints = planeJoints(crane);
  const chosen = joints.length - 2;
  if (chosen < 1) return;
  yield* ends(crane, cell, MOST_COORDINATES);
  const fine = finest(crane, LOOSE * cell);
  for (let layer = 1; layer <= LAYERS; layer += 1)
    yield fine.map((all, k) => {
      const [low, high] = joints[k].limits ?? [0, 0];
      return k < chosen ? [low + (high - low) * radicalInverse(layer, PRIMES[k % PRIMES.length])] : all;
    });
}

const LAYERS = 96;
const PRIMES = [2, 3, 5, 7, 11, 13];
/** Wider apart than in a grid that is alone: many of them leave no cell out. */
const LOOSE = 1.25;

/** The digits of a number behind the point: 1, 2, 3, 4 in base 2 give 1/2, 1/4, 3/4, 1/8. */
function radicalInverse(value: number, base: number): number {
  let result = 0;
  for (let rest = value, part = 1 / base; rest > 0; rest = Math.floor(rest / base), part /= base)
    result += (rest % base) * part;
  return result;
}

/** How many postures a grid has. */
export function size(grid: Grid): number {
  return grid.reduce((product, values) => product * values.length, 1);
}

/** Buffers that a raster uses again from one drag event to the next. */
export class Rasteriser {
  private load = new Float32Array(0);
  private best = new Float64Array(0);
  private filled: readonly number[] = [];
  private grids: Grid[] = [];
  private swept = 0;
  private further: Iterator<Grid> = [].values();

  section(crane: Crane, mode: Mode, view: View): Section {
    const cells = view.width * view.height;
    if (this.load.length !== cells) {
      this.load = new Float32Array(cells);
      this.best = new Float64Array(cells);
    }
    this.best.fill(-1);
    this.filled = [];
    this.grids = [];
    this.swept = 0;
    this.further = layers(crane, view.cell);
    const most = Math.min(POSTURES_PER_CELL * cells, MOST_POSTURES);
    // four grids of half of the postures
    const perJoint = Math.floor(Math.sqrt(most / 8));
    for (const grid of ends(crane, view.cell, perJoint)) this.sweep(crane, mode, view, grid);
    this.sweep(crane, mode, view, postures(crane, view.cell, most - this.swept));
    return this.finished(crane, view, planeJoints(crane).length < 3);
  }

  /** The same section with more postures, as many as take about `milliseconds`. */
  refined(crane: Crane, mode: Mode, view: View, milliseconds: number): Section {
    for (const cell of this.filled) this.best[cell] = -1;
    const end = performance.now() + milliseconds;
    let complete = false;
    while (!complete && performance.now() < end) {
      const next = this.further.next();
      complete = next.done === true || this.swept + size(next.value) > INDICES;
      if (!complete) this.sweep(crane, mode, view, next.value);
    }
    return this.finished(crane, view, complete);
  }

  private sweep(crane: Crane, mode: Mode, view: View, grid: Grid): void {
    const { swept, best } = this;
    sweep(crane, grid, mode, (row, at) => take(row, swept + at, view, best));
    this.grids.push(grid);
    this.swept += size(grid);
  }

  private finished(crane: Crane, view: View, complete: boolean): Section {
    const { load, best } = this;
    this.filled = fillHoles(best, view);
    for (let cell = 0; cell < load.length; cell += 1) load[cell] = loadOf(best[cell]);
    return { view, load, best, grids: this.grids, joints: planeJoints(crane).map((joint) => joint.name), complete };
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

/** Lets a cell that no posture met, between two others, be like the better one. Which cells those are. */
function fillHoles(best: Float64Array, { width, height }: View): number[] {
  const filled: number[] = [];
  for (let row = 1; row + 1 < height; row += 1)
    for (let cell = row * width + 1; cell + 1 < (row + 1) * width; cell += 1) {
      if (best[cell] >= 0) continue;
      const left = cell - 1;
      const right = cell + 1;
      const below = cell - width;
      const above = cell + width;
      if (best[left] >= 0 && best[right] >= 0) best[cell] = Math.max(best[left], best[right]);
      else if (best[below] >= 0 && best[above] >= 0) best[cell] = Math.max(best[below], best[above]);
      else continue;
      filled.push(cell);
    }
  return filled;
}

/** The posture of a cell by joint [rad, m]; null out of reach. */
export function postureAt(section: Section, x: number, z: number): Record<string, number> | null {
  const { view, best, grids, joints } = section;
  const column = Math.round((x - view.x) / view.cell);
  const row = Math.round((z - view.z) / view.cell);
  if (column < 0 || column >= view.width || row < 0 || row >= view.height) return null;
  const value = best[row * view.width + column];
  if (value < 0) return null;
  let index = value % INDICES;
  let place = 0;
  while (index >= size(grids[place])) {
    index -= size(grids[place]);
    place += 1;
  }
  const posture: Record<string, number> = {};
  for (let k = joints.length - 1; k >= 0; k -= 1) {
    const values = grids[place][k];
    const count = values.length;
    posture[joints[k]] = values[index % count];
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
