import { useMemo } from "react";
import { endOf } from "../../core/design/length";
import { frames, outOf, type Point, type Pose, type Posture, pin, retracted } from "../../core/design/plane";
import { furnished } from "../../core/design/standard";
import type { Crane } from "../../core/design/types";
import { useDesigner } from "../context";
import { outline } from "./outline";
import { pedestal } from "./pedestal";
import { toPixels, type Window } from "./window";

const HANG = 4;

/** The crane being designed, in its posture from the side, and the travel of its joints. */
export function Drawing({ window, arc }: { window: Window; arc: (link: number) => number }) {
  const crane = useDesigner((state) => state.crane);
  const posture = useDesigner((state) => state.posture);
  const selection = useDesigner((state) => state.selection);
  const problems = useDesigner((state) => state.problems);
  const marks: Marks = {
    selected: (kind, index) => selection.kind === kind && selection.index === index,
    wrong: (place) => problems.some(({ path }) => path.startsWith(place)),
  };
  return (
    <g className="crane">
      <Figure crane={crane} posture={posture} window={window} marks={marks} />
      {crane.links.map((link, index) =>
        link.joint.limits && link.joint.name !== crane.slew?.joint ? (
          <Travel key={link.name} crane={crane} posture={posture} index={index} window={window} radius={arc(index)} />
        ) : null,
      )}
    </g>
  );
}

/** What of a crane is to stand out. */
interface Marks {
  readonly selected: (kind: "link" | "cylinder", index: number) => boolean;
  readonly wrong: (place: string) => boolean;
}

const UNMARKED: Marks = { selected: () => false, wrong: () => false };

interface FigureProps {
  readonly crane: Crane;
  readonly posture: Posture;
  readonly window: Window;
  readonly marks?: Marks;
}

/** A crane in a posture from the side: links from their parts, cylinders and rope. */
export function Figure({ crane, posture, window, marks = UNMARKED }: FigureProps) {
  const links = useMemo(() => outlines(crane), [crane]);
  const at = useMemo(() => frames(crane, posture), [crane, posture]);
  const px = (point: Point) => toPixels(window, point).join(",");
  const tip = pin(at, crane.hoist.sheaves[crane.hoist.sheaves.length - 1]);
  const rope = [crane.hoist.drum, ...crane.hoist.sheaves].map((attachment) => pin(at, attachment));
  const hook: Point = [tip[0], tip[1] - HANG];
  return (
    <g className="crane">
      {crane.slew && <polygon className="pedestal" points={standing(crane).map(px).join(" ")} />}
      {links.map(({ name, shapes }, index) => (
        <g
          key={name}
          className="link"
          data-selected={marks.selected("link", index)}
          data-wrong={marks.wrong(`links[${name}]`)}
        >
          {shapes.map((shape, i) => {
            const pose = at.get(name)!;
            const key = `${name} ${i}`;
            if (!shape.circle)
              return <polygon key={key} points={shape.points.map(([x, z]) => px(outOf(pose, x, z))).join(" ")} />;
            const [cx, cy] = toPixels(window, outOf(pose, shape.circle[0], shape.circle[1]));
            return <circle key={key} cx={cx} cy={cy} r={shape.circle[2] * window.scale} />;
          })}
        </g>
      ))}
      {crane.cylinders.map((cylinder, index) => {
        const [base, eye] = [pin(at, cylinder.base), pin(at, cylinder.eye)];
        const length = Math.hypot(eye[0] - base[0], eye[1] - base[1]);
        const share = Math.min(0.96, (0.95 * retracted(crane, cylinder)) / Math.max(length, 1e-9));
        const end: Point = [base[0] + (eye[0] - base[0]) * share, base[1] + (eye[1] - base[1]) * share];
        return (
          <g
            key={cylinder.name}
            className="cylinder"
            data-wrong={marks.wrong(`cylinders[${cylinder.name}]`)}
            data-selected={marks.selected("cylinder", index)}
          >
            <polyline
              className="rod"
              points={`${px(base)} ${px(eye)}`}
              strokeWidth={Math.max(2, cylinder.rod * window.scale)}
            />
            {Number.isFinite(end[0]) && (
              <polyline
                className="barrel"
                points={`${px(base)} ${px(end)}`}
                strokeWidth={Math.max(4, 1.15 * cylinder.bore * window.scale)}
              />
            )}
          </g>
        );
      })}
      <polyline className="rope" points={[...rope, hook].map(px).join(" ")} />
      <circle className="hook" cx={toPixels(window, hook)[0]} cy={toPixels(window, hook)[1]} r={4} />
    </g>
  );
}

interface TravelProps {
  crane: Crane;
  posture: Posture;
  index: number;
  window: Window;
  radius: number;
}

/** The travel of a joint: an arc about it, or a line along it. */
function Travel({ crane, posture, index, window, radius }: TravelProps) {
  const { joint, name } = crane.links[index];
  const [low, high] = joint.limits!;
  const pose = (q: number): Pose => frames(crane, { ...posture, [joint.name]: q }).get(name)!;
  if (joint.kind === "prismatic") {
    const [x, z] = endOf(crane, index);
    const points = [low, high].map((q) => toPixels(window, outOf(pose(q), x, z)).join(",")).join(" ");
    return <polyline className="travel" points={points} />;
  }
  const count = 40;
  const points = Array.from({ length: count + 1 }, (_, i) =>
    toPixels(window, outOf(pose(low + ((high - low) * i) / count), radius, 0)).join(","),
  );
  const now = pose(posture[joint.name] ?? 0);
  const centre = toPixels(window, [now.x, now.z]).join(",");
  return (
    <g className="travel" data-wrong={low >= high}>
      <polygon points={[centre, ...points].join(" ")} />
      <polyline points={points.join(" ")} />
      <polyline className="now" points={`${centre} ${toPixels(window, outOf(now, radius, 0)).join(",")}`} />
    </g>
  );
}

function outlines(crane: Crane) {
  try {
    return furnished(crane).links.map(({ name, parts }) => ({ name, shapes: (parts ?? []).flatMap(outline) }));
  } catch {
    // Lengths that no part can be made from: the bare chain shows them.
    return crane.links.map(({ name }, i) => ({
      name,
      shapes: [{ points: [[0, 0], endOf(crane, i)] as Point[], circle: undefined }],
    }));
  }
}

function standing(crane: Crane): Point[] {
  const { top, bottom, depth } = pedestal(crane);
  return [
    [-top, 0],
    [top, 0],
    [bottom, -depth],
    [-bottom, -depth],
  ];
}
