import { Button } from "@mantine/core";
import { useMemo } from "react";
import { type CraneAxis, craneAxes } from "../../core/axes";
import { BESIDE, LEFT_ACROSS, LEFT_ALONG, type Place, places, RIGHT_ACROSS, RIGHT_ALONG } from "../../core/driving";
import type { Axes } from "../../rpc/messages";
import { keyName } from "./keys";
import { usePage, useSession } from "./usePage";

/** The sticks as they are asked for now, the dead man's lamp, and who holds the controls. */
export function SticksPanel() {
  const session = useSession();
  const { axes, deadman, source } = usePage((page) => page.demand);
  const model = usePage((page) => page.model);
  const at = useMemo(() => {
    const where = places(model?.axes ?? []);
    const known = model ? craneAxes(model) : [];
    return (place: Place) => known.find(({ name }) => where.get(name) === place);
  }, [model]);
  const driver = usePage((page) => page.status?.driver ?? null);
  const you = usePage((page) => page.status?.you ?? null);
  const open = usePage((page) => page.link === "open");
  const mine = driver !== null && driver === you;
  const holder = mine ? "You hold the controls" : driver ? `Client ${driver} holds the controls` : "Controls are free";
  return (
    <section className="sticks" aria-label="Controls">
      <Stick title="Left" across={[at(LEFT_ACROSS), LEFT_ACROSS]} along={[at(LEFT_ALONG), LEFT_ALONG]} axes={axes} />
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
      {/* Pulling back hoists: along the right stick the positive sense is back. */}
      <Stick
        title="Right"
        across={[at(RIGHT_ACROSS), RIGHT_ACROSS]}
        along={[at(RIGHT_ALONG), RIGHT_ALONG]}
        axes={axes}
        pulled
      />
      {BESIDE.map((place) => at(place) && <Beside key={place.plus[0]} axis={at(place)!} place={place} axes={axes} />)}
    </section>
  );
}

type Held = readonly [axis: CraneAxis | undefined, place: Place];

interface StickProps {
  title: string;
  /** Positive is to the left. */
  across: Held;
  /** Positive is forward, or back if it is pulled. */
  along: Held;
  axes: Axes;
  pulled?: boolean;
}

function Stick({ title, across, along, axes, pulled }: StickProps) {
  const x = -value(across[0], axes);
  const y = (pulled ? -1 : 1) * value(along[0], axes);
  const said = [across, along].flatMap(([axis]) => axis?.senses ?? []).join(", ");
  return (
    <div className="stick" role="img" aria-label={`${title} stick: ${said || "nothing"}`}>
      <Legend className="forward" of={along} sense={pulled ? 1 : 0} />
      <Legend className="left" of={across} sense={0} />
      <svg viewBox="-1.3 -1.3 2.6 2.6" aria-hidden="true">
        <rect x="-1.2" y="-1.2" width="2.4" height="2.4" rx="0.35" className="gate" />
        <path d="M-1 0H1M0-1V1" className="cross" />
        <line x1="0" y1="0" x2={x} y2={-y} className="shaft" />
        <circle cx={x} cy={-y} r="0.3" className="knob" data-moved={x !== 0 || y !== 0} />
      </svg>
      <Legend className="right" of={across} sense={1} />
      <Legend className="back" of={along} sense={pulled ? 0 : 1} />
    </div>
  );
}

/** An axis beside the sticks, as a lever of its own. */
function Beside({ axis, place, axes }: { axis: CraneAxis; place: Place; axes: Axes }) {
  const y = value(axis, axes);
  return (
    <div className="stick lever" role="img" aria-label={`Lever: ${axis.senses.join(", ")}`}>
      <Legend className="forward" of={[axis, place]} sense={0} />
      <svg viewBox="-1.3 -1.3 2.6 2.6" aria-hidden="true">
        <rect x="-0.45" y="-1.2" width="0.9" height="2.4" rx="0.35" className="gate" />
        <path d="M0-1V1" className="cross" />
        <circle cx={0} cy={-y} r="0.3" className="knob" data-moved={y !== 0} />
      </svg>
      <Legend className="back" of={[axis, place]} sense={1} />
    </div>
  );
}

function Legend({ className, of: [axis, place], sense }: { className: string; of: Held; sense: 0 | 1 }) {
  if (!axis) return <span className={className} />;
  return (
    <span className={className}>
      <kbd>{keyName((sense === 0 ? place.plus : place.minus)[0])}</kbd>
      <em>{axis.senses[sense]}</em>
    </span>
  );
}

function value(axis: CraneAxis | undefined, axes: Axes): number {
  return axis ? (axes[axis.name] ?? 0) : 0;
}
