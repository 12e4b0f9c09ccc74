// A crane on its way through the range of all its joints.
import { useEffect, useState } from "react";
import { fitting } from "../../core/design/edit";
import type { Posture } from "../../core/design/plane";
import type { Crane } from "../../core/design/types";

const PERIOD = 24;

/** The posture at a phase of 0 to 1: every joint passes both its limits, the outer ones more often; slewing turns round. */
export function swung(crane: Crane, phase: number): Posture {
  const turn = 2 * Math.PI * phase;
  const to = crane.links.map(({ joint: { name, limits } }, i) => {
    if (!limits) return [name, turn];
    const share = 0.5 - 0.5 * Math.cos(Math.max(1, i) * turn);
    return [name, limits[0] + (limits[1] - limits[0]) * share];
  });
  return fitting(crane, Object.fromEntries(to));
}

/** A phase that runs while `moving`, on from where it was put; it stands where less motion is asked for. */
export function usePhase(moving: boolean): readonly [phase: number, put: (phase: number) => void] {
  const [phase, setPhase] = useState(0);
  const [held, setHeld] = useState(false);
  // biome-ignore lint/correctness/useExhaustiveDependencies: it goes on from the phase that it has when it begins
  useEffect(() => {
    if (!moving) return setHeld(false);
    if (held || matchMedia("(prefers-reduced-motion: reduce)").matches) return;
    const begun = performance.now() - phase * PERIOD * 1e3;
    let request = 0;
    const step = (now: number) => {
      setPhase(((now - begun) / 1e3 / PERIOD) % 1);
      request = requestAnimationFrame(step);
    };
    request = requestAnimationFrame(step);
    return () => cancelAnimationFrame(request);
  }, [moving, held]);
  const put = (to: number) => {
    setHeld(true);
    setPhase(to);
  };
  return [phase, put];
}
