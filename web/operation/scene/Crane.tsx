import { useFrame } from "@react-three/fiber";
import { type ReactNode, useMemo, useRef } from "react";
import { type Group, Matrix4, Vector3 } from "three";
import { attachmentPoint, isKnuckleBoom, linkEnd, retractedLength } from "../../core/crane";
import { furnished } from "../../core/design/standard";
import type { Crane as Design, Part } from "../../core/design/types";
import type { Frame } from "../../core/frames";
import { boomStations, girder, jibStations, lug, type Point2, type Station, sectionAt } from "../../core/solids";
import { shapeOf } from "../../designer/solid/shapes";
import type { Attachment, CraneDesign, Cylinder, Link } from "../../rpc/messages";
import { useDirector } from "./director";
import { Merged } from "./Merged";
import * as m from "./materials";
import { Bar, Box, Lettering, Pin, Plate, Rail, Solid, type V3 } from "./parts";
import { TIP_SHEAVE } from "./reeving";

/** The crane of the design, each link in its frame; in the frame of the crane's foot. */
export function Crane() {
  const { model } = useDirector();
  const { crane } = model;
  return (
    <>
      {isKnuckleBoom(crane) ? (
        crane.links.map((link, i) => (
          <OnLink key={link.name} name={link.name}>
            <Merged>
              <LinkShape crane={crane} link={link} index={i} />
            </Merged>
          </OnLink>
        ))
      ) : (
        <OfParts crane={crane} />
      )}
      {crane.cylinders.map((cylinder) => (
        <CylinderSet key={cylinder.name} crane={crane} cylinder={cylinder} />
      ))}
    </>
  );
}

export function toMatrix({ R, p }: Frame, out: Matrix4): Matrix4 {
  return out.set(R[0], R[1], R[2], p[0], R[3], R[4], R[5], p[1], R[6], R[7], R[8], p[2], 0, 0, 0, 1);
}

export function OnLink({ name, children }: { name: string; children: ReactNode }) {
  const director = useDirector();
  const group = useRef<Group>(null);
  useFrame(() => {
    const frame = director.frames.get(name);
    if (!frame || !group.current) return;
    toMatrix(frame, group.current.matrix);
    group.current.matrixWorldNeedsUpdate = true;
  });
  return (
    <group ref={group} matrixAutoUpdate={false}>
      {children}
    </group>
  );
}

/** The links from the parts of their design, of a crane that has no picture of its own. */
function OfParts({ crane }: { crane: CraneDesign }) {
  const { links } = useMemo(() => furnished(crane as Design), [crane]); // the server describes the whole design
  return links.map((link) => (
    <OnLink key={link.name} name={link.name}>
      <Merged>
        {(link.parts ?? []).map((part) => (
          <mesh key={part.name} geometry={shapeOf(part)} material={painted(part)} />
        ))}
      </Merged>
    </OnLink>
  ));
}

function painted(part: Part) {
  if (part.kind === "sheave" || part.kind === "drum") return m.DARK_STEEL;
  return part.kind === "box" && part.name === "cabin" ? m.GLASS : m.YELLOW;
}

function LinkShape({ crane, link, index }: { crane: CraneDesign; link: Link; index: number }) {
  const last = index === crane.links.length - 1;
  const end = linkEnd(crane, index);
  if (Math.abs(link.joint.axis[2]) > 0.9) return <Column crane={crane} link={link} pivot={[end[0], end[2]]} />;
  return last ? <Jib crane={crane} link={link} length={end[0]} /> : <Boom crane={crane} link={link} length={end[0]} />;
}

/** Pins of cylinders on a link. */
function pinsOn(crane: CraneDesign, link: Link): Point2[] {
  const points: Attachment[] = crane.cylinders.flatMap(({ base, eye }) => [base, eye]);
  return points.filter((p) => p.link === link.name).map(({ x, z }): Point2 => [x, z]);
}

/** How far apart the two of a pair stand from the plane of the crane. */
function offsets(cylinder: Cylinder): number[] {
  const pitch = Math.max(0.7, 1.9 * cylinder.bore);
  return Array.from({ length: cylinder.count }, (_, i) => (i - (cylinder.count - 1) / 2) * pitch);
}

// ---------------------------------------------------------------- column
function Column({ crane, link, pivot }: { crane: CraneDesign; link: Link; pivot: Point2 }) {
  const [px, pz] = pivot;
  const pins = pinsOn(crane, link);
  const front = Math.max(1.6, ...pins.map(([x]) => x));
  const { drum, drum_radius: drumRadius } = crane.hoist;
  const drumAt: Point2 = [drum.x, drum.z - drumRadius];
  const cheek = useMemo((): Point2[] => {
    const round: Point2[] = [];
    for (let i = 0; i <= 14; i += 1) {
      const angle = -0.35 + (Math.PI * 0.98 * i) / 14;
      round.push([px + 0.85 * Math.cos(angle), pz + 0.85 * Math.sin(angle)]);
    }
    return [
      [front + 0.45, 0.35],
      [front + 0.45, 0.75],
      [front - 0.35, 1.25],
      ...round,
      [drumAt[0] + 0.2, drumAt[1] + 0.55],
      [drumAt[0] - 0.6, drumAt[1] + 0.35],
      [drumAt[0] - 1.1, 1.1],
      [drumAt[0] - 1.5, 0.35],
    ];
  }, [px, pz, front, drumAt[0], drumAt[1]]);
  const back = drumAt[0] - 1.9;
  return (
    <group>
      <Bar from={[0, 0, 0]} to={[0, 0, 0.4]} radius={2.1} material={m.YELLOW} sides={40} />
      <Box size={[front + 0.6 - back, 3.9, 0.22]} at={[(front + 0.6 + back) / 2, 0, 0.46]} material={m.YELLOW} />
      {[-1, 1].map((side) => (
        <Plate key={side} outline={cheek} y={side * 1.06} thickness={0.24} material={m.YELLOW} />
      ))}
      <Box size={[0.24, 1.9, 2.2]} at={[px - 0.95, 0, 1.65]} material={m.YELLOW_DARK} />
      <Box size={[0.9, 1.9, 0.2]} at={[px - 0.5, 0, 2.75]} material={m.YELLOW_DARK} />
      <Pin at={pivot} radius={0.34} width={2.7} material={m.STEEL} />
      {pins.map((pin) => (
        <Pin key={`${pin}`} at={pin} radius={0.2} width={2.3} material={m.STEEL} />
      ))}
      <Bar
        from={[drumAt[0], -1.6, drumAt[1]]}
        to={[drumAt[0], -1.18, drumAt[1]]}
        radius={0.62}
        material={m.DARK_STEEL}
        sides={24}
      />
      <Bar
        from={[drumAt[0], -2.1, drumAt[1]]}
        to={[drumAt[0], -1.6, drumAt[1]]}
        radius={0.34}
        material={m.CARGO}
        sides={20}
      />
      {/* Power unit to the right of the drum, the cab to the left of the boom. */}
      <Box size={[2.6, 0.85, 1.9]} at={[back + 1.5, -1.5, 1.55]} material={m.YELLOW_DARK} />
      <Box size={[1.9, 0.05, 1]} at={[back + 1.5, -1.95, 1.6]} material={m.BLACK} />
      <Cab />
      <Rail
        path={[
          [front - 0.2, -1.9, 0.57],
          [back + 0.05, -1.9, 0.57],
          [back + 0.05, 1.9, 0.57],
          [-0.2, 1.9, 0.57],
        ]}
        spacing={1.3}
        material={m.YELLOW}
      />
    </group>
  );
}

/** Where the operator's eyes are, on the column. */
export const EYE: V3 = [2.7, 2.1, 3.1];

function Cab() {
  const [x, y, z] = [1.2, 2.1, 1.45];
  const side: Point2[] = [
    [-1, 0],
    [0.85, 0],
    [1.25, 0.7],
    [0.95, 2.35],
    [-1, 2.35],
  ];
  const window: Point2[] = [
    [-0.35, 0.85],
    [1.1, 0.85],
    [0.88, 2.1],
    [-0.35, 2.1],
  ];
  return (
    <group position={[x, y, z]}>
      <Plate outline={side} y={0} thickness={1.5} material={m.WHITE} />
      {[-1, 1].map((s) => (
        <Plate key={s} outline={window} y={s * 0.75} thickness={0.03} material={m.GLASS} />
      ))}
      <Box size={[0.05, 1.3, 1.5]} at={[1.11, 0, 1.5]} turn={[0, -0.18, 0]} material={m.GLASS} />
      <Box size={[0.05, 1.3, 0.72]} at={[1.07, 0, 0.37]} turn={[0, 0.52, 0]} material={m.GLASS} />
      <Box size={[2.2, 1.7, 0.12]} at={[0, 0, 2.42]} material={m.YELLOW} />
      <Box size={[2, 1.3, 0.16]} at={[-0.1, -0.4, -0.1]} material={m.YELLOW} />
      <Box size={[0.3, 0.9, 0.9]} at={[-0.9, -0.4, -0.5]} material={m.YELLOW} />
      <Box size={[0.18, 0.18, 0.25]} at={[-0.6, 0, 2.6]} material={m.ORANGE} />
    </group>
  );
}

// ---------------------------------------------------------------- boom and jib
function Lugs(props: { pins: readonly Point2[]; crane: CraneDesign; stations: readonly Station[] }) {
  const { pins, crane, stations } = props;
  return pins.map((pin) => {
    const cylinder = crane.cylinders.find(
      ({ base, eye }) => (base.x === pin[0] && base.z === pin[1]) || (eye.x === pin[0] && eye.z === pin[1]),
    );
    const section = sectionAt(stations, pin[0]);
    const root = pin[1] < 0 ? section.bottom + 0.25 : section.top - 0.25;
    const outline = lug(pin, root, 0.36, 0.75);
    const at = cylinder ? offsets(cylinder) : [0];
    const width = at.length > 1 ? at[at.length - 1] - at[0] + 1 : 1;
    return (
      <group key={`${pin}`}>
        {at.flatMap((y) =>
          [-1, 1].map((side) => (
            <Plate key={`${y}:${side}`} outline={outline} y={y + side * 0.28} thickness={0.09} material={m.YELLOW} />
          )),
        )}
        <Pin at={pin} radius={0.17} width={width} material={m.STEEL} />
      </group>
    );
  });
}

function Boom({ crane, link, length }: { crane: CraneDesign; link: Link; length: number }) {
  const pins = pinsOn(crane, link);
  const stations = useMemo(() => boomStations(length, pins[0]?.[0] ?? length / 3), [length, pins]);
  const s = length / 18;
  const sheaves = crane.hoist.sheaves.filter((sheave) => sheave.link === link.name);
  const knuckle: Point2[] = useMemo(() => {
    const sheave = sheaves[0];
    const round: Point2[] = [];
    for (let i = 0; i <= 12; i += 1) {
      const angle = -Math.PI * 0.62 + (Math.PI * 0.95 * i) / 12;
      round.push([length + 0.72 * s * Math.cos(angle), 0.72 * s * Math.sin(angle)]);
    }
    const head: Point2[] = sheave
      ? [
          [sheave.x + 0.3, sheave.z + 0.12],
          [sheave.x + 0.12, sheave.z + 0.3],
          [sheave.x - 0.22, sheave.z + 0.28],
        ]
      : [];
    return [[length - 2.6 * s, -0.5 * s], ...round, ...head, [length - 2.2 * s, 0.72 * s]];
  }, [length, s, sheaves]);
  const swl = crane.capacity?.[0];
  const walkZ = sectionAt(stations, length * 0.3).top;
  return (
    <group>
      <Solid of={() => girder(stations, 0.09)} material={m.YELLOW} />
      {[-1, 1].map((side) => (
        <Plate key={side} outline={knuckle} y={side * 0.62 * s} thickness={0.14} material={m.YELLOW} />
      ))}
      <Pin at={[length, 0]} radius={0.26} width={1.66 * s} material={m.STEEL} />
      {sheaves.map(({ x, z }) => (
        <Pin key={`${x}:${z}`} at={[x, z]} radius={0.13} width={1.5 * s} material={m.STEEL} />
      ))}
      <Lugs pins={pins} crane={crane} stations={stations} />
      {/* Hose lines along the left side, a walkway along the right. */}
      {[0, 0.14, 0.28].map((dz) => (
        <Bar
          key={dz}
          from={[0.8, 0.82 * s, dz - 0.45]}
          to={[length * 0.9, 0.68 * s, dz - 0.45]}
          radius={0.045}
          material={m.BLACK}
          sides={8}
        />
      ))}
      {[0.16, 0.32, 0.48, 0.64, 0.8].map((u) => (
        <Box key={u} size={[0.12, 0.2, 0.6]} at={[u * length, 0.76 * s, -0.3]} material={m.YELLOW_DARK} />
      ))}
      <Box
        size={[length * 0.62, 0.62, 0.06]}
        at={[length * 0.52, -(0.74 * s + 0.28), walkZ - 0.9]}
        material={m.DARK_STEEL}
      />
      <Rail
        path={[
          [length * 0.21, -(0.74 * s + 0.56), walkZ - 0.88],
          [length * 0.83, -(0.74 * s + 0.56), walkZ - 0.88],
        ]}
        spacing={1.8}
        material={m.YELLOW}
      />
      {([1, -1] as const).map((side) => (
        <group key={side}>
          <Lettering
            text={crane.name.toUpperCase()}
            at={[length * 0.6, side * (0.712 * s + 0.015), 0.4 * s]}
            height={0.8 * s}
            side={side}
          />
          {swl && (
            <Lettering
              text={`SWL ${swl.mass / 1000} t \u2013 ${swl.radius} m`}
              at={[length * 0.26, side * (0.772 * s + 0.015), 0.42 * s]}
              height={0.5 * s}
              side={side}
            />
          )}
        </group>
      ))}
    </group>
  );
}

function Jib({ crane, link, length }: { crane: CraneDesign; link: Link; length: number }) {
  const pins = pinsOn(crane, link);
  const stations = useMemo(() => jibStations(length, pins[0]?.[0] ?? length / 7), [length, pins]);
  const s = length / 14;
  const [tipX, tipZ] = [length + TIP_SHEAVE[0], TIP_SHEAVE[1]];
  const head: Point2[] = useMemo(() => {
    const round: Point2[] = [];
    for (let i = 0; i <= 12; i += 1) {
      const angle = -Math.PI / 2 + (Math.PI * i) / 12;
      round.push([tipX + 0.3 * Math.cos(angle), tipZ + 0.3 * Math.sin(angle)]);
    }
    return [[0.86 * length, -0.28 * s], ...round, [0.86 * length, 0.3 * s]];
  }, [length, s, tipX, tipZ]);
  return (
    <group>
      <Solid of={() => girder(stations, 0.07)} material={m.YELLOW} />
      {[-1, 1].map((side) => (
        <Plate key={side} outline={head} y={side * 0.33 * s} thickness={0.1} material={m.YELLOW} />
      ))}
      <Pin at={[tipX, tipZ]} radius={0.12} width={0.9 * s} material={m.STEEL} />
      <Lugs pins={pins} crane={crane} stations={stations} />
      {/* Red head, so that the end of the jib is seen against sea and sky. */}
      <Bar from={[0.8 * length, 0.38 * s, 0.1]} to={[0.93 * length, 0.36 * s, 0.1]} radius={0.1} material={m.RED} />
      <Bar from={[0.8 * length, -0.38 * s, 0.1]} to={[0.93 * length, -0.36 * s, 0.1]} radius={0.1} material={m.RED} />
      {[0, 0.12].map((dz) => (
        <Bar
          key={dz}
          from={[0.4, 0.46 * s, dz]}
          to={[length * 0.72, 0.4 * s, dz]}
          radius={0.035}
          material={m.BLACK}
          sides={8}
        />
      ))}
    </group>
  );
}

// ---------------------------------------------------------------- cylinders
/** Barrel on the base pin, rod on the eye pin; the rod shows what the barrel does not cover. */
function CylinderSet({ crane, cylinder }: { crane: CraneDesign; cylinder: Cylinder }) {
  const director = useDirector();
  const refs = useRef<(Group | null)[]>([]);
  const eyes = useRef<(Group | null)[]>([]);
  const barrel = useMemo(() => retractedLength(crane, cylinder) - 0.42, [crane, cylinder]);
  const at = offsets(cylinder);
  const scratch = useMemo(
    () => ({ base: new Vector3(), along: new Vector3(), across: new Vector3(), up: new Vector3() }),
    [],
  );
  const matrix = useMemo(() => new Matrix4(), []);
  useFrame(() => {
    if (!director.ready) return;
    at.forEach((y, i) => {
      const { base, along, across, up } = scratch;
      const from = attachmentPoint(director.frames, cylinder.base, y);
      const to = attachmentPoint(director.frames, cylinder.eye, y);
      base.set(...from);
      along.set(...to).sub(base);
      const length = along.length();
      along.normalize();
      const R = director.frames.get(cylinder.base.link)?.R;
      if (R) across.set(R[1], R[4], R[7]);
      up.crossVectors(along, across);
      matrix.makeBasis(along, across, up).setPosition(base);
      const group = refs.current[i];
      if (group) {
        group.matrix.copy(matrix);
        group.matrixWorldNeedsUpdate = true;
      }
      eyes.current[i]?.position.set(length, 0, 0);
    });
  });
  const outer = cylinder.bore * 0.61;
  const rod = cylinder.rod / 2;
  const end: V3 = [barrel, 0, 0];
  return at.map((y, i) => (
    <group
      key={y}
      matrixAutoUpdate={false}
      ref={(group) => {
        refs.current[i] = group;
      }}
    >
      <Eye radius={outer * 1.1} />
      <Bar from={[0.15, 0, 0]} to={end} radius={outer} material={m.DARK_STEEL} sides={28} />
      <Bar from={[0.3, 0, 0]} to={[0.55, 0, 0]} radius={outer * 1.12} material={m.DARK_STEEL} sides={28} />
      <Bar from={[barrel - 0.3, 0, 0]} to={[barrel + 0.04, 0, 0]} radius={outer * 1.14} material={m.STEEL} sides={28} />
      <Bar
        from={[0.5, 0, outer + 0.05]}
        to={[barrel - 0.2, 0, outer + 0.05]}
        radius={0.035}
        material={m.STEEL}
        sides={8}
      />
      <group
        ref={(group) => {
          eyes.current[i] = group;
        }}
      >
        <Bar from={[-cylinder.stroke - 0.6, 0, 0]} to={[-0.1, 0, 0]} radius={rod} material={m.CHROME} sides={28} />
        <Eye radius={rod * 1.45} />
      </group>
    </group>
  ));
}

function Eye({ radius }: { radius: number }) {
  return (
    <mesh material={m.DARK_STEEL} castShadow>
      <cylinderGeometry args={[radius, radius, 0.36, 24]} />
    </mesh>
  );
}

/** A grooved sheave about y, or a drum's flange: rim, web and lightening holes, so that turning is seen. */
export function Sheave({ radius, width, spokes = 6 }: { radius: number; width: number; spokes?: number }) {
  return (
    <group>
      {[-1, 1].map((side) => (
        <mesh key={side} position={[0, (side * width) / 2, 0]} material={m.RED} castShadow>
          <cylinderGeometry args={[radius + 0.09, radius + 0.09, width * 0.28, 36]} />
        </mesh>
      ))}
      <mesh material={m.STEEL} castShadow>
        <cylinderGeometry args={[radius - 0.03, radius - 0.03, width, 36]} />
      </mesh>
      {Array.from({ length: spokes }, (_, i) => {
        const angle = (2 * Math.PI * i) / spokes;
        const at: V3 = [0.58 * radius * Math.cos(angle), 0, 0.58 * radius * Math.sin(angle)];
        return (
          <mesh key={angle} position={at} material={m.BLACK}>
            <cylinderGeometry args={[0.17 * radius, 0.17 * radius, width * 1.32, 16]} />
          </mesh>
        );
      })}
    </group>
  );
}
