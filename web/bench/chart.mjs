// Time of the load chart of every shipped design, in harbour and at sea, in this process: `npm run bench`, or
// `npm run bench -- 40` for the shortest of 40 runs each. Run it on a quiet machine.
import { readdir, readFile } from "node:fs/promises";
import { load } from "../scripts/bundle.mjs";

const { measure } = await load("bench/chart.ts");
const folder = new URL("../../src/seacrane/design/cranes/", import.meta.url);
const files = (await readdir(folder)).filter((name) => name.endsWith(".json")).sort();
const designs = await Promise.all(files.map(async (name) => JSON.parse(await readFile(new URL(name, folder), "utf8"))));
const rows = measure(designs, Number(process.argv[2] ?? 15));
const head = ["design", "mode", "360k ms", "1M ms", "plain/this", "off", "section ms", "postures", "event ms"];
const cells = rows.map(({ design, mode, grids, ratio, off, section, postures, event }) => [
  design,
  mode,
  ...grids.map((time) => time.toFixed(1)),
  ratio.toFixed(0),
  off.toExponential(0),
  section.toFixed(1),
  String(postures),
  event.toFixed(1),
]);
const widths = head.map((title, i) => Math.max(title.length, ...cells.map((row) => row[i].length)));
for (const row of [head, ...cells])
  console.log(row.map((text, i) => (i < 2 ? text.padEnd(widths[i]) : text.padStart(widths[i]))).join("  "));
