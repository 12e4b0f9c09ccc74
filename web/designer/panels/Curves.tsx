import { useEffect, useId, useState } from "react";
import type { Curve } from "../../core/design/curve";
import { type Crane, modeLabel, modes } from "../../core/design/types";
import { fixed, TONNE } from "../../core/units";
import type { Charts } from "../charts";
import { useBench, useDesigner } from "../context";
import { gridStep } from "../section/window";
import { namesOn } from "./curveNames";
import { usePlotSize } from "./plotSize";

const LEFT = 34;
const BOTTOM = 26;
const BAND = 0.5;
/** Half the width of a name on a curve [px]. */
const NAME = 30;
/** Above this the name of the axis stands at the left [px]. */
const CORNER = 24;

/** The curves of a crane, newest last; those shown stay until the new ones are there. */
export function useCurves(charts: Charts, crane: Crane): readonly Curve[] {
  const [curves, setCurves] = useState<readonly Curve[]>([]);
  useEffect(() => {
    charts
      .ask<"curves">({ kind: "curves", crane, width: BAND })
      .then((found) => found && setCurves(found))
      .catch(() => setCurves([]));
  }, [charts, crane]);
  return curves;
}

/** Load over radius: the mode shown bold, the other sea states thin. */
export function Curves() {
  const { designer, curves: charts } = useBench();
  const crane = useDesigner((state) => state.crane);
  const mode = useDesigner((state) => state.mode);
  const curves = useCurves(charts, crane);
  const sea = modes(crane);
  return (
    <section className="curves" aria-label="Load curves">
      <nav className="modes" aria-label="Mode">
        {sea.map((item) => (
          <button
            key={item.name}
            type="button"
            aria-pressed={item.name === mode}
            data-testid={`mode-${item.name}`}
            onClick={() => designer.setMode(item.name)}
          >
            {modeLabel(item)}
          </button>
        ))}
      </nav>
      <Plot
        lines={curves.map((curve) => {
          const item = sea.find(({ name }) => name === curve.mode);
          return { curve, kind: curve.mode === mode ? "chosen" : "other", name: item && modeLabel(item) };
        })}
        rated={crane.capacity}
      />
    </section>
  );
}

export interface Line {
  readonly curve: Curve;
  readonly kind: "chosen" | "other" | "compared";
  /** Written on it, where there is room. */
  readonly name?: string;
}

export function Plot({ lines, rated = [] }: { lines: readonly Line[]; rated?: Crane["capacity"] }) {
  const { ref, width, height } = usePlotSize(0.72, 420);
  const area = useId();
  const [at, setAt] = useState<number | null>(null);
  const chosen = lines.find((line) => line.kind === "chosen")?.curve;
  const furthest = Math.max(1, ...lines.map(({ curve }) => curve.radius.at(-1) ?? 0));
  const largest = Math.max(100, ...lines.map(({ curve }) => sensible(curve)));
  const top = 1.08 * largest;
  const x = (radius: number) => LEFT + ((width - LEFT - 8) * radius) / furthest;
  const y = (load: number) => height - BOTTOM - ((height - BOTTOM - 10) * Math.min(load, 1.2 * top)) / top;
  const every = gridStep((width - LEFT) / furthest, 44);
  const high = gridStep((height - BOTTOM) / (top / TONNE), 34) * TONNE;
  const order = [...lines].sort((a, b) => Number(a.kind === "chosen") - Number(b.kind === "chosen"));
  const named = [...order].reverse().flatMap(({ curve, name }) => (name ? [{ curve, name }] : []));
  const aside = (NAME * furthest) / Math.max(width - LEFT - 8, 1);
  const band = at === null || !chosen ? -1 : Math.round(at / BAND);
  const load = chosen?.load[band];
  return (
    <>
      <svg
        ref={ref}
        className="plot"
        height={height}
        viewBox={`0 0 ${width} ${height}`}
        role="img"
        aria-label={describe(chosen)}
        data-testid="curves"
        data-loads={
          chosen ? Array.from(chosen.load, (value) => (Number.isFinite(value) ? value.toFixed(0) : "")).join(",") : ""
        }
        onPointerMove={(event) => {
          const box = event.currentTarget.getBoundingClientRect();
          const px = ((event.clientX - box.left) * width) / box.width;
          setAt(((px - LEFT) * furthest) / (width - LEFT - 8));
        }}
        onPointerLeave={() => setAt(null)}
      >
        <clipPath id={area}>
          <rect x={LEFT} y={4} width={width - LEFT} height={height - BOTTOM - 4} />
        </clipPath>
        {Array.from({ length: Math.floor(furthest / every) + 1 }, (_, i) => i * every).map((radius) => (
          <g key={radius} className="rule">
            <line x1={x(radius)} x2={x(radius)} y1={4} y2={height - BOTTOM} />
            <text x={x(radius)} y={height - BOTTOM + 13} textAnchor="middle">
              {fixed(radius, every < 1 ? 1 : 0)}
            </text>
          </g>
        ))}
        {Array.from({ length: Math.floor(top / high) + 1 }, (_, i) => i * high).map((value) => (
          <g key={value} className="rule">
            <line x1={LEFT} x2={width} y1={y(value)} y2={y(value)} />
            <text x={LEFT - 4} y={y(value) + 4} textAnchor="end">
              {fixed(value / TONNE, high < TONNE ? 1 : 0)}
            </text>
          </g>
        ))}
        <g clipPath={`url(#${area})`}>
          {order.map(({ curve, kind }) => (
            <polyline
              key={`${kind} ${curve.mode}`}
              className={kind}
              points={Array.from(curve.radius, (radius, i) =>
                Number.isFinite(curve.load[i]) ? `${x(radius).toFixed(1)},${y(curve.load[i]).toFixed(1)}` : "",
              ).join(" ")}
            />
          ))}
          {rated.map(({ radius, mass }) => (
            <circle key={radius} className="rated" cx={x(radius)} cy={y(mass)} r={3}>
              <title>{`rated: ${fixed(mass / TONNE, 1)} t at ${fixed(radius, 1)} m`}</title>
            </circle>
          ))}
          {load !== undefined && load >= 0 && (
            <circle className="cursor" cx={x(chosen!.radius[band])} cy={y(load)} r={3.5} />
          )}
        </g>
        {namesOn(named, y, aside, furthest - aside)
          .filter(({ radius, load: value }) => y(value) > CORNER || x(radius) > LEFT + 3 * NAME)
          .map(({ name, radius, load: value }) => (
            <text key={name} className="curve" x={x(radius)} y={y(value) - 4} textAnchor="middle">
              {name}
            </text>
          ))}
        <text className="name" x={width - 8} y={height - 1} textAnchor="end">
          radius [m]
        </text>
        <text className="name" x={LEFT + 4} y={14}>
          SWL [t]
        </text>
      </svg>
      <p className="hint">
        {load !== undefined && load >= 0
          ? `${fixed(load / TONNE, 1)} t at ${fixed(chosen!.radius[band], 1)} m: ${chosen!.governs[band]} governs`
          : `Best posture at each radius${rated.length ? "; circles: rated loads of the design" : ""}`}
      </p>
    </>
  );
}

/** The largest load that the axis should reach: postures close to the slewing axis may bear any load. */
function sensible({ load }: Curve): number {
  const seen = Array.from(load)
    .filter((value) => value >= 0)
    .sort((a, b) => a - b);
  return seen.length ? Math.min(seen.at(-1)!, 2.5 * seen[Math.floor(0.6 * seen.length)] + 1) : 0;
}

function describe(curve: Curve | undefined): string {
  if (!curve) return "No load curve";
  const points: string[] = [];
  curve.radius.forEach((radius, i) => {
    if (radius % 5 === 0 && curve.load[i] >= 0) points.push(`${fixed(curve.load[i] / TONNE, 1)} t at ${radius} m`);
  });
  return `Load over radius, ${curve.mode}: ${points.join(", ")}`;
}
