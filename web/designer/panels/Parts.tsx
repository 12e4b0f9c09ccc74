import { useMemo, useState } from "react";
import { fresh } from "../../core/design/edit";
import { PART_KINDS, type PartKind } from "../../core/design/fields";
import { ofPart, weighed } from "../../core/design/mass";
import { newPart } from "../../core/design/newPart";
import { furnished } from "../../core/design/standard";
import { followsParts } from "../../core/design/together";
import type { Part } from "../../core/design/types";
import { fixed, TONNE } from "../../core/units";
import { useBench, useDesigner } from "../context";
import { choose, MESH_FILE } from "../files";
import { meshPart } from "../server";
import { FileInput } from "./Files";
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
  const [unitless, setUnitless] = useState<File | null>(null);
  const [refused, setRefused] = useState<string | null>(null);
  const put = (part: Part) => {
    designer.edit(`add ${part.kind}`, path, [...parts, part]);
    designer.select({ kind: "link", index, part: parts.length });
  };
  const add = (kind: PartKind) => (kind === "mesh" ? choose(MESH_FILE) : put(newPart(kind, crane, index)));
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
            {followsParts(link) ? (
              `All parts ${fixed(mass / TONNE, 2)} t. Mass, centre and inertia of the link follow them.`
            ) : (
              <>
                All parts {fixed(mass / TONNE, 2)} t; the design says {fixed(link.mass / TONNE, 2)} t.{" "}
                <button
                  type="button"
                  className="plain"
                  onClick={() => designer.edit("weigh", ["links", index], weighed(crane).links[index])}
                >
                  Take mass, centre and inertia from the parts
                </button>
              </>
            )}
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
      <FileInput
        id={MESH_FILE}
        test="mesh-file"
        accept=".stl,.glb,.gltf"
        onChoose={(chosen) => (/\.stl$/i.test(chosen.name) ? setUnitless(chosen) : void take(chosen, "m"))}
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
