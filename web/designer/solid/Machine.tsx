import { Line } from "@react-three/drei";
import { useMemo } from "react";
import { MeshStandardMaterial, type Plane, Quaternion, Vector3 } from "three";
import { type Posture, retracted } from "../../core/design/plane";
import type { Attachment, Crane, Link, Part } from "../../core/design/types";
import { useDesigner } from "../context";
import { shapeOf } from "./shapes";

const SPREAD = 0.9;

interface Props {
  /** With parts in every link. */
  crane: Crane;
  posture: Posture;
  /** 0 together, 1 apart. */
  explode: number;
  planes: Plane[];
  centres: boolean;
  onSelect: (link: number, part: number) => void;
}

interface Place {
  readonly at: Vector3;
  readonly turn: Quaternion;
}

/** Where each link is, in foot axes. */
function places(crane: Crane, posture: Posture): Map<string, Place> {
  let now: Place = { at: new Vector3(), turn: new Quaternion() };
  const found = new Map([["foot", now]]);
  for (const { name, joint } of crane.links) {
    const q = posture[joint.name] ?? 0;
    const axis = new Vector3(...joint.axis).normalize();
    const at = new Vector3(...joint.origin).applyQuaternion(now.turn).add(now.at);
    now =
      joint.kind === "revolute"
        ? { at, turn: now.turn.clone().multiply(new Quaternion().setFromAxisAngle(axis, q)) }
        : { at: at.add(axis.multiplyScalar(q).applyQuaternion(now.turn)), turn: now.turn };
    found.set(name, now);
  }
  return found;
}

/** The parts of a crane in a posture, with cylinders and rope. */
export function Machine({ crane, posture, explode, planes, centres, onSelect }: Props) {
  const selection = useDesigner((state) => state.selection);
  const at = useMemo(() => places(crane, posture), [crane, posture]);
  const paints = useMemo(
    () => ({
      body: paint("#e2a31b", 0.5, planes),
      chosen: paint("#2f9ed0", 0.45, planes),
      steel: paint("#6a727a", 0.4, planes),
      rod: paint("#dfe5ea", 0.2, planes),
      glass: paint("#31414c", 0.3, planes),
    }),
    [planes],
  );
  const pin = ({ link, x, z }: Attachment, y = 0): Vector3 => {
    const place = at.get(link) ?? at.get("foot")!;
    return new Vector3(x, y, z).applyQuaternion(place.turn).add(place.at);
  };
  const rope = [crane.hoist.drum, ...crane.hoist.sheaves].map((to) => pin(to));
  const tip = rope[rope.length - 1];
  return (
    <>
      {crane.links.map((link, index) => {
        const place = at.get(link.name)!;
        const chosen = selection.kind === "link" && selection.index === index;
        return (
          <group key={link.name} position={place.at} quaternion={place.turn}>
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
                onClick={() => onSelect(index, i)}
              />
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
                <Bar from={a} to={b} start={0} end={barrel} diameter={1.18 * cylinder.bore} material={paints.steel} />
                <Bar from={a} to={b} start={barrel} end={length} diameter={cylinder.rod} material={paints.rod} />
              </group>
            );
          });
        })}
      {explode === 0 && <Line points={[...rope, tip.clone().setZ(tip.z - 4)]} color="#22282d" lineWidth={1.5} />}
    </>
  );
}

function paint(color: string, roughness: number, clippingPlanes: Plane[]): MeshStandardMaterial {
  return new MeshStandardMaterial({ color, roughness, metalness: 0.1, flatShading: true, side: 2, clippingPlanes });
}

function painted(part: Part): "body" | "steel" | "glass" {
  if (part.kind === "sheave" || part.kind === "drum") return "steel";
  return part.kind === "box" && part.name === "cabin" ? "glass" : "body";
}

/** How far a part goes from the middle of its link when taken apart. */
function apart(part: Part, link: Link, explode: number): [number, number, number] {
  if (explode === 0) return [0, 0, 0];
  const shape = shapeOf(part);
  if (!shape.boundingSphere) shape.computeBoundingSphere();
  const { x, y, z } = shape.boundingSphere!.center;
  const k = SPREAD * explode;
  return [
    k * (x - link.com[0]),
    k * (1 + Math.abs(x - link.com[0])) * Math.sign(y) + k * y,
    k * 2.5 * (z - link.com[2]),
  ];
}

interface BarProps {
  from: Vector3;
  to: Vector3;
  start: number;
  end: number;
  diameter: number;
  material: MeshStandardMaterial;
}

/** A round bar on the line between two points, from `start` to `end` along it [m]. */
function Bar({ from, to, start, end, diameter, material }: BarProps) {
  const along = to.clone().sub(from).normalize();
  const middle = from.clone().addScaledVector(along, 0.5 * (start + end));
  const turn = new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along);
  const length = Math.max(end - start, 1e-3);
  return (
    <mesh position={middle} quaternion={turn} scale={[0.5 * diameter, length, 0.5 * diameter]} material={material}>
      <cylinderGeometry args={[1, 1, 1, 24]} />
    </mesh>
  );
}
