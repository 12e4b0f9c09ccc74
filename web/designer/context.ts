import { createContext, useContext, useMemo } from "react";
import { useStore } from "zustand";
import type { Charts } from "./charts";
import { type Command, commands } from "./commands";
import type { Layout, LayoutStore } from "./layout";
import type { Searching, SearchStore } from "./search";
import type { Designer, DesignerStore } from "./store";
import type { View, ViewStore } from "./view";

export interface Bench {
  readonly designer: DesignerStore;
  readonly view: ViewStore;
  readonly search: SearchStore;
  readonly layout: LayoutStore;
  /** Two workers: sections must not wait for curves. */
  readonly sections: Charts;
  readonly curves: Charts;
}

export const BenchContext = createContext<Bench | null>(null);

export function useBench(): Bench {
  const bench = useContext(BenchContext);
  if (!bench) throw new Error("there is no designer above");
  return bench;
}

export function useDesigner<T>(select: (designer: Designer) => T): T {
  return useStore(useBench().designer.store, select);
}

export function useView<T>(select: (view: View) => T): T {
  return useStore(useBench().view.store, select);
}

export function useSearch<T>(select: (searching: Searching) => T): T {
  return useStore(useBench().search.store, select);
}

export function useLayout<T>(select: (layout: Layout) => T): T {
  return useStore(useBench().layout.store, select);
}

/** All that can be ordered as the page stands. */
export function useCommands(): readonly Command[] {
  const bench = useBench();
  const states = [
    useStore(bench.designer.store),
    useStore(bench.view.store),
    useStore(bench.search.store),
    useStore(bench.layout.store),
  ];
  return useMemo(() => commands(bench), [bench, ...states]);
}
