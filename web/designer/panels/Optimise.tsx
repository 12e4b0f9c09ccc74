import "./optimise.css";
import { useEffect, useMemo, useState } from "react";
import {
  bounded,
  type Goal,
  LEAST_POPULATION,
  lacking,
  MOST,
  type Size,
  sized,
  sizes,
  type Variable,
} from "../../core/design/optimise";
import { type Crane, HARBOUR, modeLabel, modes } from "../../core/design/types";
import { useBench, useDesigner, useSearch } from "../context";
import { choose, FRONT_FILE } from "../files";
import { inWords } from "../server";
import { FrontView } from "./Front";
import { NumberField } from "./NumberField";

/** The search for designs that none beats in every goal: what may change, what is wanted, and the front as it grows. */
export function Optimise() {
  const { search } = useBench();
  const crane = useDesigner((state) => state.crane);
  const { told, failure, asked, taken } = useSearch((state) => state);
  const wanted = useMemo(() => search.wanted(crane, asked), [search, crane, asked]);
  const [open, setOpen] = useState(true);
  const running = told?.running ?? false;
  const front = told?.front ?? null;
  const missing = lacking(wanted);
  useEffect(() => {
    void search.look();
  }, [search]);
  return (
    <section className="optimise" aria-label="Optimisation">
      <details open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
        <summary>
          {counted(wanted.variables.length, "size")}, {counted(wanted.goals.length, "goal")}
        </summary>
        <Sizes crane={crane} chosen={wanted.variables} onChange={(variables) => search.ask({ ...wanted, variables })} />
        <Goals crane={crane} goals={wanted.goals} onChange={(goals) => search.ask({ ...wanted, goals })} />
        <h2>Effort</h2>
        <Count
          label="Population"
          value={wanted.population}
          least={LEAST_POPULATION}
          onChange={(population) => search.ask({ ...wanted, population })}
        />
        <Count
          label="Generations"
          value={wanted.generations}
          least={1}
          onChange={(generations) => search.ask({ ...wanted, generations })}
        />
      </details>
      {missing && <p className="wrong">{missing}</p>}
      <p className="tools">
        {running ? (
          <button type="button" data-testid="search-stop" onClick={() => search.stop()}>
            Stop
          </button>
        ) : (
          <button
            type="button"
            className="primary"
            data-testid="search-start"
            disabled={missing !== null}
            onClick={() => {
              setOpen(false);
              void search.begin();
            }}
          >
            Search
          </button>
        )}
        {front && !running && (
          <button
            type="button"
            title="With the sizes, goals and candidates of the front below"
            disabled={search.further() < 1}
            onClick={() => search.goOn()}
          >
            Go on for {search.further()} more
          </button>
        )}
        {front && (
          <button
            type="button"
            title="A file from which `seacrane design optimise --front` goes on too"
            data-testid="front-save"
            onClick={() => search.save()}
          >
            Save the front
          </button>
        )}
        {!running && (
          <button
            type="button"
            title={
              "A front saved here or by `seacrane design optimise --front`; " +
              "it takes the place of the one below, for the server has one at a time"
            }
            onClick={() => choose(FRONT_FILE)}
          >
            Open a front{"\u2026"}
          </button>
        )}
      </p>
      {told && front && (
        <p className="progress" aria-live="polite">
          <progress max={told.generations} value={front.generation} aria-label="Progress of the search" />
          <span data-testid="generation" data-value={front.generation} data-running={running}>
            generation {front.generation} of {told.generations}
            {!running && front.generation < told.generations && ", stopped"}
          </span>
        </p>
      )}
      {failure && (
        <p className="wrong" role="alert" data-testid="search-failure">
          {failure}
        </p>
      )}
      {told?.problems.map((problem) => (
        <p className="wrong" role="alert" key={problem.path}>
          {inWords(problem)}
        </p>
      ))}
      {front && front.crane.name !== crane.name && <p className="hint">This front is of {front.crane.name}.</p>}
      {front && (
        <FrontView
          front={front}
          stands={told?.stands ?? null}
          hindered={told?.hindered ?? []}
          loaded={taken?.crane === crane ? taken.key : null}
          onLoad={(index) => search.take(index)}
        />
      )}
    </section>
  );
}

function counted(n: number, what: string): string {
  return `${n} ${what}${n === 1 ? "" : "s"}`;
}

interface SizesProps {
  crane: Crane;
  chosen: readonly Variable[];
  onChange: (chosen: readonly Variable[]) => void;
}

function Sizes({ crane, chosen, onChange }: SizesProps) {
  const all = useMemo(() => sizes(crane), [crane]);
  const owners = [...new Set(all.map(({ owner }) => owner))];
  const at = (path: string) => chosen.findIndex((item) => item.path === path);
  const toggle = (size: Size) =>
    onChange(at(size.path) >= 0 ? chosen.filter(({ path }) => path !== size.path) : [...chosen, bounded(size)]);
  return (
    <>
      <h2>Sizes that may change</h2>
      {owners.map((owner) => {
        const own = all.filter((size) => size.owner === owner);
        return (
          <fieldset key={owner} className="inner">
            <legend>{owner}</legend>
            <p className="chips">
              {own.map((size) => (
                <button
                  key={size.path}
                  type="button"
                  aria-pressed={at(size.path) >= 0}
                  data-testid={`size-${size.path}`}
                  onClick={() => toggle(size)}
                >
                  {size.label}
                </button>
              ))}
            </p>
            {own
              .filter(({ path }) => at(path) >= 0)
              .map((size) => (
                <Bounds
                  key={size.path}
                  size={size}
                  variable={chosen[at(size.path)]}
                  onChange={(next) => onChange(chosen.map((item) => (item.path === size.path ? next : item)))}
                />
              ))}
          </fieldset>
        );
      })}
    </>
  );
}

interface BoundsProps {
  size: Size;
  variable: Variable;
  onChange: (next: Variable) => void;
}

function Bounds({ size, variable, onChange }: BoundsProps) {
  const { low, high } = variable;
  const { unit, positive } = size;
  const lowest = (value: number) =>
    value >= high
      ? `must be below ${sized(high, unit)}`
      : positive && value <= 0
        ? `must be above ${sized(0, unit)}`
        : null;
  return (
    <fieldset className="bounds">
      <legend>
        {size.label} <small>now {sized(size.now, unit)}</small>
      </legend>
      <NumberField
        label="from"
        value={low}
        unit={unit}
        check={lowest}
        onChange={(value) => value !== undefined && onChange({ ...variable, low: value })}
      />
      <NumberField
        label="to"
        value={high}
        unit={unit}
        check={(value) => (value <= low ? `must be above ${sized(low, unit)}` : null)}
        onChange={(value) => value !== undefined && onChange({ ...variable, high: value })}
      />
    </fieldset>
  );
}

interface GoalsProps {
  crane: Crane;
  goals: readonly Goal[];
  onChange: (goals: readonly Goal[]) => void;
}

const WITHOUT_RADIUS = [
  ["weight", "least weight"],
  ["reach", "largest reach"],
] as const;

function Goals({ crane, goals, onChange }: GoalsProps) {
  const furthest = Math.max(...crane.capacity.map(({ radius }) => radius));
  const change = (index: number, next: Partial<Goal>) =>
    onChange(goals.map((goal, i) => (i === index ? { ...goal, ...next } : goal)));
  return (
    <>
      <h2>Goals</h2>
      <p className="chips">
        {WITHOUT_RADIUS.map(([kind, label]) => {
          const has = goals.some((goal) => goal.kind === kind);
          return (
            <button
              key={kind}
              type="button"
              aria-pressed={has}
              data-testid={`goal-${kind}`}
              onClick={() => {
                const goal: Goal = { kind, radius: 0, mode: HARBOUR.name };
                if (has) onChange(goals.filter((item) => item.kind !== kind));
                else onChange(kind === "weight" ? [goal, ...goals] : [...goals, goal]);
              }}
            >
              {label}
            </button>
          );
        })}
        <button
          type="button"
          data-testid="goal-capacity"
          onClick={() =>
            onChange([...goals, { kind: "capacity", radius: Math.round(0.8 * furthest), mode: HARBOUR.name }])
          }
        >
          + load at a radius
        </button>
      </p>
      {goals.map((goal, index) =>
        goal.kind === "capacity" ? (
          // biome-ignore lint/suspicious/noArrayIndexKey: goals have no names, and two may be equal for a while
          <fieldset key={index} className="capacity">
            <legend>largest load</legend>
            <NumberField
              label="at"
              value={goal.radius}
              unit="m"
              check={(value) => (value > 0 ? null : "must be above 0 m")}
              onChange={(radius) => radius !== undefined && change(index, { radius })}
            />
            <select
              aria-label="Mode"
              value={goal.mode}
              onChange={(event) => change(index, { mode: event.currentTarget.value })}
            >
              {modes(crane).map((mode) => (
                <option key={mode.name} value={mode.name}>
                  {modeLabel(mode)}
                </option>
              ))}
            </select>
            <button
              type="button"
              className="plain"
              aria-label={`Remove the load at ${goal.radius} m`}
              onClick={() => onChange(goals.filter((_, i) => i !== index))}
            >
              {"\u00d7"}
            </button>
          </fieldset>
        ) : null,
      )}
    </>
  );
}

interface CountProps {
  label: string;
  value: number;
  least: number;
  onChange: (value: number) => void;
}

function Count({ label, value, least, onChange }: CountProps) {
  return (
    <NumberField
      label={label}
      value={value}
      unit="1"
      check={(next) =>
        Number.isInteger(next) && next >= least && next <= MOST ? null : `must be a whole number, ${least} to ${MOST}`
      }
      onChange={(next) => next !== undefined && onChange(next)}
    />
  );
}
