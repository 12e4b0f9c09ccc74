// The crane from its parts: turned, cut open, taken apart, measured, moved through its range, in its workspace.
import { Html, Line, OrbitControls } from "@react-three/drei";
import { Canvas, type ThreeEvent, useThree } from "@react-three/fiber";
import { useEffect, useMemo, useRef, useState } from "react";
import { DoubleSide, MeshStandardMaterial, Plane, Vector3 } from "three";
import { fitting } from "../../core/design/edit";
import { ofPart } from "../../core/design/mass";
import { furnished } from "../../core/design/standard";
import type { Crane } from "../../core/design/types";
import { fixed, TONNE } from "../../core/units";
import { useBench, useDesigner, useView } from "../context";
import { bounds } from "../section/window";
import { Machine } from "./Machine";
import { revolved } from "./shapes";

const PERIOD = 12;
const OPEN = 1.5 * Math.PI;
const FIELD = 32;
const FROM = new Vector3(0.5, -1, 0.42).normalize();

export default function Solid() {
  const { designer, view } = useBench();
  const crane = useDesigner((state) => state.crane);
  const held = useDesigner((state) => state.posture);
  const { explode, cut, measuring, moving, volume, centres } = useView((state) => state.tools);
  const [points, setPoints] = useState<readonly Vector3[]>([]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: each measuring begins anew
  useEffect(() => setPoints([]), [measuring]);
  const swung = useSwing(crane, moving);
  const built = useMemo(() => attempt(crane), [crane]);
  const size = useMemo(() => {
    const { low, high } = bounds(crane);
    return Math.max(high[0] - low[0], high[1] - low[1]);
  }, [crane]);
  const planes = useMemo(
    () => (cut === null ? [] : [new Plane(new Vector3(0, -1, 0), cut * 0.08 * size)]),
    [cut, size],
  );
  const parts = built?.links.reduce(
    (sum, link) => sum + (link.parts ?? []).reduce((m, part) => m + ofPart(part).mass, 0),
    0,
  );
  const whole = crane.links.reduce((sum, link) => sum + link.mass, 0);
  const measure = (event: ThreeEvent<MouseEvent>) => {
    if (!measuring) return;
    event.stopPropagation();
    setPoints((now) => (now.length === 1 ? [...now, event.point.clone()] : [event.point.clone()]));
  };
  const distance = points.length === 2 ? points[0].distanceTo(points[1]) : null;
  return (
    <section className="solid" aria-label="The crane in three dimensions" data-testid="solid">
      {built ? (
        <Canvas
          frameloop="demand"
          dpr={[1, 2]}
          gl={{ localClippingEnabled: true }}
          camera={{ up: [0, 0, 1], fov: FIELD, near: 0.1, far: 20 * size }}
          onCreated={({ gl }) => {
            gl.domElement.dataset.ready = "true";
          }}
        >
          <Redraw on={[built, held, swung, explode, cut, points, volume, centres]} />
          <ambientLight intensity={1.1} />
          <directionalLight position={[size, -size, 2 * size]} intensity={2.4} />
          <directionalLight position={[-size, size, size]} intensity={0.8} />
          <OrbitControls makeDefault />
          <Framed crane={crane} size={size} />
          <gridHelper args={[2 * Math.ceil(size), 2 * Math.ceil(size)]} rotation={[Math.PI / 2, 0, 0]}>
            <lineBasicMaterial color="#6b7d89" transparent opacity={0.28} depthWrite={false} />
          </gridHelper>
          {/* biome-ignore lint/a11y/noStaticElementInteractions: an object of the scene, not of the page */}
          <group onClick={measure}>
            <Machine
              crane={built}
              posture={swung ?? held}
              explode={explode}
              planes={planes}
              centres={centres}
              onSelect={(index, part) => {
                if (!measuring)
                  designer.select({ kind: "link", index, part: crane.links[index].parts?.length ? part : undefined });
              }}
            />
          </group>
          {volume && <Volume crane={crane} />}
          {points.map((point) => (
            <mesh key={point.toArray().join()} position={point}>
              <sphereGeometry args={[0.006 * size, 12, 8]} />
              <meshBasicMaterial color="#d6336c" depthTest={false} />
            </mesh>
          ))}
          {distance !== null && (
            <>
              <Line points={[points[0], points[1]]} color="#d6336c" lineWidth={2} depthTest={false} />
              <Html position={points[0].clone().lerp(points[1], 0.5)} center>
                <output className="distance" data-testid="distance">
                  {fixed(distance, 3)} m
                </output>
              </Html>
            </>
          )}
        </Canvas>
      ) : (
        <p className="failure">No meshes can be made from these sizes.</p>
      )}
      <div className="solid-tools">
        <Switch label="Section" on={cut !== null} onChange={(on) => view.tool({ cut: on ? 0 : null })} />
        <Switch label="Measure" on={measuring} onChange={(on) => view.tool({ measuring: on })} />
        <Switch label="Animate" on={moving} onChange={(on) => view.tool({ moving: on })} />
        <Switch label="Workspace" on={volume} onChange={(on) => view.tool({ volume: on })} />
        <Switch label="Centres" on={centres} onChange={(on) => view.tool({ centres: on })} />
        <button type="button" onClick={() => view.all()}>
          Fit
        </button>
        <label>
          Explode
          <input
            type="range"
            min={0}
            max={1}
            step={0.01}
            value={explode}
            onChange={(event) => view.tool({ explode: Number(event.currentTarget.value) })}
          />
        </label>
        {cut !== null && (
          <label>
            Cut at
            <input
              type="range"
              min={-1}
              max={1}
              step={0.01}
              value={cut}
              onChange={(event) => view.tool({ cut: Number(event.currentTarget.value) })}
            />
          </label>
        )}
      </div>
      <p className="masses">
        Links <b>{fixed(whole / TONNE, 1)} t</b> in the design, <b>{fixed((parts ?? 0) / TONNE, 1)} t</b> by their parts
      </p>
    </section>
  );
}

function Switch({ label, on, onChange }: { label: string; on: boolean; onChange: (on: boolean) => void }) {
  return (
    <button type="button" aria-pressed={on} onClick={() => onChange(!on)}>
      {label}
    </button>
  );
}

/** What of the controls is used here; the library has no type for those of a scene. */
interface Controls {
  readonly target: Vector3;
  update(): void;
  addEventListener(event: "end", hear: () => void): void;
  removeEventListener(event: "end", hear: () => void): void;
}

/** From where somebody looks; else at the whole crane from its port side, anew for another crane or another size. */
function Framed({ crane, size }: { crane: Crane; size: number }) {
  const eye = useThree((state) => state.camera);
  const controls = useThree((state) => state.controls) as Controls | null;
  const { view } = useBench();
  const invalidate = useThree((state) => state.invalidate);
  const { width, height } = useThree((state) => state.size);
  const camera = useView((state) => state.camera);
  const fits = useView((state) => state.fits);
  const extent = useRef(size);
  extent.current = size;
  // biome-ignore lint/correctness/useExhaustiveDependencies: another crane is another picture, another length is not
  useEffect(() => {
    if (!controls) return;
    if (camera) {
      eye.position.fromArray(camera.eye);
      controls.target.fromArray(camera.target);
    } else {
      const away = (0.5 * extent.current) / Math.tan((0.5 * FIELD * Math.PI) / 180) / Math.min(1, width / height);
      controls.target.set(0.22 * extent.current, 0, 0.25 * extent.current);
      eye.position.copy(FROM).multiplyScalar(away).add(controls.target);
    }
    controls.update();
    invalidate();
  }, [eye, controls, width, height, crane.name, camera, fits]);
  useEffect(() => {
    if (!controls) return;
    const end = () => view.set({ camera: { eye: eye.position.toArray(), target: controls.target.toArray() } });
    controls.addEventListener("end", end);
    return () => controls.removeEventListener("end", end);
  }, [controls, eye, view]);
  return null;
}

/** Draws when any of these changes. */
function Redraw({ on }: { on: readonly unknown[] }) {
  const invalidate = useThree((state) => state.invalidate);
  useEffect(() => invalidate(), [...on, invalidate]);
  return null;
}

function attempt(crane: Crane): Crane | null {
  try {
    return furnished(crane);
  } catch {
    return null;
  }
}

/** A posture on its way through the range of all joints, each at its own pace; null while it stands. */
function useSwing(crane: Crane, moving: boolean): Readonly<Record<string, number>> | null {
  const [posture, setPosture] = useState<Readonly<Record<string, number>> | null>(null);
  useEffect(() => {
    if (!moving) return setPosture(null);
    const begun = performance.now();
    let request = 0;
    const step = (now: number) => {
      const phase = ((now - begun) / 1e3 / PERIOD) * 2 * Math.PI;
      setPosture(
        fitting(
          crane,
          Object.fromEntries(
            crane.links.map(({ joint }, i) => {
              if (!joint.limits) return [joint.name, 0.5 * phase];
              const [low, high] = joint.limits;
              return [joint.name, low + (high - low) * (0.5 - 0.5 * Math.cos(phase * (1 + 0.35 * i)))];
            }),
          ),
        ),
      );
      request = requestAnimationFrame(step);
    };
    request = requestAnimationFrame(step);
    return () => cancelAnimationFrame(request);
  }, [crane, moving]);
  return posture;
}

const HAZE = new MeshStandardMaterial({
  color: "#2f9ed0",
  transparent: true,
  opacity: 0.22,
  side: DoubleSide,
  depthWrite: false,
});

/** The section of the workspace turned about the slewing axis; three quarters of it, to look inside. */
function Volume({ crane }: { crane: Crane }) {
  const { curves } = useBench();
  const [segments, setSegments] = useState<Float32Array | null>(null);
  useEffect(() => {
    curves
      .ask<"edge">({ kind: "edge", crane })
      .then((found) => found && setSegments(found))
      .catch(() => setSegments(null));
  }, [curves, crane]);
  const slewing = crane.links.find((link) => link.joint.name === crane.slew?.joint)?.joint;
  const shape = useMemo(() => {
    if (!segments) return null;
    const [low, high] = slewing?.limits ?? [0, OPEN];
    return crane.slew ? revolved(segments, low, high - low) : revolved(segments, -0.01, 0.02);
  }, [segments, slewing, crane.slew]);
  useEffect(() => () => shape?.dispose(), [shape]);
  return shape && <mesh geometry={shape} material={HAZE} />;
}
