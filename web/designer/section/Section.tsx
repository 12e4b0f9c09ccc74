// The crane's plane: the load chart below, the crane in its posture above, and handles on all that can be dragged.
import { useElementSize } from "@mantine/hooks";
import { type KeyboardEvent, type PointerEvent, useCallback, useEffect, useMemo, useRef, useState } from "react";
import { dragged, type Handle, nudged, type Steps } from "../../core/design/edit";
import type { Point } from "../../core/design/plane";
import { inStep } from "../../core/design/together";
import { fixed, TONNE } from "../../core/units";
import type { Found, Painted } from "../chart.worker";
import { useBench, useDesigner, useView } from "../context";
import { follow } from "../pointer";
import { CLOSER, WORKSPACE } from "../view";
import { ColourBar } from "./ColourBar";
import { Drawing } from "./Drawing";
import { Grid } from "./Grid";
import { type Grip, grips } from "./handles";
import { framed, raster, toMetres, toPixels, type Window, zoomed } from "./window";

const CELLS = 600;
const DEGREE = Math.PI / 180;
const FRAME = 14;
const REST = 90;

function steps(event: { altKey: boolean; shiftKey: boolean }): Steps {
  if (event.altKey) return { length: 0, angle: 0 };
  return event.shiftKey ? { length: 0.01, angle: 0.1 * DEGREE } : { length: 0.1, angle: DEGREE };
}

export function Section() {
  const { designer, view, sections } = useBench();
  const crane = useDesigner((state) => state.crane);
  const posture = useDesigner((state) => state.posture);
  const mode = useDesigner((state) => state.mode);
  const dragging = useDesigner((state) => state.dragging);
  const { ref: host, width, height } = useElementSize();
  const look = useView((state) => state.look);
  const fitted = useView((state) => state.fitted);
  const fits = useView((state) => state.fits);
  const [painted, setPainted] = useState<Painted | null>(null);
  const [failure, setFailure] = useState<string | null>(null);
  const [pointed, setPointed] = useState<{ at: Point; found: Found } | null>(null);
  const [active, setActive] = useState<string | null>(null);
  const canvas = useRef<HTMLCanvasElement>(null);
  const coarse = useRef(1);
  const spare = useRef<ArrayBuffer>(undefined);
  const fittedTo = useRef("");

  // All that the crane reaches, fitted anew only for another crane, another number of links or another size of the drawing: it must not move while
  // something is dragged.
  useEffect(() => {
    const to = `${crane.name} ${crane.links.length} ${width} ${height} ${fits}`;
    if (!width || !height || fittedTo.current === to) return;
    fittedTo.current = to;
    view.set({ fitted: framed(crane, width, height) });
  }, [view, crane, width, height, fits]);

  const window = useMemo<Window | null>(() => {
    if (!fitted) return null;
    return { ...(look ? { x: look.x, z: look.z, scale: fitted.scale * look.zoom } : fitted), width, height };
  }, [look, fitted, width, height]);

  const show = useCallback((answer: Painted) => {
    const to = canvas.current;
    if (to) {
      const { width, height } = answer.view;
      if (to.width !== width || to.height !== height) Object.assign(to, { width, height });
      to.getContext("2d")?.putImageData(new ImageData(new Uint8ClampedArray(answer.pixels), width, height), 0, 0);
      to.dataset.took = answer.took.toFixed(2);
      to.dataset.painted = String(Number(to.dataset.painted ?? 0) + 1);
      to.dataset.most = String(answer.most);
      to.dataset.complete = String(answer.complete);
    }
    spare.current = answer.pixels;
    setPainted(answer);
    setFailure(null);
  }, []);

  const taken = useCallback(() => {
    const pixels = spare.current;
    spare.current = undefined;
    return pixels;
  }, []);

  const request = useCallback(
    async (factor: number) => {
      if (!window || window.width < 10 || window.height < 10) return null;
      const begun = performance.now();
      const view = raster(window, CELLS / factor);
      const answer = await sections.ask<"section">({ kind: "section", crane, mode, view, pixels: taken() });
      if (!answer) return null;
      show(answer);
      if (canvas.current) canvas.current.dataset.waited = (performance.now() - begun).toFixed(2);
      // halfway to what would have taken a frame
      const fitting = factor * Math.sqrt(answer.took / FRAME);
      coarse.current = Math.min(3, Math.max(1, Math.sqrt(coarse.current * fitting)));
      return answer;
    },
    [sections, crane, mode, window, show, taken],
  );

  // While dragging as many cells as a frame allows; then all of them, and where there is a choice of postures, more of those.
  useEffect(() => {
    let wanted = true;
    const paintAll = async () => {
      let answer = await request(coarse.current);
      if (dragging) return;
      if (coarse.current > 1) {
        await new Promise((done) => setTimeout(done, REST));
        if (wanted) answer = await request(1);
      }
      while (wanted && answer && !answer.complete) {
        answer = await sections.ask<"refined">({ kind: "refined", pixels: taken() });
        if (wanted && answer) show(answer);
      }
    };
    paintAll().catch((error: Error) => setFailure(error.message));
    return () => {
      wanted = false;
    };
  }, [request, dragging, sections, show, taken]);

  // ---------------------------------------------------------------- the pointer
  const svg = useRef<SVGSVGElement>(null);
  const metres = useCallback(
    (event: { clientX: number; clientY: number }): Point => {
      const box = svg.current!.getBoundingClientRect();
      return toMetres(window!, [event.clientX - box.left, event.clientY - box.top]);
    },
    [window],
  );

  useEffect(() => {
    const element = svg.current;
    if (!element || !window) return;
    const wheel = (event: WheelEvent) => {
      event.preventDefault();
      const box = element.getBoundingClientRect();
      view.look(zoomed(window, [event.clientX - box.left, event.clientY - box.top], Math.exp(-0.0015 * event.deltaY)));
    };
    element.addEventListener("wheel", wheel, { passive: false });
    return () => element.removeEventListener("wheel", wheel);
  }, [window, view]);

  const point = async (event: PointerEvent) => {
    const at = metres(event);
    const found = await sections.ask<"point">({ kind: "point", x: at[0], z: at[1] }).catch(() => null);
    setPointed(found && { at, found });
  };

  const pan = (event: PointerEvent<SVGSVGElement>) => {
    if (event.button > 1 || !window) return;
    const from = metres(event);
    const [x0, y0] = [event.clientX, event.clientY];
    const start = window;
    let moved = false;
    follow(event.currentTarget, event.pointerId, {
      move: (next) => {
        const [dx, dy] = [next.clientX - x0, next.clientY - y0];
        if (!moved && Math.hypot(dx, dy) < 4) return;
        moved = true;
        view.look({ ...start, x: start.x - dx / start.scale, z: start.z + dy / start.scale });
      },
      done: () => {
        if (moved || event.button === 1) return;
        void sections.ask<"point">({ kind: "point", x: from[0], z: from[1] }).then((found) => {
          if (found) designer.pose(found.posture);
        });
      },
    });
  };

  const grab = (event: PointerEvent<SVGGElement>, grip: Grip) => {
    if (event.button !== 0 || !window) return;
    event.stopPropagation();
    event.currentTarget.focus();
    const from = metres(event);
    const held: Point = [grip.at[0] - from[0], grip.at[1] - from[1]];
    pick(grip.handle);
    designer.begin();
    const begun = designer.store.getState();
    setActive(grip.key);
    setPointed(null);
    follow(event.currentTarget, event.pointerId, {
      move: (next) => {
        const [x, z] = metres(next);
        // a joint goes on from where it is, past half a turn; a shape is always the one from before with one change
        const from = grip.handle.kind === "joint" ? designer.store.getState() : begun;
        const scene = dragged(from, grip.handle, [x + held[0], z + held[1]], steps(next));
        designer.change({ ...scene, crane: inStep(from.crane, scene.crane) });
      },
      done: (cancelled) => {
        setActive(null);
        cancelled ? designer.cancel() : designer.end(grip.label);
      },
    });
  };

  const pick = (handle: Handle) => {
    if (handle.kind === "pin") designer.select({ kind: "cylinder", index: handle.cylinder });
    else if (handle.kind === "sheave" || handle.kind === "drum") designer.select({ kind: "hoist" });
    else designer.select({ kind: "link", index: handle.link });
  };

  const key = (event: KeyboardEvent, grip: Grip) => {
    const direction = ARROWS[event.key];
    if (!direction || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    event.stopPropagation();
    const { crane, posture } = designer.store.getState();
    const next = nudged(
      { crane, posture },
      grip.handle,
      ...direction,
      steps({ altKey: false, shiftKey: event.shiftKey }),
    );
    designer.apply(grip.label, inStep(crane, next.crane), next.posture);
  };

  const arc = useCallback(
    (link: number) => {
      const scale = window?.scale ?? 20;
      return Math.min(Math.max(0.16 * (CELLS / scale), 46 / scale), 96 / scale) * (link % 2 ? 1 : 0.8);
    },
    [window?.scale],
  );
  const all = useMemo(() => grips({ crane, posture }, arc), [crane, posture, arc]);
  const shown = all.find((grip) => grip.key === active);
  const corner =
    window &&
    painted &&
    toPixels(window, [
      painted.view.x - 0.5 * painted.view.cell,
      painted.view.z + (painted.view.height - 0.5) * painted.view.cell,
    ]);
  const size = window && painted && painted.view.cell * window.scale;

  return (
    <section id={WORKSPACE} className="section" aria-label="Section of the workspace" ref={host} data-testid="section">
      <canvas
        ref={canvas}
        data-testid="raster"
        style={
          corner && size
            ? {
                transform: `translate(${corner[0]}px, ${corner[1]}px)`,
                width: painted.view.width * size,
                height: painted.view.height * size,
              }
            : undefined
        }
      />
      {window && window.width > 0 && (
        <svg
          ref={svg}
          width={window.width}
          height={window.height}
          onPointerDown={pan}
          onPointerMove={(event) => {
            if (!dragging && event.buttons === 0) void point(event);
          }}
          onPointerLeave={() => setPointed(null)}
          onDoubleClick={() => view.all()}
        >
          <title>Side view of the crane with its load chart</title>
          <Grid window={window} waterline={-crane.pedestal[2]} />
          {painted?.labels.map(({ x, z, load }) => {
            const [px, py] = toPixels(window, [x, z]);
            return (
              <text key={`${load} ${x} ${z}`} className="contour" x={px} y={py}>
                {fixed(load / TONNE, load % TONNE ? 1 : 0)}
              </text>
            );
          })}
          <Drawing window={window} arc={arc} />
          {all.map((grip) => {
            const [px, py] = toPixels(window, grip.at);
            return (
              <g
                key={grip.key}
                className={`grip ${grip.handle.kind}`}
                data-active={active === grip.key}
                data-testid={grip.key}
                transform={`translate(${px} ${py})`}
                tabIndex={0}
                role="slider"
                aria-label={grip.label}
                aria-valuenow={Number(grip.now.toFixed(3))}
                aria-valuetext={grip.value}
                onPointerDown={(event) => grab(event, grip)}
                onKeyDown={(event) => key(event, grip)}
                onFocus={() => setActive(grip.key)}
                onBlur={() => setActive(null)}
              >
                <title>{`${grip.label}: ${grip.value}`}</title>
                <circle className="target" r={12} />
                {SHAPES[grip.handle.kind]}
              </g>
            );
          })}
          {shown && <Tag at={toPixels(window, shown.at)} lines={[shown.label, shown.value]} width={window.width} />}
          {pointed && !dragging && !shown && (
            <Tag
              at={toPixels(window, pointed.at)}
              width={window.width}
              lines={[
                `${fixed(pointed.found.load / TONNE, 1)} t, ${pointed.found.governs}`,
                `radius ${fixed(pointed.at[0], 1)} m, height ${fixed(pointed.at[1], 1)} m`,
              ]}
            />
          )}
        </svg>
      )}
      {painted && <ColourBar most={painted.most} step={painted.step} />}
      {failure && (
        <p className="failure" role="alert">
          The load chart cannot be computed: {failure}
        </p>
      )}
      <p className="stamp">Not a certified load chart</p>
      <div className="zoom">
        <button type="button" aria-label="Closer" onClick={() => view.closer(CLOSER)}>
          +
        </button>
        <button type="button" aria-label="Further away" onClick={() => view.closer(1 / CLOSER)}>
          {"\u2212"}
        </button>
        <button type="button" data-testid="fit" onClick={() => view.all()}>
          Fit
        </button>
      </div>
    </section>
  );
}

const ARROWS: Record<string, readonly [number, number] | undefined> = {
  ArrowLeft: [-1, 0],
  ArrowRight: [1, 0],
  ArrowUp: [0, 1],
  ArrowDown: [0, -1],
};

const SHAPES: Record<Handle["kind"], React.ReactNode> = {
  joint: <circle r={6.5} />,
  end: <rect x={-5.5} y={-5.5} width={11} height={11} rx={1.5} />,
  limit: <path d="M0 -6.5 L6.5 0 L0 6.5 L-6.5 0 Z" />,
  pin: <circle r={4.5} />,
  sheave: <circle r={4.5} />,
  drum: <circle r={4.5} />,
};

function Tag({ at: [x, y], lines, width }: { at: Point; lines: readonly string[]; width: number }) {
  const wide = 14 + 6.6 * Math.max(...lines.map((line) => line.length));
  const left = x + 18 + wide > width ? x - 18 - wide : x + 18;
  return (
    <g className="tag" transform={`translate(${left} ${Math.max(y - 44, 8)})`}>
      <rect width={wide} height={38} rx={4} />
      {lines.map((line, i) => (
        <text key={line} x={8} y={15 + 16 * i}>
          {line}
        </text>
      ))}
    </g>
  );
}
