import { afterEach, describe, expect, it, vi } from "vitest";
import type { StreamFrame } from "../rpc/messages";
import { LinkLost, type LinkState, RpcClient, RpcError, type Socket } from "./rpc";

/** The far end of a link, held by the test. */
class FarEnd implements Socket {
  readonly heard: { id?: number; method?: string; params?: unknown }[] = [];
  onopen: (() => void) | null = null;
  onclose: ((event: { code: number }) => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;

  send(text: string): void {
    this.heard.push(JSON.parse(text));
  }

  close(): void {
    this.onclose?.({ code: 1000 });
  }

  say(message: object): void {
    this.onmessage?.({ data: JSON.stringify({ jsonrpc: "2.0", ...message }) });
  }
}

function setUp(refused?: () => Promise<boolean>) {
  const ends: FarEnd[] = [];
  const states: LinkState[] = [];
  const frames: StreamFrame[] = [];
  const client = new RpcClient({
    open: () => {
      ends.push(new FarEnd());
      return ends[ends.length - 1];
    },
    onState: (state) => states.push(state),
    onFrame: (frame) => frames.push(frame),
    refused,
    retry: { first: 0.25, most: 1 },
  });
  return { client, ends, states, frames };
}

afterEach(() => {
  vi.useRealTimers();
});

describe("calls", () => {
  it("are answered by their id, in any order", async () => {
    const { client, ends } = setUp();
    ends[0].onopen?.();
    const [first, second] = [client.call("simulation.pause", {}), client.call("simulation.resume", {})];
    const [a, b] = ends[0].heard;
    expect([a.method, b.method]).toEqual(["simulation.pause", "simulation.resume"]);
    ends[0].say({ id: b.id, result: "second" });
    ends[0].say({ id: a.id, result: "first" });
    expect(await first).toBe("first");
    expect(await second).toBe("second");
    expect(client.latency).toBeGreaterThanOrEqual(0);
  });

  it("fail with the server's own problems", async () => {
    const { client, ends } = setUp();
    ends[0].onopen?.();
    const call = client.call("control.acquire", {});
    const problems = [{ path: "control", message: "is held by client 2", hint: "Take over." }];
    ends[0].say({ id: ends[0].heard[0].id, error: { code: -32000, message: "server", data: { problems } } });
    await expect(call).rejects.toThrow("control: is held by client 2 Take over.");
    await expect(call).rejects.toBeInstanceOf(RpcError);
  });

  it("fail when the link is lost, and at once while there is none", async () => {
    const { client, ends } = setUp();
    ends[0].onopen?.();
    const call = client.call("simulation.status", {});
    ends[0].close();
    await expect(call).rejects.toBeInstanceOf(LinkLost);
    await expect(client.call("simulation.status", {})).rejects.toBeInstanceOf(LinkLost);
  });
});

describe("frames", () => {
  it("are acknowledged and handed on", () => {
    const { ends, frames } = setUp();
    ends[0].onopen?.();
    ends[0].say({ method: "stream.frame", params: { subscription: 3, seq: 41, time: 1.5, values: [1, null] } });
    expect(ends[0].heard).toEqual([{ jsonrpc: "2.0", method: "stream.ack", params: { subscription: 3, seq: 41 } }]);
    expect(frames).toEqual([{ subscription: 3, seq: 41, time: 1.5, values: [1, null] }]);
  });
});

describe("the link", () => {
  it("is made again after it is lost, ever more patiently", async () => {
    vi.useFakeTimers();
    const { ends, states } = setUp();
    ends[0].onopen?.();
    ends[0].close();
    await vi.advanceTimersByTimeAsync(250);
    expect(ends).toHaveLength(2);
    ends[1].close();
    await vi.advanceTimersByTimeAsync(250);
    expect(ends).toHaveLength(2);
    await vi.advanceTimersByTimeAsync(250);
    expect(ends).toHaveLength(3);
    ends[2].onopen?.();
    expect(states).toEqual(["connecting", "open", "lost", "connecting", "lost", "connecting", "open"]);
  });

  it("is not tried again where the server refuses us", async () => {
    vi.useFakeTimers();
    const { ends, states } = setUp(async () => true);
    ends[0].close();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(ends).toHaveLength(1);
    expect(states).toEqual(["connecting", "refused"]);
  });

  it("stays closed when it is closed from here", async () => {
    vi.useFakeTimers();
    const { client, ends } = setUp();
    ends[0].onopen?.();
    client.close();
    await vi.advanceTimersByTimeAsync(60_000);
    expect(ends).toHaveLength(1);
  });
});
