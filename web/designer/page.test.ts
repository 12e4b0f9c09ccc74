import { readFileSync } from "node:fs";
import { beforeEach, describe, expect, it } from "vitest";
import { read } from "../core/design/file";
import { type Command, commands, hear } from "./commands";
import type { Bench } from "./context";
import { createLayout, USUAL } from "./layout";
import { fitting } from "./panels/Palette";
import { createSearch } from "./search";
import { createDesigner } from "./store";
import { createView } from "./view";

const crane = read(readFileSync("../src/seacrane/design/cranes/offshore-100t.json", "utf8"));

/** A bench without the workers, which none of these ask. */
function bench(): Bench {
  const designer = createDesigner(crane);
  const none = undefined as never;
  return {
    designer,
    view: createView(designer),
    search: createSearch(designer),
    layout: createLayout(),
    sections: none,
    curves: none,
  };
}

const named = (on: Bench, id: string): Command => commands(on).find((command) => command.id === id)!;
const press = (on: Bench, key: string, held: KeyboardEventInit = {}, target: EventTarget = document.body) => {
  const event = new KeyboardEvent("keydown", { key, cancelable: true, bubbles: true, ...held });
  Object.defineProperty(event, "target", { value: target });
  hear(on, event);
  return event.defaultPrevented;
};

beforeEach(() => localStorage.clear());

describe("the table of commands", () => {
  it("names each once, and gives no keys twice", () => {
    const on = bench();
    for (const selection of [{ kind: "link", index: 1 } as const, { kind: "cylinder", index: 0 } as const]) {
      on.designer.select(selection);
      const all = commands(on);
      const ids = all.map(({ id }) => id);
      const keys = all.flatMap((command) => command.keys ?? []);
      expect(new Set(ids).size).toBe(ids.length);
      expect(new Set(keys).size).toBe(keys.length);
    }
  });

  it("says why something cannot be done, and does not do it", () => {
    const on = bench();
    expect(named(on, "undo").cannot).toBe("nothing to undo");
    expect(named(on, "measure").cannot).toContain("not shown");
    expect(named(on, "simulate").cannot).toContain("lifts nothing");
    expect(press(on, "z", { ctrlKey: true })).toBe(true);
    expect(on.designer.store.getState().crane).toBe(crane);
  });

  it("offers what the selection can have done to it", () => {
    const on = bench();
    on.designer.select({ kind: "link", index: 2 });
    named(on, "add-girder").run();
    expect(on.designer.store.getState().crane.links[2].parts?.at(-1)?.kind).toBe("girder");
    named(on, "remove-link").run();
    expect(on.designer.store.getState().crane.links).toHaveLength(2);
    on.designer.select({ kind: "cylinder", index: 0 });
    expect(named(on, "fit-stroke").label).toContain("boom_cylinder");
    named(on, "undo").run();
    named(on, "undo").run();
    expect(on.designer.store.getState().crane).toBe(crane);
  });
});

describe("keys", () => {
  it("give the commands that the table gives them", () => {
    const on = bench();
    press(on, "2");
    expect(on.view.store.getState().show).toBe("both");
    press(on, "o");
    expect(on.view.store.getState().results).toBe("optimise");
    press(on, "r");
    expect(on.layout.store.getState().shown.results).toBe(false);
    press(on, "?", { shiftKey: true });
    expect(on.view.store.getState().dialog).toBe("help");
  });

  it("lead to the handles of the drawing, which are far to tab to", () => {
    const on = bench();
    document.body.innerHTML = `<div id="workspace"><svg><g role="slider" tabindex="0" id="first"></g></svg></div>`;
    press(on, "h");
    expect(document.activeElement?.id).toBe("first");
    document.body.innerHTML = "";
    on.view.set({ show: "solid" });
    expect(named(on, "go-handles").cannot).toBe("the workspace is not shown");
  });

  it("belong to a field that is typed in, and to a dialog, but for those that no text needs", () => {
    const on = bench();
    const field = document.createElement("input");
    expect(press(on, "2", {}, field)).toBe(false);
    expect(on.view.store.getState().show).toBe("section");
    press(on, "k", { ctrlKey: true }, field);
    expect(on.view.store.getState().dialog).toBe("palette");
    expect(press(on, "n")).toBe(false);
    expect(on.view.store.getState().dialog).toBe("palette");
  });
});

describe("the palette", () => {
  it("finds commands by a few letters, those that can be done first", () => {
    const on = bench();
    expect(fitting(commands(on), "sdf")[0].id).toBe("save-json");
    expect(fitting(commands(on), "pk65")[0].id).toBe("open-gunnerus-pk65");
    expect(fitting(commands(on), "hs 2.0")[0].id).toBe("mode-hs2.0");
    expect(fitting(commands(on), "knuckle tele")[0].id).toBe("open-gunnerus-pk65");
    const ids = (typed: string) => fitting(commands(on), typed).map(({ id }) => id);
    expect(ids("me").indexOf("measure")).toBeGreaterThan(ids("me").indexOf("show-solid"));
    expect(ids("measure")[0]).toBe("measure");
    expect(ids("redo")[0]).toBe("redo");
    on.designer.select({ kind: "cylinder", index: 1 });
    expect(fitting(commands(on), "jib_cyl").map(({ id }) => id)).toEqual([
      "go-cylinder-1",
      "fit-stroke",
      "remove-cylinder",
    ]);
    expect(fitting(commands(on), "zzz")).toEqual([]);
  });
});

describe("the view", () => {
  it("looks closer about the same middle, within bounds, and at all of another crane", () => {
    const { view, designer } = bench();
    view.closer(2);
    expect(view.store.getState().look).toBeNull();
    view.set({ fitted: { x: 3, z: 4, scale: 20, width: 800, height: 600 } });
    view.closer(2);
    expect(view.store.getState().look).toEqual({ x: 3, z: 4, zoom: 2 });
    for (let i = 0; i < 20; i += 1) view.closer(2);
    expect(view.store.getState().look?.zoom).toBe(100);
    designer.edit("mass", ["links", 0, "mass"], 1e5);
    expect(view.store.getState().look).not.toBeNull();
    designer.edit("name", ["name"], "another");
    expect(view.store.getState().look).toBeNull();
  });
});

describe("the layout", () => {
  it("is there again after a reload, and is what it was at first once reset", () => {
    const layout = createLayout();
    layout.widen("design", 400.4);
    layout.widen("results", 9999);
    layout.toggle("results");
    layout.swap();
    layout.share(0.05);
    const again = createLayout();
    expect(again.store.getState()).toEqual({
      widths: { design: 400, results: 760 },
      shown: { design: true, results: false },
      swapped: true,
      share: 0.2,
    });
    again.reset();
    expect(createLayout().store.getState()).toEqual(USUAL);
  });

  it.each(["{", "null", '"wide"', '{"widths":{"design":"x","results":null},"shown":3,"swapped":"yes","share":null}'])(
    "is the usual one where %s was kept",
    (kept) => {
      localStorage.setItem("seacrane.designer.layout", kept);
      expect(createLayout().store.getState()).toEqual(USUAL);
    },
  );

  it("keeps a width that was kept within the bounds", () => {
    localStorage.setItem("seacrane.designer.layout", '{"widths":{"design":-5,"results":1e9}}');
    expect(createLayout().store.getState().widths).toEqual({ design: 220, results: 760 });
  });
});
