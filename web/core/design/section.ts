// The load over the crane's plane as a raster: every posture of a grid, fine enough that none of the reachable cells is
// missed, brings its load to the cell where its tip is; the best posture of a cell counts. Where more than two joints leave
// a choice of postures to each point, further grids fill in between, best done while nobody drags.
import { chart, memory, sweep } from "./loadChart";
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
  /** By cell: load and index of the best posture in one number, for `postureAt`; negative if none. */
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
/** So that fewer cells are fewer postures; where three joints leave a choice, refining brings the others. */
const POSTURES_PER_CELL = 2.8;
const CHOSEN_PER_CELL = 1.2;

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
  private grids: Grid[] = [];
  private swept = 0;
  private further: Iterator<Grid> = [].values();

  section(crane: Crane, mode: Mode, view: View): Section {
    const cells = view.width * view.height;
    if (this.load.length !== cells) {
      this.load = new Float32Array(cells);
      this.best = new Float64Array(cells);
    }
    this.grids = [];
    this.swept = 0;
    this.further = layers(crane, view.cell);
    const choice = planeJoints(crane).length > 2;
    const most = Math.min((choice ? CHOSEN_PER_CELL : POSTURES_PER_CELL) * cells, MOST_POSTURES);
    // four grids of half of the postures
    const perJoint = Math.floor(Math.sqrt(most / 8));
    const loose = ends(crane, view.cell, perJoint);
    const rest = most - loose.reduce((sum, grid) => sum + size(grid), 0);
    const raster = this.raster(view);
    for (const grid of [...loose, postures(crane, view.cell, rest)]) this.sweep(crane, mode, grid);
    return this.finished(crane, view, raster, !choice);
  }

  /** The same section with more postures, as many as take about `milliseconds`. */
  refined(crane: Crane, mode: Mode, view: View, milliseconds: number): Section {
    const end = performance.now() + milliseconds;
    const raster = this.raster(view);
    let complete = false;
    while (!complete && performance.now() < end) {
      const next = this.further.next();
      complete = next.done === true || this.swept + size(next.value) > INDICES;
      if (!complete) this.sweep(crane, mode, next.value);
    }
    return this.finished(crane, view, raster, complete);
  }

  /** The raster that postures are brought to, with those so far. */
  private raster({ width, height, x, z, cell }: View): Float64Array {
    const [left, low] = [0.5 - x / cell, 0.5 - z / cell];
    const at = chart.raster(width, height, left, low, 1 / cell, PER_KILOGRAM, LARGEST, INDICES);
    const raster = new Float64Array(memory, at, this.best.length);
    if (this.swept > 0) raster.set(this.best);
    else raster.fill(-1);
    return raster;
  }

  /** Let the postures of a grid take the cells where their tips are. */
  private sweep(crane: Crane, mode: Mode, grid: Grid): void {
    const { swept } = this;
    sweep(crane, grid, mode, ({ count }, at, stride) => chart.bring(count, swept + at, stride), false);
    this.grids.push(grid);
    this.swept += size(grid);
  }

  private finished(crane: Crane, view: View, raster: Float64Array, complete: boolean): Section {
    const { load, best } = this;
    best.set(raster);
    load.set(new Float32Array(memory, chart.loads(), load.length));
    return { view, load, best, grids: this.grids, joints: planeJoints(crane).map((joint) => joint.name), complete };
  }
}

function loadOf(best: number): number {
  return best < 0 ? Number.NaN : Math.fround(Math.floor(best / INDICES) / PER_KILOGRAM);
}

/** The posture of a cell by joint [rad, m]; null out of reach. */
export function postureAt(section: Section, x: number, z: number): Record<string, number> | null {
  const { view, load, best, grids, joints } = section;
  const column = Math.round((x - view.x) / view.cell);
  const row = Math.round((z - view.z) / view.cell);
  if (column < 0 || column >= view.width || row < 0 || row >= view.height) return null;
  const cell = row * view.width + column;
  if (Number.isNaN(load[cell])) return null;
  // one that no posture met is like one beside it
  const value = [0, -1, 1, -view.width, view.width]
    .map((step) => best[cell + step])
    .find((met) => loadOf(met) === load[cell])!;
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
