// The edge of what a crane reaches, as segments in its plane: turned about the slewing axis they bound its workspace.
import { Rasteriser, type View } from "./section";
import { type Crane, HARBOUR } from "./types";

/** Segments x, z, x, z [m] between what is reached and what is not, smooth to half a cell (marching squares). */
export function edge(load: Float32Array, view: View): Float32Array {
  const { width, height, x, z, cell } = view;
  const inside = (column: number, row: number) =>
    column >= 0 && column < width && row >= 0 && row < height && load[row * width + column] >= 0 ? 1 : 0;
  const segments: number[] = [];
  for (let row = -1; row < height; row += 1)
    for (let column = -1; column < width; column += 1) {
      const corners = [
        inside(column, row),
        inside(column + 1, row),
        inside(column + 1, row + 1),
        inside(column, row + 1),
      ];
      const crossed = SIDES.filter((_, i) => corners[i] !== corners[(i + 1) % 4]);
      for (let i = 0; i + 1 < crossed.length; i += 2)
        for (const [dx, dz] of [crossed[i], crossed[i + 1]])
          segments.push(x + (column + dx) * cell, z + (row + dz) * cell);
    }
  return Float32Array.from(segments);
}

/** Middles of the sides of a square of four cells, from below around. */
const SIDES: readonly (readonly [number, number])[] = [
  [0.5, 0],
  [1, 0.5],
  [0.5, 1],
  [0, 0.5],
];

const CELLS = 160;

/** The edge of all that a crane reaches, about a hundred cells across. */
export function reachEdge(crane: Crane): Float32Array {
  const span = extent(crane);
  const cell = (2 * span) / CELLS;
  const view: View = { width: CELLS, height: CELLS, x: -span + 0.5 * cell, z: -span + 0.5 * cell, cell };
  return edge(new Rasteriser().section(crane, HARBOUR, view).load, view);
}

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
