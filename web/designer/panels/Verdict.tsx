import { useEffect } from "react";
import { fixed, TONNE } from "../../core/units";
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

/** What the posture shown may lift, and what each limit alone would allow. */
export function Verdict() {
  const bench = useBench();
  const value = useView((state) => state.verdict);
  if (!value) return null;
  const least = Math.max(value.load, 1);
  return (
    <section className="verdict" aria-label="Load in the posture shown">
      <h2>In this posture</h2>
      <p className="load">
        <b data-testid="load" data-value={value.load}>
          {fixed(value.load / TONNE, 1)}
        </b>{" "}
        t <span>{value.load > 0 ? `${value.governs} governs` : `nothing: ${value.governs}`}</span>
      </p>
      <p className="hint">
        radius <b>{fixed(value.radius, 2)} m</b>, height <b>{fixed(value.height, 2)} m</b>
      </p>
      <table>
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
      <button
        type="button"
        className="wide"
        data-testid="simulate"
        disabled={!(value.load > 0)}
        onClick={() => simulate(bench)}
      >
        Simulate from here with {fixed(value.load / TONNE, 1)} t
      </button>
    </section>
  );
}
