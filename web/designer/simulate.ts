import { HARBOUR, modes } from "../core/design/types";
import type { Bench } from "./context";
import { simulated } from "./server";

/** Opens the crane in the posture shown, with what it may lift there, in the sea of the mode, on an operation page. */
export async function simulate({ designer, view }: Bench): Promise<void> {
  const { crane, posture, mode } = designer.store.getState();
  const load = view.store.getState().verdict?.load ?? 0;
  const { waveHeight } = modes(crane).find(({ name }) => name === mode) ?? HARBOUR;
  // Opened at once, by the click: a browser holds back a window that opens later.
  const page = window.open("", "_blank");
  if (page) page.document.body.textContent = `${crane.name} is being built. A crane that is new takes half a minute.`;
  try {
    const address = await simulated(crane, posture, load, waveHeight);
    if (page) page.location.href = address;
    else designer.tell(`The crane runs at ${address}`);
  } catch (error) {
    page?.close();
    designer.tell((error as Error).message, "wrong");
  }
}
