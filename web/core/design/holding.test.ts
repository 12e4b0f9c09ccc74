import { readFileSync } from "node:fs";
import { describe, expect, it } from "vitest";
import { verdict } from "./curve";
import { set } from "./edit";
import { read } from "./file";
import { holding } from "./holding";
import { meetingSpeed } from "./loadChart";
import { GRAVITY, HARBOUR, modes } from "./types";

const DEGREE = Math.PI / 180;
const BAR = 1e5;
const shipped = (name: string) => read(readFileSync(`../src/seacrane/design/cranes/${name}.json`, "utf8"));
const offshore = shipped("offshore-100t");
const posture = { slew: 90 * DEGREE, luff: 50 * DEGREE, jib: -70 * DEGREE };

describe("what cylinders bear", () => {
  it("is the static pressure known of the reference crane, with its arms and lengths", () => {
    const [boom, jib] = holding(offshore, posture, 40e3 * GRAVITY, HARBOUR);
    expect(boom.pressure / BAR).toBeCloseTo(191.0, 0);
    expect(jib.pressure / BAR).toBeCloseTo(115.5, 0);
    expect([boom.lever, jib.lever, boom.length, jib.length].map((value) => value.toFixed(2))).toEqual([
      "3.00",
      "2.19",
      "8.54",
      "7.14",
    ]);
    expect([boom.side, jib.side]).toEqual(["bore", "bore"]);
  });

  it("is on the rod side where the cylinder pulls", () => {
    // the jib far below the boom hangs outboard of its pin no more
    const pulling = holding(offshore, { luff: 0, jib: -115 * DEGREE }, 0, HARBOUR)[1];
    expect(pulling.side).toBe("rod");
  });

  it("is the working pressure where the cylinder governs, in harbour and at sea, heeled and reeved", () => {
    const cases = {
      ...offshore,
      rating: { ...offshore.rating, slew_moment: null, slew_torque: null, heel: 0.05, trim: 0.03 },
    };
    const crane = set(set(cases, ["hoist", "falls"], 2), ["hoist", "hook_mass"], 1500);
    for (const mode of modes(crane)) {
      const { governs, held } = verdict(crane, { luff: 0.4, jib: -0.2 }, mode);
      const governing = held.find(({ cylinder }) => cylinder === governs)!;
      expect(governing.pressure / BAR, mode.name).toBeCloseTo(280, 3);
    }
  });

  it("has no end where there is no lever", () => {
    const dead = set(offshore, ["cylinders", 0, "eye"], { link: "boom", x: 0, z: 0 });
    expect(holding(dead, posture, 0, HARBOUR)[0].pressure).toBe(Number.POSITIVE_INFINITY);
  });
});

describe("the dynamic factor", () => {
  it("is that of the design in harbour", () => {
    expect(verdict(offshore, posture, HARBOUR).dynamic).toBe(offshore.rating?.harbour_factor);
  });

  it("follows from one stiffness at the hook in all sea states", () => {
    // psi = 1 + (v_r / g) sqrt(k / m), solved for k
    const stiffness = modes(offshore)
      .slice(1)
      .map((mode) => {
        const { dynamic, load } = verdict(offshore, posture, mode);
        const speed = 0.5 * offshore.hoist.speed + meetingSpeed(offshore, mode);
        return load * (((dynamic - 1) * GRAVITY) / speed) ** 2;
      });
    for (const k of stiffness) expect(k / stiffness[0]).toBeCloseTo(1, 6);
    expect(stiffness[0]).toBeGreaterThan(1e6);
    expect(stiffness[0]).toBeLessThan(offshore.hoist.rope.EA / 12);
  });

  it("is larger for a load below what the dynamics allow", () => {
    const mode = modes(offshore)[2];
    const light = { ...offshore, rating: { ...offshore.rating, load_moment: 2e6 } };
    expect(verdict(light, posture, mode).governs).toBe("load moment");
    expect(verdict(light, posture, mode).dynamic).toBeGreaterThan(verdict(offshore, posture, mode).dynamic);
  });
});
