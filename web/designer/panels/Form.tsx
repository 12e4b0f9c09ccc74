import { useId, useState } from "react";
import type { Path } from "../../core/design/edit";
import { get, set, withKind } from "../../core/design/edit";
import {
  bound,
  type Field,
  fieldsOf,
  type ListField,
  ofShapes,
  type QuantityField,
  type ShapeName,
  unitOf,
} from "../../core/design/fields";
import { firstItem } from "../../core/design/newPart";
import { type UnitSymbol, written } from "../../core/design/quantity";
import { inStep } from "../../core/design/together";
import { type Crane, FOOT, type Joint } from "../../core/design/types";
import { symbol } from "../../core/units";
import { useBench, useDesigner } from "../context";
import { NumberField } from "./NumberField";

interface Props {
  shape: ShapeName;
  path: Path;
  /** Fields that are shown elsewhere, or not at all. */
  without?: readonly string[];
}

/** The fields of a piece of the design, by what the design file says of them. */
export function Form({ shape, path, without = [] }: Props) {
  const value = useDesigner((state) => get(state.crane, path));
  const fields = fieldsOf(shape, value);
  if (!fields || typeof value !== "object" || value === null) return null;
  return (
    <div className="form" data-shape={shape}>
      {Object.entries(fields)
        .filter(([name]) => !without.includes(name))
        .map(([name, field]) => (
          <One key={name} name={name} field={field} path={[...path, name]} owner={value} />
        ))}
    </div>
  );
}

/** A path as the package writes it: items of lists by their names. */
export function pathText(crane: Crane, path: Path): string {
  return path.reduce<string>((text, key, i) => {
    if (typeof key === "string") return text ? `${text}.${key}` : key;
    const item = get(crane, path.slice(0, i + 1)) as { name?: string } | null;
    return `${text}[${item?.name ?? key}]`;
  }, "");
}

function useQuantity(path: Path, label: string) {
  const { designer } = useBench();
  const changed = (value: number) => {
    const { crane, posture } = designer.store.getState();
    return { crane: inStep(crane, set(crane, path, value)), posture };
  };
  return {
    onChange: (value: number | undefined) => designer.edit(label, path, value),
    onDrag: (value: number) => {
      if (!designer.store.getState().dragging) designer.begin();
      designer.change(changed(value));
    },
    onDragged: (cancelled: boolean) => (cancelled ? designer.cancel() : designer.end(label)),
  };
}

function One({ name, field, path, owner }: { name: string; field: Field; path: Path; owner: unknown }) {
  const crane = useDesigner((state) => state.crane);
  const here = pathText(crane, path);
  const problem = useDesigner((state) => state.problems.find((item) => item.path === here)?.message ?? null);
  const value = (owner as Record<string, unknown>)[name];
  switch (field.kind) {
    case "quantity":
      return (
        <Quantity
          path={path}
          field={field}
          unit={unitOf(name, field, owner)}
          value={value as number}
          problem={problem}
        />
      );
    case "text":
      return <Text path={path} field={field} value={(value as string) ?? ""} problem={problem} />;
    case "vector":
      if (value == null) return <Absent field={field} path={path} start={[-0.5, 0.5]} />;
      return (
        <fieldset
          className="vector"
          title={field.hint}
          data-count={field.unit === "kg.m2" ? 1 : field.count}
          data-wrong={Boolean(problem)}
        >
          <legend>{field.label}</legend>
          {field.parts.map((part, i) => (
            <Item
              key={part}
              label={part}
              path={[...path, i]}
              unit={unitOf(name, field, owner)}
              value={(value as number[])[i]}
            />
          ))}
          {problem && <p className="wrong">{problem}</p>}
        </fieldset>
      );
    case "shape":
      if (value == null) return field.shape === "rating" ? <Absent field={field} path={path} start={{}} /> : null;
      return (
        <fieldset className="inner">
          <legend>{field.label}</legend>
          {problem && <p className="wrong">{problem}</p>}
          <Form shape={field.shape} path={path} />
        </fieldset>
      );
    case "list":
      if (value == null && field.usual) {
        const absent = `${field.usual.join(", ")} ${symbol(field.of)}`;
        return <Absent field={{ ...field, absent }} path={path} start={field.usual} />;
      }
      return <List field={field} path={path} value={(value as unknown[]) ?? []} />;
  }
}

interface QuantityProps {
  path: Path;
  field: QuantityField;
  unit: UnitSymbol;
  value: number | null | undefined;
  problem: string | null;
}

function Quantity({ path, field, unit, value, problem }: QuantityProps) {
  const change = useQuantity(path, field.label);
  return (
    <NumberField
      label={field.label}
      value={value}
      unit={unit}
      hint={field.hint}
      absent={field.optional ? (field.absent ?? "") : undefined}
      problem={problem}
      check={(next) => bound(field, next, (limit) => `${written(limit, unit)} ${unit === "1" ? "" : unit}`.trim())}
      {...change}
    />
  );
}

function Item({ label, path, unit, value }: { label: string; path: Path; unit: UnitSymbol; value: number }) {
  const change = useQuantity(path, label);
  return <NumberField compact label={label} value={value} unit={unit} {...change} />;
}

function Text({
  path,
  field,
  value,
  problem,
}: {
  path: Path;
  field: Field & { kind: "text" };
  value: string;
  problem: string | null;
}) {
  const { designer } = useBench();
  const id = useId();
  const crane = useDesigner((state) => state.crane);
  const choices =
    field.names === "places"
      ? [FOOT, ...crane.links.map((link) => link.name)]
      : field.names === "joints"
        ? crane.links.map((link) => link.joint.name)
        : field.choices;
  const [refused, setRefused] = useState<string | null>(null);
  const save = (next: string, element?: HTMLInputElement | HTMLTextAreaElement) => {
    const reason = next === value ? null : takenBy(crane, path, next);
    setRefused(reason);
    if (reason) return;
    if (next && next !== value) designer.apply(field.label, renamed(crane, path, next));
    else if (element) element.value = value;
  };
  const message = refused ?? problem;
  return (
    <div className="field" data-wrong={Boolean(message)}>
      <label htmlFor={id}>
        <span>{field.label}</span>
        {choices ? (
          <select id={id} value={value} onChange={(event) => save(event.currentTarget.value)}>
            {[...new Set([value, ...choices])].map((choice) => (
              <option key={choice}>{choice}</option>
            ))}
          </select>
        ) : field.long ? (
          <textarea
            id={id}
            key={value}
            rows={2}
            defaultValue={value}
            onBlur={(event) => save(event.currentTarget.value.trim(), event.currentTarget)}
          />
        ) : (
          <input
            id={id}
            key={value}
            defaultValue={value}
            aria-invalid={Boolean(message)}
            onBlur={(event) => save(event.currentTarget.value.trim(), event.currentTarget)}
            onKeyDown={(event) => event.key === "Enter" && event.currentTarget.blur()}
          />
        )}
      </label>
      {message && <p className="wrong">{message}</p>}
    </div>
  );
}

/** Why a name cannot be given: what it is the name of already; null if it can, or is none that others refer to. */
export function takenBy(crane: Crane, path: Path, next: string): string | null {
  const [group, index, ...rest] = path;
  const field = rest.join(".");
  const others = (names: readonly string[]) => names.some((name, i) => name === next && i !== index);
  if (group === "links" && field === "name") {
    if (next === FOOT) return `${FOOT} is the ship\u2019s side of the first joint`;
    return others(crane.links.map(({ name }) => name)) ? `${next} is the name of another link` : null;
  }
  if (group === "links" && field === "joint.name")
    return others(crane.links.map(({ joint }) => joint.name)) ? `${next} is the name of another joint` : null;
  if (group === "cylinders" && field === "name")
    return others(crane.cylinders.map(({ name }) => name)) ? `${next} is the name of another cylinder` : null;
  return null;
}

/** The crane with a text set; a name that others refer to changes with them. */
function renamed(crane: Crane, path: Path, next: string): Crane {
  const [group, index, field, inner] = path;
  if (group === "links" && inner === "kind") return withKind(crane, index as number, next as Joint["kind"]);
  if (group !== "links" || (field !== "name" && inner !== "name")) return set(crane, path, next);
  const link = crane.links[index as number];
  const joint = field === "joint";
  const old = joint ? link.joint.name : link.name;
  const swap = (text: string) => (text === old ? next : text);
  const at = <T extends { readonly link: string }>(pin: T): T => (joint ? pin : { ...pin, link: swap(pin.link) });
  const changed = set(crane, path, next);
  return {
    ...changed,
    cylinders: changed.cylinders.map((item) => ({
      ...item,
      moves: joint ? swap(item.moves) : item.moves,
      base: at(item.base),
      eye: at(item.eye),
    })),
    hoist: { ...changed.hoist, drum: at(changed.hoist.drum), sheaves: changed.hoist.sheaves.map(at) },
    ...(joint && changed.slew ? { slew: { ...changed.slew, joint: swap(changed.slew.joint) } } : {}),
    ...(joint && changed.rating?.structure
      ? {
          rating: {
            ...changed.rating,
            structure: changed.rating.structure.map((item) => ({ ...item, joint: swap(item.joint) })),
          },
        }
      : {}),
  };
}

function Absent({ field, path, start }: { field: Field; path: Path; start: unknown }) {
  const { designer } = useBench();
  return (
    <p className="absent">
      {field.label}: {field.absent ?? "none"}{" "}
      <button type="button" className="plain" onClick={() => designer.edit(`add ${field.label}`, path, start)}>
        Set
      </button>
    </p>
  );
}

function List({ field, path, value }: { field: ListField; path: Path; value: readonly unknown[] }) {
  const { designer } = useBench();
  const crane = useDesigner((state) => state.crane);
  const { of } = field;
  const least = field.least ?? 0;
  const add = () => {
    designer.edit(`add to ${field.label}`, path, [...value, value.at(-1) ?? firstItem(of, crane)]);
  };
  return (
    <fieldset className="inner" title={field.hint}>
      <legend>{field.label}</legend>
      {value.map((_, i) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: the items are known by their place
        <div className="item" key={i}>
          {ofShapes(of) ? (
            <Form shape={of} path={[...path, i]} />
          ) : (
            <Item label={`${i + 1}`} path={[...path, i]} unit={of} value={value[i] as number} />
          )}
          {value.length > least && (
            <button
              type="button"
              className="plain"
              aria-label={`Remove ${field.label} ${i + 1}`}
              onClick={() => designer.edit(`remove from ${field.label}`, [...path, i], undefined)}
            >
              {"\u00d7"}
            </button>
          )}
        </div>
      ))}
      <button type="button" className="plain" onClick={add}>
        Add
      </button>
    </fieldset>
  );
}
