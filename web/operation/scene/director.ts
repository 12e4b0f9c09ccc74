// What the picture shows at this instant, computed once per drawn frame and read by every part of the scene.
import { createContext, useContext } from "react";
import { Quaternion, Vector3 } from "three";
import { linkFrames } from "../../core/crane";
import type { Frame } from "../../core/frames";
import type { ModelDescription } from "../../rpc/messages";
import type { Session } from "../session";

export class Director {
  /** Whether there is anything to show yet. */
  ready = false;
  time = 0;
  frames: Map<string, Frame> = new Map();
  readonly shipPosition = new Vector3();
  readonly shipOrientation = new Quaternion();
  /** Hook in the frame of the crane's foot. */
  readonly hook = new Vector3();
  /** Rope beyond its straight length between last sheave and hook [m]; zero when taut. */
  slack = 0;
  /** Rope off the drum [m], which turns drum and sheaves. */
  paidOut = 0;

  constructor(
    readonly session: Session,
    readonly model: ModelDescription,
  ) {}

  update(now: number): void {
    const picture = this.session.picture(now);
    if (!picture) return;
    const { crane, load } = this.model;
    const { read } = picture;
    const number = (name: string, otherwise = 0) => read(name) ?? otherwise;
    this.time = picture.time;
    const q: Record<string, number> = {};
    for (const { joint } of crane.links) q[joint.name] = number(`crane.${joint.name}`);
    this.frames = linkFrames(crane, q);
    this.shipPosition.set(number("ship.x"), number("ship.y"), number("ship.z"));
    this.shipOrientation.set(number("ship.qx"), number("ship.qy"), number("ship.qz"), number("ship.qw", 1)).normalize();
    const [tx, ty, tz] = [number("crane.tip.x"), number("crane.tip.y"), number("crane.tip.z")];
    this.hook.set(
      number("crane.load.x", tx),
      number("crane.load.y", ty),
      number("crane.load.z", tz - 2 * load.size[2]),
    );
    const taut = number("crane.rope.tension", 1) > 0;
    this.slack = taut ? 0 : Math.max(0.05, -number("crane.rope.stretch"));
    this.paidOut = number("crane.rope.unstretched_length");
    this.ready = true;
  }
}

export const DirectorContext = createContext<Director | null>(null);

export function useDirector(): Director {
  const director = useContext(DirectorContext);
  if (!director) throw new Error("the scene has no director");
  return director;
}
