import "uplot/dist/uPlot.min.css";
import { ActionIcon, Button, Checkbox, TextInput } from "@mantine/core";
import { useEffect, useMemo, useRef, useState } from "react";
import uPlot from "uplot";
import { toCsv } from "../../core/history";
import { type Branch, search, variableTree } from "../../core/tree";
import { shown, symbol } from "../../core/units";
import type { VariableInfo } from "../../rpc/messages";
import { usePage, useSession } from "./usePage";

const WINDOWS = [10, 30, 60, 120, 300];
const COLORS = ["#2f9bd6", "#e08a1e", "#2ca56b", "#d1495b", "#8a6fd1", "#b58900", "#17a2a2", "#c063a9"];

interface Range {
  from: number;
  to: number;
}

/** Live plots of any variables, one panel for each unit, over one window of time. */
export default function Plots() {
  const session = useSession();
  const variables = usePage((page) => page.model?.variables ?? NONE);
  const plotted = usePage((page) => page.plotted);
  const [span, setSpan] = useState(60);
  const [frozen, setFrozen] = useState<Range | null>(null);
  const byName = useMemo(() => new Map(variables.map((v) => [v.name, v])), [variables]);
  const chosen = plotted.flatMap((name) => byName.get(name) ?? []);
  const units = [...new Set(chosen.map((v) => v.shown))];
  const range = (): Range => frozen ?? { from: Math.max(0, session.history.latest - span), to: session.history.latest };

  const download = () => {
    const { from, to } = range();
    const text = toCsv(session.history.slice(from, to), (name) => byName.get(name)?.unit ?? "1");
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    link.download = "seacrane-plotted.csv";
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };

  return (
    <aside className="plots" aria-label="Plots">
      <div className="plot-tools">
        <label>
          Window
          <select value={span} onChange={(event) => setSpan(Number(event.target.value))} data-testid="window">
            {WINDOWS.map((seconds) => (
              <option key={seconds} value={seconds}>
                {seconds} s
              </option>
            ))}
          </select>
        </label>
        <Button
          size="compact-sm"
          variant={frozen ? "light" : "default"}
          aria-pressed={frozen !== null}
          data-testid="plot-hold"
          onClick={() => setFrozen(frozen ? null : range())}
        >
          {frozen ? "Follow" : "Hold"}
        </Button>
        <span className="spring" />
        <Button
          size="compact-sm"
          variant="default"
          data-testid="download-plotted"
          disabled={chosen.length === 0}
          title="The plotted variables over the window shown, in SI"
          onClick={download}
        >
          CSV
        </Button>
        <Button
          size="compact-sm"
          variant="default"
          component="a"
          href="./api/recording.csv"
          download="seacrane-recording.csv"
          data-testid="download-all"
          title="All variables since the start, in SI"
        >
          CSV of all
        </Button>
      </div>
      <div className="plot-stack">
        {units.map((unit) => (
          <Panel
            key={unit}
            unit={unit}
            variables={chosen.filter((v) => v.shown === unit)}
            colorOf={(name) => COLORS[plotted.indexOf(name) % COLORS.length]}
            range={range}
            held={frozen !== null}
            onZoom={setFrozen}
          />
        ))}
        {units.length === 0 && <p className="empty">Tick variables below to plot them.</p>}
      </div>
      <Chooser variables={variables} plotted={plotted} />
    </aside>
  );
}

const NONE: readonly VariableInfo[] = [];

interface PanelProps {
  unit: string;
  variables: readonly VariableInfo[];
  colorOf: (name: string) => string;
  range: () => Range;
  held: boolean;
  onZoom: (range: Range | null) => void;
}

function Panel({ unit, variables, colorOf, range, held, onZoom }: PanelProps) {
  const session = useSession();
  const host = useRef<HTMLDivElement>(null);
  const now = useRef({ range, onZoom });
  now.current = { range, onZoom };
  const [values, setValues] = useState<{ points: number; at: Map<string, number | null> }>({
    points: 0,
    at: new Map(),
  });
  const names = variables.map(({ name }) => name).join(" ");

  // biome-ignore lint/correctness/useExhaustiveDependencies: the plot is rebuilt when its variables change, not on each render
  useEffect(() => {
    const element = host.current;
    if (!element) return;
    const style = getComputedStyle(element);
    const [ink, grid] = [style.getPropertyValue("--ink-dim").trim(), style.getPropertyValue("--rule").trim()];
    const axis = {
      stroke: ink,
      grid: { stroke: grid, width: 1 },
      ticks: { stroke: grid, width: 1 },
      font: "11px system-ui",
    };
    const plot = new uPlot(
      {
        width: element.clientWidth,
        height: element.clientHeight,
        legend: { show: false },
        cursor: { sync: { key: "plots", setSeries: false }, drag: { x: true, y: false, setScale: false } },
        scales: { x: { time: false }, y: { range: roomy } },
        axes: [
          { ...axis, size: 26, values: (_, ticks) => ticks.map((t) => `${Number(t.toFixed(3))} s`) },
          { ...axis, size: 52, space: 24 },
        ],
        series: [
          {},
          ...variables.map(({ name }) => ({
            stroke: colorOf(name),
            width: 1.75,
            points: { show: false },
            spanGaps: false,
          })),
        ],
        hooks: {
          setSelect: [
            (u) => {
              if (u.select.width < 4) return;
              const [from, to] = [u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")];
              u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
              now.current.onZoom({ from, to });
            },
          ],
        },
      },
      [[], ...variables.map(() => [])],
      element,
    );
    plot.over.addEventListener("dblclick", () => now.current.onZoom(null));
    const draw = () => {
      const { from, to } = now.current.range();
      const series = session.history.slice(from, to);
      const columns = variables.map(({ name, factor }) => {
        const column = series.columns.get(name);
        return Array.from(series.time, (_, i) => {
          const value = column?.[i];
          return value === undefined || Number.isNaN(value) ? null : value * factor;
        });
      });
      plot.batch(() => {
        plot.setData([Array.from(series.time), ...columns], false);
        plot.setScale("x", { min: from, max: to });
      });
      const index = plot.cursor.idx ?? series.time.length - 1;
      setValues({
        points: series.time.length,
        at: new Map(variables.map(({ name, factor }, i) => [name, toSi(columns[i][index], factor)])),
      });
    };
    draw();
    const timer = setInterval(draw, 120);
    const watch = new ResizeObserver(() => plot.setSize({ width: element.clientWidth, height: element.clientHeight }));
    watch.observe(element);
    return () => {
      clearInterval(timer);
      watch.disconnect();
      plot.destroy();
    };
  }, [names, session]);

  return (
    <section
      className="panel"
      data-testid={`plot-${unit}`}
      data-points={values.points}
      data-held={held}
      aria-label={`Plot in ${unit}`}
    >
      <header>
        <b>{symbol(unit)}</b>
        <ul>
          {variables.map((v) => (
            <li key={v.name}>
              <i style={{ background: colorOf(v.name) }} aria-hidden="true" />
              <span title={v.about}>{v.name}</span>
              <output data-testid={`plotted-${v.name}`} data-value={values.at.get(v.name) ?? undefined}>
                {shown(values.at.get(v.name) ?? null, v)}
              </output>
              <ActionIcon
                size="xs"
                variant="subtle"
                color="gray"
                aria-label={`Remove ${v.name}`}
                onClick={() => session.plot(v.name, false)}
              >
                {"\u00d7"}
              </ActionIcon>
            </li>
          ))}
        </ul>
      </header>
      <div className="plot-host" ref={host} />
    </section>
  );
}

/** Limits of the ordinate: the data with some air, and at least a hundredth of its size, so that noise stays small. */
function roomy(_: uPlot, low: number | null, high: number | null): [number, number] {
  if (low === null || high === null) return [0, 1];
  const middle = (low + high) / 2;
  const half = Math.max((high - low) * 0.6, Math.abs(middle) * 0.01, 1e-9);
  return [middle - half, middle + half];
}

function toSi(value: number | null | undefined, factor: number): number | null {
  return value === null || value === undefined ? null : value / factor;
}

// ---------------------------------------------------------------- choosing
function Chooser({ variables, plotted }: { variables: readonly VariableInfo[]; plotted: readonly string[] }) {
  const [query, setQuery] = useState("");
  const found = useMemo(() => search(variables, query), [variables, query]);
  const tree = useMemo(() => variableTree(found), [found]);
  return (
    <div className="chooser">
      <TextInput
        size="xs"
        placeholder={`Search ${variables.length} variables`}
        aria-label="Search variables"
        value={query}
        onChange={(event) => setQuery(event.currentTarget.value)}
        data-testid="variable-search"
      />
      <div className="tree" role="tree" aria-label="Variables">
        {tree.branches.map((branch) => (
          <Twig key={branch.path} branch={branch} plotted={plotted} open={query !== "" && found.length < 60} />
        ))}
        {found.length === 0 && <p className="empty">No variable has all of these words.</p>}
      </div>
    </div>
  );
}

function Twig({ branch, plotted, open }: { branch: Branch; plotted: readonly string[]; open: boolean }) {
  const [unfolded, setUnfolded] = useState(false);
  const showing = open || unfolded;
  const ticked = plotted.filter((name) => name.startsWith(`${branch.path}.`)).length;
  return (
    <div role="treeitem" aria-expanded={showing} tabIndex={-1}>
      <button
        type="button"
        className="twig"
        onClick={() => setUnfolded(!showing)}
        data-testid={`branch-${branch.path}`}
      >
        <span aria-hidden="true">{showing ? "\u25be" : "\u25b8"}</span>
        {branch.label}
        <small>{ticked > 0 ? `${ticked} of ${branch.size}` : branch.size}</small>
      </button>
      {showing && (
        // biome-ignore lint/a11y/useSemanticElements: the group of a tree item is a role of its own
        <div role="group" className="leaves">
          {branch.branches.map((inner) => (
            <Twig key={inner.path} branch={inner} plotted={plotted} open={open} />
          ))}
          {branch.leaves.map((variable) => (
            <Leaf key={variable.name} variable={variable} ticked={plotted.includes(variable.name)} />
          ))}
        </div>
      )}
    </div>
  );
}

function Leaf({ variable, ticked }: { variable: VariableInfo; ticked: boolean }) {
  const session = useSession();
  const label = variable.name.slice(variable.name.lastIndexOf(".") + 1);
  return (
    <div className="leaf" title={variable.about}>
      <Checkbox
        size="xs"
        label={label}
        checked={ticked}
        onChange={(event) => session.plot(variable.name, event.currentTarget.checked)}
        data-testid={`variable-${variable.name}`}
      />
      <small>{symbol(variable.shown)}</small>
    </div>
  );
}
