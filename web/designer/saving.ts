// Work that outlives the page: the newest state within two seconds, and versions kept by name.
import { fromData, text } from "../core/design/file";
import { readSearch, type Specification, searchText } from "../core/design/optimise";
import type { Posture } from "../core/design/plane";
import type { Crane } from "../core/design/types";
import type { DesignerStore } from "./store";

const CURRENT = "seacrane.designer.current";
const VERSIONS = "seacrane.designer.versions";
const SEARCH = "seacrane.designer.search";
const PAUSE = 1000;

export interface Recovered {
  readonly crane: Crane;
  readonly posture: Posture;
  readonly at: number;
}

export interface Version {
  readonly name: string;
  readonly at: number;
  readonly crane: Crane;
}

/** What was being worked on when the page was left; null if there is nothing that can be read. */
export function recovered(): Recovered | null {
  try {
    const kept = JSON.parse(localStorage.getItem(CURRENT) ?? "null");
    return kept && { crane: fromData(kept.crane), posture: kept.posture ?? {}, at: kept.at };
  } catch {
    return null;
  }
}

/** Keeps the newest state, at most a second old, from now on; returns what ends it. `failed` hears why it cannot. */
export function autosave({ store }: DesignerStore, failed: (reason: string) => void): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  let told = false;
  const save = () => {
    clearTimeout(timer);
    timer = undefined;
    const { crane, posture } = store.getState();
    try {
      localStorage.setItem(CURRENT, JSON.stringify({ crane, posture, at: Date.now() }));
      told = false;
    } catch {
      if (!told) failed("This browser keeps no more: save the design to a file.");
      told = true;
    }
  };
  const leave = () => timer !== undefined && save();
  const stop = store.subscribe((now, before) => {
    if (now.crane !== before.crane || now.posture !== before.posture) timer ??= setTimeout(save, PAUSE);
  });
  addEventListener("pagehide", leave);
  return () => {
    leave();
    stop();
    removeEventListener("pagehide", leave);
  };
}

export function versions(): Version[] {
  try {
    return JSON.parse(localStorage.getItem(VERSIONS) ?? "[]");
  } catch {
    return [];
  }
}

/** Throws where the browser keeps no more. */
export function keepVersions(kept: readonly Version[]): void {
  localStorage.setItem(VERSIONS, JSON.stringify(kept));
}

/** What was last asked of a search for better designs, if it was for a crane of this name. */
export function recoveredSearch(crane: Crane): Specification | null {
  return readSearch(localStorage.getItem(SEARCH), crane);
}

/** Throws where the browser keeps no more. */
export function keepSearch(wanted: Specification, crane: Crane): void {
  localStorage.setItem(SEARCH, searchText(wanted, crane));
}

/** Hands a file to the person. */
export function download(name: string, content: BlobPart, type: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], { type }));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

export function saveJson(crane: Crane): void {
  download(`${crane.name}.json`, text(crane), "application/json");
}
