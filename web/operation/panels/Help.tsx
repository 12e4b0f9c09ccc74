import { Modal } from "@mantine/core";
import { craneAxes } from "../../core/axes";
import { BESIDE, LEFT_ACROSS, LEFT_ALONG, type Place, places, RIGHT_ACROSS, RIGHT_ALONG } from "../../core/driving";
import type { ModelDescription } from "../../rpc/messages";
import { keyName } from "./keys";
import { usePage } from "./usePage";

const PADS = new Map<Place, string>([
  [LEFT_ACROSS, "Left stick, left / right"],
  [LEFT_ALONG, "Left stick, forward / back"],
  [RIGHT_ACROSS, "Right stick, left / right"],
  [RIGHT_ALONG, "Right stick, back / forward"],
  [BESIDE[0], "Cross, up / down"],
  [BESIDE[1], "Cross, right / left"],
]);

/** What moves each axis of the crane. */
function driven(model: ModelDescription): [string, string, string][] {
  const where = places(model.axes);
  return craneAxes(model).flatMap(({ name, senses }) => {
    const place = where.get(name);
    if (!place) return [];
    const said = `${senses[0]} / ${senses[1]}`;
    const keys = place.plus.map((plus, i) => `${keyName(plus)} / ${keyName(place.minus[i])}`).join(" or ");
    return [[said[0].toUpperCase() + said.slice(1), keys, PADS.get(place) ?? ""]];
  });
}

const ROWS: readonly (readonly [string, string, string])[] = [
  ["Dead man's switch", "the key itself: let go and the crane stops", "hold A or RB"],
  ["Slowly", "with Shift", "a small deflection"],
  ["Stop everything", "Space", "let go of the button"],
  ["Release the controls", "Esc", ""],
  ["Pause or resume", "P", ""],
  ["Overview, side, deck, cab, hook", "1 to 5", ""],
  ["Plots", "V", ""],
  ["These keys", "?", ""],
];

export function Help({ open, onClose }: { open: boolean; onClose: () => void }) {
  const model = usePage((page) => page.model);
  const rows = [...(model ? driven(model) : []), ...ROWS];
  return (
    <Modal
      opened={open}
      onClose={onClose}
      title="Keys and gamepad"
      size="xl"
      transitionProps={{ duration: 80 }}
      data-testid="help-dialog"
    >
      <table className="help">
        <thead>
          <tr>
            <th>To</th>
            <th>Keyboard</th>
            <th>Gamepad</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(([what, keys, pad]) => (
            <tr key={what}>
              <td>{what}</td>
              <td>{keys}</td>
              <td>{pad}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <p>
        The crane moves only while a key or the gamepad's button is held. It stops when this page loses the focus, is
        hidden, or loses its link. Drag to turn the view, scroll to come closer, drag with the right button to shift it.
      </p>
    </Modal>
  );
}
