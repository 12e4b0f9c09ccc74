import { Modal } from "@mantine/core";

const ROWS: readonly (readonly [string, string, string])[] = [
  ["Slew left / right", "A / D", "Left stick, left / right"],
  ["Jib out / in", "W / S", "Left stick, forward / back"],
  ["Boom up / down", "\u2190 / \u2192 or J / L", "Right stick, left / right"],
  ["Hoist / lower", "\u2193 / \u2191 or K / I (pull back hoists)", "Right stick, back / forward"],
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
          {ROWS.map(([what, keys, pad]) => (
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
