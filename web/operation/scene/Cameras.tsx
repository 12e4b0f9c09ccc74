import { OrbitControls } from "@react-three/drei";
import { useFrame, useThree } from "@react-three/fiber";
import { type ComponentRef, useEffect, useMemo, useRef } from "react";
import { MathUtils, Matrix4, type PerspectiveCamera, Vector3 } from "three";
import { FOOT } from "../../core/design/types";
import type { View } from "../views";
import { EYE, toMatrix } from "./Crane";
import { useDirector } from "./director";

type Controls = ComponentRef<typeof OrbitControls>;

const FIELD = 38;

/** Orbit camera with presets; two of them ride along: the operator's eyes with the column, the hook view with the load. */
export function Cameras({ view, request }: { view: View; request: number }) {
  const director = useDirector();
  const controls = useRef<Controls>(null);
  const camera = useThree((state) => state.camera) as PerspectiveCamera;
  const size = useThree((state) => state.size);
  const invalidate = useThree((state) => state.invalidate);
  const foot = useMemo(() => new Vector3(...director.model.crane.pedestal), [director]);
  const placed = useRef("");
  const scratch = useMemo(
    () => ({
      m: new Matrix4(),
      ship: new Matrix4(),
      hook: new Vector3(),
      last: new Vector3(),
      eye: new Vector3(),
      look: new Vector3(),
    }),
    [],
  );

  useEffect(() => {
    // A narrow picture keeps the width of the scene in view.
    camera.fov = size.width < size.height * 1.35 ? FIELD * 1.25 : FIELD;
    camera.near = 0.4;
    camera.far = 20_000;
    camera.updateProjectionMatrix();
  }, [camera, size]);

  // biome-ignore lint/correctness/useExhaustiveDependencies: another view is drawn even of a scene that stands still
  useEffect(() => invalidate(), [invalidate, view, request]);

  useFrame(() => {
    if (!director.ready) return;
    const { m, ship, hook, last, eye, look } = scratch;
    const orbit = controls.current;
    ship.compose(director.shipPosition, director.shipOrientation, new Vector3(1, 1, 1));
    hook.copy(director.hook).add(foot).applyMatrix4(ship);
    const key = `${view}:${request}`;
    const fresh = placed.current !== key;
    placed.current = key;
    if (view === "cab") {
      const { crane, axes } = director.model;
      const column = director.frames.get(axes[0] === "slew" ? crane.links[0].name : FOOT);
      if (!column) return;
      m.copy(ship).multiply(new Matrix4().makeTranslation(foot)).multiply(toMatrix(column, new Matrix4()));
      eye.set(...EYE).applyMatrix4(m);
      camera.position.copy(eye);
      // The operator watches the hook, and turns the head a little towards it, not all the way.
      look.set(EYE[0] + 30, EYE[1] - 1.2, EYE[2] + 1).applyMatrix4(m);
      look.lerp(hook, 0.75).z -= 2.5;
      camera.up.set(0, 0, 1).applyQuaternion(director.shipOrientation);
      camera.lookAt(look);
      camera.fov = MathUtils.damp(camera.fov, 62, fresh ? 1e9 : 4, 0.016);
      camera.updateProjectionMatrix();
      return;
    }
    camera.up.set(0, 0, 1);
    if (!orbit) return;
    if (fresh) {
      const { position, target } = place(view, foot, hook);
      camera.fov = size.width < size.height * 1.35 ? FIELD * 1.25 : FIELD;
      camera.updateProjectionMatrix();
      camera.position.copy(position);
      orbit.target.copy(target);
      orbit.update();
    } else if (view === "hook") {
      look.copy(hook).sub(last);
      camera.position.add(look);
      orbit.target.add(look);
      orbit.update();
    }
    last.copy(hook);
  });
  return (
    <OrbitControls
      ref={controls}
      enabled={view !== "cab"}
      enableDamping={false}
      minDistance={6}
      maxDistance={420}
      maxPolarAngle={Math.PI * 0.56}
    />
  );
}

function place(view: View, foot: Vector3, hook: Vector3): { position: Vector3; target: Vector3 } {
  const at = (x: number, y: number, z: number) => new Vector3(foot.x + x, foot.y + y, z);
  const out = Math.sign(foot.y) || 1;
  if (view === "side") return { position: at(-78, out * 12, 16), target: at(0, out * 9, 14.5) };
  if (view === "deck") return { position: at(-23, -out * 13.5, 6), target: at(2, out * 9, 15.5) };
  if (view === "hook") {
    const back = new Vector3(hook.x - foot.x, hook.y - foot.y, 0).normalize();
    const side = new Vector3(-back.y, back.x, 0);
    return {
      position: hook
        .clone()
        .addScaledVector(back, 12)
        .addScaledVector(side, 20)
        .add(new Vector3(0, 0, 6)),
      target: hook.clone().add(new Vector3(0, 0, -2)),
    };
  }
  return { position: at(-69, out * 48, 26), target: at(9, out * 4, 13.2) };
}
