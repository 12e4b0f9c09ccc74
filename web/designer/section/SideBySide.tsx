// Designs side by side at one scale and in one scale of colours: what reaches further or lifts more is seen to.
import { useEffect, useMemo, useRef, useState } from "react";
import type { Posture } from "../../core/design/plane";
import { type Crane, HARBOUR, modeLabel, modes } from "../../core/design/types";
import type { Painted } from "../chart.worker";
import type { Charts } from "../charts";
import { ColourBar } from "./ColourBar";
import { Figure } from "./Drawing";
import { Grid } from "./Grid";
import { framed, raster, toPixels, type Window } from "./window";

const WIDTH = 560;
const HEIGHT = 320;
const CELLS = 400;

/** A crane, the posture that it is shown in, and the worker that computes its chart. */
export interface Compared {
  readonly crane: Crane;
  readonly posture: Posture;
  readonly charts: Charts;
}

/** Sections of the workspace with load charts; each crane in harbour that has no such mode. */
export function SideBySide({ designs, mode }: { designs: readonly Compared[]; mode: string }) {
  const window = useMemo(
    () =>
      framed(
        designs.map(({ crane }) => crane),
        WIDTH,
        HEIGHT,
      ),
    [designs],
  );
  const [sections, setSections] = useState<readonly Painted[]>([]);
  const [failure, setFailure] = useState("");
  useEffect(() => {
    let wanted = true;
    setSections([]);
    setFailure("");
    compute(designs, mode, window, () => wanted, setSections).catch((error: Error) => setFailure(error.message));
    return () => {
      wanted = false;
    };
  }, [designs, mode, window]);
  return (
    <div className="side-by-side">
      {designs.map(({ crane, posture }, i) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: two designs may have one name
        <figure key={i} data-testid={`compared-${i}`} data-most={sections[i]?.most} aria-label={crane.name}>
          <Picture crane={crane} posture={posture} window={window} painted={sections[i]} />
          <figcaption>
            <b className={i === 0 ? "mine" : "theirs"}>{crane.name}</b>,{" "}
            {modeLabel(modes(crane).find(({ name }) => name === mode) ?? HARBOUR)}
          </figcaption>
        </figure>
      ))}
      {failure && (
        <p className="failure" role="alert">
          The load charts cannot be computed: {failure}
        </p>
      )}
    </div>
  );
}

/** Shows the sections, then with the colours of the one that lifts most, then with more postures until they are complete. */
async function compute(
  designs: readonly Compared[],
  mode: string,
  window: Window,
  wanted: () => boolean,
  show: (sections: readonly Painted[]) => void,
): Promise<void> {
  const view = raster(window, CELLS);
  // nothing more is asked once nobody waits for it: that would take the place of what is asked instead
  const all = async (ask: (design: Compared, i: number) => Promise<Painted | null>) => {
    const found = (await Promise.all(designs.map(ask))).flatMap((one) => one ?? []);
    return wanted() && found.length === designs.length ? found : null;
  };
  const first = await all(({ crane, charts }) => charts.ask<"section">({ kind: "section", crane, mode, view }));
  if (!first) return;
  const most = Math.max(...first.map((one) => one.most));
  let sections = await all(({ crane, charts }) => charts.ask<"section">({ kind: "section", crane, mode, view, most }));
  while (sections) {
    show(sections);
    const before = sections;
    if (before.every(({ complete }) => complete)) return;
    sections = await all(async ({ charts }, i) =>
      before[i].complete ? before[i] : charts.ask<"refined">({ kind: "refined", most }),
    );
  }
}

interface PictureProps {
  readonly crane: Crane;
  readonly posture: Posture;
  readonly window: Window;
  readonly painted?: Painted;
}

function Picture({ crane, posture, window, painted }: PictureProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    const to = canvas.current;
    if (!to || !painted) return;
    const { width, height } = painted.view;
    Object.assign(to, { width, height });
    to.getContext("2d")?.putImageData(new ImageData(new Uint8ClampedArray(painted.pixels), width, height), 0, 0);
  }, [painted]);
  return (
    <div className="section" style={{ aspectRatio: `${WIDTH} / ${HEIGHT}` }}>
      <canvas ref={canvas} style={painted && placed(painted, window)} />
      <svg viewBox={`0 0 ${WIDTH} ${HEIGHT}`}>
        <title>{`Side view of ${crane.name} with its load chart`}</title>
        <Grid window={window} waterline={-crane.pedestal[2]} />
        <Figure crane={crane} posture={posture} window={window} />
      </svg>
      {painted && <ColourBar most={painted.most} step={painted.step} />}
      <p className="stamp">Not a certified load chart</p>
    </div>
  );
}

/** Where the raster lies in its picture. */
function placed({ view }: Painted, window: Window) {
  const corner = [view.x - 0.5 * view.cell, view.z + (view.height - 0.5) * view.cell] as const;
  const [left, top] = toPixels(window, corner);
  const part = (pixels: number, of: number) => `${(100 * pixels) / of}%`;
  return {
    left: part(left, WIDTH),
    top: part(top, HEIGHT),
    width: part(view.width * view.cell * window.scale, WIDTH),
    height: part(view.height * view.cell * window.scale, HEIGHT),
  };
}
