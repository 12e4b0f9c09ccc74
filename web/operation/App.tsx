import { Loader } from "@mantine/core";
import { lazy, Suspense, useCallback, useEffect, useState } from "react";
import { useStore } from "zustand";
import { takesKeys } from "../core/keys";
import { Fallback } from "./panels/Fallback";
import { Help } from "./panels/Help";
import { Instruments } from "./panels/Instruments";
import { LinkNotice } from "./panels/LinkNotice";
import { LiveBar } from "./panels/LiveBar";
import { SticksPanel } from "./panels/SticksPanel";
import { SessionContext } from "./panels/usePage";
import type { Session } from "./session";
import { VIEWS, type View } from "./views";

const Scene = lazy(() => import("./scene/Scene"));
const Plots = lazy(() => import("./panels/Plots"));

export function App({ session }: { session: Session }) {
  const model = useStore(session.store, (page) => page.model);
  const [camera, setCamera] = useState<{ view: View; request: number }>({ view: "overview", request: 0 });
  const [plotsOpen, setPlotsOpen] = useState(window.innerWidth > 1250);
  const [helpOpen, setHelpOpen] = useState(false);
  const [ready, setReady] = useState(false);
  const look = useCallback((view: View) => setCamera(({ request }) => ({ view, request: request + 1 })), []);
  const onReady = useCallback(() => setReady(true), []);

  useEffect(() => {
    const hear = (event: KeyboardEvent) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.repeat || takesKeys(event.target)) return;
      const { status } = session.store.getState();
      const number = Number(event.key);
      if (event.key === "?") setHelpOpen((open) => !open);
      else if (VIEWS[number - 1]) look(VIEWS[number - 1].view);
      else if (event.key === "p") status?.running ? session.pause() : session.resume();
      else if (event.key === "v") setPlotsOpen((open) => !open);
      else if (event.key === "Escape" && status && status.driver === status.you) void session.release();
    };
    window.addEventListener("keydown", hear);
    return () => window.removeEventListener("keydown", hear);
  }, [session, look]);

  return (
    <SessionContext value={session}>
      <div className="page" data-plots={plotsOpen}>
        <LiveBar plotsOpen={plotsOpen} onPlots={() => setPlotsOpen(!plotsOpen)} onHelp={() => setHelpOpen(true)} />
        <Instruments />
        <main className="stage" data-testid="scene" data-ready={ready} aria-label="View of the crane">
          {model && (
            <Fallback>
              <Suspense fallback={<Loader className="stage-loader" />}>
                <Scene session={session} model={model} view={camera.view} request={camera.request} onReady={onReady} />
              </Suspense>
            </Fallback>
          )}
          <nav className="views" aria-label="Camera">
            {VIEWS.map(({ view, label }, i) => (
              <button
                key={view}
                type="button"
                aria-pressed={camera.view === view}
                data-testid={`view-${view}`}
                title={`${label} (${i + 1})`}
                onClick={() => look(view)}
              >
                {label}
              </button>
            ))}
          </nav>
          <SticksPanel />
          <LinkNotice />
        </main>
        {plotsOpen && (
          <Suspense fallback={<aside className="plots" />}>
            <Plots />
          </Suspense>
        )}
      </div>
      <Help open={helpOpen} onClose={() => setHelpOpen(false)} />
    </SessionContext>
  );
}
