// Where the panels are and how wide, as somebody left them; kept in the browser.
import { createStore } from "zustand/vanilla";

const KEPT = "seacrane.designer.layout";

export type Side = "design" | "results";

export interface Layout {
  /** Widths of the panels [px]; null for what suits the window. */
  readonly widths: Readonly<Record<Side, number | null>>;
  readonly shown: Readonly<Record<Side, boolean>>;
  /** Whether the results are on the left. */
  readonly swapped: boolean;
  /** Of the drawing's width, where both pictures are shown. */
  readonly share: number;
}

export const USUAL: Layout = {
  widths: { design: null, results: null },
  shown: { design: true, results: true },
  swapped: false,
  share: 0.5,
};

/** [px] */
export const WIDTHS: Readonly<Record<Side, readonly [least: number, most: number]>> = {
  design: [220, 560],
  results: [260, 760],
};
export const SHARES: readonly [least: number, most: number] = [0.2, 0.8];

/** Widths where nobody has said others, in a window that is wide or not [px]. */
export const SUITING: Readonly<Record<"wide" | "narrow", Readonly<Record<Side, number>>>> = {
  wide: { design: 330, results: 420 },
  narrow: { design: 292, results: 340 },
};

export function within([least, most]: readonly [number, number], value: number): number {
  return Math.min(Math.max(value, least), most);
}

export function createLayout() {
  const store = createStore<Layout>(() => recovered());
  store.subscribe((layout) => {
    try {
      localStorage.setItem(KEPT, JSON.stringify(layout));
    } catch {
      // A browser that stores nothing has the usual layout after a reload.
    }
  });
  return {
    store,
    /** A width within the bounds; null for what suits the window. */
    widen(side: Side, width: number | null): void {
      const next = width === null ? null : Math.round(within(WIDTHS[side], width));
      store.setState(({ widths }) => ({ widths: { ...widths, [side]: next } }));
    },
    toggle(side: Side): void {
      store.setState(({ shown }) => ({ shown: { ...shown, [side]: !shown[side] } }));
    },
    swap(): void {
      store.setState(({ swapped }) => ({ swapped: !swapped }));
    },
    share(share: number): void {
      store.setState({ share: within(SHARES, share) });
    },
    reset(): void {
      store.setState(USUAL);
    },
  };
}

export type LayoutStore = ReturnType<typeof createLayout>;

/** The layout that was kept, as far as it can be one. */
function recovered(): Layout {
  let kept: Record<string, unknown>;
  try {
    kept = Object(JSON.parse(localStorage.getItem(KEPT) ?? "{}"));
  } catch {
    return USUAL;
  }
  const [widths, shown] = [Object(kept.widths), Object(kept.shown)];
  const width = (side: Side) => (Number.isFinite(widths[side]) ? within(WIDTHS[side], widths[side]) : null);
  return {
    widths: { design: width("design"), results: width("results") },
    shown: { design: shown.design !== false, results: shown.results !== false },
    swapped: kept.swapped === true,
    share: Number.isFinite(kept.share) ? within(SHARES, kept.share as number) : USUAL.share,
  };
}
