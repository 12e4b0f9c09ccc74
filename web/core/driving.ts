// The operator's two sticks: what keys and a gamepad ask for, and when nothing may be asked for (dead man).
//
// Left hand: slew and jib. Right hand: boom and hoist; pulling back hoists. A key is its own dead man's switch: the
// crane moves only while it is held. On a gamepad a button must be held besides. Losing the window, the page or the
// link drops everything, and a stick that was over when that happened does not count again until released.
import type { Axes } from "../rpc/messages";

export const AXES = ["slew", "boom", "jib", "hoist"] as const;
export type AxisName = (typeof AXES)[number];
export const ZERO: Axes = Object.freeze({ slew: 0, boom: 0, jib: 0, hoist: 0 });

/** Key (KeyboardEvent.code) to axis and sense. Positive: slew to the left, boom up, jib out, hook up. */
export const KEYS: Readonly<Record<string, readonly [AxisName, 1 | -1]>> = {
  KeyA: ["slew", 1],
  KeyD: ["slew", -1],
  KeyW: ["jib", 1],
  KeyS: ["jib", -1],
  ArrowLeft: ["boom", 1],
  ArrowRight: ["boom", -1],
  ArrowDown: ["hoist", 1],
  ArrowUp: ["hoist", -1],
  KeyJ: ["boom", 1],
  KeyL: ["boom", -1],
  KeyK: ["hoist", 1],
  KeyI: ["hoist", -1],
};

/** A standard-mapping gamepad: axes 0, 1 left stick and 2, 3 right stick (right and back positive); buttons A, RB. */
export interface Pad {
  readonly axes: readonly number[];
  readonly buttons: readonly { readonly pressed: boolean }[];
}

const DEADMAN_BUTTONS = [0, 5];
const DEAD_BAND = 0.12;
/** Share of full stick per second by which a held key moves its axis; letting go is immediate. */
const KEY_RATE = 2.5;
const FINE = 0.3;

export interface Demand {
  readonly axes: Axes;
  readonly deadman: boolean;
  readonly source: "keyboard" | "gamepad" | "none";
}

/** Stick travel without its dead band, full again at the end, squared for a fine centre. */
export function shape(travel: number): number {
  const size = Math.min(1, Math.abs(travel));
  if (!(size > DEAD_BAND)) return 0;
  const share = (size - DEAD_BAND) / (1 - DEAD_BAND);
  return Math.sign(travel) * share * share;
}

export function padAxes(pad: Pad): Axes {
  const axis = (i: number) => shape(pad.axes[i] ?? 0);
  const [slew, jib, boom, hoist] = [-axis(0), -axis(1), -axis(2), axis(3)];
  return { slew: slew || 0, jib: jib || 0, boom: boom || 0, hoist: hoist || 0 };
}

export function padHeld(pad: Pad): boolean {
  return DEADMAN_BUTTONS.some((i) => pad.buttons[i]?.pressed ?? false);
}

export class Sticks {
  private held = new Set<string>();
  private ramp: Record<AxisName, number> = { ...ZERO };
  private fine = false;
  /** After a drop the gamepad's dead man must be let go once before it counts again. */
  private padBlocked = false;

  /** Whether the key is one of the crane's (and the page should not scroll for it). */
  press(code: string): boolean {
    if (code === "ShiftLeft" || code === "ShiftRight") this.fine = true;
    if (!(code in KEYS)) return false;
    this.held.add(code);
    return true;
  }

  release(code: string): boolean {
    if (code === "ShiftLeft" || code === "ShiftRight") this.fine = false;
    return this.held.delete(code);
  }

  /** Blur, hidden page, lost link, stop key: everything to zero, and held sticks are forgotten. */
  drop(): void {
    this.held.clear();
    this.fine = false;
    this.ramp = { ...ZERO };
    this.padBlocked = true;
  }

  /** What is asked for now, `dt` seconds after the last call. */
  demand(pad: Pad | null, dt: number): Demand {
    const target: Record<AxisName, number> = { ...ZERO };
    for (const code of this.held) {
      const [axis, sense] = KEYS[code];
      target[axis] += sense;
    }
    let moved = false;
    for (const axis of AXES) {
      const wanted = Math.max(-1, Math.min(1, target[axis])) * (this.fine ? FINE : 1);
      const now = this.ramp[axis];
      const further = Math.abs(wanted) > Math.abs(now) && wanted * now >= 0;
      this.ramp[axis] = further ? now + Math.sign(wanted) * Math.min(Math.abs(wanted - now), KEY_RATE * dt) : wanted;
      if (wanted * now < 0) this.ramp[axis] = 0;
      moved ||= wanted !== 0;
    }
    if (moved) return { axes: { ...this.ramp }, deadman: true, source: "keyboard" };
    if (!pad || !padHeld(pad)) {
      this.padBlocked = false;
      return { axes: ZERO, deadman: false, source: "none" };
    }
    if (this.padBlocked) return { axes: ZERO, deadman: false, source: "none" };
    return { axes: padAxes(pad), deadman: true, source: "gamepad" };
  }
}

/**
 * When commands are sent: repeated while the dead man is held (they lapse on the server without), then a few zeros, so
 * that a lost one does not leave the crane moving until it lapses, then nothing.
 */
export class CommandRepeater {
  private zerosLeft = 0;
  private last = Number.NEGATIVE_INFINITY;

  constructor(readonly interval = 1 / 15) {}

  /** Nothing is owed any more: the controls or the link are gone. */
  forget(): void {
    this.zerosLeft = 0;
  }

  /** Whether to send now (seconds of a monotonic clock). */
  due(demand: Demand, now: number): boolean {
    if (demand.deadman) {
      // The first command goes out at once, not at the next beat.
      const first = this.zerosLeft === 0;
      this.zerosLeft = 3;
      if (!first && now - this.last < this.interval) return false;
      this.last = now;
      return true;
    }
    if (this.zerosLeft === 0) return false;
    if (this.zerosLeft < 3 && now - this.last < this.interval) return false;
    this.zerosLeft -= 1;
    this.last = now;
    return true;
  }
}
