import { Line } from "@react-three/drei";
import type { ThreeEvent } from "@react-three/fiber";
import { useMemo } from "react";
import {
  BackSide,
  CylinderGeometry,
  FrontSide,
  type Intersection,
  Mesh,
  MeshBasicMaterial,
  MeshStandardMaterial,
  type Plane,
  Quaternion,
  type Raycaster,
  Vector3,
} from "three";
import { retracted } from "../../core/design/plane";
import type { Attachment, Crane, Link, Part } from "../../core/design/types";
import { useDesigner } from "../context";
import { pedestal } from "../section/pedestal";
import { type Place, placed, wholeCentre } from "./places";
import { shapeOf } from "./shapes";

/** How much further from the middle of its link a part is when taken apart: along it, across it, upwards. */
const SPREAD = [0.35, 0.9, 2.2] as const;

interface Props {
  /** With parts in every link. */
  crane: Crane;
  at: ReadonlyMap<string, Place>;
  /** 0 together, 1 apart. */
  explode: number;
  planes: Plane[];
  centres: boolean;
  onClick: (event: ThreeEvent<MouseEvent>, link: number, part: number) => void;
}

/** The parts of a crane in a posture, with cylinders and rope. */
export function Machine({ crane, at, explode, planes, centres, onClick }: Props) {
  const selection = useDesigner((state) => state.selection);
  const paints = useMemo(
    () => ({
      body: paint("#e2a31b", 0.5, planes),
      chosen: paint("#2f9ed0", 0.45, planes),
      steel: paint("#6a727a", 0.4, planes),
      rod: paint("#dfe5ea", 0.2, planes),
      glass: paint("#4a6274", 0.3, planes),
      // What a cut lays open is seen from within the plate
      cut: new MeshBasicMaterial({ color: "#c2255c", side: BackSide, clippingPlanes: planes }),
    }),
    [planes],
  );
  const pin = ({ link, x, z }: Attachment, y = 0) => placed(at, { link, local: [x, y, z] });
  const rope = [crane.hoist.drum, ...crane.hoist.sheaves].map((to) => pin(to));
  const tip = rope[rope.length - 1];
  const whole = crane.links.reduce((sum, link) => sum + link.mass, 0);
  const foot = pedestal(crane);
  const left = useMemo(() => hitsLeftBy(planes), [planes]);
  const cut = planes.length ? paints.cut : null;
  return (
    <>
      {crane.links.map((link, index) => {
        const place = at.get(link.name)!;
        const chosen = selection.kind === "link" && selection.index === index;
        return (
          <group key={link.name} name={link.name} position={place.at} quaternion={place.turn}>
            {(link.parts ?? []).map((part, i) => (
              // biome-ignore lint/a11y/noStaticElementInteractions: an object of the scene, not of the page
              <mesh
                // biome-ignore lint/suspicious/noArrayIndexKey: parts are known by their place
                key={i}
                geometry={shapeOf(part)}
                material={
                  chosen && (selection.part === undefined || selection.part === i)
                    ? paints.chosen
                    : paints[painted(part)]
                }
                position={apart(part, link, explode)}
                raycast={left}
                onClick={(event) => onClick(event, index, i)}
              >
                {cut && <mesh geometry={shapeOf(part)} material={cut} raycast={() => null} />}
              </mesh>
            ))}
            {centres && (
              <mesh position={[...link.com]} renderOrder={2}>
                <sphereGeometry args={[0.12 * Math.cbrt(link.mass / 1e4), 16, 12]} />
                <meshBasicMaterial color="#d6336c" depthTest={false} transparent />
              </mesh>
            )}
          </group>
        );
      })}
      {explode === 0 &&
        crane.cylinders.flatMap((cylinder) => {
          const count = cylinder.count ?? 1;
          return Array.from({ length: count }, (_, side) => {
            const y = (side - 0.5 * (count - 1)) * 1.76 * cylinder.bore;
            const [a, b] = [pin(cylinder.base, y), pin(cylinder.eye, y)];
            const length = a.distanceTo(b);
            const barrel = Math.min(0.95 * retracted(crane, cylinder), 0.96 * length);
            return (
              <group key={`${cylinder.name} ${y}`}>
                <Bar
                  from={a}
                  to={b}
                  start={0}
                  end={barrel}
                  diameter={1.18 * cylinder.bore}
                  paint={paints.steel}
                  cut={cut}
                />
                <Bar from={a} to={b} start={barrel} end={length} diameter={cylinder.rod} paint={paints.rod} cut={cut} />
              </group>
            );
          });
        })}
      {explode === 0 && <Line points={[...rope, tip.clone().setZ(tip.z - 4)]} color={ROPE} lineWidth={1.5} />}
      {centres && (
        <mesh position={wholeCentre(crane, at)} renderOrder={2}>
          <octahedronGeometry args={[0.25 * Math.cbrt(whole / 1e4)]} />
          <meshBasicMaterial color="#d6336c" depthTest={false} transparent />
        </mesh>
      )}
      {crane.slew && (
        <mesh position={[0, 0, -0.5 * foot.depth]} rotation={[Math.PI / 2, 0, 0]} material={FOUNDATION}>
          <cylinderGeometry args={[foot.top, foot.bottom, foot.depth, 40]} />
        </mesh>
      )}
    </>
  );
}

const FOUNDATION = new MeshStandardMaterial({ color: "#6a727a", roughness: 0.5, metalness: 0.1 });

/** Seen before light and dark paper. */
const ROPE = "#77838d";

function paint(color: string, roughness: number, clippingPlanes: Plane[]): MeshStandardMaterial {
  return new MeshStandardMaterial({
    color,
    roughness,
    metalness: 0.1,
    flatShading: true,
    side: FrontSide,
    clippingPlanes,
  });
}

function painted(part: Part): "body" | "steel" | "glass" {
  if (part.kind === "sheave" || part.kind === "drum") return "steel";
  return part.kind === "box" && part.name === "cabin" ? "glass" : "body";
}

/** Rays meet a mesh only where it is not cut away. */
function hitsLeftBy(planes: Plane[]) {
  return function raycast(this: Mesh, ray: Raycaster, found: Intersection[]): void {
    const all: Intersection[] = [];
    Mesh.prototype.raycast.call(this, ray, all);
    found.push(...all.filter(({ point }) => planes.every((plane) => plane.distanceToPoint(point) >= 0)));
  };
}

/** How far a part goes from the middle of its link when taken apart. */
function apart(part: Part, link: Link, explode: number): [number, number, number] {
  if (explode === 0) return [0, 0, 0];
  const shape = shapeOf(part);
  if (!shape.boundingSphere) shape.computeBoundingSphere();
  const { x, y, z } = shape.boundingSphere!.center;
  const from = x - link.com[0];
  const aside = (1 + Math.abs(from)) * Math.sign(y);
  return [explode * SPREAD[0] * from, explode * SPREAD[1] * (y + aside), explode * SPREAD[2] * (z - link.com[2])];
}

const ROUND = new CylinderGeometry(1, 1, 1, 24);

interface BarProps {
  from: Vector3;
  to: Vector3;
  start: number;
  end: number;
  diameter: number;
  paint: MeshStandardMaterial;
  /** Of what is laid open by a cut, if there is one. */
  cut: MeshBasicMaterial | null;
}

/** A round bar on the line between two points, from `start` to `end` along it [m]. */
function Bar({ from, to, start, end, diameter, paint, cut }: BarProps) {
  const along = to.clone().sub(from).normalize();
  const middle = from.clone().addScaledVector(along, 0.5 * (start + end));
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along);
  const length = Math.max(end - start, 1e-3);
  return (
    <group position={middle} quaternion={turn} scale={[0.5 * diameter, length, 0.5 * diameter]}>
      <mesh geometry={ROUND} material={paint} />
      {cut && <mesh geometry={ROUND} material={cut} raycast={() => null} />}
    </group>
  );
}
