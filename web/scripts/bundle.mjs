// A TypeScript module of the page with all that it imports as one JavaScript module, for Node and for bare web pages.
import { fileURLToPath } from "node:url";
import { build } from "vite";

/** Its JavaScript; `path` is relative to the folder of the page's sources. */
export async function bundle(path) {
  const root = fileURLToPath(new URL("..", import.meta.url));
  const lib = { entry: root + path, formats: ["es"], fileName: "bundle" };
  // constants stay constants, as in the worker of vite.config.ts
  const rolldownOptions = { output: { topLevelVar: false } };
  const options = { lib, write: false, rolldownOptions };
  const [{ output }] = await build({ root, configFile: false, logLevel: "error", build: options });
  return output[0].code;
}

/** The module itself, loaded into this process. */
export async function load(path) {
  return import(`data:text/javascript,${encodeURIComponent(await bundle(path))}`);
}
