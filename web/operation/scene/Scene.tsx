import { Canvas, useFrame } from "@react-three/fiber";
import { useMemo, useRef } from "react";
import { ACESFilmicToneMapping, Object3D, PCFShadowMap, Vector3 } from "three";
import { SOFTWARE } from "../../core/software";
import type { ModelDescription } from "../../rpc/messages";
import type { Session } from "../session";
import type { View } from "../views";
import { Cameras } from "./Cameras";
import { Crane } from "./Crane";
import { Director, DirectorContext } from "./director";
import { Economy } from "./economy";
import { Hoist } from "./Hoist";
import { Sea } from "./Sea";
import { Ship } from "./Ship";
import { Sky } from "./Sky";

// z is up, as in the physics.
Object3D.DEFAULT_UP.set(0, 0, 1);

const SUN = new Vector3(-0.62, 0.52, 0.55);

interface Props {
  session: Session;
  model: ModelDescription;
  view: View;
  /** Changes each time a view is asked for, so that asking again puts the camera back. */
  request: number;
  onReady: () => void;
}

export default function Scene({ session, model, view, request, onReady }: Props) {
  const director = useMemo(() => new Director(session, model), [session, model]);
  return (
    <Canvas
      shadows={{ type: PCFShadowMap }}
      dpr={SOFTWARE ? 1 : [1, 2]}
      frameloop="demand"
      camera={{ fov: 38, near: 0.4, far: 20_000, position: [-86, 53, 25] }}
      gl={{
        antialias: !SOFTWARE,
        toneMapping: ACESFilmicToneMapping,
        toneMappingExposure: 1.2,
        powerPreference: "high-performance",
      }}
    >
      <DirectorContext value={director}>
        <Conductor director={director} onReady={onReady} />
        <Economy />
        <Sky sun={SUN} />
        <Sunlight />
        <Sea />
        <Ship>
          <group position={model.crane.pedestal as [number, number, number]}>
            <Crane />
            <Hoist />
          </group>
        </Ship>
        <Cameras view={view} request={request} />
      </DirectorContext>
    </Canvas>
  );
}

/** Brings the picture up to now before anything is drawn; the canvas says how often it was. */
function Conductor({ director, onReady }: { director: Director; onReady: () => void }) {
  const told = useRef(false);
  useFrame(({ gl }) => {
    director.update(performance.now());
    gl.domElement.dataset.drawn = String(Number(gl.domElement.dataset.drawn ?? 0) + 1);
    if (director.ready && !told.current) {
      told.current = true;
      onReady();
    }
  }, -1);
  return null;
}

function Sunlight() {
  return (
    <>
      <hemisphereLight args={["#cfdde8", "#25343c", 0.35]} />
      <directionalLight
        position={[SUN.x * 120, SUN.y * 120, SUN.z * 120]}
        intensity={2.6}
        color="#fff1dc"
        castShadow
        shadow-mapSize={SOFTWARE ? [1024, 1024] : [2048, 2048]}
        shadow-camera-left={-70}
        shadow-camera-right={70}
        shadow-camera-top={60}
        shadow-camera-bottom={-60}
        shadow-camera-near={10}
        shadow-camera-far={260}
        shadow-bias={-0.0006}
        shadow-normalBias={0.06}
      />
    </>
  );
}
