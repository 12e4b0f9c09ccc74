import { Modal } from "@mantine/core";
import { type KeyboardEvent, useEffect, useId, useMemo, useRef, useState } from "react";
import { closeness } from "../../core/fuzzy";
import type { Command } from "../commands";
import { useBench, useCommands, useView } from "../context";
import { Keys } from "./Keys";

const PAGE = 8;
const LESS = 8;

/** All commands, found by a few letters of what they are called and given by Enter. */
export function Palette() {
  const { view } = useBench();
  const open = useView((state) => state.dialog === "palette");
  return (
    <Modal.Root opened={open} onClose={view.close} size="38rem" yOffset="9vh" transitionProps={{ duration: 0 }}>
      <Modal.Overlay />
      <Modal.Content aria-label="All commands" data-testid="palette">
        {open && <Search />}
      </Modal.Content>
    </Modal.Root>
  );
}

function Search() {
  const { view } = useBench();
  const every = useCommands();
  const all = useMemo(() => every.filter(({ id }) => id !== "palette"), [every]);
  const id = useId();
  const [typed, setTyped] = useState("");
  const [active, setActive] = useState(0);
  const found = useMemo(() => fitting(all, typed), [all, typed]);
  const option = (index: number) => `${id}-${index}`;
  // At once: what is typed right after Ctrl K is already for the field.
  const field = useRef<HTMLInputElement>(null);
  useEffect(() => field.current?.focus(), []);
  useEffect(() => {
    document.getElementById(`${id}-${active}`)?.scrollIntoView({ block: "nearest" });
  }, [id, active]);

  const give = (command: Command | undefined) => {
    if (!command || command.cannot) return;
    view.close();
    command.run();
  };
  const key = (event: KeyboardEvent) => {
    const last = found.length - 1;
    const to = {
      ArrowDown: active >= last ? 0 : active + 1,
      ArrowUp: active <= 0 ? last : active - 1,
      PageDown: Math.min(active + PAGE, last),
      PageUp: Math.max(active - PAGE, 0),
    }[event.key];
    if (to !== undefined) setActive(Math.max(to, 0));
    else if (event.key === "Enter") give(found[active]);
    else return;
    event.preventDefault();
  };
  return (
    <div className="palette">
      <input
        role="combobox"
        aria-label="Find a command"
        aria-expanded="true"
        aria-controls={`${id}-list`}
        aria-autocomplete="list"
        aria-activedescendant={found.length ? option(active) : undefined}
        placeholder={"What should be done?"}
        autoComplete="off"
        spellCheck={false}
        ref={field}
        data-autofocus
        value={typed}
        onChange={(event) => {
          setTyped(event.currentTarget.value);
          setActive(0);
        }}
        onKeyDown={key}
      />
      <div id={`${id}-list`} className="options" role="listbox" aria-label="Commands">
        {found.map((command, index) => (
          // biome-ignore lint/a11y/useKeyWithClickEvents: the keys are those of the field, which keeps the focus
          <div
            key={command.id}
            id={option(index)}
            role="option"
            tabIndex={-1}
            aria-selected={index === active}
            aria-disabled={Boolean(command.cannot)}
            data-testid={`command-${command.id}`}
            onPointerDown={(event) => event.preventDefault()}
            onPointerMove={() => setActive(index)}
            onClick={() => give(command)}
          >
            <i aria-hidden="true">{command.on ? "\u2713" : ""}</i>
            <span>
              {command.label}
              {command.on && <span className="unseen">, on</span>}
            </span>
            <small>{command.cannot ?? command.detail ?? ""}</small>
            {command.keys ? <Keys keys={command.keys[0]} /> : <small className="group-name">{command.group}</small>}
          </div>
        ))}
      </div>
      <p className="hint" role="status">
        {found.length ? `${found.length} of ${all.length} commands` : "No command has these letters in this order."}
      </p>
    </div>
  );
}

/** Those that fit what was typed, the best first; what cannot be done now comes after what fits nearly as well. */
export function fitting(all: readonly Command[], typed: string): readonly Command[] {
  if (!typed.trim()) return all;
  return all
    .flatMap((command) => {
      const how = closeness(`${command.label} ${command.detail ?? ""}`, typed);
      return how === null ? [] : [{ command, how: command.cannot ? how - LESS : how }];
    })
    .sort((a, b) => b.how - a.how)
    .map(({ command }) => command);
}
