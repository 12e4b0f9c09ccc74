import { ActionIcon, Button, Tooltip } from "@mantine/core";
import { clock, DASH, fixed } from "../../core/units";
import { usePage, useSession } from "./usePage";

interface Props {
  plotsOpen: boolean;
  onPlots: () => void;
  onHelp: () => void;
}

/** What the simulation does now: state, time, pace, cost, link. */
export function LiveBar({ plotsOpen, onPlots, onHelp }: Props) {
  const session = useSession();
  const status = usePage((page) => page.status);
  const link = usePage((page) => page.link);
  const time = usePage((page) => page.time);
  const latency = usePage((page) => page.latency);
  const frameRate = usePage((page) => page.frameRate);
  const name = usePage((page) => page.model?.crane.name);
  const state = stateOf(link, status);
  const live = link === "open" && status !== null;
  return (
    <header className="live-bar">
      <div className="title">
        <strong>seacrane</strong>
        <span>{name ?? ""}</span>
      </div>
      <output className="state" data-state={state} data-testid="state" aria-live="polite">
        {LABELS[state]}
      </output>
      <div className="controls">
        <Button
          size="compact-sm"
          variant="default"
          data-testid="pause"
          disabled={!live || Boolean(status?.error)}
          onClick={() => (status?.running ? session.pause() : session.resume())}
        >
          {status?.running === false ? "Resume" : "Pause"}
        </Button>
        <Button
          size="compact-sm"
          variant="default"
          data-testid="reset"
          disabled={!live}
          onClick={() => session.reset()}
        >
          Reset
        </Button>
      </div>
      <dl className="figures">
        <Figure label="Simulated" value={clock(time)} unit="" test="sim-time" raw={time} wide />
        <Figure
          label="Real-time factor"
          value={fixed(status?.real_time_factor, 2)}
          unit=""
          about="Computing time over simulated time: below 1 keeps up with the clock"
        />
        <Figure label="Step" value={status ? fixed(status.macro_step * 1e3, 1) : DASH} unit="ms" />
        <Figure
          label="Overruns"
          value={status ? String(status.overruns) : DASH}
          unit=""
          warn={(status?.overruns ?? 0) > 0}
          about={`Steps that came late; 99 % are less than ${fixed(status?.late_ms_p99, 1)} ms late`}
        />
        <Figure
          label="Latency"
          value={fixed(latency, latency !== null && latency < 10 ? 1 : 0)}
          unit="ms"
          about="Round trip of a call"
        />
        <Figure label="Frames" value={frameRate ? String(frameRate) : DASH} unit="1/s" />
        <Figure
          label="Clients"
          value={status ? String(status.clients) : DASH}
          unit=""
          test="clients"
          raw={status?.clients}
        />
      </dl>
      <div className="controls">
        <Button
          size="compact-sm"
          variant={plotsOpen ? "light" : "default"}
          aria-pressed={plotsOpen}
          onClick={onPlots}
          data-testid="toggle-plots"
        >
          Plots
        </Button>
        <Tooltip label="Keys and gamepad (?)">
          <ActionIcon variant="default" size="md" aria-label="Keys and gamepad" onClick={onHelp} data-testid="help">
            ?
          </ActionIcon>
        </Tooltip>
      </div>
    </header>
  );
}

type State = "connecting" | "lost" | "refused" | "error" | "finished" | "paused" | "running";

const LABELS: Record<State, string> = {
  connecting: "Connecting",
  lost: "Link lost",
  refused: "No access",
  error: "Stopped by an error",
  finished: "Finished",
  paused: "Paused",
  running: "Running",
};

function stateOf(link: string, status: { error: string | null; finished: boolean; running: boolean } | null): State {
  if (link === "lost" || link === "refused") return link;
  if (link === "connecting" || !status) return "connecting";
  if (status.error) return "error";
  if (status.finished) return "finished";
  return status.running ? "running" : "paused";
}

interface FigureProps {
  label: string;
  value: string;
  unit: string;
  about?: string;
  test?: string;
  raw?: number | null;
  warn?: boolean;
  wide?: boolean;
}

function Figure({ label, value, unit, about, test, raw, warn, wide }: FigureProps) {
  const figure = (
    <div className={wide ? "figure wide" : "figure"} data-warn={warn}>
      <dt>{label}</dt>
      <dd data-testid={test} data-value={raw ?? undefined}>
        {value}
        {unit && <small>{unit}</small>}
      </dd>
    </div>
  );
  return about ? <Tooltip label={about}>{figure}</Tooltip> : figure;
}
