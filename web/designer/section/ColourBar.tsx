import { colour } from "../../core/design/paint";
import { fixed, TONNE } from "../../core/units";

const STOPS = 16;

/** What the colours of the section mean, in tonnes. */
export function ColourBar({ most, step }: { most: number; step: number }) {
  // the brightest colour is that of all larger loads too: its tick says so, and has room
  const ticks = Array.from({ length: Math.ceil(0.94 * (most / step)) }, (_, i) => i * step);
  const gradient = Array.from({ length: STOPS + 1 }, (_, i) => `rgb(${colour(i / STOPS).join(" ")})`).join(", ");
  return (
    <figure className="colour-bar" aria-label={`Colours: 0 to ${most / TONNE} t`}>
      <figcaption>SWL [t]</figcaption>
      <div style={{ background: `linear-gradient(to top, ${gradient})` }}>
        {ticks.map((load) => (
          <span key={load} style={{ bottom: `${(100 * load) / most}%` }}>
            {fixed(load / TONNE, step < TONNE ? 1 : 0)}
          </span>
        ))}
        <span style={{ bottom: "100%" }}>{`\u2265\u2009${Number((most / TONNE).toPrecision(2))}`}</span>
      </div>
    </figure>
  );
}
