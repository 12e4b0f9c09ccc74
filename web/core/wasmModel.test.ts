import { describe, expect, it } from "vitest";
import { WasmModel } from "./wasmModel";

// What a model computes is tested on an exported one, in Node and in Chromium: e2e/wasm.mjs.

const EMPTY = [0, 0x61, 0x73, 0x6d, 1, 0, 0, 0];

async function withDescription(description: unknown): Promise<Uint8Array<ArrayBuffer>> {
  const text = new Blob([JSON.stringify(description)]).stream().pipeThrough(new CompressionStream("deflate"));
  const content = [...new Uint8Array(await new Response(text).arrayBuffer())];
  const name = [...new TextEncoder().encode("seacrane")];
  const size = 1 + name.length + content.length;
  return new Uint8Array([...EMPTY, 0, (size & 0x7f) | 0x80, size >> 7, name.length, ...name, ...content]);
}

describe("a module that is no model of ours is refused", () => {
  it("when it is none at all", async () => {
    await expect(WasmModel.load(new TextEncoder().encode("<!doctype html>"))).rejects.toThrow(
      /is no WebAssembly module: .*magic/,
    );
  });

  it("when nothing describes a model in it", async () => {
    await expect(WasmModel.load(new Uint8Array(EMPTY))).rejects.toThrow("is no model exported by seacrane");
  });

  it("when it was written by a later version", async () => {
    await expect(WasmModel.load(await withDescription({ format: "seacrane-wasm/2" }))).rejects.toThrow(
      "the model has format seacrane-wasm/2; this program reads seacrane-wasm/1",
    );
  });

  it("when the server has none", async () => {
    const answer = new Response("gone", { status: 404, statusText: "Not Found" });
    await expect(WasmModel.load(answer)).rejects.toThrow("cannot be loaded: 404 Not Found");
  });
});
