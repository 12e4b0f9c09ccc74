import { Button } from "@mantine/core";
import { usePage, useSession } from "./usePage";

/** Both sticks as they are asked for now, the dead man's lamp, and who holds the controls. */
export function SticksPanel() {
  const session = useSession();
  const { axes, deadman, source } = usePage((page) => page.demand);
  const driver = usePage((page) => page.status?.driver ?? null);
  const you = usePage((page) => page.status?.you ?? null);
  const open = usePage((page) => page.link === "open");
  const mine = driver !== null && driver === you;
  const holder = mine ? "You hold the controls" : driver ? `Client ${driver} holds the controls` : "Controls are free";
  return (
    <section className="sticks" aria-label="Controls">
      <Stick
        title="Left"
        x={-axes.slew}
        y={axes.jib}
        labels={["slew left", "slew right", "jib out", "jib in"]}
        keys={["A", "D", "W", "S"]}
      />
      <div className="driver">
        <div className="lamp" data-on={deadman} data-testid="deadman">
          <i aria-hidden="true" />
          <span>{deadman ? `Dead man: ${source}` : "Dead man released"}</span>
        </div>
        <div className="holder" data-testid="driver" data-driver={driver ?? ""} data-mine={mine}>
          {open ? holder : "No link"}
        </div>
        {mine ? (
          <Button size="compact-xs" variant="default" data-testid="release" onClick={() => void session.release()}>
            Release
          </Button>
        ) : (
          <Button
            size="compact-xs"
            variant={driver ? "filled" : "default"}
            color="yellow.8"
            data-testid="take-over"
            disabled={!open}
            onClick={() => void session.takeOver()}
          >
            {driver ? "Take over" : "Take the controls"}
          </Button>
        )}
      </div>
      <Stick
        title="Right"
        x={-axes.boom}
        y={-axes.hoist}
        labels={["boom up", "boom down", "lower", "hoist"]}
        keys={["\u2190", "\u2192", "\u2191", "\u2193"]}
      />
    </section>
  );
}

interface StickProps {
  title: string;
  /** Travel to the right and forward, -1 to 1. */
  x: number;
  y: number;
  /** Left, right, forward, back. */
  labels: [string, string, string, string];
  keys: [string, string, string, string];
}

function Stick({ title, x, y, labels, keys }: StickProps) {
  const [left, right, forward, back] = labels;
  const legend = (i: number) => (
    <>
      <kbd>{keys[i]}</kbd>
      <em>{labels[i]}</em>
    </>
  );
  return (
    <div className="stick" role="img" aria-label={`${title} stick: ${left}, ${right}; ${forward}, ${back}`}>
      <span className="forward">{legend(2)}</span>
      <span className="left">{legend(0)}</span>
      <svg viewBox="-1.3 -1.3 2.6 2.6" aria-hidden="true">
        <rect x="-1.2" y="-1.2" width="2.4" height="2.4" rx="0.35" className="gate" />
        <path d="M-1 0H1M0-1V1" className="cross" />
        <line x1="0" y1="0" x2={x} y2={-y} className="shaft" />
        <circle cx={x} cy={-y} r="0.3" className="knob" data-moved={x !== 0 || y !== 0} />
      </svg>
      <span className="right">{legend(1)}</span>
      <span className="back">{legend(3)}</span>
    </div>
  );
}
