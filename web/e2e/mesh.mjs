// A mesh of another program as a part of a link, in a real browser: SEACRANE_URL is the address that `seacrane designer`
// prints. CHROMIUM names the browser (default /usr/bin/chromium), OUTPUT the folder of screenshots.
import assert from "node:assert/strict";
import { mkdir } from "node:fs/promises";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

const url = process.env.SEACRANE_URL;
if (!url) {
  console.error("SEACRANE_URL must be the address that `seacrane designer` prints, with its token");
  process.exit(2);
}
const output = process.env.OUTPUT ?? fileURLToPath(new URL("./output/", import.meta.url));
await mkdir(output, { recursive: true });

/** An ASCII STL of a box of 2000 x 2000 x 2500; without its first side it is open. */
function box(closed) {
  const at = (i) => [2000 * (i & 1) - 1000, 1000 * (i & 2) - 1000, 625 * (i & 4)].join(" ");
  const sides = ["0 2 3 1", "4 5 7 6", "0 1 5 4", "2 6 7 3", "0 4 6 2", "1 3 7 5"].slice(closed ? 0 : 1);
  const facets = sides.flatMap((side) => {
    const [a, b, c, d] = side.split(" ");
    return [
      [a, b, c],
      [a, c, d],
    ];
  });
  const text = facets.map(
    (facet) => `facet normal 0 0 0\nouter loop\n${facet.map((i) => `vertex ${at(i)}\n`).join("")}endloop\nendfacet\n`,
  );
  return Buffer.from(`solid box\n${text.join("")}endsolid box\n`);
}

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-background-networking", "--disable-sync", "--no-first-run"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, colorScheme: "light" });
  page.setDefaultTimeout(30_000);
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(url);
  await page.getByTestId("select-column").click();
  const give = (name, buffer) =>
    page.getByTestId("mesh-file").setInputFiles({ name, mimeType: "application/octet-stream", buffer });

  // An STL has no unit, so the page asks for it; what is not closed has no mass and is refused in place.
  await give("open.stl", box(false));
  await page.getByTestId("mesh-mm").click();
  await page.getByTestId("mesh-refused").filter({ hasText: "is not closed" }).waitFor();
  await give("words.glb", Buffer.from("these are words"));
  await page.getByTestId("mesh-refused").filter({ hasText: "cannot be read as a mesh" }).waitFor();

  // 2 m x 2 m x 2.5 m of steel.
  await give("cabin.stl", box(true));
  await page.getByTestId("mesh-mm").click();
  await page.getByRole("button", { name: /cabin\s*mesh, 78\.50 t/ }).waitFor();
  assert.equal(await page.getByTestId("mesh-refused").count(), 0);
  await page.screenshot({ path: join(output, "mesh.png") });

  await page.getByTestId("undo").click();
  await page.getByRole("button", { name: /cabin\s*mesh/ }).waitFor({ state: "detached" });
  assert.deepEqual(errors, []);
  console.log("ok: refused, taken, undone");
} finally {
  await browser.close();
}
