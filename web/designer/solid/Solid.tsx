// The crane from its parts: turned, cut open, taken apart, measured, moved through its range, in its workspace.
import { OrbitControls } from "@react-three/drei";
import { Canvas, type ThreeEvent, useFrame, useThree } from "@react-three/fiber";
import { useEffect, useMemo, useRef, useState } from "react";
import { Box3, DoubleSide, type Group, MeshStandardMaterial, PerspectiveCamera, Plane, Vector3 } from "three";
import { ofPart } from "../../core/design/mass";
import { furnished } from "../../core/design/standard";
import type { Crane } from "../../core/design/types";
import type { Reach } from "../../core/design/volume";
import { SOFTWARE } from "../../core/software";
import { DEGREE, fixed, symbol, TONNE } from "../../core/units";
import { useBench, useDesigner, useView } from "../context";
import { pedestal } from "../section/pedestal";
import { bounds } from "../section/window";
import { distanceToSee, FIELD } from "./framing";
import { Machine } from "./Machine";
import { Measure, Measured, onSteel } from "./Measure";
import { type Mark, places, wholeCentre } from "./places";
import { revolved } from "./shapes";
import { swung, usePhase } from "./swing";

const OPEN = 1.5 * Math.PI;
const FROM = new Vector3(0.5, -1, 0.42).normalize();
/** How far to either side of the middle a cut can be, for a crane of one metre. */
const ASIDE = 0.08;

export default function Solid() {
  const { designer, view } = useBench();
  const crane = useDesigner((state) => state.crane);
  const held = useDesigner((state) => state.posture);
  const { explode, cut, measuring, moving, volume, centres } = useView((state) => state.tools);
  const [points, setPoints] = useState<readonly Mark[]>([]);
  // biome-ignore lint/correctness/useExhaustiveDependencies: each measuring begins anew
  useEffect(() => setPoints([]), [measuring]);
  const [phase, setPhase] = usePhase(moving);
  const reach = useReach(crane, volume);
  const built = useMemo(() => attempt(crane), [crane]);
  const [size, room] = useMemo(() => {
    const { low, high } = bounds(crane);
    const across = crane.slew ? Math.max(-low[0], high[0]) : 0;
    return [
      Math.max(high[0] - low[0], high[1] - low[1]),
      new Box3(
        new Vector3(Math.min(low[0], -across), -across, low[1]),
        new Vector3(Math.max(high[0], across), across, high[1]),
      ),
    ];
  }, [crane]);
  const aside = cut === null ? 0 : cut * ASIDE * size;
  // Cut away is the half on the side from which the crane is first seen
  const planes = useMemo(() => (cut === null ? [] : [new Plane(new Vector3(0, 1, 0), -aside)]), [cut, aside]);
  const posture = useMemo(() => (moving ? swung(crane, phase) : held), [crane, moving, phase, held]);
  const at = useMemo(() => places(crane, posture), [crane, posture]);
  const content = useRef<Group>(null);
  const parts = built?.links.reduce(
    (sum, link) => sum + (link.parts ?? []).reduce((m, part) => m + ofPart(part).mass, 0),
    0,
  );
  const whole = crane.links.reduce((sum, link) => sum + link.mass, 0);
  const grid = size > 12 ? 5 : 1;
  const pick = (mark: Mark) => setPoints((now) => (now.length === 1 ? [...now, mark] : [mark]));
  const click = (event: ThreeEvent<MouseEvent>, index: number, part: number) => {
    event.stopPropagation();
    if (measuring) pick(onSteel(event, at));
    else designer.select({ kind: "link", index, part: crane.links[index].parts?.length ? part : undefined });
  };
  return (
    <section className="solid" aria-label="The crane in three dimensions" data-testid="solid">
      {built ? (
        <Canvas
          frameloop="demand"
          dpr={SOFTWARE ? 1 : [1, 2]}
          gl={{ localClippingEnabled: true, antialias: !SOFTWARE }}
          camera={{ up: [0, 0, 1], fov: FIELD }}
          onCreated={({ gl }) => {
            gl.domElement.dataset.ready = "true";
          }}
        >
          <Redraw on={[built, at, explode, cut, points, measuring, reach, centres]} />
          <ambientLight intensity={1.1} />
          <directionalLight position={[size, -size, 2 * size]} intensity={2.4} />
          <directionalLight position={[-size, size, size]} intensity={0.8} />
          <OrbitControls makeDefault />
          <gridHelper
            args={[2 * grid * Math.ceil(size / grid), 2 * Math.ceil(size / grid)]}
            rotation={[Math.PI / 2, 0, 0]}
            position={[0, 0, crane.slew ? -pedestal(crane).depth : 0]}
          >
            <lineBasicMaterial color="#6b7d89" transparent opacity={0.28} depthWrite={false} />
          </gridHelper>
          <group ref={content}>
            <Machine crane={built} at={at} explode={explode} planes={planes} centres={centres} onClick={click} />
            {reach && <Volume crane={crane} edge={reach.edge} />}
          </group>
          {measuring && <Measure crane={crane} at={at} points={points} radius={0.006 * size} onPick={pick} />}
          <Framed
            content={content}
            room={moving ? room : null}
            on={[crane.name, crane.links.length, reach !== null, moving, explode]}
          />
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
        <Slider
          label="Explode"
          shown={`${fixed(100 * explode, 0)} %`}
          value={explode}
          onChange={(value) => view.tool({ explode: value })}
        />
        {cut !== null && (
          <Slider
            label="Cut at y"
            shown={`${fixed(aside, 2)} m`}
            value={cut}
            least={-1}
            onChange={(value) => view.tool({ cut: value })}
          />
        )}
        {moving && <Slider label="Range" shown={`${fixed(100 * phase, 0)} %`} value={phase} onChange={setPhase} />}
      </div>
      <div className="solid-facts">
        {measuring && <Measured at={at} points={points} />}
        {moving && (
          <p data-testid="moved-posture" data-posture={JSON.stringify(posture)}>
            {crane.links.map(({ joint: { name, kind } }, i) => (
              <span key={name}>
                {i > 0 && ", "}
                {name}{" "}
                <b>
                  {kind === "revolute"
                    ? `${fixed((posture[name] ?? 0) / DEGREE, 0)}\u00b0`
                    : `${fixed(posture[name], 2)} m`}
                </b>
              </span>
            ))}
          </p>
        )}
        {reach && <Reached {...reach} />}
        {centres && <Centre crane={crane} centre={wholeCentre(crane, at)} />}
        <p>
          Links <b>{fixed(whole / TONNE, 1)} t</b> in the design, <b>{fixed((parts ?? 0) / TONNE, 1)} t</b> by their
          parts; grid {grid} m
        </p>
      </div>
    </section>
  );
}

const rounded = (value: number) =>
  new Intl.NumberFormat("en", { maximumSignificantDigits: 4 }).format(value).replaceAll(",", "\u202f");

function Reached({ area, volume }: Reach) {
  return (
    <p data-testid="reach" data-area={area} data-volume={volume}>
      Workspace: section{" "}
      <b>
        {rounded(area)} {symbol("m2")}
      </b>
      {volume > 0 && (
        <>
          , swept in slewing{" "}
          <b>
            {rounded(volume)} {symbol("m3")}
          </b>
        </>
      )}
    </p>
  );
}

function Centre({ crane, centre }: { crane: Crane; centre: Vector3 }) {
  return (
    <p data-testid="whole-centre" data-at={centre.toArray().join(" ")}>
      Centre of mass of {crane.links.length} links:{" "}
      {(["x", "y", "z"] as const).map((axis) => (
        <span key={axis}>
          {axis} <b>{fixed(centre[axis], 2)} m</b>{" "}
        </span>
      ))}
    </p>
  );
}

function Switch({ label, on, onChange }: { label: string; on: boolean; onChange: (on: boolean) => void }) {
  return (
    <button type="button" aria-pressed={on} onClick={() => onChange(!on)}>
      {label}
    </button>
  );
}

interface SliderProps {
  label: string;
  shown: string;
  value: number;
  least?: number;
  onChange: (value: number) => void;
}

function Slider({ label, shown, value, least = 0, onChange }: SliderProps) {
  return (
    <label>
      {label}
      <input
        type="range"
        min={least}
        max={1}
        step="any"
        value={value}
        aria-label={label}
        aria-valuetext={shown}
        onChange={(event) => onChange(Number(event.currentTarget.value))}
      />
      <b>{shown}</b>
    </label>
  );
}

/** What of the controls is used here; the library has no type for those of a scene. */
interface Controls {
  readonly target: Vector3;
  update(): void;
  addEventListener(event: "start" | "end", hear: () => void): void;
  removeEventListener(event: "start" | "end", hear: () => void): void;
}

const ORIGIN = new Vector3();

interface FramedProps {
  content: { readonly current: Group | null };
  /** To be seen as well. */
  room: Box3 | null;
  on: readonly unknown[];
}

/** From where somebody looks; else at all that there is, anew when the picture changes its size or any of `on` changes. */
function Framed({ content, room, on }: FramedProps) {
  const eye = useThree((state) => state.camera);
  const controls = useThree((state) => state.controls) as Controls | null;
  const { view } = useBench();
  const invalidate = useThree((state) => state.invalidate);
  const { width, height } = useThree((state) => state.size);
  const camera = useView((state) => state.camera);
  const fits = useView((state) => state.fits);
  // biome-ignore lint/correctness/useExhaustiveDependencies: it must not move while something is dragged
  useEffect(() => {
    if (!controls || !content.current) return;
    if (camera) {
      eye.position.fromArray(camera.eye);
      controls.target.fromArray(camera.target);
    } else {
      const box = new Box3().setFromObject(content.current);
      if (room) box.union(room);
      box.getCenter(controls.target);
      eye.position
        .copy(FROM)
        .multiplyScalar(distanceToSee(box, FROM, width / height))
        .add(controls.target);
    }
    controls.update();
    invalidate();
  }, [eye, controls, width, height, camera, fits, ...on]);
  useEffect(() => {
    if (!controls) return;
    const now = () => ({ eye: eye.position.toArray(), target: controls.target.toArray() });
    let from = now();
    const start = () => {
      from = now();
    };
    // A click alone is no other place to look from
    const end = () => {
      const to = now();
      if (JSON.stringify(to) !== JSON.stringify(from)) view.set({ camera: to });
    };
    controls.addEventListener("start", start);
    controls.addEventListener("end", end);
    return () => {
      controls.removeEventListener("start", start);
      controls.removeEventListener("end", end);
    };
  }, [controls, eye, view]);
  return null;
}

/** Draws when any of these changes; the canvas says how often it was drawn. Plates must not flicker through each other. */
function Redraw({ on }: { on: readonly unknown[] }) {
  const invalidate = useThree((state) => state.invalidate);
  const canvas = useThree((state) => state.gl.domElement);
  useEffect(() => invalidate(), [...on, invalidate]);
  useFrame(({ camera, controls }) => {
    const away = camera.position.distanceTo((controls as Controls | null)?.target ?? ORIGIN);
    if (camera instanceof PerspectiveCamera && camera.far !== 30 * away) {
      [camera.near, camera.far] = [0.02 * away, 30 * away];
      camera.updateProjectionMatrix();
    }
    canvas.dataset.drawn = String(Number(canvas.dataset.drawn ?? 0) + 1);
  });
  return null;
}

function attempt(crane: Crane): Crane | null {
  try {
    return furnished(crane);
  } catch {
    return null;
  }
}

/** What the crane reaches, once it is known; null where it is not wanted. */
function useReach(crane: Crane, wanted: boolean): Reach | null {
  const { curves } = useBench();
  const [reach, setReach] = useState<Reach | null>(null);
  useEffect(() => {
    if (!wanted) return setReach(null);
    curves
      .ask<"reach">({ kind: "reach", crane })
      .then((found) => found && setReach(found))
      .catch(() => setReach(null));
  }, [curves, crane, wanted]);
  return wanted ? reach : null;
}

const HAZE = new MeshStandardMaterial({
  color: "#2f9ed0",
  transparent: true,
  opacity: 0.22,
  side: DoubleSide,
  depthWrite: false,
});

/** The section of the workspace turned about the slewing axis; three quarters of it, to look inside. */
function Volume({ crane, edge }: { crane: Crane; edge: Float32Array }) {
  const slewing = crane.links.find((link) => link.joint.name === crane.slew?.joint)?.joint;
  const shape = useMemo(() => {
    const [low, high] = slewing?.limits ?? [0, OPEN];
    return crane.slew ? revolved(edge, low, high - low) : revolved(edge, -0.01, 0.02);
  }, [edge, slewing, crane.slew]);
  useEffect(() => () => shape.dispose(), [shape]);
  return <mesh geometry={shape} material={HAZE} raycast={() => null} />;
}
