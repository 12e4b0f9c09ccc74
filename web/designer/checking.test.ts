import { readFileSync } from "node:fs";
import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import { set } from "../core/design/edit";
import { read } from "../core/design/file";
import type { Crane } from "../core/design/types";
import { keepChecked } from "./checking";
import { createDesigner } from "./store";

const crane = read(readFileSync("../src/seacrane/design/cranes/offshore-100t.json", "utf8"));
const THICK = { path: "links[boom].parts[boom].thickness", message: "must be less than half of the narrowest section" };

describe("the check of the package", () => {
  beforeEach(() => void vi.useFakeTimers());
  afterEach(() => void vi.useRealTimers());
  const paths = (designer: ReturnType<typeof createDesigner>) => designer.store.getState().problems.map((p) => p.path);

  it("is asked for once the work rests, and what it finds stands beside what the page found", async () => {
    const designer = createDesigner(crane);
    const asked: Crane[] = [];
    const stop = keepChecked(designer, async (one) => {
      asked.push(one);
      return [THICK, { path: "cylinders[boom_cylinder].stroke", message: "is too short" }];
    });
    designer.edit("a", ["cylinders", 0, "stroke"], 4.1);
    designer.edit("b", ["cylinders", 0, "stroke"], 4);
    expect(paths(designer)).toEqual(["cylinders[boom_cylinder].stroke"]);
    await vi.advanceTimersByTimeAsync(1000);
    expect(asked).toEqual([designer.store.getState().crane]);
    expect(paths(designer), "each place is told once").toEqual(["cylinders[boom_cylinder].stroke", THICK.path]);
    stop();
  });

  it("that is late tells nothing of another crane, and one that is not there tells nothing", async () => {
    const designer = createDesigner(crane);
    const answers: ((found: readonly [typeof THICK] | readonly []) => void)[] = [];
    const stop = keepChecked(designer, () => new Promise((done) => void answers.push(done)));
    await vi.advanceTimersByTimeAsync(1000);
    designer.edit("plate", ["links", 0, "mass"], 100_000);
    answers[0]([THICK]);
    await vi.advanceTimersByTimeAsync(0);
    expect(paths(designer)).toEqual([]);
    stop();
    const alone = createDesigner(set(crane, ["cylinders", 0, "stroke"], 4));
    const end = keepChecked(alone, () => Promise.reject(new Error("no server")));
    await vi.advanceTimersByTimeAsync(1000);
    expect(paths(alone)).toEqual(["cylinders[boom_cylinder].stroke"]);
    end();
  });

  it("stands until the next one: nothing flickers while something else is dragged, and another crane is free of it", async () => {
    const designer = createDesigner(crane);
    designer.found([THICK]);
    designer.begin();
    designer.change({ crane: set(crane, ["links", 0, "mass"], 1e5), posture: designer.store.getState().posture });
    expect(paths(designer)).toEqual([THICK.path]);
    designer.end("drag");
    designer.open({ ...crane, name: "another" });
    expect(paths(designer)).toEqual([]);
  });
});
