// Where no graphics card draws (a remote desktop, a test machine), the processor does, and the simulation may need it.
import { useThree } from "@react-three/fiber";
import { useEffect } from "react";

/** Whether WebGL is drawn in software here. */
export const SOFTWARE = drawnInSoftware();

const SHORTEST_PAUSE = 60;
const LONGEST_PAUSE = 1000;
const SHADOW_EVERY = 8;

function drawnInSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (!gl) return false;
  const info = gl.getExtension("WEBGL_debug_renderer_info");
  const name = String(info ? gl.getParameter(info.UNMASKED_RENDERER_WEBGL) : gl.getParameter(gl.RENDERER));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

/** Draws on demand: one frame, then a pause as long as the frame took, and shadows only now and then. */
export function Economy() {
  const invalidate = useThree((state) => state.invalidate);
  const gl = useThree((state) => state.gl);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout>;
    let request = 0;
    let frames = 0;
    gl.shadowMap.autoUpdate = false;
    const draw = () => {
      const begun = performance.now();
      gl.shadowMap.needsUpdate = frames % SHADOW_EVERY === 0;
      frames += 1;
      invalidate();
      // The second animation frame comes when the first has been drawn.
      request = requestAnimationFrame(() => {
        request = requestAnimationFrame(() => {
          const took = performance.now() - begun;
          timer = setTimeout(draw, Math.min(LONGEST_PAUSE, Math.max(SHORTEST_PAUSE, took)));
        });
      });
    };
    draw();
    return () => {
      clearTimeout(timer);
      cancelAnimationFrame(request);
      gl.shadowMap.autoUpdate = true;
    };
  }, [invalidate, gl]);
  return null;
}
