// Meshes of other programs as parts of a link, in a real browser: see bench.mjs.
import assert from "node:assert/strict";
import { join } from "node:path";
import { output, scenarios } from "./bench.mjs";

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

async function takes_a_mesh_in_its_unit_or_refuses_it(open) {
  const page = await open({ viewport: { width: 1280, height: 900 }, colorScheme: "light" });
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
}

await scenarios({ takes_a_mesh_in_its_unit_or_refuses_it });
