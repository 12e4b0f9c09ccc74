import { useMediaQuery } from "@mantine/hooks";
import type { ReactNode } from "react";
import { useBench, useLayout } from "../context";
import { type Side, SUITING, WIDTHS } from "../layout";
import { Separator } from "./Separator";

const NAMES: Readonly<Record<Side, string>> = { design: "design panel", results: "results panel" };

/** How wide the panels are now [px]. */
export function useWidths(): Readonly<Record<Side, number>> {
  const wide = useMediaQuery("(min-width: 1700px)", false, { getInitialValueInEffect: false });
  const { widths } = useLayout((state) => state);
  const suiting = SUITING[wide ? "wide" : "narrow"];
  return { design: widths.design ?? suiting.design, results: widths.results ?? suiting.results };
}

/** A panel beside the drawing. */
export function Panel({ side, label, children }: { side: Side; label: string; children: ReactNode }) {
  const shown = useLayout((state) => state.shown[side]);
  const left = useIsLeft(side);
  return (
    <aside
      id={`panel-${side}`}
      className={side === "design" ? "inspector" : "results"}
      aria-label={label}
      hidden={!shown}
      style={{ gridArea: left ? "left" : "right" }}
    >
      {children}
    </aside>
  );
}

/** The edge between a panel and the drawing, with what folds the panel away and brings it back. */
export function Edge({ side }: { side: Side }) {
  const { layout } = useBench();
  const shown = useLayout((state) => state.shown[side]);
  const width = useWidths()[side];
  const left = useIsLeft(side);
  const name = NAMES[side];
  return (
    <div className="edge" data-folded={!shown} style={{ gridArea: left ? "left-edge" : "right-edge" }}>
      {shown && (
        <Separator
          label={`Width of the ${name}`}
          controls={`panel-${side}`}
          value={width}
          range={WIDTHS[side]}
          text={`${width} pixels`}
          steps={[16, 1]}
          perPixel={() => (left ? 1 : -1)}
          onChange={(next) => layout.widen(side, next)}
          onUsual={() => layout.widen(side, null)}
          onFold={() => layout.toggle(side)}
        />
      )}
      <button
        type="button"
        className="fold"
        aria-expanded={shown}
        aria-controls={`panel-${side}`}
        aria-label={shown ? `Hide the ${name}` : `Show the ${name}`}
        title={`${shown ? "Hide" : "Show"} the ${name} (${side === "design" ? "I" : "R"})`}
        data-testid={`fold-${side}`}
        onClick={() => layout.toggle(side)}
      >
        {left === shown ? "\u2039" : "\u203a"}
      </button>
    </div>
  );
}

function useIsLeft(side: Side): boolean {
  return useLayout((state) => (side === "design") !== state.swapped);
}
