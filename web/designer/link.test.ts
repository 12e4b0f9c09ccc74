import { beforeEach, describe, expect, it, vi } from "vitest";
import type { Bench } from "./context";
import { createLayout } from "./layout";
import { addressOf, fragment, LONGEST, openLink, readFragment, type Shared } from "./link";
import { versions } from "./saving";
import { createSearch } from "./search";
import { SHIPPED } from "./shipped";
import { createDesigner } from "./store";
import { createView } from "./view";

const offshore = await SHIPPED.find(({ name }) => name === "offshore-100t")!.load();
const gangway = await SHIPPED.find(({ name }) => name === "gangway-24m")!.load();
const changed = { ...offshore, name: "mine \u00e9\u{1f3d7}", bulk_modulus: 1.3e9 };

const shared = (some: Partial<Shared> = {}): Shared => ({
  crane: offshore,
  posture: { slew: 0, luff: 0.8, jib: -1.1 },
  mode: "hs2.0",
  selection: { kind: "link", index: 1 },
  show: "both",
  results: "optimise",
  look: { x: 12.5, z: 3.25, zoom: 2.5 },
  camera: { eye: [10, -40, 22.5], target: [7, 0, 8] },
  tools: { cut: 0.25, explode: 0.5, volume: true, centres: false },
  ...some,
});

/** A fragment with this in it, whatever it is. */
async function holding(data: unknown): Promise<string> {
  const text = typeof data === "string" ? data : JSON.stringify(data);
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  return `crane=1.${Buffer.from(bytes).toString("base64url")}`;
}

const inside = { ...shared(), crane: undefined, design: changed, look: [1, 2, 3], camera: [1, 2, 3, 4, 5, 6] };

function bench(crane = offshore): Bench {
  const designer = createDesigner(crane);
  const none = undefined as never;
  const rest = { search: createSearch(designer), layout: createLayout(), sections: none, curves: none };
  return { designer, view: createView(designer), ...rest };
}

beforeEach(() => localStorage.clear());

describe("a link", () => {
  it("gives back the design and how it was seen", async () => {
    for (const crane of [offshore, gangway, changed]) {
      const mode = "harbour";
      const all = shared({ crane, mode });
      expect(await readFragment(await fragment(all))).toEqual(all);
      const bare = shared({ crane, mode, look: null, camera: null, tools: { ...all.tools, cut: null } });
      expect(await readFragment(`http://127.0.0.1:8765/designer.html#${await fragment(bare)}`)).toEqual(bare);
    }
  });

  it("is short for a design that everybody has, and short enough for any other", async () => {
    expect((await fragment(shared())).length).toBeLessThan(400);
    expect((await fragment(shared({ crane: changed }))).length).toBeLessThan(2500);
  });

  it("is refused in words where the design is too large for it", async () => {
    const about = Array.from({ length: 40_000 }, (_, i) => ((i * 2654435761) >>> 8).toString(36)).join("");
    await expect(fragment(shared({ crane: { ...changed, about } }))).rejects.toThrow(
      /too large for a link \(\d+ characters, at most 32000\): send its design file/,
    );
  });

  it("is refused in words when it was cut off, or changed in any letter", async () => {
    const whole = await fragment(shared({ crane: changed }));
    for (const length of [8, 12, 200, whole.length - 1])
      await expect(readFragment(whole.slice(0, length)), `${length}`).rejects.toThrow("cut off or damaged");
    for (const at of [20, 300, whole.length - 3]) {
      const other = whole[at] === "A" ? "B" : "A";
      await expect(readFragment(whole.slice(0, at) + other + whole.slice(at + 1)), `${at}`).rejects.toThrow(
        "cut off or damaged",
      );
    }
    await expect(readFragment(`${whole}!`)).rejects.toThrow("cut off or damaged");
  });

  it("is refused in words when it is something else", async () => {
    await expect(readFragment("https://example.org/")).rejects.toThrow("holds no crane");
    await expect(readFragment("")).rejects.toThrow("holds no crane");
    await expect(readFragment("#crane=2.abc")).rejects.toThrow("is of a later version (2)");
    await expect(readFragment(`crane=1.${"A".repeat(LONGEST)}`)).rejects.toThrow("is longer than 32000 characters");
    await expect(readFragment(await holding(" ".repeat(3 * 2 ** 20)))).rejects.toThrow("holds more than 2 MiB");
    for (const data of ["{", "[]", "null", "3", '"crane"'])
      await expect(readFragment(await holding(data)), data).rejects.toThrow(/damaged|holds no crane/);
  });

  it.each([
    [{ design: "none-such" }, "names a design that does not come with this version: none-such"],
    [{ design: "offshore-100t", sum: 1 }, "is of another version of offshore-100t"],
    [{ design: { format: "seacrane-crane/1", links: 3 } }, "links: must be a list"],
    [{ design: null }, "does not hold a crane"],
    [{ posture: { luff: "high" } }, "posture must be numbers by joint"],
    [{ mode: "storm" }, "mode must be one of harbour, hs1.0"],
    [{ selection: { kind: "link", index: 99 } }, "selection must be something that the crane has"],
    [{ selection: { kind: "link", index: 0, part: 0.5 } }, "selection must be"],
    [{ show: "<img>", results: 3 }, "show must be section, both or solid; results must be chart or optimise"],
    [{ look: [1, 2, 1e9] }, "look must be x, z [m] and zoom"],
    [{ camera: [1, 2, 3, 4, 5, null] }, "camera must be six numbers [m]"],
    [{ tools: { cut: 7, explode: 0, volume: true, centres: true } }, "tools must be"],
    [{ tools: 3 }, "tools must be"],
  ])("with %j is refused: %s", async (damage, reason) => {
    await expect(readFragment(await holding({ ...inside, ...damage }))).rejects.toThrow(reason);
  });

  it("with names of what every object has is read as any other", async () => {
    const text = JSON.stringify({ ...inside, design: changed }).replaceAll('"luff"', '"constructor"');
    const link = await holding(text.replace('"posture":{', '"posture":{"__proto__":1,'));
    const on = bench();
    await openLink(on, link);
    const { posture, crane } = on.designer.store.getState();
    expect(Object.keys(posture)).toEqual(crane.links.map(({ joint }) => joint.name));
    expect(Object.values(posture).every(Number.isFinite)).toBe(true);
  });
});

describe("opening a link", () => {
  it("shows what was shown, and one undo brings back what there was", async () => {
    const from = bench(changed);
    from.designer.pose({ luff: 0.5 });
    from.designer.setMode("hs1.5");
    from.designer.select({ kind: "cylinder", index: 1 });
    from.view.set({ show: "solid", camera: { eye: [1, 2, 3], target: [0, 0, 1] } });
    from.view.tool({ cut: 0.5 });
    const to = bench();
    to.view.tool({ measuring: true });
    await openLink(to, await addressOf(from));
    const state = to.designer.store.getState();
    expect(state.crane).toEqual(changed);
    expect([state.posture.luff, state.mode, state.selection]).toEqual([0.5, "hs1.5", { kind: "cylinder", index: 1 }]);
    expect(to.view.store.getState()).toMatchObject({
      show: "solid",
      camera: { eye: [1, 2, 3], target: [0, 0, 1] },
      tools: { cut: 0.5, measuring: true, moving: false },
    });
    to.designer.undo();
    expect(to.designer.store.getState().crane).toBe(offshore);
  });

  it("keeps the work on the bench as a version, once, and says so; a ready design needs none", async () => {
    const link = await fragment(shared({ crane: gangway, mode: "harbour", selection: { kind: "crane" } }));
    const on = bench(changed);
    await openLink(on, link);
    expect(versions().map(({ name, crane }) => [name, crane])).toEqual([[`${changed.name} before a link`, changed]]);
    expect(on.designer.store.getState().notice?.text).toContain("is kept as the version");
    on.designer.undo();
    await openLink(on, link);
    await openLink(bench(), link);
    expect(versions()).toHaveLength(1);
  });

  it("is refused where the browser cannot keep the work", async () => {
    const full = () => {
      throw new DOMException("full", "QuotaExceededError");
    };
    vi.stubGlobal("localStorage", { getItem: () => null, setItem: full });
    const on = bench(changed);
    const link = await fragment(shared());
    await expect(openLink(on, link)).rejects.toThrow("mine \u00e9\u{1f3d7} must not be lost: save it to a file");
    vi.unstubAllGlobals();
    expect(on.designer.store.getState().crane).toBe(changed);
  });

  it("that is broken changes nothing and says why", async () => {
    const on = bench(changed);
    const before = on.designer.store.getState();
    await expect(openLink(on, "#crane=1.abc")).rejects.toThrow(
      "The link is not opened. It is cut off or damaged: copy all of it.",
    );
    expect(on.designer.store.getState()).toBe(before);
  });

  it("to the crane on the bench changes how it is seen, and no version is kept", async () => {
    const on = bench(changed);
    await openLink(on, await fragment(shared({ crane: changed })));
    expect(on.designer.store.getState().crane).toBe(changed);
    expect(on.view.store.getState().look?.zoom).toBe(2.5);
    expect(versions()).toEqual([]);
  });
});
