// A section in colours: from dark for the least load to bright for the most, with contours.
import type { Section } from "./section";

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
  const palette = Uint8Array.from({ length: 256 * 3 }, (_, i) => colour(Math.floor(i / 3) / 255)[i % 3]);
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
      const at = 3 * Math.min(255, Math.floor(value * scale));
      const white = line(load, cell, width, value * bands, bands);
      const red = palette[at] + (LINE - palette[at]) * white;
      const green = palette[at + 1] + (LINE - palette[at + 1]) * white;
      const blue = palette[at + 2] + (LINE - palette[at + 2]) * white;
      out[to] = (255 << 24) | (blue << 16) | (green << 8) | red;
    }
}

/** How much of a cell a contour covers, 0 to 1: from how far it is away, in cells, by the slope of the load. */
function line(load: Float32Array, cell: number, width: number, level: number, bands: number): number {
  const off = Math.abs(level - Math.floor(level + 0.5));
  if (level < 0.5 || off > 0.25) return 0;
  const slopeX = 0.5 * bands * (load[cell + 1] - load[cell - 1]);
  const slopeZ = 0.5 * bands * (load[cell + width] - load[cell - width]);
  const slope = Math.sqrt(slopeX * slopeX + slopeZ * slopeZ);
  // beside the edge of the section, and on plateaus, there is no contour to draw
  if (!(slope > 1e-4)) return 0;
  const away = off / slope;
  return away < HALF_WIDTH ? Math.min(1, HALF_WIDTH - away) : 0;
}
