// The operator's two sticks: what keys and a gamepad ask for, and when nothing may be asked for (dead man).
//
// Left hand: slew, and the second joint after it (a jib). Right hand: the first (the boom), and hoist; pulling back
// hoists. Further joints have pairs of keys, and the cross of the gamepad. A key is its own dead man's switch: the crane
// moves only while it is held. On a gamepad a button must be held besides. Losing the window, the page or the link drops
// everything, and a stick that was over when that happened does not count again until released.
import type { Axes } from "../rpc/messages";
import { HOIST } from "./axes";

/** A standard-mapping gamepad: axes 0, 1 left stick and 2, 3 right stick (right and back positive); buttons. */
export interface Pad {
  readonly axes: readonly number[];
  readonly buttons: readonly { readonly pressed: boolean }[];
}

/** Where an axis is: the keys (KeyboardEvent.code) for either sense, and what a gamepad asks of it. */
export interface Place {
  readonly plus: readonly string[];
  readonly minus: readonly string[];
  readonly read: (pad: Pad) => number;
}

const travel = (i: number, sense: 1 | -1) => (pad: Pad) => sense * shape(pad.axes[i] ?? 0) || 0;
const pressed = (pad: Pad, i: number) => Number(pad.buttons[i]?.pressed ?? false);

export const LEFT_ACROSS: Place = { plus: ["KeyA"], minus: ["KeyD"], read: travel(0, -1) };
export const LEFT_ALONG: Place = { plus: ["KeyW"], minus: ["KeyS"], read: travel(1, -1) };
export const RIGHT_ACROSS: Place = { plus: ["ArrowLeft", "KeyJ"], minus: ["ArrowRight", "KeyL"], read: travel(2, -1) };
export const RIGHT_ALONG: Place = { plus: ["ArrowDown", "KeyK"], minus: ["ArrowUp", "KeyI"], read: travel(3, 1) };
/** Beside the sticks: the gamepad's cross, up and down, right and left. */
export const BESIDE: readonly Place[] = [
  { plus: ["KeyQ"], minus: ["KeyE"], read: (pad) => pressed(pad, 12) - pressed(pad, 13) },
  { plus: ["KeyR"], minus: ["KeyF"], read: (pad) => pressed(pad, 15) - pressed(pad, 14) },
];

/** Where each axis is, by its name; a sixth joint and beyond have no place. */
export function places(axes: readonly string[]): Map<string, Place> {
  const found = new Map<string, Place>();
  const free = [RIGHT_ACROSS, LEFT_ALONG, ...(axes.includes("slew") ? [] : [LEFT_ACROSS]), ...BESIDE];
  for (const name of axes) {
    const place = name === HOIST ? RIGHT_ALONG : name === "slew" ? LEFT_ACROSS : free.shift();
    if (place) found.set(name, place);
  }
  return found;
}

/** All axes at rest. */
export function atRest(axes: readonly string[]): Axes {
  return Object.fromEntries(axes.map((name) => [name, 0]));
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

export function padHeld(pad: Pad): boolean {
  return DEADMAN_BUTTONS.some((i) => pad.buttons[i]?.pressed ?? false);
}

export class Sticks {
  private readonly places: Map<string, Place>;
  private readonly keys = new Map<string, readonly [axis: string, sense: 1 | -1]>();
  private readonly rest: Axes;
  private held = new Set<string>();
  private ramp: Record<string, number>;
  private fine = false;
  /** After a drop the gamepad's dead man must be let go once before it counts again. */
  private padBlocked = false;

  constructor(axes: readonly string[]) {
    this.places = places(axes);
    for (const [name, { plus, minus }] of this.places) {
      for (const code of plus) this.keys.set(code, [name, 1]);
      for (const code of minus) this.keys.set(code, [name, -1]);
    }
    this.rest = atRest(axes);
    this.ramp = { ...this.rest };
  }

  /** Whether the key is one of the crane's (and the page should not scroll for it). */
  press(code: string): boolean {
    if (code === "ShiftLeft" || code === "ShiftRight") this.fine = true;
    if (!this.keys.has(code)) return false;
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
    this.ramp = { ...this.rest };
    this.padBlocked = true;
  }

  /** What is asked for now, `dt` seconds after the last call. */
  demand(pad: Pad | null, dt: number): Demand {
    const target: Record<string, number> = { ...this.rest };
    for (const code of this.held) {
      const [axis, sense] = this.keys.get(code)!;
      target[axis] += sense;
    }
    let moved = false;
    for (const axis of Object.keys(target)) {
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
      return { axes: this.rest, deadman: false, source: "none" };
    }
    if (this.padBlocked) return { axes: this.rest, deadman: false, source: "none" };
    const axes: Record<string, number> = { ...this.rest };
    for (const [name, { read }] of this.places) axes[name] = read(pad);
    return { axes, deadman: true, source: "gamepad" };
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
