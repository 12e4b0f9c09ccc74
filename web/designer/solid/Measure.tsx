// Distances between two points: pins chosen by name, or places on the steel; they go with their links.
import { Html, Line } from "@react-three/drei";
import type { ThreeEvent } from "@react-three/fiber";
import type { Crane } from "../../core/design/types";
import { FOOT } from "../../core/design/types";
import { fixed } from "../../core/units";
import { type Mark, marks, type Place, placed } from "./places";

/** Below the tools and messages of the page. */
const LAYERS = [1, 0];

interface Props {
  crane: Crane;
  at: ReadonlyMap<string, Place>;
  points: readonly Mark[];
  /** Of a dot [m]. */
  radius: number;
  onPick: (mark: Mark) => void;
}

export function Measure({ crane, at, points, radius, onPick }: Props) {
  const ends = points.map((point) => placed(at, point));
  return (
    <>
      {marks(crane).map((mark) => (
        <Html key={mark.name} position={placed(at, mark)} center zIndexRange={LAYERS}>
          <button
            type="button"
            className="mark"
            aria-label={`Measure: ${mark.name}`}
            aria-pressed={points.some(({ name }) => name === mark.name)}
            title={mark.name}
            data-testid={`mark-${mark.name}`}
            onClick={() => onPick(mark)}
          />
        </Html>
      ))}
      {ends.map((end, i) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: the first and the second end
        <mesh key={i} position={end} renderOrder={3}>
          <sphereGeometry args={[radius, 12, 8]} />
          <meshBasicMaterial color="#d6336c" depthTest={false} transparent />
        </mesh>
      ))}
      {ends.length === 2 && <Line points={ends} color="#d6336c" lineWidth={2} depthTest={false} renderOrder={3} />}
    </>
  );
}

/** The place on the steel that was clicked. */
export function onSteel(event: ThreeEvent<MouseEvent>, at: ReadonlyMap<string, Place>): Mark {
  const link = event.object.parent?.name || FOOT;
  const { at: origin, turn } = at.get(link) ?? at.get(FOOT)!;
  const local = event.point.clone().sub(origin).applyQuaternion(turn.clone().invert());
  return { link, local: local.toArray(), name: link === FOOT ? "a point" : `a point of ${link}` };
}

/** What was measured, in numbers. */
export function Measured({ at, points }: Pick<Props, "at" | "points">) {
  const [from, to] = points;
  if (!from) return <output className="measured">Choose two pins, or click on the steel</output>;
  if (!to) return <output className="measured">From {from.name} to…</output>;
  const [a, b] = [placed(at, from), placed(at, to)];
  const [dx, dy, dz] = b.clone().sub(a).toArray();
  return (
    <output
      className="measured"
      data-testid="distance"
      data-from={a.toArray().join(" ")}
      data-to={b.toArray().join(" ")}
      data-value={a.distanceTo(b)}
    >
      {from.name} to {to.name}: <b>{fixed(a.distanceTo(b), 3)} m</b>
      <small>
        x {fixed(dx, 3)} m, y {fixed(dy, 3)} m, z {fixed(dz, 3)} m
      </small>
    </output>
  );
}
