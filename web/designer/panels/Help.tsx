import { Modal } from "@mantine/core";

const ROWS: readonly (readonly [string, string])[] = [
  ["Round grip on a link", "turns or slides its joint: the posture"],
  ["Square at the end of a link", "moves the next joint, or the tip: lengths"],
  ["Diamonds on an arc", "the limits of the joint"],
  ["Small rings", "pins of the cylinders, sheaves, drum"],
  ["Click in the load chart", "the best posture for that place"],
  ["Drag beside the crane, wheel, double click", "shift, zoom, show all"],
  ["Alt while dragging", "no snapping (else 0.1 m and 1\u00b0)"],
  ["Shift while dragging, or with the arrows", "fine: 0.01 m and 0.1\u00b0"],
  ["Esc while dragging", "as it was"],
  ["Tab, then the arrows", "from handle to handle; moves it"],
  ["Ctrl Z, Ctrl Shift Z", "undo, redo"],
  ["Ctrl S", "save the design file"],
  ["1, 2, 3", "workspace, both, mechanical"],
  ["N", "new crane"],
  ["O", "load chart or optimisation"],
  ["In a field", "8 ft, 420 mm, 18 + 0.5; arrows step; drag the label"],
  ["?", "this table"],
];

export function Help({ open, onClose }: { open: boolean; onClose: () => void }) {
  return (
    <Modal opened={open} onClose={onClose} title="Keys and handles" size="lg" transitionProps={{ duration: 80 }}>
      <table className="help" data-testid="help-dialog">
        <tbody>
          {ROWS.map(([what, does]) => (
            <tr key={what}>
              <th scope="row">{what}</th>
              <td>{does}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </Modal>
  );
}
