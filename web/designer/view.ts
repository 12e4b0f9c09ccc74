// How the work is looked at, which is no part of the design and no step of undo: pictures, cameras, panels, dialogs.
import { createStore } from "zustand/vanilla";
import type { Verdict } from "../core/design/curve";
import type { Window } from "./section/window";
import type { DesignerStore } from "./store";

/** Where the workspace is in the page. */
export const WORKSPACE = "workspace";

export type Show = "section" | "both" | "solid";
export type Results = "chart" | "optimise";
export type Dialog = "new" | "versions" | "compare" | "link" | "help" | "palette";
export type Vec = readonly [number, number, number];

/** What of the crane's plane is shown: its middle [m], and how much closer than where all of the crane is seen. */
export interface Look {
  readonly x: number;
  readonly z: number;
  readonly zoom: number;
}

/** Where the eye is and what it looks at, in the crane's frame [m]. */
export interface Camera {
  readonly eye: Vec;
  readonly target: Vec;
}

/** The tools of the picture in three dimensions. */
export interface Tools {
  /** Where the crane is cut open, as a share of the room to either side; null while it is whole. */
  readonly cut: number | null;
  readonly explode: number;
  readonly measuring: boolean;
  readonly moving: boolean;
  readonly volume: boolean;
  readonly centres: boolean;
}

export interface View {
  readonly show: Show;
  readonly results: Results;
  readonly dialog: Dialog | null;
  /** What somebody chose to look at; null for all of the crane. */
  readonly look: Look | null;
  /** The window that shows all of the crane, as it was when it was last fitted; null until there is a drawing. */
  readonly fitted: Window | null;
  /** How often all was asked for. */
  readonly fits: number;
  readonly camera: Camera | null;
  readonly tools: Tools;
  /** What the posture shown may lift; null until it is known. */
  readonly verdict: Verdict | null;
}

/** What one step of the zoom does. */
export const CLOSER = 1.25;
export const ZOOMS: readonly [least: number, most: number] = [0.05, 100];

export function createView({ store: designer }: DesignerStore) {
  const store = createStore<View>(() => ({
    show: "section",
    results: "chart",
    dialog: null,
    look: null,
    fitted: null,
    fits: 0,
    camera: null,
    tools: { cut: null, explode: 0, measuring: false, moving: false, volume: false, centres: false },
    verdict: null,
  }));
  // Another crane is looked at whole, another length of the same is not.
  designer.subscribe((now, before) => {
    if (now.crane.name !== before.crane.name) store.setState({ look: null, camera: null });
  });
  return {
    store,
    set(some: Partial<View>): void {
      store.setState(some);
    },
    open(dialog: Dialog): void {
      store.setState({ dialog });
    },
    close(): void {
      store.setState({ dialog: null });
    },
    tool(some: Partial<Tools>): void {
      // Distances between parts that are taken apart mean nothing
      const other = some.measuring ? { explode: 0 } : some.explode ? { measuring: false } : {};
      store.setState(({ tools }) => ({ tools: { ...tools, ...some, ...other } }));
    },
    /** All of the crane, in every picture. */
    all(): void {
      store.setState(({ fits }) => ({ look: null, camera: null, fits: fits + 1 }));
    },
    /** This piece of the plane. */
    look({ x, z, scale }: Window): void {
      store.setState(({ fitted }) => (fitted ? { look: { x, z, zoom: scale / fitted.scale } } : {}));
    },
    /** Closer by a factor, the middle kept. */
    closer(by: number): void {
      store.setState(({ look, fitted }) => {
        if (!fitted) return {};
        const { x, z, zoom } = look ?? { ...fitted, zoom: 1 };
        return { look: { x, z, zoom: Math.min(Math.max(zoom * by, ZOOMS[0]), ZOOMS[1]) } };
      });
    },
  };
}

export type ViewStore = ReturnType<typeof createView>;
