// What this page knows: the crane being designed, the posture it is shown in, how it came to be so, and what is looked at.
import { createStore } from "zustand/vanilla";
import { type Problem, problems } from "../core/design/check";
import { fitting, type Path, type Scene, set, withCylinder, withLink } from "../core/design/edit";
import type { Posture } from "../core/design/plane";
import { ratedByChart } from "../core/design/rated";
import { inStep } from "../core/design/together";
import { type Crane, HARBOUR, type Joint, modes } from "../core/design/types";

const DEEPEST = 400;

export type Selection =
  | { readonly kind: "crane" }
  | { readonly kind: "link"; readonly index: number; readonly part?: number }
  | { readonly kind: "cylinder"; readonly index: number }
  | { readonly kind: "hoist" }
  | { readonly kind: "rating" };

export interface Step extends Scene {
  /** What made it, in a few words. */
  readonly by: string;
}

export interface Designer extends Scene {
  readonly past: readonly Step[];
  readonly future: readonly Step[];
  /** Whether a drag is under way, which will be one step. */
  readonly dragging: boolean;
  readonly selection: Selection;
  readonly mode: string;
  /** What is wrong: what the page itself finds, and what the package found last at other places. */
  readonly problems: readonly Problem[];
  readonly told: readonly Problem[];
  readonly notice: { readonly text: string; readonly kind: "done" | "wrong" } | null;
}

/** All that keeps a crane from being computed or built, place by place. */
export function problemsOf(crane: Crane): Problem[] {
  try {
    return problems(crane);
  } catch (error) {
    return [{ path: "", message: (error as Error).message }];
  }
}

function judged(crane: Crane, told: readonly Problem[]): Pick<Designer, "problems" | "told"> {
  const found = problemsOf(crane);
  return { problems: [...found, ...told.filter(({ path }) => !found.some((item) => item.path === path))], told };
}

export function createDesigner(crane: Crane, posture: Posture = {}) {
  const store = createStore<Designer>(() => opened(crane, posture));
  let before: Scene | null = null;

  const show = (scene: Scene) =>
    store.setState((now) => ({
      ...scene,
      ...(scene.crane === now.crane ? {} : judged(scene.crane, scene.crane.name === now.crane.name ? now.told : [])),
      mode: modes(scene.crane).some(({ name }) => name === now.mode) ? now.mode : HARBOUR.name,
      selection: present(now.selection, scene.crane),
    }));

  return {
    store,

    /** Begin what undo takes back in one step, such as a drag; changes until `end` belong to it. */
    begin(): void {
      const { crane, posture } = store.getState();
      before ??= { crane, posture };
      store.setState({ dragging: true });
    },
    change(scene: Scene): void {
      show(scene);
    },
    end(by: string): void {
      const started = before;
      before = null;
      store.setState(({ crane, posture, past, future }) => {
        const changed = started && (started.crane !== crane || started.posture !== posture);
        return {
          dragging: false,
          past: changed ? [...past.slice(1 - DEEPEST), { ...started, by }] : past,
          future: changed ? [] : future,
        };
      });
    },
    /** Back to where the drag began. */
    cancel(): void {
      if (before) show(before);
      before = null;
      store.setState({ dragging: false });
    },

    /** What the package finds wrong with the crane as it is. */
    found(told: readonly Problem[]): void {
      store.setState(({ crane }) => judged(crane, told));
    },

    /** One step. A posture that is not given is kept, as far as it fits. */
    apply(by: string, crane: Crane, posture?: Posture): void {
      this.begin();
      this.change({ crane, posture: fitting(crane, posture ?? store.getState().posture) });
      this.end(by);
    },
    edit(by: string, path: Path, value: unknown): void {
      const { crane } = store.getState();
      this.apply(by, inStep(crane, set(crane, path, value)));
    },
    /** A link more at the end of the crane, and its fields to fill in. */
    addLink(kind: Joint["kind"]): void {
      const { crane } = store.getState();
      this.apply("add link", withLink(crane, kind));
      this.select({ kind: "link", index: crane.links.length });
    },
    addCylinder(link: number): void {
      const { crane } = store.getState();
      this.apply("add cylinder", withCylinder(crane, link));
      this.select({ kind: "cylinder", index: crane.cylinders.length });
    },
    /** Rated loads by the load chart. */
    rate(): void {
      const { crane } = store.getState();
      this.edit("rated loads", ["capacity"], ratedByChart(crane));
    },
    pose(posture: Posture): void {
      const { crane, posture: now } = store.getState();
      this.apply("posture", crane, { ...now, ...posture });
    },

    undo(): void {
      const { past, future, crane, posture } = store.getState();
      const step = past.at(-1);
      if (!step || before) return;
      show({ crane: step.crane, posture: step.posture });
      store.setState({ past: past.slice(0, -1), future: [...future, { crane, posture, by: step.by }] });
    },
    redo(): void {
      const { past, future, crane, posture } = store.getState();
      const step = future.at(-1);
      if (!step || before) return;
      show({ crane: step.crane, posture: step.posture });
      store.setState({ past: [...past, { crane, posture, by: step.by }], future: future.slice(0, -1) });
    },

    /** Another crane in place of this one; undo brings this one back. */
    open(crane: Crane): void {
      this.apply(`open ${crane.name}`, crane, {});
      store.setState({ selection: { kind: "crane" } });
    },
    select(selection: Selection): void {
      store.setState({ selection });
    },
    setMode(mode: string): void {
      store.setState({ mode });
    },
    tell(text: string, kind: "done" | "wrong" = "done"): void {
      store.setState({ notice: { text, kind } });
    },
    hush(): void {
      store.setState({ notice: null });
    },
  };
}

export type DesignerStore = ReturnType<typeof createDesigner>;

function opened(crane: Crane, posture: Posture): Designer {
  return {
    crane,
    posture: fitting(crane, posture),
    past: [],
    future: [],
    dragging: false,
    selection: { kind: "crane" },
    mode: HARBOUR.name,
    ...judged(crane, []),
    notice: null,
  };
}

/** The selection, or what is nearest to it where the crane no longer has it. */
function present(selection: Selection, crane: Crane): Selection {
  if (selection.kind === "link" && selection.index >= crane.links.length) return { kind: "crane" };
  if (selection.kind === "cylinder" && selection.index >= crane.cylinders.length) return { kind: "crane" };
  if (
    selection.kind === "link" &&
    selection.part !== undefined &&
    selection.part >= (crane.links[selection.index].parts?.length ?? 0)
  )
    return { kind: "link", index: selection.index };
  return selection;
}
