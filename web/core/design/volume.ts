// What a crane reaches: the edge of its section, which turned about the slewing axis bounds its workspace, and their size.
import { Rasteriser, type View } from "./section";
import { type Crane, HARBOUR } from "./types";

export interface Reach {
  /** The edge as segments x, z, x, z [m]. */
  readonly edge: Float32Array;
  /** Of the section [m2]. */
  readonly area: number;
  /** Swept outboard of the slewing axis [m3]; 0 where the crane does not slew. */
  readonly volume: number;
}

const CELLS = 400;
const BLUR = 2;
/** The reached cells are all that the tip touches, half a cell too many: a blurred edge is this high half a cell inside. */
const LEVEL = 0.5 + 0.5 / (2 * BLUR + 1);

/** All that a crane reaches. */
export function reach(crane: Crane): Reach {
  const span = extent(crane);
  const cell = (2 * span) / CELLS;
  const view: View = { width: CELLS, height: CELLS, x: -span + 0.5 * cell, z: -span + 0.5 * cell, cell };
  const { load } = new Rasteriser().section(crane, HARBOUR, view);
  const reached = Float32Array.from(load, (value) => (value >= 0 ? 1 : 0));
  return { edge: edge(blurred(blurred(reached, 1), CELLS), view), ...sizes(crane, reached, view) };
}

/** Mean of each value and its nearest `BLUR` neighbours to both sides, `stride` apart. */
function blurred(values: Float32Array, stride: number): Float32Array {
  const result = new Float32Array(values.length);
  for (let i = 0; i < values.length; i += 1) {
    let sum = 0;
    for (let k = -BLUR; k <= BLUR; k += 1) sum += values[i + k * stride] ?? 0;
    result[i] = sum / (2 * BLUR + 1);
  }
  return result;
}

/** Area, and volume by Pappus; a cell at the edge counts half. */
function sizes(crane: Crane, reached: Float32Array, { width, x, cell }: View): Omit<Reach, "edge"> {
  let area = 0;
  let moment = 0;
  reached.forEach((is, i) => {
    if (!is) return;
    const inner = [i - 1, i + 1, i - width, i + width].every((beside) => reached[beside]);
    const share = (inner ? 1 : 0.5) * cell ** 2;
    area += share;
    moment += share * Math.max(0, x + (i % width) * cell);
  });
  const slewing = crane.links.find((link) => link.joint.name === crane.slew?.joint)?.joint;
  const turn = slewing ? (slewing.limits ? slewing.limits[1] - slewing.limits[0] : 2 * Math.PI) : 0;
  return { area, volume: moment * Math.min(turn, 2 * Math.PI) };
}

/** Segments x, z, x, z [m] along which a field is at `LEVEL` (marching squares). */
export function edge(field: Float32Array, view: View): Float32Array {
  const { width, height, x, z, cell } = view;
  const at = (column: number, row: number) =>
    column >= 0 && column < width && row >= 0 && row < height ? field[row * width + column] : 0;
  const segments: number[] = [];
  for (let row = -1; row < height; row += 1)
    for (let column = -1; column < width; column += 1) {
      const corners = CORNERS.map(([dx, dz]) => at(column + dx, row + dz));
      const crossed = CORNERS.flatMap(([ax, az], i) => {
        const [a, b] = [corners[i], corners[(i + 1) % 4]];
        if (a >= LEVEL === b >= LEVEL) return [];
        const [bx, bz] = CORNERS[(i + 1) % 4];
        const share = (LEVEL - a) / (b - a);
        return [[x + (column + ax + share * (bx - ax)) * cell, z + (row + az + share * (bz - az)) * cell]];
      });
      for (let i = 0; i + 1 < crossed.length; i += 2) segments.push(...crossed[i], ...crossed[i + 1]);
    }
  return Float32Array.from(segments);
}

/** Corners of a square of four cells, in turn. */
const CORNERS: readonly (readonly [number, number])[] = [
  [0, 0],
  [1, 0],
  [1, 1],
  [0, 1],
];

/** A distance from the foot that the tip does not go beyond [m]. */
function extent(crane: Crane): number {
  const travel = ({ joint }: Crane["links"][number]) =>
    joint.kind === "prismatic" && joint.limits ? Math.max(...joint.limits.map(Math.abs)) : 0;
  const tip = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  const links = crane.links.reduce(
    (sum, link) => sum + Math.hypot(link.joint.origin[0], link.joint.origin[2]) + travel(link),
    0,
  );
  return 1.02 * (links + Math.hypot(tip.x, tip.z));
}
