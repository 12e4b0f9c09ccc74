import { afterEach, beforeEach, describe, expect, it, vi } from "vitest";
import fixture from "../../tests/fixtures/crane_kinematics.json";
import { Session } from "./session";

// The simulation at the far end of the link, as far as these claims need it.
class Server {
  static newest: Server;
  driver: number | null = null;
  calls: { id?: number; method: string; params: Record<string, unknown> }[] = [];
  onopen: (() => void) | null = null;
  onclose: ((event: { code: number }) => void) | null = null;
  onmessage: ((event: { data: unknown }) => void) | null = null;

  constructor() {
    Server.newest = this;
    queueMicrotask(() => this.onopen?.());
  }

  send(text: string): void {
    const call = JSON.parse(text);
    this.calls.push(call);
    if (call.method === "control.acquire") this.driver = 1;
    const result = {
      "simulation.status": { time: 0, running: true, error: null, driver: this.driver, you: 1 },
      "model.describe": {
        crane: fixture.crane,
        axes: ["slew", "boom", "jib", "hoist"],
        variables: ["crane.luff", "crane.rope.tension"].map((name) => ({
          name,
          unit: "1",
          shown: "1",
          factor: 1,
          about: "",
        })),
      },
      "stream.subscribe": { subscription: 1, rate: 60 },
      "control.acquire": { driver: 1, lease: 5 },
      "control.command": { accepted: true },
    }[call.method as string];
    if (call.id)
      queueMicrotask(() => this.onmessage?.({ data: JSON.stringify({ id: call.id, result: result ?? {} }) }));
  }

  close(): void {
    this.onclose?.({ code: 1000 });
  }

  get commands(): { axes: Record<string, number>; deadman: boolean }[] {
    return this.calls.filter(({ method }) => method === "control.command").map(({ params }) => params as never);
  }
}

const key = (type: string, code: string) => window.dispatchEvent(new KeyboardEvent(type, { code }));

describe("the operator's page", () => {
  let session: Session;

  beforeEach(async () => {
    vi.useFakeTimers();
    vi.stubGlobal("WebSocket", Server);
    localStorage.clear();
    session = new Session("ws://server/rpc");
    await vi.advanceTimersByTimeAsync(600);
  });

  afterEach(() => {
    session.close();
    vi.unstubAllGlobals();
    vi.useRealTimers();
  });

  it("takes the free controls at the first key and repeats its command 10 to 20 times a second", async () => {
    key("keydown", "ArrowLeft");
    await vi.advanceTimersByTimeAsync(1000);
    const { commands } = Server.newest;
    expect(commands.length).toBeGreaterThanOrEqual(10);
    expect(commands.length).toBeLessThanOrEqual(20);
    expect(commands.at(-1)).toEqual({ axes: { slew: 0, boom: 1, jib: 0, hoist: 0 }, deadman: true });
  });

  it.each([
    ["the window loses the focus", () => window.dispatchEvent(new Event("blur"))],
    ["the page is left", () => window.dispatchEvent(new Event("pagehide"))],
    ["space is pressed", () => key("keydown", "Space")],
    ["the key is let go", () => key("keyup", "ArrowLeft")],
  ])("commands zero at once when %s", async (_, happen) => {
    key("keydown", "ArrowLeft");
    await vi.advanceTimersByTimeAsync(500);
    happen();
    expect(Server.newest.commands.at(-1)).toEqual({ axes: { slew: 0, boom: 0, jib: 0, hoist: 0 }, deadman: false });
    await vi.advanceTimersByTimeAsync(1000);
    expect(Server.newest.commands.at(-1)?.deadman).toBe(false);
  });

  it("does not drive while somebody else does, nor on when they let go", async () => {
    Server.newest.driver = 2;
    await vi.advanceTimersByTimeAsync(600);
    key("keydown", "ArrowLeft");
    await vi.advanceTimersByTimeAsync(300);
    expect(session.store.getState().notice).toContain("Client 2 holds the controls");
    Server.newest.driver = null;
    await vi.advanceTimersByTimeAsync(2000);
    expect(Server.newest.commands).toEqual([]);
  });

  it("lets go when somebody takes over in the middle of a movement", async () => {
    key("keydown", "ArrowLeft");
    await vi.advanceTimersByTimeAsync(500);
    Server.newest.driver = 2;
    await vi.advanceTimersByTimeAsync(600);
    expect(session.store.getState().demand.deadman).toBe(false);
  });

  it("forgets held keys when the link is lost, and asks for everything again when it is back", async () => {
    key("keydown", "ArrowLeft");
    await vi.advanceTimersByTimeAsync(300);
    Server.newest.close();
    expect(session.store.getState().demand.deadman).toBe(false);
    await vi.advanceTimersByTimeAsync(1500);
    expect(session.store.getState().link).toBe("open");
    const asked = Server.newest.calls.map(({ method }) => method);
    expect(asked).toContain("model.describe");
    expect(asked).toContain("stream.subscribe");
    expect(asked).not.toContain("control.command");
  });

  it("leaves keys to a field that is typed in", async () => {
    const field = document.body.appendChild(document.createElement("input"));
    field.dispatchEvent(new KeyboardEvent("keydown", { code: "KeyA", bubbles: true }));
    await vi.advanceTimersByTimeAsync(300);
    expect(Server.newest.commands).toEqual([]);
    field.remove();
  });
});
