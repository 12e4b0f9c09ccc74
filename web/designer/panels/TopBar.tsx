import { Menu } from "@mantine/core";
import type { Command } from "../commands";
import { SHOWS } from "../commands";
import { useBench, useCommands, useDesigner } from "../context";
import { SHIPPED } from "../shipped";
import { Keys } from "./Keys";

/** What is done with the design as a whole. */
export function TopBar() {
  const { view } = useBench();
  const name = useDesigner((state) => state.crane.name);
  const all = useCommands();
  const named = (id: string) => all.find((command) => command.id === id)!;
  const item = (id: string) => <Item command={named(id)} />;
  return (
    <header className="top-bar">
      <div className="title">
        <strong>seacrane designer</strong>
        <span>{name}</span>
      </div>
      <Menu position="bottom-start" transitionProps={{ duration: 60 }} withinPortal withInitialFocusPlaceholder={false}>
        <Menu.Target>
          <button type="button" data-testid="design-menu">
            Design
          </button>
        </Menu.Target>
        <Menu.Dropdown>
          {item("new")}
          <Menu.Label>Ready designs</Menu.Label>
          {SHIPPED.map(({ name }) => (
            <Item key={name} command={named(`open-${name}`)} label={name} />
          ))}
          <Menu.Divider />
          {item("open-file")}
          {item("link")}
          {item("duplicate")}
          {item("versions")}
          {item("compare")}
        </Menu.Dropdown>
      </Menu>
      <Menu position="bottom-start" transitionProps={{ duration: 60 }} withinPortal withInitialFocusPlaceholder={false}>
        <Menu.Target>
          <button type="button" data-testid="save-menu">
            Save
          </button>
        </Menu.Target>
        <Menu.Dropdown>
          {item("save-json")}
          {item("export-zip")}
          {item("export-stl")}
          <Menu.Divider />
          {item("check")}
        </Menu.Dropdown>
      </Menu>
      <Order command={named("copy-link")} />
      <div className="group">
        <Order command={named("undo")} />
        <Order command={named("redo")} />
      </div>
      <span className="spring" />
      <Menu position="bottom-end" transitionProps={{ duration: 60 }} withinPortal withInitialFocusPlaceholder={false}>
        <Menu.Target>
          <button type="button" data-testid="panels-menu">
            Panels
          </button>
        </Menu.Target>
        <Menu.Dropdown>
          {item("panel-design")}
          {item("panel-results")}
          {item("panel-swap")}
          <Menu.Divider />
          {item("panel-reset")}
        </Menu.Dropdown>
      </Menu>
      <nav className="group" aria-label="What is shown">
        {SHOWS.map(([value]) => (
          <Order key={value} command={named(`show-${value}`)} />
        ))}
      </nav>
      <button
        type="button"
        data-testid="all-commands"
        title="All commands (Ctrl K)"
        onClick={() => view.open("palette")}
      >
        Commands
      </button>
      <button
        type="button"
        aria-label="Keys and handles"
        title="Keys and handles (?)"
        onClick={() => view.open("help")}
      >
        ?
      </button>
    </header>
  );
}

/** A command in a menu. */
function Item({ command, label = command.label }: { command: Command; label?: string }) {
  const { id, detail, keys, cannot, on, run } = command;
  return (
    <Menu.Item
      data-testid={id}
      disabled={Boolean(cannot)}
      role={on === undefined ? "menuitem" : "menuitemcheckbox"}
      aria-checked={on}
      leftSection={on === undefined ? undefined : <i className="tick">{on ? "\u2713" : ""}</i>}
      rightSection={keys ? <Keys keys={keys[0]} /> : detail && <small>{detail}</small>}
      onClick={run}
    >
      {label}
    </Menu.Item>
  );
}

/** A command as a button. */
function Order({ command: { id, label, detail, keys, cannot, on, run } }: { command: Command }) {
  const what = cannot ? `${label}: ${cannot}` : [label, detail].filter(Boolean).join(" ");
  return (
    <button
      type="button"
      disabled={Boolean(cannot)}
      aria-pressed={on}
      title={keys ? `${what} (${keys[0]})` : what}
      data-testid={id}
      onClick={run}
    >
      {label}
    </button>
  );
}
