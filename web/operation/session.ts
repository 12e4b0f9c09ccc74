// What this page knows and does, without React: the link, the model, the newest frames, the sticks.
import { createStore } from "zustand/vanilla";
import { atRest, CommandRepeater, type Demand, type Pad, Sticks } from "../core/driving";
import { History } from "../core/history";
import { type Readings, readings, wanted } from "../core/instruments";
import { takesKeys } from "../core/keys";
import { LinkLost, type LinkState, RpcClient } from "../core/rpc";
import type { ModelDescription, SimulationStatus, StreamFrame } from "../rpc/messages";

const FRAME_RATE = 60;
const LONGEST_WINDOW = 300;

export interface Page {
  link: LinkState;
  model: ModelDescription | null;
  status: SimulationStatus | null;
  latency: number | null;
  /** Frames received per second, over the last two. */
  frameRate: number;
  time: number | null;
  readings: Readings | null;
  demand: Demand;
  /** What the last attempt to take or use the controls, or a call, was answered with. */
  notice: string | null;
  plotted: readonly string[];
}

interface Sample {
  time: number;
  values: Map<string, number>;
  arrived: number;
}

const PLOTTED_AT_FIRST = ["crane.luff", "crane.rope.tension"];

export class Session {
  readonly store = createStore<Page>(() => ({
    link: "connecting",
    model: null,
    status: null,
    latency: null,
    frameRate: 0,
    time: null,
    readings: null,
    demand: { axes: {}, deadman: false, source: "none" },
    notice: null,
    plotted: recall("plotted", PLOTTED_AT_FIRST),
  }));
  readonly history = new History(LONGEST_WINDOW);

  private readonly client: RpcClient;
  /** Of no axes until the model is known. */
  private sticks = new Sticks([]);
  private readonly repeater = new CommandRepeater();
  private newest: Sample | null = null;
  private before: Sample | null = null;
  private subscribed: readonly string[] = [];
  private subscription: number | null = null;
  private arrivals: number[] = [];
  private acquiring = false;
  private lastBeat = performance.now();
  private readonly stops: (() => void)[] = [];

  constructor(address: string) {
    this.client = new RpcClient({
      open: () => new WebSocket(address) as never,
      onState: (state) => this.linkChanged(state),
      onFrame: (frame) => this.frame(frame),
      refused: async () => {
        const answer = await fetch("./", { method: "HEAD", cache: "no-store" }).catch(() => null);
        return answer !== null && (answer.status === 401 || answer.status === 403);
      },
    });
    this.listen();
    this.every(1000 / 30, () => this.beat());
    this.every(100, () => this.show());
    this.every(500, () => void this.poll());
  }

  close(): void {
    for (const stop of this.stops) stop();
    this.client.close();
  }

  // ---------------------------------------------------------------- what the scene reads
  /**
   * A reader of values for the picture at this moment: between the last two frames, reached when the next is due, so that
   * motion is even though frames arrive unevenly. Null before the first frame.
   */
  picture(now: number): { time: number; read: (name: string) => number | null } | null {
    const { newest, before } = this;
    if (!newest) return null;
    const gap = before ? newest.arrived - before.arrived : 0;
    const step = before ? newest.time - before.time : 0;
    const usable = before !== null && step > 0 && step < 0.5 && gap > 0;
    const u = usable ? Math.min(1, Math.max(0, (now - newest.arrived) / gap)) : 1;
    return {
      time: usable ? before.time + u * step : newest.time,
      read: (name) => {
        const b = newest.values.get(name);
        if (b === undefined) return null;
        const a = usable ? before.values.get(name) : undefined;
        return a === undefined ? b : a + u * (b - a);
      },
    };
  }

  // ---------------------------------------------------------------- orders
  pause(): void {
    void this.order("simulation.pause");
  }

  resume(): void {
    void this.order("simulation.resume");
  }

  reset(): void {
    void this.order("simulation.reset");
  }

  async takeOver(): Promise<void> {
    this.drop();
    await this.acquire(true);
  }

  async release(): Promise<void> {
    this.drop();
    await this.client.call("control.release", {}).catch((reason) => this.tell(reason));
    await this.poll();
  }

  /** Everything to zero now, on the server too. */
  drop(): void {
    const moving = this.store.getState().demand.deadman;
    const axes = atRest(this.store.getState().model?.axes ?? []);
    this.sticks.drop();
    this.store.setState({ demand: { axes, deadman: false, source: "none" } });
    if (moving && this.driving) {
      this.client.call("control.command", { axes, deadman: false }).catch(() => undefined);
    }
  }

  plot(name: string, on: boolean): void {
    const { plotted } = this.store.getState();
    if (plotted.includes(name) === on) return;
    const now = on ? [...plotted, name] : plotted.filter((other) => other !== name);
    remember("plotted", now);
    this.store.setState({ plotted: now });
    void this.subscribe();
  }

  dismiss(): void {
    this.store.setState({ notice: null });
  }

  // ---------------------------------------------------------------- inside
  private get driving(): boolean {
    const { status, link } = this.store.getState();
    return link === "open" && status !== null && status.driver === status.you;
  }

  private async order(method: "simulation.pause" | "simulation.resume" | "simulation.reset"): Promise<void> {
    try {
      this.learn(await this.client.call(method, {}));
      this.dismiss();
    } catch (reason) {
      this.tell(reason);
    }
  }

  private tell(reason: unknown): void {
    if (reason instanceof LinkLost) return;
    this.store.setState({ notice: reason instanceof Error ? reason.message : String(reason) });
  }

  private linkChanged(link: LinkState): void {
    this.store.setState({ link });
    if (link === "open") void this.begin();
    else {
      this.drop();
      this.subscription = null;
      this.store.setState({ status: null, latency: null });
    }
  }

  private async begin(): Promise<void> {
    try {
      const [model, status] = await Promise.all([
        this.client.call("model.describe", {}),
        this.client.call("simulation.status", {}),
      ]);
      this.sticks = new Sticks(model.axes);
      this.store.setState({ model, status });
      this.drop();
      await this.subscribe();
    } catch (reason) {
      this.tell(reason);
    }
  }

  private async subscribe(): Promise<void> {
    const { model, plotted, link } = this.store.getState();
    if (!model || link !== "open") return;
    const there = new Set(model.variables.map(({ name }) => name));
    const limits = model.variables.filter(({ name }) => isLimit(name)).map(({ name }) => name);
    const names = [...new Set([...wanted(model), ...limits, ...plotted])].filter((name) => there.has(name));
    const old = this.subscription;
    try {
      this.history.keep(plotted.filter((name) => there.has(name)));
      const { subscription } = await this.client.call("stream.subscribe", { variables: names, rate: FRAME_RATE });
      this.subscribed = names;
      this.subscription = subscription;
      if (old !== null) await this.client.call("stream.unsubscribe", { subscription: old });
    } catch (reason) {
      this.tell(reason);
    }
  }

  private frame(frame: StreamFrame): void {
    if (frame.subscription !== this.subscription) return;
    const values = new Map<string, number>();
    this.subscribed.forEach((name, i) => {
      const value = frame.values[i];
      if (value !== null && value !== undefined) values.set(name, value);
    });
    const arrived = performance.now();
    this.before = this.newest && this.newest.time < frame.time ? this.newest : null;
    this.newest = { time: frame.time, values, arrived };
    this.arrivals = [...this.arrivals.filter((at) => at > arrived - 2000), arrived];
    this.history.push(frame.time, (name) => values.get(name));
  }

  /** Ten times a second: what people read. */
  private show(): void {
    const { model } = this.store.getState();
    const { newest } = this;
    if (!model || !newest) return;
    const now = performance.now();
    const limits = model.variables.filter(({ name }) => isLimit(name)).map(({ name }) => name);
    this.store.setState({
      time: newest.time,
      frameRate: Math.round(this.arrivals.filter((at) => at > now - 2000).length / 2),
      readings: readings(model, (name) => newest.values.get(name) ?? null, limits),
    });
  }

  /** Whoever loses the controls to somebody else has let go, whatever is still held. */
  private learn(status: SimulationStatus): void {
    const lost = this.driving && status.driver !== null && status.driver !== status.you;
    this.store.setState({ status });
    if (lost) this.drop();
  }

  private async poll(): Promise<void> {
    if (this.store.getState().link !== "open") return;
    try {
      this.learn(await this.client.call("simulation.status", {}));
      this.store.setState({ latency: this.client.latency });
    } catch (reason) {
      this.tell(reason);
    }
  }

  private beat(): void {
    const now = performance.now();
    const demand = this.sticks.demand(gamepad(), (now - this.lastBeat) / 1000);
    this.lastBeat = now;
    if (!sameDemand(demand, this.store.getState().demand)) this.store.setState({ demand });
    if (!this.driving) {
      this.repeater.forget();
      if (demand.deadman) void this.acquire(false);
      return;
    }
    if (this.repeater.due(demand, now / 1000)) {
      this.client
        .call("control.command", { axes: demand.axes, deadman: demand.deadman })
        .then(({ accepted }) => {
          if (!accepted) void this.poll();
        })
        .catch(() => this.poll()); // no longer the driver: see who is
    }
  }

  private async acquire(takeOver: boolean): Promise<void> {
    const { status } = this.store.getState();
    if (this.acquiring || !status) return;
    if (!takeOver && status.driver !== null && status.driver !== status.you) {
      this.drop();
      this.store.setState({ notice: `Client ${status.driver} holds the controls. Take over to drive.` });
      return;
    }
    this.acquiring = true;
    try {
      const { driver } = await this.client.call("control.acquire", takeOver ? { take_over: true } : {});
      this.store.setState({ status: { ...(this.store.getState().status ?? status), driver }, notice: null });
    } catch (reason) {
      this.tell(reason);
      await this.poll();
    } finally {
      this.acquiring = false;
    }
  }

  private listen(): void {
    this.on(window, "keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey) {
        this.drop();
        return;
      }
      if (takesKeys(event.target)) return;
      if (event.code === "Space" && !isControl(event.target)) {
        this.drop();
        event.preventDefault();
      } else if (this.sticks.press(event.code)) {
        event.preventDefault();
        if (!event.repeat) this.beat();
      }
    });
    this.on(window, "keyup", (event) => {
      if (this.sticks.release(event.code)) this.beat();
    });
    this.on(window, "blur", () => this.drop());
    this.on(document, "visibilitychange", () => {
      if (document.hidden) this.drop();
    });
    this.on(window, "pagehide", () => this.drop());
  }

  private on(target: Window, type: "keydown" | "keyup", hear: (event: KeyboardEvent) => void): void;
  private on(target: Window | Document, type: string, hear: () => void): void;
  private on(target: EventTarget, type: string, hear: (event: never) => void): void {
    target.addEventListener(type, hear as EventListener);
    this.stops.push(() => target.removeEventListener(type, hear as EventListener));
  }

  private every(ms: number, act: () => void): void {
    const timer = setInterval(act, ms);
    this.stops.push(() => clearInterval(timer));
  }
}

export function isLimit(name: string): boolean {
  return name.startsWith("joystick.limit.");
}

function gamepad(): Pad | null {
  const pads = navigator.getGamepads?.() ?? [];
  return [...pads].find((pad) => pad?.connected && pad.axes.length >= 4) ?? null;
}

function sameDemand(a: Demand, b: Demand): boolean {
  return (
    a.deadman === b.deadman &&
    a.source === b.source &&
    Object.keys({ ...a.axes, ...b.axes }).every((name) => a.axes[name] === b.axes[name])
  );
}

function isControl(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && target.closest("button, input, a, summary") !== null;
}

function recall<T>(key: string, otherwise: T): T {
  try {
    const text = localStorage.getItem(`seacrane.${key}`);
    return text ? JSON.parse(text) : otherwise;
  } catch {
    return otherwise;
  }
}

function remember(key: string, value: unknown): void {
  try {
    localStorage.setItem(`seacrane.${key}`, JSON.stringify(value));
  } catch {
    // A browser that stores nothing still drives.
  }
}
