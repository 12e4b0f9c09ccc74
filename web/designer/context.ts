import { createContext, useContext } from "react";
import { useStore } from "zustand";
import type { Charts } from "./charts";
import type { Designer, DesignerStore } from "./store";

export interface Bench {
  readonly designer: DesignerStore;
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
