// Quantities as an engineer types them: `18`, `8 ft`, `420 mm`, `2*(1.5 m + 300 mm)`. SI inside.
const UNITS = {
  "1": [1, "1"],
  "%": [0.01, "1"],
  kg: [1, "kg"],
  t: [1e3, "kg"],
  m: [1, "m"],
  mm: [1e-3, "m"],
  cm: [1e-2, "m"],
  km: [1e3, "m"],
  ft: [0.3048, "m"],
  in: [0.0254, "m"],
  rad: [1, "rad"],
  deg: [Math.PI / 180, "rad"],
  "\u00b0": [Math.PI / 180, "rad"],
  Pa: [1, "Pa"],
  bar: [1e5, "Pa"],
  MPa: [1e6, "Pa"],
  GPa: [1e9, "Pa"],
  N: [1, "N"],
  kN: [1e3, "N"],
  MN: [1e6, "N"],
  "N.m": [1, "N.m"],
  "kN.m": [1e3, "N.m"],
  "MN.m": [1e6, "N.m"],
  "m/s": [1, "m/s"],
  "m/min": [1 / 60, "m/s"],
  "mm/s": [1e-3, "m/s"],
  kn: [1852 / 3600, "m/s"],
  "rad/s": [1, "rad/s"],
  "deg/s": [Math.PI / 180, "rad/s"],
  rpm: [Math.PI / 30, "rad/s"],
  "1/s": [1, "1/s"],
  Hz: [1, "1/s"],
  "kg/m": [1, "kg/m"],
  "kg/m3": [1, "kg/m3"],
  "kg.m2": [1, "kg.m2"],
  "t.m2": [1e3, "kg.m2"],
} as const satisfies Record<string, readonly [factor: number, si: string]>;

export type UnitSymbol = keyof typeof UNITS;

const LONGEST_FIRST = (Object.keys(UNITS) as UnitSymbol[]).sort((a, b) => b.length - a.length);

/** SI value of one of this unit. */
export function factor(unit: UnitSymbol): number {
  return UNITS[unit][0];
}

/** The SI value of so much of a unit. 350 mm are 0.35 m by a division: no number of a computer is a thousandth. */
function inSi(value: number, unit: UnitSymbol): number {
  const parts = 1 / factor(unit);
  return Number.isInteger(parts) ? value / parts : value * factor(unit);
}

/** All units in which a quantity shown in `unit` may be given. */
export function alike(unit: UnitSymbol): UnitSymbol[] {
  return (Object.keys(UNITS) as UnitSymbol[]).filter((other) => UNITS[other][1] === UNITS[unit][1]);
}

/** What is wrong with a text that should be a quantity. */
export class QuantityError extends Error {}

/** A value on the way: a plain number, or one with a unit. */
interface Term {
  readonly value: number;
  readonly unit: boolean;
}

/** The SI value of a text; a number without a unit is in `shown`. `QuantityError` says what is wrong. */
export function parsed(text: string, shown: UnitSymbol): number {
  const reader = new Reader(text, shown);
  const { value } = reader.whole();
  if (!Number.isFinite(value)) throw new QuantityError("is not a finite number");
  return value;
}

class Reader {
  private at = 0;
  private readonly text: string;

  constructor(
    text: string,
    private readonly shown: UnitSymbol,
  ) {
    this.text = text
      .replaceAll("\u2212", "-")
      .replaceAll("\u00b7", ".")
      .replaceAll("\u00b2", "2")
      .replaceAll("\u00b3", "3")
      .trim();
  }

  whole(): Term {
    if (!this.text) throw new QuantityError("is empty: give a number");
    const value = this.quantity(this.sum());
    if (this.at < this.text.length)
      throw new QuantityError(
        `cannot be read from \u201c${this.text.slice(this.at)}\u201d on; units here: ${alike(this.shown).join(", ")}`,
      );
    return value;
  }

  private quantity(term: Term): Term {
    return term.unit ? term : { value: inSi(term.value, this.shown), unit: true };
  }

  private sum(): Term {
    let left = this.product();
    for (let sign = this.take("+-"); sign; sign = this.take("+-")) {
      let right = this.product();
      if (left.unit !== right.unit) [left, right] = [this.quantity(left), this.quantity(right)];
      left = { value: left.value + (sign === "+" ? right.value : -right.value), unit: left.unit };
    }
    return left;
  }

  private product(): Term {
    let left = this.factor();
    for (let sign = this.take("*/"); sign; sign = this.take("*/")) {
      const right = this.factor();
      if (right.unit && (left.unit || sign === "/")) throw new QuantityError("has units multiplied or divided");
      left = {
        value: sign === "*" ? left.value * right.value : left.value / right.value,
        unit: left.unit || right.unit,
      };
    }
    return left;
  }

  private factor(): Term {
    if (this.take("-")) {
      const { value, unit } = this.factor();
      return { value: -value, unit };
    }
    if (this.take("(")) {
      const inner = this.sum();
      if (!this.take(")")) throw new QuantityError("has a bracket that is not closed");
      return inner;
    }
    this.skip();
    const found = /^(\d+\.?\d*|\.\d+)(e[-+]?\d+)?/i.exec(this.text.slice(this.at));
    if (!found) throw new QuantityError("is not a number with a unit");
    this.at += found[0].length;
    this.skip();
    const rest = this.text.slice(this.at);
    const unit = LONGEST_FIRST.find(
      (symbol) => symbol !== "1" && rest.startsWith(symbol) && !/^[a-z0-9]/i.test(rest.slice(symbol.length)),
    );
    if (!unit) return { value: Number(found[0]), unit: false };
    if (UNITS[unit][1] !== UNITS[this.shown][1])
      throw new QuantityError(`cannot be given in ${unit}; allowed: ${alike(this.shown).join(", ")}`);
    this.at += unit.length;
    return { value: inSi(Number(found[0]), unit), unit: true };
  }

  private skip(): void {
    while (this.text[this.at] === " ") this.at += 1;
  }

  private take(of: string): string {
    this.skip();
    const next = this.text[this.at];
    if (next === undefined || !of.includes(next)) return "";
    this.at += 1;
    return next;
  }
}

/** Less than this of any unit shown is what a computer leaves of nothing. */
const NOTHING = 1e-10;

/** An SI value in the unit shown, with no more digits than it has, at most eight. */
export function written(value: number, shown: UnitSymbol): string {
  const amount = value / factor(shown);
  return String(Math.abs(amount) < NOTHING ? 0 : Number(amount.toPrecision(8))).replace("-", "\u2212");
}
