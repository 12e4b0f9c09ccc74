import { describe, expect, it } from "vitest";
import { parsed, written } from "./quantity";

describe("a quantity", () => {
  it("is in the unit shown unless it says another", () => {
    expect(parsed("18", "m")).toBe(18);
    expect(parsed("420", "mm")).toBeCloseTo(0.42, 12);
    expect(parsed("8 ft", "m")).toBeCloseTo(2.4384, 12);
    expect(parsed("8ft", "mm")).toBeCloseTo(2.4384, 12);
    expect(parsed("\u221240 deg", "deg")).toBeCloseTo((-40 * Math.PI) / 180, 12);
    expect(parsed("30 m/min", "m/s")).toBe(0.5);
    expect(parsed("350 mm", "mm")).toBe(0.35);
    expect(parsed("9", "mm")).toBe(0.009);
  });

  it("may be reckoned, with units where they make sense", () => {
    expect(parsed("18 + 0.5", "m")).toBe(18.5);
    expect(parsed("2*3.5 m", "m")).toBe(7);
    expect(parsed("2*(1.5 m + 300 mm)", "m")).toBeCloseTo(3.6, 12);
    expect(parsed("1 m + 1", "mm")).toBeCloseTo(1.001, 12);
    expect(parsed("100/4", "bar")).toBeCloseTo(25e5, 6);
    expect(parsed("-(2-5)", "t")).toBe(3000);
  });

  it("says what is wrong and what is allowed", () => {
    expect(() => parsed("420 bar", "m")).toThrow("cannot be given in bar; allowed: m, mm, cm, km, ft, in");
    expect(() => parsed("", "m")).toThrow("is empty");
    expect(() => parsed("18 furlongs", "m")).toThrow("furlongs");
    expect(() => parsed("1,5", "m")).toThrow("\u201c,5\u201d");
    expect(() => parsed("1/0", "m")).toThrow("finite");
    expect(() => parsed("2 m * 3 m", "m")).toThrow("multiplied");
    expect(() => parsed("(2", "m")).toThrow("bracket");
  });

  it("is written without noise", () => {
    expect(written(0.1 + 0.2, "m")).toBe("0.3");
    expect(written(-Math.PI / 4, "deg")).toBe("\u221245");
    expect(written(28e6, "bar")).toBe("280");
    // in a narrow field the exponent of such a number is not seen
    expect(written(-2.34928e-17, "m")).toBe("0");
    expect(written(1e-6, "m")).toBe("0.000001");
  });
});
