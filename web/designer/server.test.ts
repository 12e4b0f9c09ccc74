import { afterEach, describe, expect, it, vi } from "vitest";
import fixture from "../../tests/fixtures/crane_kinematics.json";
import type { Crane } from "../core/design/types";
import { judge } from "./files";
import { placed } from "./server";

const crane = fixture.crane as unknown as Crane;
const answering = (problems: unknown[]) =>
  vi.stubGlobal("fetch", async () => new Response(JSON.stringify({ problems }), { status: 200 }));

describe("what the package finds wrong", () => {
  afterEach(() => vi.unstubAllGlobals());

  it("is told with the value, what is allowed and what to do", async () => {
    const stroke = { path: "cylinders[boom].stroke", message: "is too short", value: "4.4", allowed: "at least 5 m" };
    const mass = { path: "links[jib].mass", message: "is missing", value: null, allowed: null };
    answering([
      { ...stroke, hint: "Move its pins." },
      { ...mass, hint: null },
    ]);
    await expect(judge(crane)).rejects.toThrow(
      "cylinders[boom].stroke: is too short (got 4.4); allowed: at least 5 m. Move its pins.\nlinks[jib].mass: is missing",
    );
  });

  it("is told at its place too", () => {
    const told = { path: "design: links[boom].parts[web].thickness", message: "is too thick", allowed: "below 0.4 m" };
    expect(placed(told)).toEqual({
      path: "links[boom].parts[web].thickness",
      message: "is too thick; allowed: below 0.4 m",
    });
  });

  it("may be nothing", async () => {
    answering([]);
    expect(await judge(crane)).toContain("is sound");
  });
});
