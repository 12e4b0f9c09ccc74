// What is written on a painted section: where its colours end, and where contours carry their load.
import type { Section } from "../../core/design/section";

export interface Label {
  readonly x: number;
  readonly z: number;
  /** [kg] */
  readonly load: number;
}

const SAMPLES = 4000;

/** The load of the brightest colour [kg]: what all but the few strongest cells stay below, in two digits. */
export function scaleEnd(load: Float32Array): number {
  const stride = Math.max(1, Math.floor(load.length / SAMPLES));
  const seen: number[] = [];
  for (let i = 0; i < load.length; i += stride) if (load[i] > 0) seen.push(load[i]);
  if (seen.length === 0) return 1000;
  seen.sort((a, b) => a - b);
  return Number(seen[Math.floor(0.93 * (seen.length - 1))].toPrecision(2));
}

/** Places for the loads of the contours: on their contour, well inside the section, far from each other. */
export function labels(section: Section, step: number, most: number): Label[] {
  const { load, view } = section;
  const { width, height } = view;
  const margin = Math.round(0.03 * width);
  const candidates = new Map<number, number[]>();
  for (let row = margin; row < height - margin; row += 3)
    for (let column = margin; column < width - margin; column += 1) {
      const cell = row * width + column;
      const band = Math.floor(load[cell] / step);
      const next = Math.floor(load[cell + 1] / step);
      if (!(Math.abs(band - next) === 1)) continue;
      const level = Math.max(band, next);
      if (level * step > 2 * most) continue;
      if (!(load[cell - margin] >= 0 && load[cell + margin] >= 0)) continue;
      if (!(load[cell - margin * width] >= 0 && load[cell + margin * width] >= 0)) continue;
      const cells = candidates.get(level);
      if (cells) cells.push(cell);
      else candidates.set(level, [cell]);
    }
  const placed: { level: number; row: number; column: number }[] = [];
  for (const level of [...candidates.keys()].sort((a, b) => a - b)) {
    const cells = candidates.get(level)!;
    if (cells.length < 8) continue;
    let best = -1;
    let distance = 0.07 * width;
    const stride = Math.max(1, Math.floor(cells.length / 60));
    for (let i = Math.floor(stride / 2); i < cells.length; i += stride) {
      const [row, column] = [Math.floor(cells[i] / width), cells[i] % width];
      // near the middle of the contour if nothing else decides: the candidates run from low to high
      const centred = 0.1 * width * (1 - Math.abs((2 * i) / cells.length - 1));
      const free = placed.reduce((d, at) => Math.min(d, Math.hypot(at.row - row, at.column - column)), 0.25 * width);
      if (free > 0.07 * width && free + centred > distance) {
        distance = free + centred;
        best = cells[i];
      }
    }
    if (best >= 0) placed.push({ level, row: Math.floor(best / width), column: best % width });
  }
  return placed.map(({ level, row, column }) => ({
    x: view.x + column * view.cell,
    z: view.z + row * view.cell,
    load: level * step,
  }));
}
