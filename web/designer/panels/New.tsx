import { Modal } from "@mantine/core";
import { useState } from "react";
import { scaled, withoutLink } from "../../core/design/edit";
import type { Crane } from "../../core/design/types";
import { useBench } from "../context";
import { bounds } from "../section/window";
import { SHIPPED } from "../shipped";
import { NumberField } from "./NumberField";

const CHAIN = "A chain, joint by joint";

/** A crane from a type, geometrically similar to a ready design, of the reach wanted. */
export function NewDialog({ open, onClose }: { open: boolean; onClose: () => void }) {
  const { designer } = useBench();
  const [type, setType] = useState(SHIPPED.find(({ name }) => name === "offshore-100t")?.type ?? CHAIN);
  const [reach, setReach] = useState(25);
  const [name, setName] = useState("my crane");
  const create = async () => {
    const like = SHIPPED.find((item) => item.type === type) ?? SHIPPED.find((item) => item.name === "offshore-100t")!;
    let crane = await like.load();
    if (type === CHAIN) crane = bare(crane);
    crane = scaled(crane, reach / furthest(crane));
    designer.open({ ...crane, name: name.trim() || "my crane", about: `A new crane: ${type.toLowerCase()}.` });
    onClose();
  };
  return (
    <Modal opened={open} onClose={onClose} title="New crane" transitionProps={{ duration: 80 }}>
      <div className="dialog" data-testid="new-dialog">
        <div className="field">
          <label>
            <span>Name</span>
            <input value={name} onChange={(event) => setName(event.currentTarget.value)} />
          </label>
        </div>
        <div className="types" role="radiogroup" aria-label="Type">
          {[...SHIPPED.map((item) => item.type), CHAIN].map((item) => (
            <label key={item}>
              <input type="radio" name="type" checked={type === item} onChange={() => setType(item)} /> {item}
            </label>
          ))}
        </div>
        <NumberField
          label="Largest radius"
          value={reach}
          unit="m"
          check={(value) => (value >= 2 && value <= 150 ? null : "must be 2 to 150 m")}
          onChange={(value) => value !== undefined && setReach(value)}
        />
        <p className="hint">
          Geometrically similar to the ready design of this type: lengths in proportion, forces by their square, masses
          by their cube. It replaces the crane on the bench; undo brings that back.
        </p>
        <button type="button" className="wide primary" data-testid="create" onClick={create}>
          Create
        </button>
      </div>
    </Modal>
  );
}

function furthest(crane: Crane): number {
  return Math.max(bounds(crane).high[0], 1);
}

/** The column and the boom of a crane alone. */
function bare(crane: Crane): Crane {
  let short = crane;
  while (short.links.length > 2) short = withoutLink(short, short.links.length - 1)!;
  return short;
}
