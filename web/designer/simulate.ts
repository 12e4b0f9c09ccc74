import type { Bench } from "./context";
import { simulated } from "./server";

/** Opens the crane in the posture shown, with what it may lift there, on an operation page. */
export async function simulate({ designer, view }: Bench): Promise<void> {
  const { crane, posture } = designer.store.getState();
  const load = view.store.getState().verdict?.load ?? 0;
  // Opened at once, by the click: a browser holds back a window that opens later.
  const page = window.open("", "_blank");
  try {
    const address = await simulated(crane, posture, load);
    if (page) page.location.href = address;
    else designer.tell(`The crane runs at ${address}`);
  } catch (error) {
    page?.close();
    designer.tell((error as Error).message, "wrong");
  }
}
