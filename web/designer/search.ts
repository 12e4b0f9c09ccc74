// The search for better designs: what is asked of it, and what the server tells of it while it runs.
import { createStore } from "zustand/vanilla";
import { changes, type Front, fitting, lacking, MOST, type Specification, usual } from "../core/design/optimise";
import type { Crane } from "../core/design/types";
import { download, keepSearch, recoveredSearch } from "./saving";
import { beginSearch, changed, openFront, resumeSearch, type Search, search, stopSearch } from "./server";
import type { DesignerStore } from "./store";

const EVERY = 500;

export interface Searching {
  /** What the server last told; null before it was asked. */
  readonly told: Search | null;
  /** What was wrong with the last order. */
  readonly failure: string | null;
  readonly asked: { readonly of: string; readonly wanted: Specification } | null;
  /** The design that was last taken of the front, and which candidate it was. */
  readonly taken: { readonly crane: Crane; readonly key: string } | null;
}

/** Knows a candidate again in a later generation. */
export function keyOf(front: Front, index: number): string {
  return front.values[index].join(" ");
}

export function createSearch(designer: DesignerStore) {
  const store = createStore<Searching>(() => ({ told: null, failure: null, asked: null, taken: null }));
  let timer: ReturnType<typeof setTimeout> | undefined;
  let lost = false;

  /** What the server knows, asked again and again while it searches, though it cannot be reached for a while. */
  const look = async () => {
    clearTimeout(timer);
    try {
      const told = await search();
      store.setState(lost ? { told, failure: null } : { told });
      lost = false;
    } catch (error) {
      lost = true;
      const why = (error as Error).message;
      store.setState({ failure: running() ? `What the search has found since is not known. ${why}` : why });
    }
    if (running()) timer = setTimeout(look, EVERY);
  };
  const order = async (what: () => Promise<Search | null>) => {
    store.setState({ failure: null });
    try {
      const told = await what();
      if (!told) return;
      store.setState({ told });
      await look();
    } catch (error) {
      store.setState({ failure: (error as Error).message });
    }
  };
  const front = () => store.getState().told?.front ?? null;
  const running = () => store.getState().told?.running ?? false;

  return {
    store,
    look,

    /** What is asked of a search for this crane: as it was asked before, or what one would ask first. */
    wanted(crane: Crane, asked = store.getState().asked): Specification {
      return asked?.of === crane.name ? fitting(asked.wanted, crane) : (recoveredSearch(crane) ?? usual(crane));
    },
    ask(wanted: Specification): void {
      const { crane } = designer.store.getState();
      store.setState({ asked: { of: crane.name, wanted } });
      try {
        keepSearch(wanted, crane);
      } catch {
        designer.tell("This browser keeps no more: a reload will forget what the search was asked.", "wrong");
      }
    },

    /** Why a search cannot be begun, in words; null if it can. */
    hindrance(): string | null {
      return running() ? "A search is under way." : lacking(this.wanted(designer.store.getState().crane));
    },
    begin(): Promise<void> {
      const { crane } = designer.store.getState();
      return order(() => beginSearch(crane, this.wanted(crane)));
    },
    stop(): Promise<void> {
      return order(stopSearch);
    },

    /** How many generations more it would go on for; 0 if it cannot. */
    further(): number {
      const now = front();
      if (!now || running()) return 0;
      return Math.min(MOST - now.generation, this.wanted(designer.store.getState().crane).generations);
    },
    goOn(): Promise<void> {
      return order(() => resumeSearch((front()?.generation ?? 0) + this.further()));
    },

    /** The design of a candidate in place of the one on the bench. */
    take(index: number): Promise<void> {
      return order(async () => {
        const from = front();
        if (!from) return null;
        const crane = await changed(from.crane, changes(from, index));
        designer.apply("take a design of the front", crane);
        store.setState({ taken: { crane, key: keyOf(from, index) } });
        return null;
      });
    },

    save(): void {
      const now = front();
      if (now) download(`${now.crane.name}-front.json`, JSON.stringify(now), "application/json");
    },
    /** A saved front in place of the server's. */
    open(file: File): Promise<void> {
      return order(async () => {
        try {
          return await openFront(file);
        } catch (error) {
          throw new Error(`${file.name} is not opened. ${(error as Error).message}`);
        }
      });
    },
  };
}

export type SearchStore = ReturnType<typeof createSearch>;
