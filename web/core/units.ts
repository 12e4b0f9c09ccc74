// SI inside, engineering units on the page. The server says of each variable which unit it is shown in and the factor.
import type { VariableInfo } from "../rpc/messages";

export const DASH = "\u2013";

export const DEGREE = Math.PI / 180;
export const BAR = 1e5;
export const TONNE = 1e3;
export const GRAVITY = 9.81;

/** A number with a fixed number of decimals, a true minus sign, no negative zero; a dash where there is none. */
export function fixed(value: number | null | undefined, decimals: number): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return DASH;
  const text = value.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

/** The symbol as typeset: m/s2 with its exponent raised, deg as its sign, the dot of a product centred. */
export function symbol(unit: string): string {
  if (unit === "1" || unit === "") return DASH;
  if (unit.startsWith("deg")) return unit.replace("deg", "\u00b0");
  return unit
    .replaceAll(".", "\u00b7")
    .replace(/(?<=[a-z])2/g, "\u00b2")
    .replace(/(?<=[a-z])3/g, "\u00b3");
}

/** Value in the engineering unit with about `digits` significant digits, never in powers of ten on everyday ranges. */
export function shown(value: number | null, variable: VariableInfo, digits = 4): string {
  if (value === null || !Number.isFinite(value)) return DASH;
  const scaled = value * variable.factor;
  const size = Math.abs(scaled);
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) return scaled.toExponential(digits - 2).replace("-", "\u2212");
  const decimals = size === 0 ? digits - 1 : Math.max(0, Math.min(6, digits - 1 - Math.floor(Math.log10(size))));
  return fixed(scaled, decimals);
}

/** Simulated time as h:mm:ss.t, or m:ss.t within the first hour. */
export function clock(seconds: number | null | undefined): string {
  if (seconds === null || seconds === undefined || !Number.isFinite(seconds)) return DASH;
  const tenths = Math.floor(seconds * 10 + 1e-6);
  const two = (n: number) => String(n).padStart(2, "0");
  const h = Math.floor(tenths / 36000);
  const m = Math.floor(tenths / 600) % 60;
  const s = Math.floor(tenths / 10) % 60;
  return `${h ? `${h}:${two(m)}` : m}:${two(s)}.${tenths % 10}`;
}
