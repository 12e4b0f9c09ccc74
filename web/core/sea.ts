// Elevation of the sea from the list of waves the physics uses (linear theory):
//   eta(x, y, t) = sum_i a_i cos(k_i (x cos d_i + y sin d_i) - omega_i t + phase_i),  d_i: direction going to.
import type { WaveComponent } from "../rpc/messages";

const TURN = 2 * Math.PI;

/** Elevation [m] at one point; the reference the grid is tested against. */
export function elevation(waves: readonly WaveComponent[], x: number, y: number, t: number): number {
  let sum = 0;
  for (const [omega, k, direction, amplitude, phase] of waves) {
    const along = (k * (x * Math.cos(direction) + y * Math.sin(direction))) % TURN;
    sum += amplitude * Math.cos(along - ((omega * t) % TURN) + phase);
  }
  return sum;
}

/**
 * Elevation on the grid of all pairs of `xs` and `ys`, which need not be evenly spaced.
 *
 * A wave is separable, exp(i(kx x + ky y + p)) = exp(i kx x) exp(i(ky y + p)), so a grid costs two small tables and one
 * multiply-add per wave and point. The tables are computed once; each instant only turns the phases, in float64 and
 * reduced to one turn, so that the picture still agrees with the physics after days.
 */
export class SeaGrid {
  readonly nx: number;
  readonly ny: number;
  private readonly cosX: Float64Array;
  private readonly sinX: Float64Array;
  private readonly cosY: Float64Array;
  private readonly sinY: Float64Array;
  private readonly now: { c: Float64Array; s: Float64Array };
  private readonly row: { c: Float64Array; s: Float64Array };

  constructor(
    readonly waves: readonly WaveComponent[],
    xs: ArrayLike<number>,
    ys: ArrayLike<number>,
  ) {
    const n = waves.length;
    this.nx = xs.length;
    this.ny = ys.length;
    [this.cosX, this.sinX] = table(n, xs, (i) => waves[i][1] * Math.cos(waves[i][2]));
    [this.cosY, this.sinY] = table(n, ys, (i) => waves[i][1] * Math.sin(waves[i][2]));
    this.now = { c: new Float64Array(n), s: new Float64Array(n) };
    this.row = { c: new Float64Array(n), s: new Float64Array(n) };
  }

  /** Elevations at time `t`, y by y: `out[j * nx + i]` is at (xs[i], ys[j]). */
  at(t: number, out: Float32Array): Float32Array {
    const n = this.waves.length;
    const { now, row } = this;
    for (let w = 0; w < n; w += 1) {
      const [omega, , , amplitude, phase] = this.waves[w];
      const turned = phase - ((omega * t) % TURN);
      now.c[w] = amplitude * Math.cos(turned);
      now.s[w] = amplitude * Math.sin(turned);
    }
    for (let j = 0; j < this.ny; j += 1) {
      for (let w = 0; w < n; w += 1) {
        const cy = this.cosY[j * n + w];
        const sy = this.sinY[j * n + w];
        row.c[w] = now.c[w] * cy - now.s[w] * sy;
        row.s[w] = now.s[w] * cy + now.c[w] * sy;
      }
      for (let i = 0; i < this.nx; i += 1) {
        let sum = 0;
        const at = i * n;
        for (let w = 0; w < n; w += 1) sum += this.cosX[at + w] * row.c[w] - this.sinX[at + w] * row.s[w];
        out[j * this.nx + i] = sum;
      }
    }
    return out;
  }
}

function table(n: number, at: ArrayLike<number>, k: (wave: number) => number): [Float64Array, Float64Array] {
  const c = new Float64Array(n * at.length);
  const s = new Float64Array(n * at.length);
  for (let w = 0; w < n; w += 1) {
    const number = k(w);
    for (let i = 0; i < at.length; i += 1) {
      c[i * n + w] = Math.cos(number * at[i]);
      s[i * n + w] = Math.sin(number * at[i]);
    }
  }
  return [c, s];
}

/**
 * Coordinates from -reach to reach that are evenly spaced near zero and widen outwards (a sinh law), so that one grid
 * shows waves at the ship and still meets the horizon.
 */
export function widening(count: number, near: number, reach: number): Float64Array {
  const half = (count - 1) / 2;
  // near * sinh(b u) / b has slope `near` at the middle; find b so that u = 1 lies at reach.
  let [low, high] = [1e-6, 40];
  for (let i = 0; i < 80; i += 1) {
    const b = (low + high) / 2;
    if ((near * half * Math.sinh(b)) / b > reach) high = b;
    else low = b;
  }
  const b = (low + high) / 2;
  return Float64Array.from({ length: count }, (_, i) => (near * half * Math.sinh((b * (i - half)) / half)) / b);
}
