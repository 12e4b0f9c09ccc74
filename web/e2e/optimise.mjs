// The search for better designs in a real browser: see bench.mjs.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { downloaded, output, scenarios, until } from "./bench.mjs";

async function searches(open) {
  const page = await open({ viewport: { width: 1280, height: 900 }, colorScheme: "light" });
  await page.getByTestId("show-optimise").click();

  const small = async (label, value) => {
    await page.getByLabel(label, { exact: true }).fill(value);
    await page.getByLabel(label, { exact: true }).press("Enter");
  };
  const generation = (n) =>
    page.waitForFunction(
      (least) => Number(document.querySelector("[data-testid=generation]")?.dataset.value) >= least,
      n,
    );
  const bore = async () => {
    await page.getByTestId("select-boom_cylinder").click();
    return page.getByTestId("details").getByLabel("Bore").inputValue();
  };

  // What cannot be searched is said in place, and the fields of the rest stay as they are.
  await small("Population", "3");
  await page.getByText("must be a whole number, 4 to 1000").waitFor();
  await small("Population", "8");
  await small("Generations", "2");
  await page.getByTestId("goal-weight").click();
  await page.getByTestId("goal-reach").click();
  await page.getByText("at least two goals").waitFor();
  assert.ok(await page.getByTestId("search-start").isDisabled());
  await page.getByTestId("goal-reach").click();
  await page.screenshot({ path: join(output, "optimise-asked.png") });

  const stands = await bore();
  await page.getByTestId("search-start").click();
  await page.getByTestId("generation").getByText("generation 2 of 2").waitFor();
  await page.waitForSelector("[data-testid=generation][data-running=false]");

  // The numbers of a point, then the design of it.
  const candidates = page.getByTestId("candidate");
  const count = await candidates.count();
  assert.ok(count >= 2, `a front of ${count}`);
  const spot = await candidates.nth(count - 1).boundingBox();
  await page.mouse.move(spot.x + spot.width / 2, spot.y + spot.height / 2);
  const numbers = page.getByTestId("candidate-numbers");
  const told = await numbers
    .getByRole("row", { name: /boom_cylinder bore/ })
    .getByRole("cell")
    .first()
    .innerText();
  assert.match(told, /^\d+ mm$/);
  await page.mouse.click(spot.x + spot.width / 2, spot.y + spot.height / 2);
  await page.waitForSelector(".front .loaded");
  assert.equal(`${Math.round(Number(await bore()))} mm`, told, "the design on the bench has the bore of the point");
  assert.notEqual(await bore(), stands);
  await page.screenshot({ path: join(output, "optimise-light.png") });
  await page.emulateMedia({ colorScheme: "dark" });
  await page.screenshot({ path: join(output, "optimise-dark.png") });

  // One step takes it back.
  await page.getByTestId("undo").click();
  assert.equal(await bore(), stands);
  assert.equal(await page.locator(".front .loaded").count(), 0);

  // A reload loses neither what was asked nor the front; the search goes on.
  await page.reload();
  await page.getByTestId("show-optimise").click();
  await generation(2);
  assert.equal(await page.getByLabel("Population", { exact: true }).inputValue(), "8");
  assert.equal(await page.getByTestId("goal-weight").getAttribute("aria-pressed"), "false");
  await page.getByRole("button", { name: "Go on for 2 more" }).click();
  await generation(3);
  await page
    .getByTestId("search-stop")
    .click({ timeout: 2000 })
    .catch(() => {});
  await page.waitForSelector("[data-testid=generation][data-running=false]");
}

async function keeps_what_was_found_when_the_server_is_lost(open) {
  const page = await open();
  await page.getByTestId("show-optimise").click();
  for (const [label, value] of [
    ["Population", "6"],
    ["Generations", "1000"],
  ]) {
    await page.getByLabel(label, { exact: true }).fill(value);
    await page.getByLabel(label, { exact: true }).press("Enter");
  }
  await page.getByTestId("search-start").click();
  const generation = async () => Number(await page.getByTestId("generation").getAttribute("data-value"));
  await until("a generation", async () => (await page.getByTestId("generation").count()) && (await generation()) > 0);
  await page.context().setOffline(true);
  await page.getByTestId("search-failure").getByText("is not known").waitFor();
  const found = await generation();
  const path = await downloaded(page, () => page.getByTestId("front-save").click());
  assert.equal(JSON.parse(await readFile(path, "utf8")).generation, found);

  // Once it is there again the page goes on by itself.
  await page.context().setOffline(false);
  await until("a later generation", async () => (await generation()) > found);
  assert.equal(await page.getByTestId("search-failure").count(), 0);
  await page.getByTestId("search-stop").click();
  await page.waitForSelector("[data-testid=generation][data-running=false]");

  // What was saved is gone on from, as by a server that was begun anew.
  await page.getByTestId("front-file").setInputFiles(path);
  await page.waitForSelector(`[data-testid=generation][data-value="${found}"][data-running=false]`);
}

await scenarios({ searches, keeps_what_was_found_when_the_server_is_lost });
