// What `npm run bench` measures, as one module for Node: the load chart of every shipped design.

import { fromData } from "../core/design/file";
import { capacity, sweep } from "../core/design/loadChart";
import { contourStep, paint } from "../core/design/paint";
import { Rasteriser, size } from "../core/design/section";
import { type Crane, HARBOUR, type Mode, planeJoints } from "../core/design/types";
import { labels, scaleEnd } from "../designer/section/contours";
import { framed, raster } from "../designer/section/window";
import { peer } from "./peer";

/** Counts of postures by the number of joints; the last joint runs fastest. */
const GRIDS: Readonly<Record<number, readonly (readonly number[])[]>> = {
  2: [
    [600, 600],
    [1000, 1000],
  ],
  3: [
    [9, 160, 250],
    [10, 250, 400],
  ],
};
const SEA: Mode = { name: "hs2.0", waveHeight: 2 };
const CELLS = 600;
const SAMPLE = 2000;

export interface Row {
  readonly design: string;
  readonly mode: string;
  /** 360,000 and 1,000,000 postures [ms]. */
  readonly grids: readonly number[];
  /** One posture by the plain formula, over one of the 360,000. */
  readonly ratio: number;
  /** The largest difference between both, relative to the load. */
  readonly off: number;
  /** A section of 600 by 600 cells, and all that the worker does for it, painting and labels too [ms]. */
  readonly section: number;
  readonly event: number;
  readonly postures: number;
}

function spaced(crane: Crane, counts: readonly number[]): Float64Array[] {
  return planeJoints(crane).map(({ limits }, k) => {
    const [low, high] = limits ?? [0, 0];
    return Float64Array.from({ length: counts[k] }, (_, i) => low + ((high - low) * i) / (counts[k] - 1));
  });
}

/** The shortest of some runs [ms]. */
function shortest(runs: number, run: () => void): number {
  let best = Number.POSITIVE_INFINITY;
  for (let i = 0; i < runs; i += 1) {
    const begun = performance.now();
    run();
    best = Math.min(best, performance.now() - begun);
  }
  return best;
}

function against(crane: Crane, mode: Mode, grid: readonly Float64Array[]): { perPosture: number; off: number } {
  const found = capacity(crane, grid, mode);
  const stride = Math.floor(found.count / SAMPLE);
  const plain = peer(crane, mode);
  let off = 0;
  const begun = performance.now();
  for (let i = 0; i < SAMPLE; i += 1) {
    let index = i * stride;
    const q: number[] = [];
    for (let k = grid.length - 1; k >= 0; k -= 1) {
      q[k] = grid[k][index % grid[k].length];
      index = Math.floor(index / grid[k].length);
    }
    const load = plain(q);
    off = Math.max(off, Math.abs(load - found.load[i * stride]) / Math.max(load, 1));
  }
  return { perPosture: (performance.now() - begun) / SAMPLE, off };
}

/** Of the parsed design files. */
export function measure(designs: readonly unknown[], runs: number): Row[] {
  const rows: Row[] = [];
  for (const crane of designs.map(fromData)) {
    const view = raster(framed(crane, 900, 900), CELLS);
    const pixels = new Uint8ClampedArray(4 * view.width * view.height);
    const grids = GRIDS[planeJoints(crane).length].map((counts) => spaced(crane, counts));
    for (const mode of [HARBOUR, SEA]) {
      const times = grids.map((grid) => shortest(runs, () => sweep(crane, grid, mode, () => {})));
      const { perPosture, off } = against(crane, mode, grids[0]);
      const rasteriser = new Rasteriser();
      let postures = 0;
      const section = shortest(runs, () => {
        postures = rasteriser.section(crane, mode, view).grids.reduce((sum, grid) => sum + size(grid), 0);
      });
      const event = shortest(runs, () => {
        const found = rasteriser.section(crane, mode, view);
        const most = scaleEnd(found.load);
        paint(found, most, contourStep(most), pixels);
        labels(found, contourStep(most), most);
      });
      const ratio = perPosture / (times[0] / size(grids[0]));
      rows.push({ design: crane.name, mode: mode.name, grids: times, ratio, off, section, event, postures });
    }
  }
  return rows;
}
