import { Menu } from "@mantine/core";
import { useRef } from "react";
import { DesignFileError, read } from "../../core/design/file";
import { joined, mesh, stl } from "../../core/design/mesh";
import { furnished } from "../../core/design/standard";
import type { Dialog, Show } from "../App";
import { useBench, useDesigner } from "../context";
import { download, saveJson } from "../saving";
import { checked, exported, imported } from "../server";
import { SHIPPED } from "../shipped";

interface Props {
  show: Show;
  onShow: (show: Show) => void;
  onDialog: (dialog: Dialog) => void;
}

const VIEWS: readonly (readonly [Show, string])[] = [
  ["section", "Workspace"],
  ["both", "Both"],
  ["solid", "Mechanical"],
];

/** What is done with the design as a whole. */
export function TopBar({ show, onShow, onDialog }: Props) {
  const { designer } = useBench();
  const crane = useDesigner((state) => state.crane);
  const undo = useDesigner((state) => state.past.at(-1)?.by);
  const redo = useDesigner((state) => state.future.at(-1)?.by);
  const file = useRef<HTMLInputElement>(null);

  const attempt = async (what: () => Promise<string> | string) => {
    try {
      designer.tell(await what());
    } catch (error) {
      designer.tell((error as Error).message, "wrong");
    }
  };
  const open = (chosen: File) =>
    attempt(async () => {
      try {
        designer.open(/\.zip$/i.test(chosen.name) ? await imported(chosen) : read(await chosen.text()));
      } catch (error) {
        if (!(error instanceof DesignFileError)) throw error;
        throw new Error(`${chosen.name} is not opened. ${error.message}`);
      }
      return `Opened ${chosen.name}.`;
    });
  const meshes = () =>
    attempt(() => {
      for (const link of furnished(crane).links)
        download(`${crane.name}-${link.name}.stl`, stl(joined((link.parts ?? []).map(mesh))) as BlobPart, "model/stl");
      return "One STL file for each link, in metres, z up.";
    });
  const archive = () =>
    attempt(async () => {
      download(`${crane.name}.zip`, await exported(crane), "application/zip");
      return `Exported ${crane.name}.zip.`;
    });
  const check = () =>
    attempt(async () => {
      const problems = await checked(crane);
      if (problems.length) throw new Error(problems.map(({ path, message }) => `${path}: ${message}`).join("\n"));
      return `${crane.name} is sound: the package finds nothing wrong.`;
    });

  return (
    <header className="top-bar">
      <div className="title">
        <strong>seacrane designer</strong>
        <span>{crane.name}</span>
      </div>
      <Menu position="bottom-start" transitionProps={{ duration: 60 }} withinPortal>
        <Menu.Target>
          <button type="button" data-testid="design-menu">
            Design
          </button>
        </Menu.Target>
        <Menu.Dropdown>
          <Menu.Item onClick={() => onDialog("new")} data-testid="new">
            New from a type{"\u2026"}
          </Menu.Item>
          <Menu.Label>Ready designs</Menu.Label>
          {SHIPPED.map(({ name, type, load }) => (
            <Menu.Item
              key={name}
              rightSection={<small>{type}</small>}
              data-testid={`open-${name}`}
              onClick={() =>
                attempt(async () => {
                  designer.open(await load());
                  return `Opened ${name}.`;
                })
              }
            >
              {name}
            </Menu.Item>
          ))}
          <Menu.Divider />
          <Menu.Item onClick={() => file.current?.click()}>Open a file (JSON or ZIP){"\u2026"}</Menu.Item>
          <Menu.Item
            onClick={() =>
              designer.apply("duplicate", { ...crane, name: `${crane.name} copy` }, designer.store.getState().posture)
            }
          >
            Duplicate
          </Menu.Item>
          <Menu.Item onClick={() => onDialog("versions")} data-testid="versions">
            Versions{"\u2026"}
          </Menu.Item>
          <Menu.Item onClick={() => onDialog("compare")} data-testid="compare">
            Compare{"\u2026"}
          </Menu.Item>
        </Menu.Dropdown>
      </Menu>
      <Menu position="bottom-start" transitionProps={{ duration: 60 }} withinPortal>
        <Menu.Target>
          <button type="button" data-testid="save-menu">
            Save
          </button>
        </Menu.Target>
        <Menu.Dropdown>
          <Menu.Item onClick={() => saveJson(crane)} rightSection={<small>Ctrl S</small>} data-testid="save-json">
            Design file (JSON)
          </Menu.Item>
          <Menu.Item onClick={archive} data-testid="export-zip">
            Everything (ZIP)
          </Menu.Item>
          <Menu.Item onClick={meshes}>Meshes (STL)</Menu.Item>
          <Menu.Divider />
          <Menu.Item onClick={check}>Check with the package</Menu.Item>
        </Menu.Dropdown>
      </Menu>
      <input
        ref={file}
        type="file"
        accept=".json,.zip"
        hidden
        data-testid="file"
        onChange={(event) => {
          const chosen = event.currentTarget.files?.[0];
          event.currentTarget.value = "";
          if (chosen) void open(chosen);
        }}
      />
      <div className="group">
        <button
          type="button"
          disabled={!undo}
          title={undo ? `Undo ${undo} (Ctrl Z)` : "Nothing to undo"}
          data-testid="undo"
          onClick={() => designer.undo()}
        >
          Undo
        </button>
        <button
          type="button"
          disabled={!redo}
          title={redo ? `Redo ${redo} (Ctrl Shift Z)` : "Nothing to redo"}
          data-testid="redo"
          onClick={() => designer.redo()}
        >
          Redo
        </button>
      </div>
      <span className="spring" />
      <nav className="group" aria-label="What is shown">
        {VIEWS.map(([value, label], i) => (
          <button
            key={value}
            type="button"
            aria-pressed={show === value}
            title={`${label} (${i + 1})`}
            data-testid={`show-${value}`}
            onClick={() => onShow(value)}
          >
            {label}
          </button>
        ))}
      </nav>
      <button type="button" aria-label="Keys and handles" title="Keys and handles (?)" onClick={() => onDialog("help")}>
        ?
      </button>
    </header>
  );
}
