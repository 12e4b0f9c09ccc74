// Keeps package-lock.json free of addresses, so that it installs from whichever registry npm is set to, and complete:
// `npm install` accepts a missing platform package silently, `npm ci` then refuses. Run after each `npm install`.
import { readFileSync, writeFileSync } from "node:fs";

const file = new URL("../package-lock.json", import.meta.url);
const lock = JSON.parse(readFileSync(file, "utf8"));
const names = new Set(Object.keys(lock.packages).map((path) => path.split("node_modules/").pop()));
const wrong = [];
for (const [path, entry] of Object.entries(lock.packages)) {
  entry.funding = undefined;
  if (entry.resolved && !entry.link) wrong.push(`${path}: has an address; .npmrc should leave it out`);
  if (path && !entry.link && !entry.integrity) wrong.push(`${path}: has no integrity`);
  for (const name of Object.keys(entry.optionalDependencies ?? {})) {
    if (!names.has(name)) wrong.push(`${path}: its optional ${name} is not in the lock file`);
  }
}
writeFileSync(file, `${JSON.stringify(lock, null, 2)}\n`);
if (wrong.length) {
  console.error(wrong.join("\n"));
  process.exit(1);
}
console.log(`${names.size - 1} packages`);
