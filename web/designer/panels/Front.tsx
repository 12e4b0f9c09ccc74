import { useState } from "react";
import { best, type Front, largerIsBetter, range, result, sized, sizes, unitOfGoal } from "../../core/design/optimise";
import { colour } from "../../core/design/paint";
import { factor } from "../../core/design/quantity";
import { DASH, fixed } from "../../core/units";
import { keyOf } from "../search";
import { gridStep } from "../section/window";
import { usePlotSize } from "./plotSize";

const LEFT = 40;
const TOP = 20;
const BOTTOM = 32;
const NEAR = 12;

interface Props {
  front: Front;
  /** What the crane that the search began with reaches in each goal, SI. */
  stands: readonly number[] | null;
  /** Why none can be built, of the candidate that misses least. */
  hindered: readonly string[];
  /** The candidate that is the design now, by its key. */
  loaded: string | null;
  onLoad: (index: number) => void;
}

/** The front over two goals, a third by colour; what is under the pointer in numbers; and as a table. */
export function FrontView({ front, stands, hindered, loaded, onLoad }: Props) {
  const [axes, setAxes] = useState<readonly [x: number, y: number, shade: number]>([0, 1, 2]);
  // What was pointed at last stays shown, so that one can read on with the pointer elsewhere.
  const [under, setUnder] = useState<string | null>(null);
  const count = front.goals.length;
  const x = Math.min(axes[0], count - 1);
  const y = axes[1] < count && axes[1] !== x ? axes[1] : x === 0 ? 1 : 0;
  const others = front.goals.map((_, i) => i).filter((i) => i !== x && i !== y);
  const shade = others.includes(axes[2]) ? axes[2] : (others[0] ?? null);
  const order = best(front, x);
  const shown = order.find((index) => keyOf(front, index) === (under ?? loaded)) ?? null;
  return (
    <>
      <div className="axes">
        <Chooser
          label="Across"
          value={x}
          of={front}
          among={front.goals.map((_, i) => i)}
          onChange={(next) => setAxes([next, next === y ? x : y, axes[2]])}
        />
        <Chooser
          label="Up"
          value={y}
          of={front}
          among={front.goals.map((_, i) => i)}
          onChange={(next) => setAxes([next === x ? y : x, next, axes[2]])}
        />
        {shade !== null && (
          <Chooser label="Colour" value={shade} of={front} among={others} onChange={(next) => setAxes([x, y, next])} />
        )}
      </div>
      {order.length === 0 ? (
        <div className="hint" data-testid="hindered">
          None of the {front.values.length} candidates can be built so far. Of the one that misses least:
          <ul>
            {hindered.map((words) => (
              <li key={words}>{words}</li>
            ))}
          </ul>
        </div>
      ) : (
        <Scatter
          front={front}
          order={order}
          stands={stands}
          axes={[x, y, shade]}
          loaded={loaded}
          shown={shown}
          onPoint={setUnder}
          onLoad={onLoad}
        />
      )}
      <Numbers front={front} index={shown} stands={stands} />
      <Table front={front} order={order} x={x} loaded={loaded} onPoint={setUnder} onLoad={onLoad} />
    </>
  );
}

interface ChooserProps {
  label: string;
  value: number;
  of: Front;
  among: readonly number[];
  onChange: (goal: number) => void;
}

function Chooser({ label, value, of, among, onChange }: ChooserProps) {
  return (
    <label>
      <span>{label}</span>
      <select value={value} onChange={(event) => onChange(Number(event.currentTarget.value))}>
        {among.map((goal) => (
          <option key={of.goals[goal].name} value={goal}>
            {of.goals[goal].name}
          </option>
        ))}
      </select>
    </label>
  );
}

interface ScatterProps {
  front: Front;
  order: readonly number[];
  stands: readonly number[] | null;
  axes: readonly [x: number, y: number, shade: number | null];
  loaded: string | null;
  shown: number | null;
  onPoint: (key: string) => void;
  onLoad: (index: number) => void;
}

function Scatter({ front, order, stands, axes: [gx, gy, shade], loaded, shown, onPoint, onLoad }: ScatterProps) {
  const { ref, width, height } = usePlotSize(0.8, 460);
  const scaleOf = (goal: number, from: number, to: number) => {
    const unit = factor(unitOfGoal(front.goals[goal].kind));
    const ends = range([...order.map((index) => front.results[index][goal]), ...(stands ? [stands[goal]] : [])]);
    const [low, high] = ends.map((end) => end / unit);
    const per = (to - from) / (high - low);
    const step = gridStep(Math.abs(per), Math.abs(to - from) / 6);
    const ticks = Array.from({ length: Math.floor(high / step) - Math.ceil(low / step) + 1 }, (_, i) =>
      Number(((Math.ceil(low / step) + i) * step).toPrecision(12)),
    );
    const decimals = Math.max(0, -Math.floor(Math.log10(step)));
    return { at: (value: number) => from + (value / unit - low) * per, per, unit, ticks, decimals };
  };
  const [x, y] = [scaleOf(gx, LEFT, width - 8), scaleOf(gy, height - BOTTOM, TOP)];
  const place = (results: readonly number[]) => [x.at(results[gx]), y.at(results[gy])] as const;
  const shades = shade === null ? null : order.map((index) => front.results[index][shade]);
  const [darkest, brightest] = shades ? [Math.min(...shades), Math.max(...shades)] : [0, 0];
  const fill = (index: number) => {
    if (shade === null) return undefined;
    const share = brightest > darkest ? (front.results[index][shade] - darkest) / (brightest - darkest) : 1;
    return `rgb(${colour(share).join(" ")})`;
  };
  const beaten = front.violation.flatMap((v, index) => (v <= 0 && !front.best[index] ? [index] : []));
  const impossible = front.violation.filter((v) => v > 0).length;
  const nearest = (event: { clientX: number; clientY: number; currentTarget: SVGSVGElement }) => {
    const box = event.currentTarget.getBoundingClientRect();
    const scale = width / box.width;
    const [px, py] = [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
    const away = (index: number) => {
      const [cx, cy] = place(front.results[index]);
      return Math.hypot(cx - px, cy - py);
    };
    const found = [...order].sort((a, b) => away(a) - away(b))[0];
    return away(found) <= NEAR ? found : null;
  };
  const axis = (goal: number, less: string, more: string) => {
    const { name, kind } = front.goals[goal];
    return `${name} [${unitOfGoal(kind)}] ${largerIsBetter(kind) ? more : less} better`;
  };
  return (
    <>
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: the table below does the same by keyboard */}
      <svg
        ref={ref}
        className="plot front"
        height={height}
        viewBox={`0 0 ${width} ${height}`}
        role="img"
        aria-label={`${order.length} designs that none beats in every goal: ${front.goals[gy].name} over ${front.goals[gx].name}`}
        data-testid="front"
        onPointerMove={(event) => {
          const index = nearest(event);
          if (index !== null) onPoint(keyOf(front, index));
        }}
        onClick={(event) => {
          const index = nearest(event);
          if (index !== null) onLoad(index);
        }}
      >
        <clipPath id="front-area">
          <rect x={LEFT} y={TOP - 8} width={width - LEFT} height={height - BOTTOM - TOP + 8} />
        </clipPath>
        {x.ticks.map((value) => (
          <g key={value} className="rule">
            <line x1={x.at(value * x.unit)} x2={x.at(value * x.unit)} y1={TOP} y2={height - BOTTOM} />
            <text x={x.at(value * x.unit)} y={height - BOTTOM + 13} textAnchor="middle">
              {fixed(value, x.decimals)}
            </text>
          </g>
        ))}
        {y.ticks.map((value) => (
          <g key={value} className="rule">
            <line x1={LEFT} x2={width - 8} y1={y.at(value * y.unit)} y2={y.at(value * y.unit)} />
            <text x={LEFT - 4} y={y.at(value * y.unit) + 4} textAnchor="end">
              {fixed(value, y.decimals)}
            </text>
          </g>
        ))}
        <g clipPath="url(#front-area)">
          {beaten.map((index) => {
            const [cx, cy] = place(front.results[index]);
            return <circle key={index} className="beaten" cx={cx} cy={cy} r={2} />;
          })}
        </g>
        {order.map((index) => {
          const [cx, cy] = place(front.results[index]);
          return (
            <circle
              key={keyOf(front, index)}
              className="best"
              data-testid="candidate"
              data-index={index}
              cx={cx}
              cy={cy}
              r={4.5}
              style={{ fill: fill(index) }}
            />
          );
        })}
        {stands && <Diamond at={place(stands)} />}
        {order
          .filter((index) => index === shown || keyOf(front, index) === loaded)
          .map((index) => {
            const [cx, cy] = place(front.results[index]);
            return (
              <circle
                key={index}
                className={keyOf(front, index) === loaded ? "ring loaded" : "ring"}
                cx={cx}
                cy={cy}
                r={8}
              />
            );
          })}
        <text className="name" x={width - 8} y={height - 4} textAnchor="end">
          {axis(gx, "\u2190", "\u2192")}
        </text>
        <text className="name" x={4} y={11}>
          {axis(gy, "\u2193", "\u2191")}
        </text>
      </svg>
      {shade !== null && (
        <p className="shades">
          <span>{result(front.goals[shade].kind, darkest)}</span>
          <i style={{ background: `linear-gradient(to right, ${SHADES})` }} />
          <span>
            {result(front.goals[shade].kind, brightest)} {unitOfGoal(front.goals[shade].kind)}
          </span>
        </p>
      )}
      <p className="hint">
        {[
          ...(stands ? ["\u25c7 the crane that the search began with"] : []),
          ...(beaten.length ? [`small: ${beaten.length} that others beat`] : []),
          ...(impossible ? [`left out: ${impossible} that cannot be built`] : []),
        ].join("; ")}
      </p>
    </>
  );
}

const SHADES = Array.from({ length: 9 }, (_, i) => `rgb(${colour(i / 8).join(" ")})`).join(", ");

function Diamond({ at: [x, y] }: { at: readonly [number, number] }) {
  const r = 6.5;
  return (
    <polygon className="stands" points={`${x},${y - r} ${x + r},${y} ${x},${y + r} ${x - r},${y}`}>
      <title>Where the search began</title>
    </polygon>
  );
}

interface NumbersProps {
  front: Front;
  index: number | null;
  stands: readonly number[] | null;
}

/** Results and sizes of one candidate, beside those that the search began with. */
function Numbers({ front, index, stands }: NumbersProps) {
  const known = sizes(front.crane);
  return (
    <table className="numbers" data-testid="candidate-numbers">
      <thead>
        <tr>
          <th scope="col">Point at a design; a click takes it</th>
          <th scope="col">design</th>
          <th scope="col">{"\u25c7"} start</th>
        </tr>
      </thead>
      <tbody>
        {front.goals.map(({ name, kind }, i) => (
          <tr key={name} className="goal">
            <th scope="row">
              {name} [{unitOfGoal(kind)}]
            </th>
            <td>{index === null ? DASH : result(kind, front.results[index][i])}</td>
            <td>{stands ? result(kind, stands[i]) : DASH}</td>
          </tr>
        ))}
        {front.variables.map(({ path }, i) => {
          const size = known.find((item) => item.path === path);
          return (
            <tr key={path}>
              <th scope="row">{size ? `${size.owner} ${size.label}` : path}</th>
              <td>{index === null ? DASH : sized(front.values[index][i], size?.unit ?? "m")}</td>
              <td>{size ? sized(size.now, size.unit) : DASH}</td>
            </tr>
          );
        })}
      </tbody>
    </table>
  );
}

interface TableProps {
  front: Front;
  order: readonly number[];
  x: number;
  loaded: string | null;
  onPoint: (key: string) => void;
  onLoad: (index: number) => void;
}

/** The same designs by keyboard, by growing result across. */
function Table({ front, order, x, loaded, onPoint, onLoad }: TableProps) {
  if (order.length === 0) return null;
  const columns = [x, ...front.goals.map((_, i) => i).filter((i) => i !== x)];
  return (
    <div className="front-table">
      <table>
        <thead>
          <tr>
            {columns.map((goal) => (
              <th key={front.goals[goal].name} scope="col">
                {front.goals[goal].name} [{unitOfGoal(front.goals[goal].kind)}]
              </th>
            ))}
            <th scope="col" aria-label="Take" />
          </tr>
        </thead>
        <tbody>
          {order.map((index) => {
            const key = keyOf(front, index);
            return (
              <tr key={key} aria-current={key === loaded} onPointerEnter={() => onPoint(key)}>
                {columns.map((goal) => (
                  <td key={front.goals[goal].name}>{result(front.goals[goal].kind, front.results[index][goal])}</td>
                ))}
                <td>
                  <button type="button" className="plain" onFocus={() => onPoint(key)} onClick={() => onLoad(index)}>
                    Take
                  </button>
                </td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </div>
  );
}
