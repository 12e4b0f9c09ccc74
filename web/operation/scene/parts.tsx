// Small parts used all over: boxes, round bars, plates, rails, text on steel.
import { useMemo } from "react";
import { CanvasTexture, type Material, MeshStandardMaterial, Quaternion, SRGBColorSpace, Vector3 } from "three";
import type { Point2, Triangles } from "../../core/solids";
import { plate, solid } from "./geometry";
import { WHITE } from "./materials";

export type V3 = [number, number, number];

interface Common {
  material: Material;
  at?: V3;
}

export function Box({ size, at = [0, 0, 0], material, turn }: Common & { size: V3; turn?: V3 }) {
  return (
    <mesh position={at} rotation={turn} material={material} castShadow receiveShadow>
      <boxGeometry args={size} />
    </mesh>
  );
}

/** A round bar between two points. */
export function Bar(props: { from: V3; to: V3; radius: number; end?: number; material: Material; sides?: number }) {
  const { from, to, radius, end = radius, material, sides = 16 } = props;
  const { middle, turn, length } = useMemo(() => {
    const [a, b] = [new Vector3(...from), new Vector3(...to)];
    const along = b.clone().sub(a);
    return {
      middle: a.add(b).multiplyScalar(0.5),
      length: along.length(),
      turn: new Quaternion().setFromUnitVectors(new Vector3(0, 1, 0), along.normalize()),
    };
  }, [from, to]);
  return (
    <mesh position={middle} quaternion={turn} material={material} castShadow receiveShadow>
      <cylinderGeometry args={[end, radius, length, sides, 1, radius < 0.06]} />
    </mesh>
  );
}

/** A pin across the plane of the crane. */
export function Pin({
  at,
  radius,
  width,
  material,
}: {
  at: Point2;
  radius: number;
  width: number;
  material: Material;
}) {
  return (
    <mesh position={[at[0], 0, at[1]]} material={material} castShadow>
      <cylinderGeometry args={[radius, radius, width, 24]} />
    </mesh>
  );
}

export function Plate(props: { outline: readonly Point2[]; y: number; thickness: number; material: Material }) {
  const { outline, y, thickness, material } = props;
  const geometry = useMemo(() => plate(outline, thickness), [outline, thickness]);
  return <mesh geometry={geometry} position={[0, y, 0]} material={material} castShadow receiveShadow />;
}

export function Solid({ of, crease, material }: { of: () => Triangles; crease?: number; material: Material }) {
  // biome-ignore lint/correctness/useExhaustiveDependencies: the shape is made once, of fixed dimensions
  const geometry = useMemo(() => solid(of(), crease), []);
  return <mesh geometry={geometry} material={material} castShadow receiveShadow />;
}

/** Handrail along a polyline: posts and two rails. */
export function Rail(props: { path: readonly V3[]; height?: number; material?: Material; spacing?: number }) {
  const { path, height = 1.1, material = WHITE, spacing = 2 } = props;
  const bars: { from: V3; to: V3 }[] = [];
  for (let i = 0; i + 1 < path.length; i += 1) {
    const [a, b] = [path[i], path[i + 1]];
    const up = (p: V3, h: number): V3 => [p[0], p[1], p[2] + h];
    bars.push({ from: up(a, height), to: up(b, height) }, { from: up(a, height / 2), to: up(b, height / 2) });
    const count = Math.max(1, Math.round(Math.hypot(b[0] - a[0], b[1] - a[1]) / spacing));
    for (let k = 0; k <= count; k += 1) {
      const p: V3 = [0, 1, 2].map((j) => a[j] + ((b[j] - a[j]) * k) / count) as V3;
      bars.push({ from: p, to: up(p, height) });
    }
  }
  return bars.map(({ from, to }) => (
    <Bar key={`${from}:${to}`} from={from} to={to} radius={0.035} material={material} sides={5} />
  ));
}

/** Text painted on a vertical face in the plane of the crane, read from +y (side 1) or -y (side -1). */
export function Lettering(props: { text: string; at: V3; height: number; side: 1 | -1; color?: string }) {
  const { text, at, height, side, color = "#15181b" } = props;
  const { material, width } = useMemo(() => {
    const canvas = document.createElement("canvas");
    const font = "700 96px 'Liberation Sans', Arial, Helvetica, sans-serif";
    const pen = canvas.getContext("2d");
    if (!pen) return { material: new MeshStandardMaterial({ visible: false }), width: 1 };
    pen.font = font;
    canvas.width = Math.ceil(pen.measureText(text).width) + 16;
    canvas.height = 112;
    pen.font = font;
    pen.fillStyle = color;
    pen.textBaseline = "middle";
    pen.fillText(text, 8, 60);
    const map = new CanvasTexture(canvas);
    map.colorSpace = SRGBColorSpace;
    map.anisotropy = 8;
    return {
      material: new MeshStandardMaterial({
        map,
        transparent: true,
        roughness: 0.6,
        polygonOffset: true,
        polygonOffsetFactor: -2,
      }),
      width: (height * canvas.width) / canvas.height,
    };
  }, [text, height, color]);
  return (
    <mesh position={at} rotation={[Math.PI / 2, side > 0 ? Math.PI : 0, 0, "XYZ"]} material={material}>
      <planeGeometry args={[width, height]} />
    </mesh>
  );
}
