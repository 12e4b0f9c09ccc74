import { lazy, Suspense, useEffect, useRef } from "react";
import { hear } from "./commands";
import { type Bench, BenchContext, useBench, useLayout, useView } from "./context";
import { SHARES, USUAL } from "./layout";
import { CompareDialog } from "./panels/Compare";
import { Curves } from "./panels/Curves";
import { Files } from "./panels/Files";
import { Help } from "./panels/Help";
import { Inspector } from "./panels/Inspector";
import { LinkDialog } from "./panels/Link";
import { NewDialog } from "./panels/New";
import { Notice } from "./panels/Notice";
import { Optimise } from "./panels/Optimise";
import { Palette } from "./panels/Palette";
import { Problems } from "./panels/Problems";
import { Separator } from "./panels/Separator";
import { Edge, Panel, useWidths } from "./panels/Side";
import { TopBar } from "./panels/TopBar";
import { useVerdict, Verdict } from "./panels/Verdict";
import { VersionsDialog } from "./panels/Versions";
import { Section } from "./section/Section";
import { WORKSPACE } from "./view";

const Solid = lazy(() => import("./solid/Solid"));

export function App({ bench }: { bench: Bench }) {
  useEffect(() => {
    const heard = (event: KeyboardEvent) => hear(bench, event);
    window.addEventListener("keydown", heard);
    return () => window.removeEventListener("keydown", heard);
  }, [bench]);
  return (
    <BenchContext value={bench}>
      <Page />
      <Files />
      <Dialogs />
    </BenchContext>
  );
}

function Page() {
  const { shown, swapped } = useLayout((state) => state);
  const widths = useWidths();
  useVerdict();
  const design = (
    <Panel key="design" side="design" label="Design">
      <Inspector />
    </Panel>
  );
  const results = <Results key="results" />;
  const [left, right] = swapped ? (["results", "design"] as const) : (["design", "results"] as const);
  const width = (side: typeof left) => (shown[side] ? `minmax(0, ${widths[side]}px)` : "0");
  // In the order in which they are seen, for the tabulator
  return (
    <div
      className="page"
      style={{ gridTemplateColumns: `${width(left)} auto minmax(320px, 1fr) auto ${width(right)}` }}
    >
      <TopBar />
      {swapped ? results : design}
      <Edge key={`edge ${left}`} side={left} />
      <Stage key="stage" />
      <Edge key={`edge ${right}`} side={right} />
      {swapped ? design : results}
    </div>
  );
}

/** The crane: from the side over its load chart, in three dimensions, or both. */
function Stage() {
  const { layout } = useBench();
  const show = useView((state) => state.show);
  const share = useLayout((state) => state.share);
  const stage = useRef<HTMLElement>(null);
  const percent = Math.round(100 * share);
  return (
    <main
      ref={stage}
      className="stage"
      aria-label="Drawing"
      style={show === "both" ? { gridTemplateColumns: `minmax(0, ${share}fr) auto minmax(0, ${1 - share}fr)` } : {}}
    >
      {show !== "solid" && <Section />}
      {show === "both" && (
        <div className="edge">
          <Separator
            label="Width of the workspace"
            controls={WORKSPACE}
            value={percent}
            range={[100 * SHARES[0], 100 * SHARES[1]]}
            text={`${percent} percent`}
            steps={[2, 0.5]}
            perPixel={() => 100 / (stage.current?.clientWidth ?? 1)}
            onChange={(next) => layout.share(next / 100)}
            onUsual={() => layout.share(USUAL.share)}
          />
        </div>
      )}
      {show !== "section" && (
        <Suspense fallback={<section className="solid" />}>
          <Solid />
        </Suspense>
      )}
      <Notice />
    </main>
  );
}

function Results() {
  const { view } = useBench();
  const results = useView((state) => state.results);
  return (
    <Panel side="results" label={results === "optimise" ? "Optimisation" : "Load chart"}>
      <nav className="modes" aria-label="Load chart or optimisation">
        <button
          type="button"
          aria-pressed={results === "chart"}
          data-testid="show-chart"
          onClick={() => view.set({ results: "chart" })}
        >
          Load chart
        </button>
        <button
          type="button"
          aria-pressed={results === "optimise"}
          data-testid="show-optimise"
          onClick={() => view.set({ results: "optimise" })}
        >
          Optimise
        </button>
      </nav>
      <Problems />
      {results === "optimise" ? (
        <Optimise />
      ) : (
        <>
          <Curves />
          <Verdict />
        </>
      )}
    </Panel>
  );
}

function Dialogs() {
  const { view } = useBench();
  const dialog = useView((state) => state.dialog);
  return (
    <>
      <NewDialog open={dialog === "new"} onClose={view.close} />
      <VersionsDialog open={dialog === "versions"} onClose={view.close} />
      <CompareDialog open={dialog === "compare"} onClose={view.close} />
      <LinkDialog open={dialog === "link"} onClose={view.close} />
      <Help />
      <Palette />
    </>
  );
}
