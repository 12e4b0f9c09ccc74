// The designs that come with the package, each loaded when it is wanted; they are the types a new crane starts from.
import { fromData } from "../core/design/file";
import type { Crane } from "../core/design/types";

const FILES = import.meta.glob<{ default: unknown }>("../../src/seacrane/design/cranes/*.json");

export interface Shipped {
  readonly name: string;
  readonly type: string;
  readonly load: () => Promise<Crane>;
}

const TYPES: Readonly<Record<string, string>> = {
  "offshore-100t": "Knuckle boom",
  "gunnerus-pk65": "Knuckle boom with telescope",
  "a-frame-30t": "A-frame",
  "dual-drag-link-60t": "Dual drag link",
  "gangway-24m": "Telescopic gangway",
};

export const SHIPPED: readonly Shipped[] = Object.entries(FILES).map(([path, load]) => {
  const name = path.split("/").pop()!.replace(".json", "");
  return { name, type: TYPES[name] ?? name, load: async () => fromData((await load()).default) };
});
