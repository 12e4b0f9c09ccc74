import { useEffect } from "react";
import type { Held } from "../../core/design/holding";
import { type Crane, planeJoints } from "../../core/design/types";
import { BAR, fixed, TONNE } from "../../core/units";
import { useBench, useDesigner, useView } from "../context";
import { simulate } from "../simulate";

/** Keeps what the posture shown may lift up to date in the view. */
export function useVerdict(): void {
  const { view, curves: charts } = useBench();
  const crane = useDesigner((state) => state.crane);
  const posture = useDesigner((state) => state.posture);
  const mode = useDesigner((state) => state.mode);
  useEffect(() => {
    charts
      .ask<"posture">({ kind: "posture", crane, mode, posture })
      .then((verdict) => verdict && view.set({ verdict }))
      .catch(() => view.set({ verdict: null }));
  }, [view, charts, crane, posture, mode]);
}

/** Joints of the crane's plane that no cylinder moves, and no limit of the structure is about. */
export function unheld(crane: Crane): string[] {
  const structure = crane.rating?.structure ?? [];
  return planeJoints(crane)
    .map(({ name }) => name)
    .filter((name) => !crane.cylinders.some(({ moves }) => moves === name) && !structure.some((s) => s.joint === name));
}

/** What the posture shown may lift, and what each limit alone would allow. */
export function Verdict() {
  const bench = useBench();
  const value = useView((state) => state.verdict);
  const crane = useDesigner((state) => state.crane);
  if (!value) return null;
  const least = Math.max(value.load, 1);
  const free = unheld(crane);
  return (
    <section className="verdict" aria-label="Load in the posture shown">
      <h2>In this posture</h2>
      <p className="load">
        <b data-testid="load" data-value={value.load}>
          {fixed(value.load / TONNE, 1)}
        </b>{" "}
        t{" "}
        <span>
          {value.load > 0
            ? `${value.governs} governs`
            : `nothing: ${value.governs} bears the crane alone, or not even that`}
        </span>
      </p>
      <p className="hint">
        radius <b>{fixed(value.radius, 2)} m</b>, height <b>{fixed(value.height, 2)} m</b>
        <br />
        dynamic factor <b data-testid="dynamic">{fixed(value.dynamic, 2)}</b>
      </p>
      <button
        type="button"
        className="wide"
        data-testid="simulate"
        disabled={!(value.load > 0)}
        onClick={() => simulate(bench)}
      >
        Simulate from here with {fixed(value.load / TONNE, 1)} t
      </button>
      <table data-testid="limits">
        <caption>Allowed by each limit alone; its use as a bar</caption>
        <tbody>
          {value.shares.map(({ limit, load }) => (
            <tr key={limit} data-governs={limit === value.governs}>
              <th scope="row">{limit}</th>
              <td>
                <i style={{ width: `${Math.min(100, (100 * least) / Math.max(load, 1))}%` }} />
              </td>
              <td>{load < 1e7 ? `${fixed(load / TONNE, 1)} t` : "free"}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {value.held.length > 0 && <Cylinders held={value.held} load={value.load} cylinders={crane.cylinders} />}
      {free.length > 0 && (
        <p className="hint" data-testid="unheld">
          No cylinder moves {free.join(", ")}: taken as held, without a limit of its own.
        </p>
      )}
    </section>
  );
}

interface CylindersProps {
  held: readonly Held[];
  /** [kg] */
  load: number;
  cylinders: Crane["cylinders"];
}

/** What the cylinders bear with the load that may be lifted. */
function Cylinders({ held, load, cylinders }: CylindersProps) {
  return (
    <table className="held" data-testid="held">
      <caption>Cylinders {load > 0 ? `with ${fixed(load / TONNE, 1)} t, dynamics in` : "without a load"}</caption>
      <tbody>
        {held.map(({ cylinder, length, lever, pressure, side }, i) => (
          <tr key={cylinder}>
            <th scope="row">
              {cylinder}
              <small>
                {fixed(length, 2)} m between pins, lever {fixed(lever, 2)} m{side === "rod" && ", rod side"}
              </small>
            </th>
            <td>
              {Number.isFinite(pressure)
                ? `${fixed(pressure / BAR, 0)} of ${fixed((cylinders[i]?.pressure ?? 0) / BAR, 0)} bar`
                : "no lever"}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
