/** Keys as caps: `Ctrl+Shift+Z`. */
export function Keys({ keys }: { keys: string }) {
  const caps = keys.length > 1 ? keys.split("+") : [keys];
  return (
    <span className="keys">
      {caps.map((cap) => (
        <kbd key={cap}>{cap === "-" ? "\u2212" : cap}</kbd>
      ))}
    </span>
  );
}
