// The whole check of the package, once the work has come to rest. What dragging brings about is said at once by the page
// itself (core/design/check.ts); plates thicker than their part, names used twice and the like are said a moment later.
import type { Problem } from "../core/design/check";
import type { Crane } from "../core/design/types";
import type { DesignerStore } from "./store";

const REST = 250;

/** Asks about each crane that stays for a moment, from now on; returns what ends it. `ask` fails where there is no server. */
export function keepChecked(designer: DesignerStore, ask: (crane: Crane) => Promise<readonly Problem[]>): () => void {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const check = async () => {
    const { crane } = designer.store.getState();
    const found = await ask(crane).catch(() => []);
    if (designer.store.getState().crane === crane) designer.found(found);
  };
  const rest = () => {
    clearTimeout(timer);
    timer = setTimeout(check, REST);
  };
  const stop = designer.store.subscribe((now, before) => {
    if (now.crane !== before.crane) rest();
  });
  rest();
  return () => {
    clearTimeout(timer);
    stop();
  };
}
