import { lazy, Suspense, useCallback, useEffect, useState } from "react";
import { type Bench, BenchContext } from "./context";
import { CompareDialog } from "./panels/Compare";
import { Curves } from "./panels/Curves";
import { Help } from "./panels/Help";
import { Inspector } from "./panels/Inspector";
import { NewDialog } from "./panels/New";
import { Notice } from "./panels/Notice";
import { Optimise } from "./panels/Optimise";
import { Problems } from "./panels/Problems";
import { TopBar } from "./panels/TopBar";
import { Verdict } from "./panels/Verdict";
import { VersionsDialog } from "./panels/Versions";
import { saveJson } from "./saving";
import { Section } from "./section/Section";
import { simulated } from "./server";

const Solid = lazy(() => import("./solid/Solid"));

export type Show = "section" | "both" | "solid";
export type Dialog = "new" | "versions" | "compare" | "help" | null;

export function App({ bench }: { bench: Bench }) {
  const { designer } = bench;
  const [show, setShow] = useState<Show>("section");
  const [dialog, setDialog] = useState<Dialog>(null);
  const [searching, setSearching] = useState(false);
  const close = useCallback(() => setDialog(null), []);

  useEffect(() => {
    const hear = (event: KeyboardEvent) => {
      const typing = event.target instanceof Element && event.target.closest("input, select, textarea");
      if (event.ctrlKey || event.metaKey) {
        const key = event.key.toLowerCase();
        if (key === "z" && !typing) {
          event.preventDefault();
          event.shiftKey ? designer.redo() : designer.undo();
        } else if (key === "y" && !typing) {
          event.preventDefault();
          designer.redo();
        } else if (key === "s") {
          event.preventDefault();
          saveJson(designer.store.getState().crane);
        }
        return;
      }
      if (typing || event.altKey) return;
      if (event.key === "?") setDialog((now) => (now === "help" ? null : "help"));
      else if (event.key === "1") setShow("section");
      else if (event.key === "2") setShow("both");
      else if (event.key === "3") setShow("solid");
      else if (event.key === "n") setDialog("new");
      else if (event.key === "o") setSearching((now) => !now);
    };
    window.addEventListener("keydown", hear);
    return () => window.removeEventListener("keydown", hear);
  }, [designer]);

  const simulate = useCallback(
    async (load: number) => {
      const { crane, posture } = designer.store.getState();
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
    },
    [designer],
  );

  return (
    <BenchContext value={bench}>
      <div className="page" data-show={show}>
        <TopBar show={show} onShow={setShow} onDialog={setDialog} />
        <Inspector />
        <main className="stage" aria-label="Drawing">
          {show !== "solid" && <Section />}
          {show !== "section" && (
            <Suspense fallback={<section className="solid" />}>
              <Solid />
            </Suspense>
          )}
          <Notice />
        </main>
        <aside className="results" aria-label={searching ? "Optimisation" : "Load chart"}>
          <nav className="modes" aria-label="Load chart or optimisation">
            <button
              type="button"
              aria-pressed={!searching}
              data-testid="show-chart"
              onClick={() => setSearching(false)}
            >
              Load chart
            </button>
            <button
              type="button"
              aria-pressed={searching}
              data-testid="show-optimise"
              onClick={() => setSearching(true)}
            >
              Optimise
            </button>
          </nav>
          <Problems />
          {searching ? (
            <Optimise />
          ) : (
            <>
              <Curves />
              <Verdict onSimulate={simulate} />
            </>
          )}
        </aside>
      </div>
      <NewDialog open={dialog === "new"} onClose={close} />
      <VersionsDialog open={dialog === "versions"} onClose={close} />
      <CompareDialog open={dialog === "compare"} onClose={close} />
      <Help open={dialog === "help"} onClose={close} />
    </BenchContext>
  );
}
