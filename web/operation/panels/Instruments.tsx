import { DASH, fixed, symbol } from "../../core/units";
import { usePage } from "./usePage";

/** The crane's instruments: load moment first, then posture, hoist and hydraulics. */
export function Instruments() {
  const r = usePage((page) => page.readings);
  const stale = usePage((page) => page.link !== "open");
  return (
    <aside className="instruments" aria-label="Instruments" data-stale={stale && r !== null}>
      <LoadMoment
        load={r?.load ?? null}
        rated={r?.rated ?? null}
        radius={r?.radius ?? null}
        utilisation={r?.utilisation ?? null}
      />
      <section aria-label="Posture">
        <h2>Posture</h2>
        {r?.joints.map(({ axis, label, value, unit }) => (
          <Reading key={axis} label={label} value={value} decimals={unit === "m" ? 2 : 1} unit={unit} test={axis} />
        ))}
      </section>
      <section aria-label="Hoist">
        <h2>Hoist</h2>
        <Reading label="Hook height" value={r?.hookHeight} decimals={1} unit="m" test="hook-height" />
        <Reading label="Wire speed" value={r?.wireSpeed} decimals={2} unit="m/s" test="wire-speed" signed />
      </section>
      <section aria-label="Cylinder pressures">
        <h2>
          Cylinders <small>piston / rod side</small>
        </h2>
        {r?.pressures.map(({ label, piston, rod }) => (
          <div className="reading" key={label}>
            <span>{label[0].toUpperCase() + label.slice(1).replaceAll("_", " ")}</span>
            <b data-testid={`pressure-${label}`} data-value={piston ?? undefined}>
              {fixed(piston, 0)} / {fixed(rod, 0)}
            </b>
            <small>bar</small>
          </div>
        ))}
      </section>
      <section className="messages" aria-label="Messages" aria-live="polite" data-testid="messages">
        {r?.slack && <p className="caution">Slack rope</p>}
        {r?.rated === null && r.radius !== null && <p className="alarm">Outside the load chart</p>}
        {r?.limits.map((text) => (
          <p className="caution" key={text}>
            {text}
          </p>
        ))}
      </section>
    </aside>
  );
}

interface ReadingProps {
  label: string;
  value: number | null | undefined;
  decimals: number;
  unit: string;
  test: string;
  signed?: boolean;
}

function Reading({ label, value, decimals, unit, test, signed }: ReadingProps) {
  const text = fixed(value, decimals);
  return (
    <div className="reading">
      <span>{label}</span>
      <b data-testid={`reading-${test}`} data-value={value ?? undefined}>
        {signed && value && value > 0 && Number(value.toFixed(decimals)) > 0 ? `+${text}` : text}
      </b>
      <small>{symbol(unit)}</small>
    </div>
  );
}

interface MomentProps {
  load: number | null;
  rated: number | null;
  radius: number | null;
  utilisation: number | null;
}

/** Load against rated load at this radius, with the marks at which an operator is warned: 90, 100 and 110 %. */
function LoadMoment({ load, rated, radius, utilisation }: MomentProps) {
  const level = utilisation === null ? "none" : utilisation >= 100 ? "alarm" : utilisation >= 90 ? "caution" : "normal";
  const share = Math.min(100, ((utilisation ?? 0) / 120) * 100);
  return (
    <section className="moment" data-level={level} aria-label="Load moment">
      <h2>Load moment</h2>
      <div className="moment-figures">
        <b className="big" data-testid="reading-utilisation" data-value={utilisation ?? undefined}>
          {fixed(utilisation, 0)}
        </b>
        <small>%</small>
        {level === "alarm" && <span className="flag">OVERLOAD</span>}
        {level === "caution" && <span className="flag">NEAR LIMIT</span>}
      </div>
      {/* biome-ignore lint/a11y/useSemanticElements: a native meter cannot carry the marks of the alarms */}
      <div
        className="bar"
        role="meter"
        aria-label="Load over rated load at this radius"
        aria-valuemin={0}
        aria-valuemax={120}
        aria-valuenow={Math.round(Math.min(120, utilisation ?? 0))}
      >
        <i style={{ width: `${share}%` }} />
        {[90, 100, 110].map((mark) => (
          <u key={mark} style={{ left: `${(mark / 120) * 100}%` }} />
        ))}
      </div>
      <div className="scale" aria-hidden="true">
        {[0, 50, 90, 100, 110].map((mark) => (
          <span key={mark} style={{ left: `${(mark / 120) * 100}%` }}>
            {mark === 90 || mark === 110 ? "" : mark}
          </span>
        ))}
      </div>
      <Reading label="Hook load" value={load} decimals={1} unit="t" test="load" />
      <Reading label="Rated here" value={rated} decimals={1} unit="t" test="rated" />
      <Reading label="Radius" value={radius} decimals={2} unit="m" test="radius" />
      {utilisation === null && load !== null && <p className="hint">Rated load unknown at this radius ({DASH})</p>}
    </section>
  );
}
