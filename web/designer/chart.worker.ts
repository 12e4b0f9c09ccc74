// Load charts off the page's thread: a section painted, curves, the verdict on a point. One answer to each request.
import { type Curve, curve, type Verdict, verdict } from "../core/design/curve";
import { contourStep, paint } from "../core/design/paint";
import { postureAt, Rasteriser, type Section, size, type View } from "../core/design/section";
import { type Crane, HARBOUR, type Mode, modes } from "../core/design/types";
import { type Reach, reach } from "../core/design/volume";
import { type Label, labels, scaleEnd } from "./section/contours";

export type Request =
  | {
      readonly kind: "section";
      readonly crane: Crane;
      readonly mode: string;
      readonly view: View;
      /** Load of the brightest colour [kg], where it is not the section's own to choose. */
      readonly most?: number;
      readonly pixels?: ArrayBuffer;
    }
  | { readonly kind: "refined"; readonly most?: number; readonly pixels?: ArrayBuffer }
  | { readonly kind: "point"; readonly x: number; readonly z: number }
  | {
      readonly kind: "posture";
      readonly crane: Crane;
      readonly mode: string;
      readonly posture: Readonly<Record<string, number>>;
    }
  | { readonly kind: "curves"; readonly crane: Crane; readonly width: number }
  | { readonly kind: "reach"; readonly crane: Crane };

export interface Painted {
  readonly view: View;
  /** RGBA, top row first. */
  readonly pixels: ArrayBuffer;
  /** Load of the brightest colour, and between contours [kg]. */
  readonly most: number;
  readonly step: number;
  readonly labels: readonly Label[];
  readonly postures: number;
  /** Whether `refined` would add nothing. */
  readonly complete: boolean;
  /** Computing and painting [ms]. */
  readonly took: number;
}

export interface Found extends Verdict {
  readonly posture: Readonly<Record<string, number>>;
}

export interface Answers {
  section: Painted;
  /** The section last asked for with more postures, a step of many; null if there is none. */
  refined: Painted | null;
  point: Found | null;
  posture: Verdict;
  curves: readonly Curve[];
  reach: Reach;
}

/** Time that a step of refining takes [ms]: no drag waits for longer. */
const REFINING = 30;

const rasteriser = new Rasteriser();
let last: { crane: Crane; mode: Mode; section: Section } | null = null;

function modeOf(crane: Crane, name: string): Mode {
  return modes(crane).find((mode) => mode.name === name) ?? HARBOUR;
}

/** A section with its colours, in the pixels given if they fit. */
function painted(section: Section, request: { most?: number; pixels?: ArrayBuffer }, begun: number): Painted {
  const { view, grids, complete } = section;
  const { most = scaleEnd(section.load), pixels: kept } = request;
  const step = contourStep(most);
  const bytes = 4 * view.width * view.height;
  const pixels = kept?.byteLength === bytes ? kept : new ArrayBuffer(bytes);
  paint(section, most, step, new Uint8ClampedArray(pixels));
  const marks = labels(section, step, most);
  const postures = grids.reduce((sum, grid) => sum + size(grid), 0);
  return { view, pixels, most, step, labels: marks, postures, complete, took: performance.now() - begun };
}

function answer(request: Request): Answers[Request["kind"]] {
  switch (request.kind) {
    case "section": {
      const begun = performance.now();
      const mode = modeOf(request.crane, request.mode);
      const section = rasteriser.section(request.crane, mode, request.view);
      last = { crane: request.crane, mode, section };
      return painted(section, request, begun);
    }
    case "refined": {
      const begun = performance.now();
      if (!last) return null;
      const section = rasteriser.refined(last.crane, last.mode, last.section.view, REFINING);
      last = { ...last, section };
      return painted(section, request, begun);
    }
    case "point": {
      const posture = last && postureAt(last.section, request.x, request.z);
      return last && posture ? { ...verdict(last.crane, posture, last.mode), posture } : null;
    }
    case "posture":
      return verdict(request.crane, request.posture, modeOf(request.crane, request.mode));
    case "curves":
      return modes(request.crane).map((mode) => curve(request.crane, mode, request.width));
    case "reach":
      return reach(request.crane);
  }
}

function pixelsOf(value: Painted | null): ArrayBuffer[] {
  return value ? [value.pixels] : [];
}

self.onmessage = ({ data }: MessageEvent<Request>) => {
  try {
    const value = answer(data);
    const transfer = data.kind === "section" || data.kind === "refined" ? pixelsOf(value as Painted | null) : [];
    self.postMessage({ value }, { transfer });
  } catch (error) {
    self.postMessage({ error: error instanceof Error ? error.message : String(error) });
  }
};
