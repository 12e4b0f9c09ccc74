import { Modal } from "@mantine/core";
import { useBench, useCommands, useView } from "../context";
import { Keys } from "./Keys";

const HANDLES: readonly (readonly [string, string])[] = [
  ["Round grip on a link", "turns or slides its joint: the posture"],
  ["Square at the end of a link", "moves the next joint, or the tip: lengths"],
  ["Diamonds on an arc", "the limits of the joint"],
  ["Small rings", "pins of the cylinders, sheaves, drum"],
  ["Click in the load chart", "the best posture for that place"],
  ["Drag beside the crane, wheel, double click", "shift, zoom, show all"],
  ["Alt while dragging", "no snapping (else 0.1 m and 1\u00b0)"],
  ["Shift while dragging, or with the arrows", "fine: 0.01 m and 0.1\u00b0"],
  ["Esc while dragging", "as it was"],
  ["H, Tab, then the arrows", "to the handles, from one to the next; moves it"],
  ["In a field", "8 ft, 420 mm, 2*(3.5 m + 300 mm); arrows step; drag the label or the number"],
  ["Tab to the edge of a panel, then the arrows", "its width; Enter folds it away; double click: the usual width"],
];

/** The keys of the commands, and what can be done with the pointer. */
export function Help() {
  const { view } = useBench();
  const open = useView((state) => state.dialog === "help");
  return (
    <Modal opened={open} onClose={view.close} title="Keys and handles" size="xl" transitionProps={{ duration: 80 }}>
      {open && <Tables />}
    </Modal>
  );
}

function Tables() {
  const { view } = useBench();
  const keyed = useCommands().filter(({ keys }) => keys);
  return (
    <div className="dialog" data-testid="help-dialog">
      <div className="two-tables">
        <table className="help">
          <caption>Keys</caption>
          <tbody>
            {keyed.map(({ id, label, keys }) => (
              <tr key={id}>
                <th scope="row">{label}</th>
                <td>
                  <Keys keys={keys![0]} />
                </td>
              </tr>
            ))}
          </tbody>
        </table>
        <table className="help">
          <caption>Handles and fields</caption>
          <tbody>
            {HANDLES.map(([what, does]) => (
              <tr key={what}>
                <th scope="row">{what}</th>
                <td>{does}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      <button type="button" data-testid="open-palette" onClick={() => view.open("palette")}>
        All commands{"\u2026"} <Keys keys="Ctrl+K" />
      </button>
    </div>
  );
}
