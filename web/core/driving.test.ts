import { describe, expect, it } from "vitest";
import { atRest, CommandRepeater, type Demand, type Pad, places, Sticks, shape } from "./driving";

const AXES = ["slew", "boom", "jib", "hoist"];
const ZERO = atRest(AXES);

const pad = (axes: number[], ...pressed: number[]): Pad => ({
  axes,
  buttons: Array.from({ length: 16 }, (_, i) => ({ pressed: pressed.includes(i) })),
});

/** What the sticks ask for after `seconds` of the page's beat. */
function demandAfter(sticks: Sticks, seconds: number, held: Pad | null = null): Demand {
  let demand = sticks.demand(held, 0);
  for (let t = 0; t < seconds; t += 1 / 30) demand = sticks.demand(held, 1 / 30);
  return demand;
}

describe("keys", () => {
  it("raise the boom while one is held and stop it at once when it is let go", () => {
    const sticks = new Sticks(AXES);
    sticks.press("ArrowLeft");
    expect(demandAfter(sticks, 1)).toEqual({ axes: { ...ZERO, boom: 1 }, deadman: true, source: "keyboard" });
    sticks.release("ArrowLeft");
    expect(sticks.demand(null, 0)).toEqual({ axes: ZERO, deadman: false, source: "none" });
  });

  it("hoist when pulled back", () => {
    const sticks = new Sticks(AXES);
    sticks.press("ArrowDown");
    expect(demandAfter(sticks, 1).axes.hoist).toBe(1);
  });

  it("move two axes at once, and cancel where they oppose", () => {
    const sticks = new Sticks(AXES);
    for (const key of ["KeyA", "KeyW", "ArrowUp", "ArrowDown"]) sticks.press(key);
    expect(demandAfter(sticks, 1).axes).toEqual({ slew: 1, jib: 1, boom: 0, hoist: 0 });
  });

  it("grow into a movement rather than jump", () => {
    const sticks = new Sticks(AXES);
    sticks.press("KeyW");
    expect(sticks.demand(null, 0.1).axes.jib).toBeCloseTo(0.25, 9);
  });

  it("go through zero when a movement is reversed", () => {
    const sticks = new Sticks(AXES);
    sticks.press("KeyW");
    demandAfter(sticks, 1);
    sticks.release("KeyW");
    sticks.press("KeyS");
    const first = sticks.demand(null, 1 / 30).axes.jib;
    expect(first).toBe(0);
    expect(demandAfter(sticks, 1).axes.jib).toBe(-1);
  });

  it("move slowly with shift", () => {
    const sticks = new Sticks(AXES);
    sticks.press("ShiftLeft");
    sticks.press("KeyD");
    expect(demandAfter(sticks, 2).axes.slew).toBeCloseTo(-0.3, 9);
  });

  it("leave the other keys to the page", () => {
    expect(new Sticks(AXES).press("KeyQ")).toBe(false);
  });
});

describe("cranes of other types", () => {
  it("have their first joint on the right stick, their second on the left, a third beside them", () => {
    const keys = (axes: string[]) => [...places(axes)].map(([name, { plus }]) => [name, plus[0]]);
    expect(keys(["frame", "leg", "hoist"])).toEqual([
      ["frame", "ArrowLeft"],
      ["leg", "KeyW"],
      ["hoist", "ArrowDown"],
    ]);
    expect(keys(["slew", "boom", "jib", "telescope", "hoist"])).toEqual([
      ["slew", "KeyA"],
      ["boom", "ArrowLeft"],
      ["jib", "KeyW"],
      ["telescope", "KeyQ"],
      ["hoist", "ArrowDown"],
    ]);
  });

  it("are moved by their own keys and no others", () => {
    const sticks = new Sticks(["frame", "leg", "hoist"]);
    expect(sticks.press("KeyA")).toBe(false);
    sticks.press("KeyS");
    expect(demandAfter(sticks, 1).axes).toEqual({ frame: 0, leg: -1, hoist: 0 });
  });
});

describe("the dead man's switch", () => {
  it("drops every key when the page loses the focus, until it is pressed anew", () => {
    const sticks = new Sticks(AXES);
    sticks.press("ArrowLeft");
    demandAfter(sticks, 1);
    sticks.drop();
    expect(demandAfter(sticks, 1)).toEqual({ axes: ZERO, deadman: false, source: "none" });
    sticks.press("ArrowLeft");
    expect(demandAfter(sticks, 1).axes.boom).toBe(1);
  });

  it("lets a gamepad move nothing unless its button is held", () => {
    const over = [0, -1, 0, 1];
    expect(demandAfter(new Sticks(AXES), 1, pad(over))).toEqual({ axes: ZERO, deadman: false, source: "none" });
    expect(demandAfter(new Sticks(AXES), 1, pad(over, 5)).axes).toEqual({ slew: 0, jib: 1, boom: 0, hoist: 1 });
    expect(demandAfter(new Sticks(AXES), 1, pad(over, 0)).deadman).toBe(true);
  });

  it("wants a gamepad's button let go once after a drop", () => {
    const sticks = new Sticks(AXES);
    const held = pad([1, 0, 0, 0], 0);
    expect(demandAfter(sticks, 0.2, held).axes.slew).toBe(-1);
    sticks.drop();
    expect(demandAfter(sticks, 1, held).deadman).toBe(false);
    demandAfter(sticks, 0.1, pad([1, 0, 0, 0]));
    expect(demandAfter(sticks, 0.1, held).deadman).toBe(true);
  });
});

describe("a gamepad", () => {
  it("has left stick slew and jib, right stick boom and hoist, back hoists", () => {
    const { axes } = demandAfter(new Sticks(AXES), 1, pad([-1, -1, -1, 1], 0));
    expect(axes).toEqual({ slew: 1, jib: 1, boom: 1, hoist: 1 });
  });

  it("has a further joint on its cross", () => {
    const sticks = new Sticks(["slew", "boom", "jib", "telescope", "hoist"]);
    expect(demandAfter(sticks, 1, pad([0, 0, 0, 0], 0, 12)).axes.telescope).toBe(1);
    expect(demandAfter(sticks, 1, pad([0, 0, 0, 0], 0, 13)).axes.telescope).toBe(-1);
  });

  it("rests inside its dead band, and is smooth and odd beyond it", () => {
    expect(shape(0.11)).toBe(0);
    expect(shape(Number.NaN)).toBe(0);
    expect(shape(0.121)).toBeLessThan(1e-4);
    expect(shape(-0.6)).toBe(-shape(0.6));
    expect(shape(1.2)).toBe(1);
  });
});

describe("commands", () => {
  const held: Demand = { axes: { ...ZERO, boom: 1 }, deadman: true, source: "keyboard" };
  const free: Demand = { axes: ZERO, deadman: false, source: "none" };

  /** Times [s] at which a command was sent, looking 100 times a second. */
  function sent(demandAt: (t: number) => Demand, until: number): number[] {
    const repeater = new CommandRepeater();
    return Array.from({ length: until * 100 }, (_, i) => i / 100).filter((t) => repeater.due(demandAt(t), t));
  }

  it("go out at once, and 10 to 20 times a second while held", () => {
    const times = sent(() => held, 2);
    expect(times[0]).toBe(0);
    expect(times.length).toBeGreaterThanOrEqual(20);
    expect(times.length).toBeLessThanOrEqual(40);
  });

  it("end with a zero at once, repeated, and then silence", () => {
    const times = sent((t) => (t < 1 ? held : free), 3).filter((t) => t >= 1);
    expect(times[0]).toBe(1);
    expect(times).toHaveLength(3);
  });

  it("are none before anything is held", () => {
    expect(sent(() => free, 1)).toEqual([]);
  });
});
