import { Modal } from "@mantine/core";
import { useEffect, useMemo, useState } from "react";
import { differences, fitting, get, type Path } from "../../core/design/edit";
import { fieldsOf, type QuantityField, type ShapeName, unitOf, type VectorField } from "../../core/design/fields";
import { written } from "../../core/design/quantity";
import { type Crane, HARBOUR, modeLabel, modes } from "../../core/design/types";
import { DASH, symbol } from "../../core/units";
import { Charts } from "../charts";
import { useDesigner } from "../context";
import { versions } from "../saving";
import { SideBySide } from "../section/SideBySide";
import { SHIPPED } from "../shipped";
import { Plot, useCurves } from "./Curves";
import { pathText } from "./Form";

const MOST_ROWS = 200;

/** Two designs: side by side, their curves over each other, and a table of what differs. */
export function CompareDialog({ open, onClose }: { open: boolean; onClose: () => void }) {
  return (
    <Modal opened={open} onClose={onClose} title="Compare" size="80rem" transitionProps={{ duration: 80 }}>
      <Compare />
    </Modal>
  );
}

function Compare() {
  const crane = useDesigner((state) => state.crane);
  const mode = useDesigner((state) => state.mode);
  const [kept] = useState(versions);
  const [chosen, setChosen] = useState(
    kept[0] ? "version 0" : (SHIPPED.find(({ name }) => name === crane.name) ?? SHIPPED[0]).name,
  );
  const [other, setOther] = useState<Crane | null>(null);
  useEffect(() => {
    const version = kept[Number(chosen.replace("version ", ""))];
    if (chosen.startsWith("version ")) setOther(version.crane);
    else
      void SHIPPED.find(({ name }) => name === chosen)
        ?.load()
        .then(setOther);
  }, [chosen, kept]);
  return (
    <div className="dialog" data-testid="compare-dialog">
      <div className="field">
        <label>
          <span>{crane.name} against</span>
          <select value={chosen} onChange={(event) => setChosen(event.currentTarget.value)} data-testid="compare-with">
            {kept.map((version, i) => (
              <option key={version.at} value={`version ${i}`}>
                {version.name}, {new Date(version.at).toLocaleString()}
              </option>
            ))}
            {SHIPPED.map(({ name }) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
      </div>
      {other && <Both a={crane} b={other} mode={mode} />}
    </div>
  );
}

function Both({ a, b, mode }: { a: Crane; b: Crane; mode: string }) {
  const [charts, setCharts] = useState<readonly [Charts, Charts] | null>(null);
  useEffect(() => {
    const pair = [new Charts(), new Charts()] as const;
    setCharts(pair);
    return () => {
      for (const one of pair) one.close();
    };
  }, []);
  const posture = useDesigner((state) => state.posture);
  const designs = useMemo(
    () =>
      charts && [
        { crane: a, posture, charts: charts[0] },
        { crane: b, posture: fitting(b, posture), charts: charts[1] },
      ],
    [a, b, posture, charts],
  );
  return (
    <>
      {designs && <SideBySide designs={designs} mode={mode} />}
      <div className="compare">
        {charts && <Overlay a={a} b={b} mode={mode} charts={charts} />}
        <Table a={a} b={b} />
      </div>
    </>
  );
}

function Overlay({ a, b, mode, charts }: { a: Crane; b: Crane; mode: string; charts: readonly [Charts, Charts] }) {
  const mine = useCurves(charts[0], a).find((curve) => curve.mode === mode);
  const others = useCurves(charts[1], b);
  const theirs = others.find((curve) => curve.mode === mode) ?? others[0];
  return (
    <div>
      <Plot
        lines={[
          ...(theirs ? [{ curve: theirs, kind: "compared" as const }] : []),
          ...(mine ? [{ curve: mine, kind: "chosen" as const }] : []),
        ]}
      />
      <p className="hint">
        {modeLabel(modes(a).find(({ name }) => name === mode) ?? HARBOUR)}: <b className="mine">{a.name}</b> and{" "}
        <b className="theirs">{b.name}</b> (dashed). Not a certified load chart.
      </p>
    </div>
  );
}

function Table({ a, b }: { a: Crane; b: Crane }) {
  const rows = differences(a, b);
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: what scrolls must be reached without a pointer
    <section className="differences" aria-label="What differs" tabIndex={0}>
      <table>
        <thead>
          <tr>
            <th>{rows.length === 0 ? "No differences" : `${rows.length} differences`}</th>
            <th>{a.name}</th>
            <th>{b.name}</th>
          </tr>
        </thead>
        <tbody>
          {rows.slice(0, MOST_ROWS).map(({ path, a: mine, b: theirs }) => {
            const named = numbered(path);
            const crane = get(a, named) === undefined ? b : a;
            return (
              <tr key={path.join(".")}>
                <th scope="row">{pathText(crane, named)}</th>
                <td>{shown(crane, named, mine)}</td>
                <td>{shown(crane, named, theirs)}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      {rows.length > MOST_ROWS && <p className="hint">and {rows.length - MOST_ROWS} more</p>}
    </section>
  );
}

function numbered(path: Path): Path {
  return path.map((key) => (typeof key === "string" && /^\d+$/.test(key) ? Number(key) : key));
}

/** A value in the unit of its field. */
function shown(crane: Crane, path: Path, value: unknown): string {
  if (value == null) return DASH;
  if (typeof value === "object") return Array.isArray(value) ? `${value.length} items` : "present";
  if (typeof value !== "number") return String(value);
  let shape: ShapeName | null = "crane";
  for (let i = 0; i < path.length && shape; i += 1) {
    const key = path[i];
    if (typeof key === "number") continue;
    const owner = get(crane, path.slice(0, i));
    const field: ReturnType<typeof fieldOf> = fieldOf(shape, owner, key);
    if (!field) break;
    if (field.kind === "quantity" || field.kind === "vector") {
      const unit = unitOf(key, field as QuantityField | VectorField, owner);
      return `${written(value, unit)} ${unit === "1" ? "" : symbol(unit)}`;
    }
    shape = field.kind === "shape" ? field.shape : field.kind === "list" ? (field.of as ShapeName) : null;
  }
  return String(value);
}

function fieldOf(shape: ShapeName, owner: unknown, key: string) {
  return fieldsOf(shape, owner)?.[key] ?? null;
}
