import { Modal } from "@mantine/core";
import { useRef, useState } from "react";
import { bare, newCrane } from "../../core/design/newCrane";
import { furthestLoad } from "../../core/design/rated";
import type { Crane } from "../../core/design/types";
import { TONNE } from "../../core/units";
import { useBench } from "../context";
import { bounds } from "../section/window";
import { SHIPPED } from "../shipped";
import { NumberField } from "./NumberField";

const CHAIN = "A chain, joint by joint";

/** A crane from a type: a ready design in the size that gives the reach and the load wanted. */
export function NewDialog({ open, onClose }: { open: boolean; onClose: () => void }) {
  return (
    <Modal opened={open} onClose={onClose} title="New crane" transitionProps={{ duration: 80 }}>
      <NewCrane onClose={onClose} />
    </Modal>
  );
}

export function NewCrane({ onClose }: { onClose: () => void }) {
  const { designer } = useBench();
  const [type, setType] = useState(SHIPPED.find(({ name }) => name === "offshore-100t")?.type ?? CHAIN);
  const [reach, setReach] = useState(25);
  const [load, setLoad] = useState<number | undefined>(undefined);
  const [name, setName] = useState("my crane");
  // reading and sizing takes a moment, in which another Enter is not another crane
  const made = useRef(false);
  const create = async () => {
    if (made.current) return;
    made.current = true;
    try {
      await open();
    } catch (error) {
      made.current = false;
      designer.tell(`No crane was made: ${(error as Error).message}`, "wrong");
    }
  };
  const open = async () => {
    const like = SHIPPED.find((item) => item.type === type) ?? SHIPPED.find((item) => item.name === "offshore-100t")!;
    const ready = await like.load();
    const short = type === CHAIN ? bare(ready) : ready;
    // a short chain is to lift what the whole crane would lift as far out
    const usual = type === CHAIN ? furthestLoad(newCrane(ready, reach / furthest(ready)))?.mass : undefined;
    const crane = newCrane(short, reach / furthest(short), load ?? usual);
    designer.open({ ...crane, name: name.trim() || "my crane", about: `A new crane: ${type.toLowerCase()}.` });
    onClose();
  };
  return (
    <form
      className="dialog"
      data-testid="new-dialog"
      noValidate
      onSubmit={(event) => {
        event.preventDefault();
        // what is wrong is said at its field, and mended before anything is made of the rest
        const wrong = event.currentTarget.querySelector<HTMLElement>("[aria-invalid=true]");
        if (wrong) wrong.focus();
        else void create();
      }}
    >
      <div className="field">
        <label>
          <span>Name</span>
          <input
            data-autofocus
            value={name}
            onFocus={(event) => event.currentTarget.select()}
            onChange={(event) => setName(event.currentTarget.value)}
          />
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
      <NumberField
        label="Load at this radius"
        hint="in harbour, in the best posture"
        value={load}
        unit="t"
        absent="as its type"
        check={(value) => (value >= 10 && value <= 5000 * TONNE ? null : "must be 0.01 to 5000 t")}
        onChange={setLoad}
      />
      <p className="hint">
        The ready design of this type in another size: lengths by the radius, cylinders, rope, winch and masses by the
        load; without one, geometrically similar. Its rated loads are those of its chart. It replaces the crane on the
        bench; undo brings that back.
      </p>
      <button type="submit" className="wide primary" data-testid="create">
        Create
      </button>
    </form>
  );
}

function furthest(crane: Crane): number {
  return Math.max(bounds(crane).high[0], 1);
}
