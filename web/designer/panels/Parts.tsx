import { useMemo, useRef, useState } from "react";
import { fresh } from "../../core/design/edit";
import { PART_KINDS, type PartKind } from "../../core/design/fields";
import { ofPart, weighed } from "../../core/design/mass";
import { furnished } from "../../core/design/standard";
import type { Crane, Part } from "../../core/design/types";
import { fixed, TONNE } from "../../core/units";
import { useBench, useDesigner } from "../context";
import { meshPart } from "../server";
import { Form } from "./Form";

const LENGTHS = ["mm", "cm", "m", "in", "ft"] as const;

/** What a link is built from; without parts of its own it is drawn with standard ones. */
export function Parts({ index, part, mass }: { index: number; part?: number; mass: number }) {
  const { designer } = useBench();
  const crane = useDesigner((state) => state.crane);
  const link = crane.links[index];
  const parts = link.parts ?? [];
  const masses = useMemo(() => parts.map((item) => ofPart(item).mass), [parts]);
  const path = ["links", index, "parts"];
  const file = useRef<HTMLInputElement>(null);
  const [unitless, setUnitless] = useState<File | null>(null);
  const [refused, setRefused] = useState<string | null>(null);
  const put = (part: Part) => {
    designer.edit(`add ${part.kind}`, path, [...parts, part]);
    designer.select({ kind: "link", index, part: parts.length });
  };
  const add = (kind: PartKind) => (kind === "mesh" ? file.current?.click() : put(made(kind, crane, index)));
  const take = async (chosen: File, unit: string) => {
    setUnitless(null);
    setRefused(null);
    try {
      const part = await meshPart(chosen, unit);
      const names = parts.map((item) => item.name);
      put({ ...part, name: fresh(part.name, names) });
      designer.tell(`${chosen.name} is a part of ${link.name} now: z up, in the frame of the link, solid inside.`);
    } catch (error) {
      setRefused(`${chosen.name} is not taken. ${(error as Error).message}`);
    }
  };
  return (
    <fieldset className="inner parts">
      <legend>Parts</legend>
      {parts.length === 0 ? (
        <p className="hint">
          Drawn with standard parts.{" "}
          <button
            type="button"
            className="plain"
            data-testid="own-parts"
            onClick={() => designer.edit("standard parts", path, furnished(crane).links[index].parts)}
          >
            Make them its own
          </button>
        </p>
      ) : (
        <>
          <ul>
            {parts.map((item, i) => (
              // biome-ignore lint/suspicious/noArrayIndexKey: parts are known by their place, their names may be equal
              <li key={i}>
                <button
                  type="button"
                  className="twig"
                  aria-current={part === i}
                  onClick={() => designer.select({ kind: "link", index, part: part === i ? undefined : i })}
                >
                  <span>{item.name}</span>
                  <small>
                    {item.kind}, {fixed(masses[i] / TONNE, 2)} t
                  </small>
                </button>
                {part === i && (
                  <>
                    <Form shape="part" path={[...path, i]} without={["kind", "surface"]} />
                    <button
                      type="button"
                      className="plain"
                      onClick={() => {
                        designer.edit("remove part", [...path, i], undefined);
                        designer.select({ kind: "link", index });
                      }}
                    >
                      Remove {item.name}
                    </button>
                  </>
                )}
              </li>
            ))}
          </ul>
          <p className="hint" data-testid="parts-mass" data-value={mass}>
            All parts {fixed(mass / TONNE, 2)} t; the design says {fixed(link.mass / TONNE, 2)} t.{" "}
            <button
              type="button"
              className="plain"
              onClick={() => designer.edit("weigh", ["links", index], weighed(crane).links[index])}
            >
              Take mass, centre and inertia from the parts
            </button>
          </p>
        </>
      )}
      <label className="adder">
        <span>Add a part</span>
        <select value="" onChange={(event) => event.currentTarget.value && add(event.currentTarget.value as PartKind)}>
          <option value="">{"\u2026"}</option>
          {PART_KINDS.map((kind) => (
            <option key={kind} value={kind}>
              {kind === "mesh" ? "mesh from a file\u2026" : kind}
            </option>
          ))}
        </select>
      </label>
      <input
        ref={file}
        type="file"
        accept=".stl,.glb,.gltf"
        hidden
        data-testid="mesh-file"
        onChange={(event) => {
          const chosen = event.currentTarget.files?.[0];
          event.currentTarget.value = "";
          if (!chosen) return;
          if (/\.stl$/i.test(chosen.name)) setUnitless(chosen);
          else void take(chosen, "m");
        }}
      />
      {unitless && (
        <p className="tools" aria-live="polite">
          An STL has no unit. One in {unitless.name} is one{" "}
          {LENGTHS.map((unit) => (
            <button key={unit} type="button" data-testid={`mesh-${unit}`} onClick={() => take(unitless, unit)}>
              {unit}
            </button>
          ))}
        </p>
      )}
      {refused && (
        <p className="wrong" role="alert" data-testid="mesh-refused">
          {refused}
        </p>
      )}
    </fieldset>
  );
}

/** A part of a kind to begin with, of the size of its link. */
function made(kind: Exclude<PartKind, "mesh">, crane: Crane, index: number): Part {
  const link = crane.links[index];
  const next = crane.links[index + 1]?.joint.origin;
  const tip = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  const [x, z] = next ? [next[0], next[2]] : [tip.x, tip.z];
  const length = Math.max(1, Math.hypot(x, z));
  const name = fresh(
    kind,
    (link.parts ?? []).map((part) => part.name),
  );
  const depth = 0.04 * length;
  switch (kind) {
    case "girder":
      return {
        kind,
        name,
        thickness: 0.015,
        stations: [0, 0.4 * length, length].map((at) => ({ x: at, top: depth, bottom: -depth, width: 1.5 * depth })),
      };
    case "tube":
      return {
        kind,
        name,
        start: [0, 0, 0],
        end: [x, 0, z],
        diameter: 2 * depth,
        end_diameter: 2 * depth,
        thickness: 0.015,
      };
    case "lug":
      return {
        kind,
        name,
        x: 0.3 * x,
        z: 0.3 * z - 2.5 * depth,
        root_x: 0.3 * x,
        root_z: 0.3 * z,
        root_width: 3 * depth,
        radius: 0.6 * depth,
        hole: 0.5 * depth,
        thickness: 0.03,
        gap: depth,
      };
    case "sheave":
      return { kind, name, x, z, radius: depth, groove: 0.2 * depth, width: 0.3 * depth, hole: 0.4 * depth };
    case "drum":
      return {
        kind,
        name,
        x: 0.5 * x,
        z: 0.5 * z + depth,
        radius: depth,
        length: 2.6 * depth,
        flange: 1.5 * depth,
        thickness: 0.03,
      };
    case "box":
      return { kind, name, centre: [0.5 * x, 0, 0.5 * z], size: [2 * depth, 2 * depth, 2 * depth], thickness: 0.01 };
  }
}
