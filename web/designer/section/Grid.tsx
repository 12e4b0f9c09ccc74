import { fixed } from "../../core/units";
import { gridStep, toMetres, toPixels, type Window } from "./window";

/** Room for the name of the lower axis, at its right end [px]. */
const NAME = 86;

/** Axes in metres: radius below, height on the left, with the deck at the foot and the waterline. */
export function Grid({ window, waterline }: { window: Window; waterline: number }) {
  const { width, height, scale } = window;
  const step = gridStep(scale, 62);
  const decimals = Math.max(0, -Math.floor(Math.log10(step)));
  const [left, top] = toMetres(window, [0, 0]);
  const [right, bottom] = toMetres(window, [width, height]);
  const marks = (low: number, high: number) =>
    Array.from({ length: Math.max(0, Math.floor(high / step) - Math.ceil(low / step) + 1) }, (_, i) =>
      Number(((Math.ceil(low / step) + i) * step).toPrecision(10)),
    );
  const [, deck] = toPixels(window, [0, 0]);
  const [axis] = toPixels(window, [0, 0]);
  const [, water] = toPixels(window, [0, waterline]);
  return (
    <g className="grid">
      {marks(left, right).map((x) => {
        const [px] = toPixels(window, [x, 0]);
        return (
          <g key={x}>
            <line x1={px} x2={px} y1={0} y2={height} />
            {px < width - NAME && (
              <text x={px} y={height - 6} textAnchor="middle">
                {fixed(x, decimals)}
              </text>
            )}
          </g>
        );
      })}
      {marks(bottom, top).map((z) => {
        const [, py] = toPixels(window, [0, z]);
        return (
          <g key={z}>
            <line x1={0} x2={width} y1={py} y2={py} />
            {py < height - 26 && py > 32 && (
              <text x={6} y={py - 4}>
                {fixed(z, decimals)}
              </text>
            )}
          </g>
        );
      })}
      <line className="deck" x1={0} x2={width} y1={deck} y2={deck} />
      <line className="axis" x1={axis} x2={axis} y1={0} y2={height} />
      {water < height && water > 0 && (
        <>
          <line className="water" x1={0} x2={width} y1={water} y2={water} />
          <text className="water-label" x={width - NAME} y={water - 5} textAnchor="end">
            waterline
          </text>
        </>
      )}
      <text className="axis-name" x={width - 8} y={height - 6} textAnchor="end">
        radius [m]
      </text>
      <text className="axis-name" x={6} y={16}>
        height above the foot [m]
      </text>
    </g>
  );
}
