// Asks the chart worker, one request at a time: while it computes, only the newest of the waiting requests is kept.
import type { Answers, Request } from "./chart.worker";

export class Charts {
  private worker: Worker;
  private waiting: { request: Request; done: (value: never) => void; failed: (reason: Error) => void }[] = [];
  private busy: (typeof this.waiting)[number] | null = null;

  constructor() {
    this.worker = this.start();
  }

  /** The answer; null if a newer request of the same kind took its place. `Error` with what the worker said. */
  ask<K extends Request["kind"]>(request: Extract<Request, { kind: K }>): Promise<Answers[K] | null> {
    return new Promise((resolve, reject) => {
      const stale = this.waiting.findIndex((item) => item.request.kind === request.kind);
      if (stale >= 0) this.waiting.splice(stale, 1)[0].done(null as never);
      this.waiting.push({ request, done: resolve as (value: never) => void, failed: reject });
      this.next();
    });
  }

  close(): void {
    this.worker.terminate();
  }

  private start(): Worker {
    const worker = new Worker(new URL("./chart.worker.ts", import.meta.url), { type: "module" });
    worker.onmessage = ({ data }: MessageEvent<{ value?: never; error?: string }>) => {
      const item = this.busy;
      this.busy = null;
      if (data.error === undefined) item?.done(data.value as never);
      else item?.failed(new Error(data.error));
      this.next();
    };
    worker.onerror = (event) => {
      this.busy?.failed(new Error(event.message || "the chart worker could not be started"));
      this.busy = null;
      this.next();
    };
    return worker;
  }

  private next(): void {
    if (this.busy) return;
    const item = this.waiting.shift();
    if (!item) return;
    this.busy = item;
    const pixels = "pixels" in item.request ? item.request.pixels : undefined;
    this.worker.postMessage(item.request, pixels ? [pixels] : []);
  }
}
