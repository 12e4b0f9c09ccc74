// Everything that can be ordered on the page, in one table: shortcuts, menus, the palette and the help are made from it.
import { withoutLink, withStroke } from "../core/design/edit";
import { PART_KINDS } from "../core/design/fields";
import { weighed } from "../core/design/mass";
import { newPart } from "../core/design/newPart";
import { furnished } from "../core/design/standard";
import { modeLabel, modes } from "../core/design/types";
import { matches, takesKeys } from "../core/keys";
import { fixed, TONNE } from "../core/units";
import type { Bench } from "./context";
import { attempt, choose, DESIGN_FILE, FRONT_FILE, judge, MESH_FILE, saveArchive, saveMeshes } from "./files";
import { copyLink } from "./link";
import { saveJson } from "./saving";
import { SHIPPED } from "./shipped";
import { simulate } from "./simulate";
import type { DesignerStore, Selection } from "./store";
import { CLOSER, type Dialog, type Show, type Tools, WORKSPACE } from "./view";

export type Group = "Design" | "Change" | "Show" | "Load chart" | "Search for designs" | "Panels" | "Go to" | "Help";

export interface Command {
  readonly id: string;
  readonly group: Group;
  readonly label: string;
  /** What else there is to say of it. */
  readonly detail?: string;
  /** Keys that do it; the first are shown. */
  readonly keys?: readonly string[];
  /** Whether the keys do it while somebody types, too. */
  readonly always?: boolean;
  /** Why it cannot be done now; null if it can. */
  readonly cannot?: string | null;
  /** Whether it is switched on; absent for what is no switch. */
  readonly on?: boolean;
  readonly run: () => unknown;
}

/** All that can be ordered as the page stands. */
export function commands(bench: Bench): readonly Command[] {
  return [
    ...ofDesign(bench),
    ...ofPlaces(bench),
    ...ofChange(bench),
    ...ofShow(bench),
    ...ofChart(bench),
    ...ofSearch(bench),
    ...ofPanels(bench),
    ...ofHelp(bench),
  ];
}

/** Does what a key asks for, unless the key belongs to what is typed in, or a dialog is open. */
export function hear(bench: Bench, event: KeyboardEvent): void {
  if (event.defaultPrevented) return;
  const taken = takesKeys(event.target) || bench.view.store.getState().dialog !== null;
  const command = commands(bench).find(
    ({ keys, always }) => (always || !taken) && keys?.some((item) => matches(event, item)),
  );
  if (!command) return;
  event.preventDefault();
  if (!command.cannot) command.run();
}

function ofDesign(bench: Bench): Command[] {
  const { designer, view } = bench;
  const { crane, posture } = designer.store.getState();
  const load = view.store.getState().verdict?.load ?? 0;
  const group = "Design";
  const dialog = (id: Dialog, label: string, keys?: readonly string[]): Command => ({
    id,
    group,
    label,
    keys,
    run: () => view.open(id),
  });
  const told = (what: () => Promise<string> | string) => () => attempt(designer, what);
  return [
    dialog("new", "New crane from a type\u2026", ["N"]),
    {
      id: "open-file",
      group,
      label: "Open a file (JSON or ZIP)\u2026",
      keys: ["Ctrl+O"],
      always: true,
      run: () => choose(DESIGN_FILE),
    },
    ...SHIPPED.map(
      ({ name, type, load }): Command => ({
        id: `open-${name}`,
        group,
        label: `Open ${name}`,
        detail: type,
        run: told(async () => {
          designer.open(await load());
          return `Opened ${name}.`;
        }),
      }),
    ),
    {
      id: "duplicate",
      group,
      label: "Duplicate",
      run: () => designer.apply("duplicate", { ...crane, name: `${crane.name} copy` }, posture),
    },
    dialog("versions", "Versions\u2026"),
    dialog("compare", "Compare with another design\u2026"),
    { id: "copy-link", group, label: "Copy link", keys: ["L"], run: () => copyLink(bench) },
    dialog("link", "Open a link\u2026"),
    {
      id: "save-json",
      group,
      label: "Save the design file (JSON)",
      keys: ["Ctrl+S"],
      always: true,
      run: () => saveJson(crane),
    },
    { id: "export-zip", group, label: "Export everything (ZIP)", run: told(() => saveArchive(crane)) },
    { id: "export-stl", group, label: "Export meshes (STL)", run: told(() => saveMeshes(crane)) },
    { id: "check", group, label: "Check with the package", run: told(() => judge(crane)) },
    {
      id: "simulate",
      group,
      label: "Simulate from here",
      detail: load > 0 ? `with ${fixed(load / TONNE, 1)} t` : undefined,
      cannot: load > 0 ? null : "the crane lifts nothing in this posture",
      run: () => simulate(bench),
    },
  ];
}

function ofChange({ designer }: Bench): Command[] {
  const { selection, past, future } = designer.store.getState();
  const group = "Change";
  const [undo, redo] = [past.at(-1)?.by, future.at(-1)?.by];
  return [
    {
      id: "undo",
      group,
      label: "Undo",
      detail: undo,
      keys: ["Ctrl+Z"],
      cannot: undo === undefined ? "nothing to undo" : null,
      run: () => designer.undo(),
    },
    {
      id: "redo",
      group,
      label: "Redo",
      detail: redo,
      keys: ["Ctrl+Shift+Z", "Ctrl+Y"],
      cannot: redo === undefined ? "nothing to redo" : null,
      run: () => designer.redo(),
    },
    ...(["revolute", "prismatic"] as const).map(
      (kind): Command => ({
        id: `add-${kind}`,
        group,
        label: kind === "revolute" ? "Add a turning link" : "Add a sliding link",
        run: () => designer.addLink(kind),
      }),
    ),
    { id: "rate", group, label: "Take the rated loads from the load chart", run: () => designer.rate() },
    ...(selection.kind === "link" ? ofLink(designer, selection.index) : []),
    ...(selection.kind === "cylinder" ? ofCylinder(designer, selection.index) : []),
  ];
}

function ofLink(designer: DesignerStore, index: number): Command[] {
  const { crane } = designer.store.getState();
  const link = crane.links[index];
  const parts = link.parts ?? [];
  const path = ["links", index, "parts"];
  const shorter = withoutLink(crane, index);
  const group = "Change";
  return [
    {
      id: "add-cylinder",
      group,
      label: `Add a cylinder to ${link.name}`,
      run: () => designer.addCylinder(index),
    },
    {
      id: "own-parts",
      group,
      label: `Make the standard parts of ${link.name} its own`,
      cannot: parts.length ? "it has parts of its own" : null,
      run: () => designer.edit("standard parts", path, furnished(crane).links[index].parts),
    },
    {
      id: "weigh",
      group,
      label: `Take mass, centre and inertia of ${link.name} from its parts`,
      cannot: parts.length ? null : "it has no parts of its own",
      run: () => designer.edit("weigh", ["links", index], weighed(crane).links[index]),
    },
    ...PART_KINDS.map(
      (kind): Command => ({
        id: `add-${kind}`,
        group,
        label: kind === "mesh" ? `Add a mesh from a file to ${link.name}\u2026` : `Add a ${kind} to ${link.name}`,
        run: () => {
          if (kind === "mesh") return choose(MESH_FILE);
          designer.edit(`add ${kind}`, path, [...parts, newPart(kind, crane, index)]);
          designer.select({ kind: "link", index, part: parts.length });
        },
      }),
    ),
    {
      id: "remove-link",
      group,
      label: `Remove ${link.name}`,
      cannot: shorter ? null : "the crane needs it",
      run: () => shorter && designer.apply("remove link", shorter),
    },
  ];
}

function ofCylinder(designer: DesignerStore, index: number): Command[] {
  const { crane } = designer.store.getState();
  const cylinder = crane.cylinders[index];
  const path = ["cylinders", index];
  const group = "Change";
  return [
    {
      id: "fit-stroke",
      group,
      label: `Fit the stroke of ${cylinder.name} to the limits`,
      run: () => designer.edit("fit stroke", path, withStroke(crane, cylinder)),
    },
    {
      id: "remove-cylinder",
      group,
      label: `Remove ${cylinder.name}`,
      run: () => designer.edit("remove cylinder", path, undefined),
    },
  ];
}

export const SHOWS: readonly (readonly [Show, string])[] = [
  ["section", "Workspace"],
  ["both", "Both"],
  ["solid", "Mechanical"],
];

function ofShow({ view }: Bench): Command[] {
  const { show, tools } = view.store.getState();
  const group = "Show";
  const flat = show === "solid" ? "the workspace is not shown" : null;
  const solid = show === "section" ? "the mechanical picture is not shown" : null;
  const tool = (id: string, label: string, on: boolean, some: Partial<Tools>): Command => ({
    id,
    group,
    label,
    on,
    cannot: solid,
    run: () => view.tool(some),
  });
  return [
    ...SHOWS.map(
      ([value, label], i): Command => ({
        id: `show-${value}`,
        group,
        label,
        keys: [`${i + 1}`],
        on: show === value,
        run: () => view.set({ show: value }),
      }),
    ),
    { id: "closer", group, label: "Closer", keys: ["+", "="], cannot: flat, run: () => view.closer(CLOSER) },
    { id: "further", group, label: "Further away", keys: ["-"], cannot: flat, run: () => view.closer(1 / CLOSER) },
    { id: "fit", group, label: "All of the crane", keys: ["0"], run: () => view.all() },
    tool("cut", "Cut open", tools.cut !== null, { cut: tools.cut === null ? 0 : null }),
    tool("explode", "Taken apart", tools.explode > 0, { explode: tools.explode > 0 ? 0 : 0.5 }),
    tool("measure", "Measure", tools.measuring, { measuring: !tools.measuring }),
    tool("animate", "Animate", tools.moving, { moving: !tools.moving }),
    tool("volume", "Workspace in three dimensions", tools.volume, { volume: !tools.volume }),
    tool("centres", "Centres of mass", tools.centres, { centres: !tools.centres }),
  ];
}

function ofChart({ designer, view }: Bench): Command[] {
  const { crane, mode } = designer.store.getState();
  const { results } = view.store.getState();
  const group = "Load chart";
  return [
    {
      id: "results",
      group,
      label: results === "chart" ? "Search for designs instead of the load chart" : "Load chart",
      keys: ["O"],
      run: () => view.set({ results: results === "chart" ? "optimise" : "chart" }),
    },
    ...modes(crane).map(
      (item): Command => ({
        id: `mode-${item.name}`,
        group,
        label: `Load chart: ${modeLabel(item)}`,
        on: item.name === mode,
        run: () => designer.setMode(item.name),
      }),
    ),
  ];
}

function ofSearch({ search, view }: Bench): Command[] {
  const { told } = search.store.getState();
  const running = told?.running ?? false;
  const front = told?.front ?? null;
  const further = search.further();
  const group = "Search for designs";
  const shown = (what: () => unknown) => () => {
    view.set({ results: "optimise" });
    return what();
  };
  return [
    {
      id: "search-start",
      group,
      label: "Begin a search for better designs",
      cannot: search.hindrance(),
      run: shown(() => search.begin()),
    },
    {
      id: "search-stop",
      group,
      label: "Stop the search",
      cannot: running ? null : "none is under way",
      run: shown(() => search.stop()),
    },
    {
      id: "search-on",
      group,
      label: "Go on with the search",
      detail: further > 0 ? `${further} generations more` : undefined,
      cannot: further > 0 ? null : "there is no front to go on from",
      run: shown(() => search.goOn()),
    },
    {
      id: "front-save",
      group,
      label: "Save the front",
      cannot: front ? null : "there is none yet",
      run: () => search.save(),
    },
    {
      id: "front-open",
      group,
      label: "Open a front\u2026",
      cannot: running ? "a search is under way" : null,
      run: shown(() => choose(FRONT_FILE)),
    },
  ];
}

function ofPanels({ layout }: Bench): Command[] {
  const { shown, swapped } = layout.store.getState();
  const group = "Panels";
  return [
    {
      id: "panel-design",
      group,
      label: "Design panel",
      keys: ["I"],
      on: shown.design,
      run: () => layout.toggle("design"),
    },
    {
      id: "panel-results",
      group,
      label: "Results panel",
      keys: ["R"],
      on: shown.results,
      run: () => layout.toggle("results"),
    },
    { id: "panel-swap", group, label: "Results on the left", on: swapped, run: () => layout.swap() },
    { id: "panel-reset", group, label: "Usual places and widths", run: () => layout.reset() },
  ];
}

function ofPlaces({ designer, view }: Bench): Command[] {
  const { crane, selection } = designer.store.getState();
  const { show } = view.store.getState();
  const group = "Go to";
  const place = (label: string, to: Selection): Command => ({
    id: `go-${to.kind}${"index" in to ? `-${to.index}` : ""}`,
    group,
    label: `Fields of ${label}`,
    on: JSON.stringify(selection) === JSON.stringify(to),
    run: () => designer.select(to),
  });
  return [
    place(crane.name, { kind: "crane" }),
    ...crane.links.map((link, index) => place(link.name, { kind: "link", index })),
    ...crane.cylinders.map((cylinder, index) => place(cylinder.name, { kind: "cylinder", index })),
    place("the hoist", { kind: "hoist" }),
    place("the rating", { kind: "rating" }),
    {
      id: "go-handles",
      group,
      label: "Handles in the drawing",
      keys: ["H"],
      cannot: show === "solid" ? "the workspace is not shown" : null,
      run: () => document.querySelector<SVGElement>(`#${WORKSPACE} [role="slider"]`)?.focus(),
    },
  ];
}

function ofHelp({ view }: Bench): Command[] {
  const group = "Help";
  return [
    { id: "palette", group, label: "All commands", keys: ["Ctrl+K"], always: true, run: () => view.open("palette") },
    { id: "help", group, label: "Keys and handles", keys: ["?"], run: () => view.open("help") },
  ];
}
