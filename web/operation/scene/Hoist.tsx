import { useFrame } from "@react-three/fiber";
import { type ReactNode, useMemo, useRef } from "react";
import { type Group, Quaternion, Vector3 } from "three";
import { isKnuckleBoom } from "../../core/crane";
import { FOOT } from "../../core/design/types";
import { OnLink, Sheave } from "./Crane";
import { useDirector } from "./director";
import { Tube } from "./geometry";
import { Merged } from "./Merged";
import * as m from "./materials";
import { Bar, Box, type V3 } from "./parts";
import { reels, ropePoints } from "./reeving";

/** Drum, sheaves, rope, hook and load, in the frame of the crane's foot. */
export function Hoist() {
  const { model } = useDirector();
  const all = reels(model.crane);
  // Those on a link of a crane that is drawn from its parts are among these.
  const places = isKnuckleBoom(model.crane) ? all : all.filter(({ link }) => link === FOOT);
  return (
    <>
      {places.map(({ link, x, z, radius }, i) => (
        <OnLink key={`${link}:${x}`} name={link}>
          <group position={[x, 0, z]}>
            {i === 0 ? (
              <Turning radius={radius}>
                <Drum radius={radius} />
              </Turning>
            ) : (
              <Turning radius={radius}>
                <Sheave radius={radius} width={0.24} />
              </Turning>
            )}
          </group>
        </OnLink>
      ))}
      <Rope />
      <HookAndLoad />
    </>
  );
}

/** Turns with the rope that runs over it. */
function Turning({ radius, children }: { radius: number; children: ReactNode }) {
  const director = useDirector();
  const group = useRef<Group>(null);
  useFrame(() => {
    if (group.current) group.current.rotation.y = director.paidOut / radius;
  });
  return (
    <group ref={group}>
      <Merged>{children}</Merged>
    </group>
  );
}

function Drum({ radius }: { radius: number }) {
  const turns = 15;
  const half = 0.84;
  return (
    <group>
      <mesh material={m.DARK_STEEL} castShadow>
        <cylinderGeometry args={[radius - 0.09, radius - 0.09, 2 * half, 32]} />
      </mesh>
      {Array.from({ length: turns }, (_, i) => {
        const y = -half + 0.1 + ((2 * half - 0.2) * i) / (turns - 1);
        return (
          <mesh key={y} position={[0, y, 0]} rotation={[Math.PI / 2, 0, 0]} material={m.WIRE}>
            <torusGeometry args={[radius - 0.05, 0.05, 6, 36]} />
          </mesh>
        );
      })}
      {[-half, half].map((y) => (
        <group key={y} position={[0, y, 0]}>
          <mesh material={m.RED} castShadow>
            <cylinderGeometry args={[radius + 0.38, radius + 0.38, 0.09, 40]} />
          </mesh>
          {Array.from({ length: 8 }, (_, i) => {
            const angle = (Math.PI * i) / 4;
            return (
              <mesh key={angle} position={[0.8 * Math.cos(angle), 0, 0.8 * Math.sin(angle)]} material={m.BLACK}>
                <cylinderGeometry args={[0.11, 0.11, 0.12, 12]} />
              </mesh>
            );
          })}
        </group>
      ))}
    </group>
  );
}

/** A wire keeps to its diameter near by, and to about a pixel far off: it never vanishes into dots. */
const PIXEL = 0.00075;

function Rope() {
  const director = useDirector();
  const tube = useMemo(() => new Tube(160, 8), []);
  const { crane } = director.model;
  const there = useMemo(() => new Vector3(), []);
  useFrame(({ camera }) => {
    if (!director.ready) return;
    there
      .copy(director.hook)
      .add(new Vector3(...crane.pedestal))
      .add(director.shipPosition);
    const radius = Math.max(crane.hoist.rope.diameter / 2, PIXEL * camera.position.distanceTo(there));
    const hook: V3 = [director.hook.x, director.hook.y, director.hook.z];
    tube.set(ropePoints(crane, director.frames, hook, director.slack), radius);
  });
  return <mesh geometry={tube.geometry} material={m.WIRE} frustumCulled={false} castShadow />;
}

/** Height of the hook block [m], and the length of the load for which it is made. */
const BLOCK = 1.9;
const FULL = 4;

function HookAndLoad() {
  const director = useDirector();
  const group = useRef<Group>(null);
  const scratch = useMemo(() => ({ fall: new Vector3(), up: new Vector3(0, 0, 1), turn: new Quaternion() }), []);
  const { load, crane } = director.model;
  const last = crane.hoist.sheaves[crane.hoist.sheaves.length - 1];
  useFrame(() => {
    const frame = director.frames.get(last.link);
    if (!group.current || !frame || !director.ready) return;
    const [x, y, z] = [last.x, 0, last.z];
    const { fall, up, turn } = scratch;
    fall.set(
      frame.R[0] * x + frame.R[1] * y + frame.R[2] * z + frame.p[0],
      frame.R[3] * x + frame.R[4] * y + frame.R[5] * z + frame.p[1],
      frame.R[6] * x + frame.R[7] * y + frame.R[8] * z + frame.p[2],
    );
    fall.sub(director.hook).normalize();
    group.current.position.copy(director.hook);
    // On a swivel hook the load keeps its heading over the ship while the crane slews.
    turn.setFromUnitVectors(up, fall);
    group.current.quaternion.copy(turn);
  });
  const [lx, ly, lz] = load.size;
  const scale = Math.min(1, lx / FULL);
  const block = scale * BLOCK;
  const sling = 0.55 * Math.hypot(lx, ly) + 0.6 * scale;
  const top = -block - sling;
  return (
    <group ref={group}>
      <Merged>
        <group scale={scale}>
          <HookBlock />
        </group>
        <group rotation={[0, 0, 0.35]}>
          {[-1, 1].flatMap((sx) =>
            [-1, 1].map((sy) => (
              <Bar
                key={`${sx}:${sy}`}
                from={[0, 0, -block]}
                to={[sx * (lx / 2 - 0.25 * scale), sy * (ly / 2 - 0.2 * scale), top]}
                radius={0.035 * scale}
                material={m.WIRE}
                sides={6}
              />
            )),
          )}
          <group position={[0, 0, top - lz / 2]} scale={scale}>
            <Cargo size={[lx / scale, ly / scale, lz / scale]} />
          </group>
        </group>
      </Merged>
    </group>
  );
}

/** Single-fall hook with its weight, hanging from the rope's end at the origin. */
function HookBlock() {
  return (
    <group>
      <Bar from={[0, 0, 0.05]} to={[0, 0, -0.3]} radius={0.09} end={0.16} material={m.STEEL} />
      <mesh position={[0, 0, -0.68]} material={m.YELLOW} castShadow>
        <sphereGeometry args={[0.5, 24, 16]} />
      </mesh>
      <mesh position={[0, 0, -0.68]} rotation={[Math.PI / 2, 0, 0]} material={m.BLACK}>
        <cylinderGeometry args={[0.505, 0.505, 0.2, 28]} />
      </mesh>
      <Bar from={[0, 0, -1.1]} to={[0, 0, -1.4]} radius={0.13} material={m.STEEL} />
      <mesh position={[0, 0, -1.68]} rotation={[Math.PI / 2, 0, -Math.PI * 0.98]} material={m.DARK_STEEL} castShadow>
        <torusGeometry args={[0.27, 0.09, 10, 24, Math.PI * 1.5]} />
      </mesh>
    </group>
  );
}

/** An offshore cargo unit: framed box with ribbed sides, padeyes and fork pockets. */
function Cargo({ size: [lx, ly, lz] }: { size: V3 }) {
  const post = 0.22;
  const ribs = Math.max(4, Math.round(lx / 0.55));
  return (
    <group>
      <Box size={[lx - 0.16, ly - 0.16, lz - 0.12]} material={m.CARGO} />
      {Array.from({ length: ribs }, (_, i) => {
        const x = -lx / 2 + 0.4 + ((lx - 0.8) * i) / (ribs - 1);
        return <Box key={x} size={[0.16, ly - 0.06, lz - 0.4]} at={[x, 0, 0]} material={m.CARGO} />;
      })}
      {[-1, 1].flatMap((sx) =>
        [-1, 1].map((sy) => (
          <group key={`${sx}:${sy}`}>
            <Box
              size={[post, post, lz]}
              at={[sx * (lx / 2 - post / 2), sy * (ly / 2 - post / 2), 0]}
              material={m.CARGO_FRAME}
            />
            <Box
              size={[0.3, 0.08, 0.34]}
              at={[sx * (lx / 2 - 0.25), sy * (ly / 2 - 0.2), lz / 2 + 0.12]}
              material={m.STEEL}
            />
          </group>
        )),
      )}
      {[-1, 1].flatMap((s) =>
        [-1, 1].map((v) => (
          <group key={`${s}:${v}`}>
            <Box
              size={[lx, post, post]}
              at={[0, s * (ly / 2 - post / 2), v * (lz / 2 - post / 2)]}
              material={m.CARGO_FRAME}
            />
            <Box
              size={[post, ly, post]}
              at={[s * (lx / 2 - post / 2), 0, v * (lz / 2 - post / 2)]}
              material={m.CARGO_FRAME}
            />
          </group>
        )),
      )}
    </group>
  );
}
