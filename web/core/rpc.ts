// JSON-RPC 2.0 over a WebSocket: calls as promises, frames acknowledged, the link re-made when it is lost.
import type { Methods, Problem, StreamFrame } from "../rpc/messages";

export type LinkState = "connecting" | "open" | "lost" | "refused";

export class RpcError extends Error {
  constructor(
    readonly code: number,
    message: string,
    readonly problems: readonly Problem[] = [],
  ) {
    super(problems.length ? problems.map(describe).join("; ") : message);
  }
}

export class LinkLost extends Error {
  constructor() {
    super("the link to the server was lost before it answered");
  }
}

function describe({ path, message, allowed, hint }: Problem): string {
  return [path && `${path}:`, message, allowed && `(allowed: ${allowed})`, hint].filter(Boolean).join(" ");
}

/** The part of the browser's WebSocket that is used. */
export interface Socket {
  send(text: string): void;
  close(): void;
  onopen: (() => void) | null;
  onclose: ((event: { code: number }) => void) | null;
  onmessage: ((event: { data: unknown }) => void) | null;
}

export interface RpcOptions {
  open: () => Socket;
  onState: (state: LinkState) => void;
  onFrame: (frame: StreamFrame) => void;
  /** Asked when a link was never opened: whether the server refuses us (no valid token), so that trying is of no use. */
  refused?: () => Promise<boolean>;
  /** Seconds to the next try; it grows after each failure. */
  retry?: { first: number; most: number };
}

interface Pending {
  resolve: (result: never) => void;
  reject: (reason: Error) => void;
  sent: number;
}

export class RpcClient {
  private socket: Socket | null = null;
  private pending = new Map<number, Pending>();
  private nextId = 1;
  private delay: number;
  private timer: ReturnType<typeof setTimeout> | null = null;
  private closed = false;
  private trips: number[] = [];
  private readonly retry: { first: number; most: number };

  constructor(private readonly options: RpcOptions) {
    this.retry = options.retry ?? { first: 0.25, most: 4 };
    this.delay = this.retry.first;
    this.connect();
  }

  /** Median round trip [ms] of the last calls; null before the first. */
  get latency(): number | null {
    if (this.trips.length === 0) return null;
    const sorted = [...this.trips].sort((a, b) => a - b);
    return sorted[Math.floor(sorted.length / 2)];
  }

  call<M extends keyof Methods>(method: M, params: Methods[M][0]): Promise<Methods[M][1]> {
    const { socket } = this;
    if (!socket) return Promise.reject(new LinkLost());
    const id = this.nextId;
    this.nextId += 1;
    return new Promise((resolve, reject) => {
      this.pending.set(id, { resolve: resolve as Pending["resolve"], reject, sent: performance.now() });
      socket.send(JSON.stringify({ jsonrpc: "2.0", id, method, params }));
    });
  }

  close(): void {
    this.closed = true;
    if (this.timer) clearTimeout(this.timer);
    this.socket?.close();
  }

  private connect(): void {
    this.options.onState("connecting");
    const socket = this.options.open();
    let opened = false;
    socket.onopen = () => {
      opened = true;
      this.socket = socket;
      this.delay = this.retry.first;
      this.options.onState("open");
    };
    socket.onmessage = ({ data }) => this.receive(String(data));
    socket.onclose = () => {
      this.socket = null;
      const waiting = [...this.pending.values()];
      this.pending.clear();
      this.trips = [];
      for (const { reject } of waiting) reject(new LinkLost());
      if (!this.closed) void this.lost(opened);
    };
  }

  private async lost(opened: boolean): Promise<void> {
    if (!opened && (await this.options.refused?.())) {
      this.options.onState("refused");
      return;
    }
    this.options.onState("lost");
    if (this.closed) return;
    this.timer = setTimeout(() => this.connect(), this.delay * 1000);
    this.delay = Math.min(this.delay * 2, this.retry.most);
  }

  private receive(text: string): void {
    const message = JSON.parse(text);
    if (message.method === "stream.frame") {
      const frame: StreamFrame = message.params;
      const ack = { subscription: frame.subscription, seq: frame.seq };
      this.socket?.send(JSON.stringify({ jsonrpc: "2.0", method: "stream.ack", params: ack }));
      this.options.onFrame(frame);
      return;
    }
    const waiting = this.pending.get(message.id);
    if (!waiting) return;
    this.pending.delete(message.id);
    this.trips = [...this.trips.slice(-8), performance.now() - waiting.sent];
    if (message.error) {
      const { code, message: said, data } = message.error;
      waiting.reject(new RpcError(code, said, data?.problems));
    } else waiting.resolve(message.result as never);
  }
}
