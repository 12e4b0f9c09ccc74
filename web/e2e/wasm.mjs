// An exported model in Node and in a real browser. MODULE is the module, PLAN the file that says what to run, and RESULT
// the file that gets what `run` of wasmDrive.mjs returned in each; CHROMIUM names the browser (default /usr/bin/chromium).
import { readFile, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { chromium } from "playwright-core";
import { bundle, load } from "../scripts/bundle.mjs";
import { run } from "./wasmDrive.mjs";

const wrapper = "core/wasmModel.ts";
const module = await readFile(process.env.MODULE);
const plan = await readFile(process.env.PLAN, "utf8");

const { WasmModel } = await load(wrapper);
const inNode = await run(WasmModel, module, JSON.parse(plan));

const files = {
  "/": ["text/html", "<!doctype html><title>model</title>"],
  "/wasmModel.js": ["text/javascript", await bundle(wrapper)],
  "/wasmDrive.js": ["text/javascript", await readFile(new URL("./wasmDrive.mjs", import.meta.url))],
  "/model.wasm": ["application/wasm", module],
  "/plan.json": ["application/json", plan],
};
const server = createServer(({ url }, response) => {
  const [type, content] = files[url] ?? ["text/plain", null];
  response.writeHead(content === null ? 404 : 200, { "content-type": type }).end(content);
});
await new Promise((ready) => server.listen(0, "127.0.0.1", ready));
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-background-networking", "--disable-component-update", "--disable-sync"],
});
try {
  const page = await browser.newPage();
  await page.goto(`http://127.0.0.1:${server.address().port}/`);
  const inBrowser = await page.evaluate(async () => {
    const { WasmModel } = await import("/wasmModel.js");
    const { run } = await import("/wasmDrive.js");
    const missing = await WasmModel.load(await fetch("/nothing.wasm")).catch((error) => error.message);
    if (!missing.endsWith("/nothing.wasm cannot be loaded: 404 Not Found")) throw new Error(missing);
    return run(WasmModel, await fetch("/model.wasm"), await (await fetch("/plan.json")).json());
  });
  await writeFile(process.env.RESULT, JSON.stringify({ node: inNode, chromium: inBrowser }));
} finally {
  await browser.close();
  server.close();
}
