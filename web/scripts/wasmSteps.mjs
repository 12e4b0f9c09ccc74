// What a step of an exported model costs in Node: reads {module, step, names, rows, record, rounds} from the file it is
// given, runs it with the inputs `names` set to `rows[i]` before step i and `record` read after it, and prints the least
// processor time per step over the rounds [us]. `benchmarks/wasm.py` calls it.
import { readFileSync } from "node:fs";
import { load } from "./bundle.mjs";

const { module, step, names, rows, record, rounds } = JSON.parse(readFileSync(process.argv[2], "utf8"));
const { WasmModel } = await load("core/wasmModel.ts");
const instance = (await WasmModel.load(readFileSync(module))).instantiate();
const inputs = rows.map((row) => Object.fromEntries(names.map((name, i) => [name, row[i]])));

function run() {
  instance.reset();
  instance.set(inputs[0]);
  instance.initialize();
  const before = process.cpuUsage();
  for (let i = 0; i < inputs.length; i += 1) {
    instance.set(inputs[i]);
    instance.step(step, i * step);
    instance.get(record);
  }
  const { user, system } = process.cpuUsage(before);
  return (user + system) / inputs.length;
}

console.log(Math.min(...Array.from({ length: rounds }, run)));
