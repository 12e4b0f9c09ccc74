// When the scene is drawn. Where the processor draws, the simulation may need it.
import { useThree } from "@react-three/fiber";
import { useEffect } from "react";
import { SOFTWARE } from "../../core/software";
import { useDirector } from "./director";

const SHORTEST_PAUSE = 60;
const LONGEST_PAUSE = 1000;
const SHADOW_EVERY = 8;

/**
 * Draws as the simulation moves on, and nothing while it stands still; what moves the camera asks for its own frames. In
 * software a frame is followed by a pause as long as it took, and shadows are drawn only now and then.
 */
export function Economy() {
  const director = useDirector();
  const invalidate = useThree((state) => state.invalidate);
  const gl = useThree((state) => state.gl);
  useEffect(() => {
    let timer: ReturnType<typeof setTimeout>;
    let request = 0;
    let frames = 0;
    let shown = Number.NaN;
    gl.shadowMap.autoUpdate = !SOFTWARE;
    const draw = () => {
      const begun = performance.now();
      const time = director.session.picture(begun)?.time;
      if (time !== shown) {
        shown = time ?? Number.NaN;
        gl.shadowMap.needsUpdate = frames % SHADOW_EVERY === 0;
        frames += 1;
        invalidate();
      }
      if (!SOFTWARE) {
        request = requestAnimationFrame(draw);
        return;
      }
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
  }, [invalidate, gl, director]);
  return null;
}
