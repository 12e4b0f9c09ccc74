import { useFrame } from "@react-three/fiber";
import { type ReactNode, useMemo, useRef } from "react";
import type { Group } from "three";
import { deckPlate, fender, HullLines, plating } from "../../core/solids";
import { useDirector } from "./director";
import { Merged } from "./Merged";
import * as m from "./materials";
import { Bar, Box, Rail, Solid, type V3 } from "./parts";

const BOOT = 0.35;

/** A supply vessel about the crane: hull, forecastle with its house, working deck. Its children ride on it. */
export function Ship({ children }: { children: ReactNode }) {
  const director = useDirector();
  const group = useRef<Group>(null);
  useFrame(() => {
    if (!group.current) return;
    group.current.position.copy(director.shipPosition);
    group.current.quaternion.copy(director.shipOrientation);
  });
  const lines = useMemo(() => new HullLines(director.model.ship), [director]);
  const { length } = lines.ship;
  const { deck, forecastle, breakX } = lines;
  return (
    <group ref={group}>
      <Merged>
        <Solid
          of={() =>
            plating(
              lines,
              (x) => lines.keel(x),
              () => BOOT,
              10,
            )
          }
          crease={0.7}
          material={m.BOTTOM}
        />
        <Solid
          of={() =>
            plating(
              lines,
              () => BOOT,
              (x) => lines.sheer(x),
              6,
              120,
            )
          }
          crease={0.7}
          material={m.HULL}
        />
        <Solid of={() => fender(lines, deck - 0.25, 0.5, 0.22)} material={m.BLACK} />
        <Solid of={() => deckPlate(lines, deck, -length / 2 + 0.1, breakX + 1)} material={m.DECK} />
        <Solid of={() => deckPlate(lines, forecastle, breakX, 0.49 * length)} material={m.DECK_GREEN} />
        <Box
          size={[0.2, 2 * lines.half(breakX, deck) - 0.3, forecastle - deck]}
          at={[breakX + 0.2, 0, (forecastle + deck) / 2]}
          material={m.WHITE}
        />
        <House lines={lines} />
        <WorkingDeck lines={lines} />
      </Merged>
      {children}
    </group>
  );
}

/** Accommodation, wheelhouse, mast and funnels on the forecastle. */
function House({ lines }: { lines: HullLines }) {
  const { length, beam } = lines.ship;
  const x0 = lines.breakX + 0.02 * length;
  const z0 = lines.forecastle;
  const tier = 2.75;
  const tiers: { from: number; to: number; width: number }[] = [
    { from: x0, to: x0 + 0.235 * length, width: 0.84 * beam },
    { from: x0 + 1, to: x0 + 0.222 * length, width: 0.8 * beam },
    { from: x0 + 2.5, to: x0 + 0.2 * length, width: 0.74 * beam },
  ];
  const bridge = { from: x0 + 4, to: x0 + 0.185 * length, width: 0.86 * beam };
  const zb = z0 + tiers.length * tier;
  const middle = (bridge.from + bridge.to) / 2;
  const span = bridge.to - bridge.from;
  return (
    <group>
      {tiers.map(({ from, to, width }, i) => (
        <group key={from}>
          <Box
            size={[to - from, width, tier - 0.12]}
            at={[(from + to) / 2, 0, z0 + (i + 0.5) * tier]}
            material={m.WHITE}
          />
          <Box
            size={[to - from + 0.5, width + 0.5, 0.12]}
            at={[(from + to) / 2, 0, z0 + (i + 1) * tier - 0.06]}
            material={m.GREY}
          />
          <Portholes from={from} to={to} width={width} z={z0 + (i + 0.58) * tier} />
          <Rail
            path={[
              [from - 0.2, -width / 2 - 0.2, z0 + (i + 1) * tier],
              [from - 0.2, width / 2 + 0.2, z0 + (i + 1) * tier],
            ]}
          />
        </group>
      ))}
      <Box size={[span, bridge.width, 0.95]} at={[middle, 0, zb + 0.47]} material={m.WHITE} />
      <Box size={[span + 0.06, bridge.width + 0.06, 1.15]} at={[middle, 0, zb + 1.52]} material={m.GLASS} />
      <Mullions from={bridge.from} to={bridge.to} width={bridge.width} z={zb + 1.52} />
      <Box size={[span + 1.2, bridge.width + 0.7, 0.35]} at={[middle, 0, zb + 2.27]} material={m.WHITE} />
      <Bar from={[middle, 0, zb + 2.4]} to={[middle - 0.5, 0, zb + 10]} radius={0.42} end={0.16} material={m.WHITE} />
      <Bar from={[middle - 0.3, -2.2, zb + 6]} to={[middle - 0.3, 2.2, zb + 6]} radius={0.09} material={m.WHITE} />
      <Box size={[0.25, 3.4, 0.22]} at={[middle + 0.5, 0, zb + 6.9]} material={m.GREY} turn={[0, 0, 0.5]} />
      <Box size={[0.22, 2.4, 0.2]} at={[middle + 0.4, 0, zb + 8.6]} material={m.GREY} turn={[0, 0, -0.7]} />
      {[-1, 1].map((side) => (
        <mesh key={side} position={[middle - 2, side * 4.6, zb + 3.6]} material={m.WHITE} castShadow>
          <sphereGeometry args={[1.05, 20, 14]} />
        </mesh>
      ))}
      {[-1, 1].map((side) => (
        <group key={side} position={[x0 + 1.6, side * 0.33 * beam, z0]}>
          <Box size={[2.6, 1.9, 10.4]} at={[0, 0, 5.2]} material={m.HULL} />
          <Box size={[2.62, 1.92, 1.1]} at={[0, 0, 8.7]} material={m.ORANGE} />
          <Bar from={[0, 0, 10.2]} to={[-0.5, 0, 11.6]} radius={0.4} material={m.BLACK} />
        </group>
      ))}
      {[-1, 1].map((side) => (
        <group key={side} position={[x0 + 0.12 * length, side * (0.44 * beam), z0 + 2.6]}>
          <mesh rotation={[0, 0, Math.PI / 2]} material={m.ORANGE} castShadow>
            <capsuleGeometry args={[0.95, 4.2, 8, 16]} />
          </mesh>
          <Box size={[0.25, 0.5, 3.4]} at={[-2, -side * 0.3, -0.6]} material={m.GREY} />
          <Box size={[0.25, 0.5, 3.4]} at={[2, -side * 0.3, -0.6]} material={m.GREY} />
        </group>
      ))}
    </group>
  );
}

interface Pane {
  at: V3;
  size: V3;
}

interface Block {
  from: number;
  to: number;
  width: number;
  z: number;
}

function Portholes({ from, to, width, z }: Block) {
  const panes = useMemo(() => {
    const places: Pane[] = [];
    for (let x = from + 2; x < to - 1; x += 2.4) {
      for (const side of [-1, 1]) places.push({ at: [x, (side * width) / 2, z], size: [0.7, 0.06, 0.8] });
    }
    for (let y = -width / 2 + 1.6; y < width / 2 - 1; y += 2.4) {
      places.push({ at: [to, y, z], size: [0.06, 0.75, 0.8] }, { at: [from, y, z], size: [0.06, 0.75, 0.8] });
    }
    return places;
  }, [from, to, width, z]);
  return panes.map(({ at, size }) => <Box key={`${at}`} at={at} size={size} material={m.GLASS} />);
}

function Mullions({ from, to, width, z }: Block) {
  const panes = useMemo(() => {
    const places: Pane[] = [];
    for (let x = from; x <= to + 0.01; x += (to - from) / 8) {
      for (const side of [-1, 1]) places.push({ at: [x, side * (width / 2 + 0.04), z], size: [0.16, 0.06, 1.15] });
    }
    for (let y = -width / 2; y <= width / 2 + 0.01; y += width / 12) {
      for (const x of [from - 0.04, to + 0.04]) places.push({ at: [x, y, z], size: [0.06, 0.16, 1.15] });
    }
    return places;
  }, [from, to, width, z]);
  return panes.map(({ at, size }) => <Box key={`${at}`} at={at} size={size} material={m.WHITE} />);
}

/** Pedestal, cargo rail, some cargo, a winch: what gives the deck its scale. */
function WorkingDeck({ lines }: { lines: HullLines }) {
  const { ship, deck, breakX } = lines;
  const [px, py, pz] = ship.pedestal;
  const aft = -ship.length / 2;
  const side = Math.sign(py) || 1;
  return (
    <group>
      <Bar from={[px, py, deck]} to={[px, py, deck + 0.9]} radius={2.5} end={2} material={m.GREY} sides={40} />
      <Bar from={[px, py, deck]} to={[px, py, pz - 1.3]} radius={1.9} material={m.GREY} sides={40} />
      <Bar from={[px, py, pz - 1.3]} to={[px, py, pz - 0.5]} radius={1.9} end={2.15} material={m.GREY} sides={40} />
      <Bar from={[px, py, pz - 0.5]} to={[px, py, pz]} radius={2.25} material={m.DARK_STEEL} sides={40} />
      {[-1, 1].map((s) => (
        <group key={s}>
          <Rail
            path={[
              [aft + 3, s * (ship.beam / 2 - 2.6), deck],
              [breakX - 3, s * (ship.beam / 2 - 2.6), deck],
            ].map((p): V3 => [p[0], p[1], p[2]])}
            height={2.4}
            spacing={3}
            material={m.GREY}
          />
        </group>
      ))}
      {[
        { x: aft + 12, y: -side * 3.2, color: m.CONTAINER_GREEN },
        { x: aft + 12, y: -side * 0.4, color: m.WHITE },
        { x: aft + 19, y: -side * 3.2, color: m.ORANGE },
        { x: breakX - 12, y: -side * 3, color: m.CARGO },
      ].map(({ x, y, color }) => (
        <group key={`${x}:${y}`} position={[x, y, deck]}>
          <Box size={[6.06, 2.44, 2.59]} at={[0, 0, 1.4]} material={color} />
          {[-3, 3].map((ex) =>
            [-1.2, 1.2].map((ey) => (
              <Box key={`${ex}:${ey}`} size={[0.16, 0.14, 2.7]} at={[ex, ey, 1.4]} material={m.DARK_STEEL} />
            )),
          )}
        </group>
      ))}
      <group position={[breakX - 4, side * 1.5, deck]}>
        <Box size={[3, 4.6, 0.4]} at={[0, 0, 0.2]} material={m.DARK_STEEL} />
        <Bar from={[0, -1.8, 1.5]} to={[0, 1.8, 1.5]} radius={0.95} material={m.WIRE} sides={24} />
        {[-1.9, 1.9].map((y) => (
          <Bar
            key={y}
            from={[0, y - 0.1, 1.5]}
            to={[0, y + 0.1, 1.5]}
            radius={1.4}
            material={m.YELLOW_DARK}
            sides={28}
          />
        ))}
      </group>
    </group>
  );
}
