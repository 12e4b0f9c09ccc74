// Design files in the page: read with all that is wrong told at once, written in SI, as Python does.
import type { Problem } from "./check";
import { bound, type Field, fieldsOf, ofShapes, type ShapeName, unitOf } from "./fields";
import { parsed, QuantityError, type UnitSymbol, written } from "./quantity";
import { type Crane, FORMAT } from "./types";

/** A text that is no design file; `problems` says what is wrong with it, place by place. */
export class DesignFileError extends Error {
  constructor(readonly problems: readonly Problem[]) {
    super(problems.map(({ path, message }) => (path ? `${path}: ${message}` : message)).join("\n"));
  }
}

const LARGEST = 16 * 2 ** 20;
const MOST_ITEMS = 1000;
const LONGEST_NAME = 100;
/** Characters that are not for reading, and that XML cannot hold. */
const NO_TEXT = /[\p{Cc}\p{Cs}\ufffe\uffff]/u;

/** The crane of a design file's text. `DesignFileError` if it is none. */
export function read(text: string): Crane {
  if (text.length > LARGEST) throw new DesignFileError([{ path: "", message: "is larger than 16 MiB" }]);
  let data: unknown;
  try {
    data = JSON.parse(text);
  } catch (error) {
    throw new DesignFileError([{ path: "", message: `is not JSON: ${(error as Error).message}` }]);
  }
  return fromData(data);
}

/** The crane in parsed JSON. `DesignFileError` if it is none. */
export function fromData(data: unknown): Crane {
  const format = isObject(data) ? data.format : undefined;
  if (format !== FORMAT) {
    const message = !isObject(data)
      ? "does not hold a crane: the file must be a JSON object"
      : format === undefined
        ? `names no format; a design file has "format": "${FORMAT}"`
        : `is of a format that this version cannot read: ${JSON.stringify(format)}`;
    throw new DesignFileError([{ path: "", message }]);
  }
  const problems: Problem[] = [];
  const crane = shape("crane", data, "", problems);
  if (problems.length) throw new DesignFileError(problems);
  return crane as unknown as Crane;
}

/** The design file of a crane, in SI. */
export function text(crane: Crane): string {
  return `${JSON.stringify(crane, (_, value) => value ?? undefined, 2)}\n`;
}

function isObject(value: unknown): value is Record<string, unknown> {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

function shape(name: ShapeName, value: unknown, path: string, problems: Problem[]): Record<string, unknown> {
  const say = (message: string) => problems.push({ path, message });
  const fields = fieldsOf(name, value);
  if (!isObject(value) || !fields) {
    say(isObject(value) ? `is of no known kind: ${JSON.stringify(value.kind)}` : "must be an object");
    return {};
  }
  const result: Record<string, unknown> = {};
  for (const key of Object.keys(value)) if (!Object.hasOwn(fields, key)) say(`${key} is not a field here`);
  for (const [key, field] of Object.entries(fields)) {
    const at = path ? `${path}.${key}` : key;
    const given = Object.hasOwn(value, key) ? value[key] : undefined;
    if (given === undefined || given === null) {
      if (!field.optional) problems.push({ path: at, message: "is missing" });
      continue;
    }
    result[key] = one(key, field, given, value, at, problems);
  }
  return result;
}

function one(key: string, field: Field, value: unknown, owner: unknown, path: string, problems: Problem[]): unknown {
  const say = (message: string) => problems.push({ path, message });
  switch (field.kind) {
    case "text":
      if (typeof value !== "string" || !value) say("must be a text");
      else if (field.choices && !field.choices.includes(value)) say(`must be one of ${field.choices.join(", ")}`);
      else {
        const wrong = unreadable(value, key === "name") ?? field.check?.(value);
        if (wrong) say(wrong);
      }
      return value;
    case "quantity": {
      const unit = unitOf(key, field, owner);
      const number = quantity(value, unit, path, problems);
      const wrong = number === null ? null : bound(field, number, (limit) => `${written(limit, unit)} ${unit}`);
      if (wrong) say(wrong);
      return number;
    }
    case "vector":
      if (!Array.isArray(value) || value.length !== field.count) {
        say(`must be a list of ${field.count}`);
        return value;
      }
      return value.map((item, i) => quantity(item, unitOf(key, field, owner), `${path}[${i}]`, problems));
    case "shape":
      return shape(field.shape, value, path, problems);
    case "list":
      if (!Array.isArray(value) || value.length < (field.least ?? 0) || value.length > (field.most ?? MOST_ITEMS)) {
        say(`must be a list of ${field.least ?? 0} to ${field.most ?? MOST_ITEMS}`);
        return value;
      }
      return value.map((item, i) => {
        const label = isObject(item) && typeof item.name === "string" ? item.name : i;
        const at = `${path}[${label}]`;
        if (ofShapes(field.of)) return shape(field.of, item, at, problems);
        const unit = field.of;
        const number = quantity(item, unit, at, problems);
        const wrong =
          number === null ? null : bound(field.each ?? {}, number, (limit) => `${written(limit, unit)} ${unit}`);
        if (wrong) problems.push({ path: at, message: wrong });
        return number;
      });
  }
}

/** Why a text cannot stand in a design, in words; null if it can. A name is one line. */
function unreadable(value: string, name: boolean): string | null {
  if (name && (value.length > LONGEST_NAME || /[\r\n\t]/.test(value)))
    return `must be one line of at most ${LONGEST_NAME} characters`;
  return NO_TEXT.test(value.replaceAll(/[\r\n\t]/g, "")) ? "has a character that cannot be printed" : null;
}

/** A number is in SI; a text has its unit. */
function quantity(value: unknown, unit: UnitSymbol, path: string, problems: Problem[]): number | null {
  if (typeof value === "number") return value;
  try {
    if (typeof value === "string") {
      if (unit !== "1" && /^[-+\d.e\s]*$/i.test(value)) throw new QuantityError("has no unit");
      return parsed(value, unit);
    }
    throw new QuantityError("must be a number, or a text with a unit");
  } catch (error) {
    problems.push({ path, message: (error as Error).message });
    return null;
  }
}
