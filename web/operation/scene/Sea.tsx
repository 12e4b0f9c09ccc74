import { useFrame } from "@react-three/fiber";
import { useMemo, useRef } from "react";
import {
  BufferAttribute,
  BufferGeometry,
  DataTexture,
  DynamicDrawUsage,
  LinearFilter,
  LinearMipmapLinearFilter,
  MeshStandardMaterial,
  RepeatWrapping,
  RGBAFormat,
  Vector2,
} from "three";
import { SeaGrid, widening } from "../../core/sea";
import { useDirector } from "./director";

const COUNT = 129;
const NEAR = 1.6;
const REACH = 12_000;
const RIPPLE = 23;

/** The sea of the physics: the same waves at the same time. Ripples smaller than its waves are in the shading only. */
export function Sea() {
  const director = useDirector();
  const waves = director.model.sea.waves;
  const shownAt = useRef(Number.NaN);
  const { geometry, material, update } = useMemo(() => {
    const line = widening(COUNT, NEAR, REACH);
    const grid = new SeaGrid(waves, line, line);
    const positions = new Float32Array(COUNT * COUNT * 3);
    const normals = new Float32Array(COUNT * COUNT * 3);
    const uv = new Float32Array(COUNT * COUNT * 2);
    // Where cells are too wide to carry the waves, the surface is level: better flat than wrong.
    const clear = Float64Array.from(line, (_, i) => {
      const cell = i + 1 < COUNT ? line[i + 1] - line[i] : line[i] - line[i - 1];
      return Math.min(1, Math.max(0, (14 - cell) / 8));
    });
    const index: number[] = [];
    for (let j = 0; j < COUNT; j += 1) {
      for (let i = 0; i < COUNT; i += 1) {
        const at = j * COUNT + i;
        positions.set([line[i], line[j], 0], 3 * at);
        uv.set([line[i] / RIPPLE, line[j] / RIPPLE], 2 * at);
        if (i + 1 < COUNT && j + 1 < COUNT) index.push(at, at + 1, at + COUNT + 1, at, at + COUNT + 1, at + COUNT);
      }
    }
    const geometry = new BufferGeometry();
    geometry.setIndex(index);
    geometry.setAttribute("position", new BufferAttribute(positions, 3).setUsage(DynamicDrawUsage));
    geometry.setAttribute("normal", new BufferAttribute(normals, 3).setUsage(DynamicDrawUsage));
    geometry.setAttribute("uv", new BufferAttribute(uv, 2));
    const heights = new Float32Array(COUNT * COUNT);
    const update = (time: number) => {
      grid.at(time, heights);
      for (let j = 0; j < COUNT; j += 1) {
        for (let i = 0; i < COUNT; i += 1) {
          const at = j * COUNT + i;
          heights[at] *= Math.min(clear[i], clear[j]);
          positions[3 * at + 2] = heights[at];
        }
      }
      for (let j = 0; j < COUNT; j += 1) {
        const [below, above] = [Math.max(0, j - 1), Math.min(COUNT - 1, j + 1)];
        for (let i = 0; i < COUNT; i += 1) {
          const [left, right] = [Math.max(0, i - 1), Math.min(COUNT - 1, i + 1)];
          const sx = (heights[j * COUNT + right] - heights[j * COUNT + left]) / (line[right] - line[left]);
          const sy = (heights[above * COUNT + i] - heights[below * COUNT + i]) / (line[above] - line[below]);
          const n = 1 / Math.sqrt(1 + sx * sx + sy * sy);
          const at = 3 * (j * COUNT + i);
          normals[at] = -sx * n;
          normals[at + 1] = -sy * n;
          normals[at + 2] = n;
        }
      }
      geometry.attributes.position.needsUpdate = true;
      geometry.attributes.normal.needsUpdate = true;
    };
    const material = new MeshStandardMaterial({
      color: "#0b3040",
      roughness: 0.16,
      metalness: 0,
      normalMap: ripples(256),
      normalScale: new Vector2(0.55, 0.55),
      envMapIntensity: 1,
    });
    return { geometry, material, update };
  }, [waves]);
  useFrame(() => {
    if (!director.ready || director.time === shownAt.current) return;
    shownAt.current = director.time;
    update(director.time);
    material.normalMap?.offset.set((director.time * 0.021) % 1, (director.time * 0.013) % 1);
  });
  return <mesh geometry={geometry} material={material} frustumCulled={false} receiveShadow />;
}

/** A normal map that tiles: many short waves of whole numbers of periods, steeper along the wind. */
function ripples(size: number): DataTexture {
  const waves: [number, number, number, number][] = [];
  let seed = 11;
  const random = () => {
    seed = (seed * 16807) % 2147483647;
    return seed / 2147483647;
  };
  while (waves.length < 56) {
    const [kx, ky] = [Math.round(random() * 44 - 22), Math.round(random() * 44 - 22)];
    const k = Math.hypot(kx, ky);
    if (k < 4 || k > 22) continue;
    waves.push([kx, ky, (0.16 + 0.1 * random()) / k ** 0.6, random() * 2 * Math.PI]);
  }
  const data = new Uint8Array(size * size * 4);
  for (let j = 0; j < size; j += 1) {
    for (let i = 0; i < size; i += 1) {
      let [sx, sy] = [0, 0];
      for (const [kx, ky, a, phase] of waves) {
        const c = a * Math.cos((2 * Math.PI * (kx * i + ky * j)) / size + phase);
        const k = Math.hypot(kx, ky);
        sx += (c * kx) / k;
        sy += (c * ky) / k;
      }
      const n = 1 / Math.sqrt(1 + sx * sx + sy * sy);
      data.set([127.5 * (1 - sx * n), 127.5 * (1 - sy * n), 127.5 * (1 + n), 255], 4 * (j * size + i));
    }
  }
  const map = new DataTexture(data, size, size, RGBAFormat);
  map.wrapS = RepeatWrapping;
  map.wrapT = RepeatWrapping;
  map.generateMipmaps = true;
  map.minFilter = LinearMipmapLinearFilter;
  map.magFilter = LinearFilter;
  map.anisotropy = 8;
  map.needsUpdate = true;
  return map;
}
