// The search for better designs in a real browser: SEACRANE_URL is the address that `seacrane designer` prints. CHROMIUM
// names the browser (default /usr/bin/chromium), OUTPUT the folder of screenshots (default e2e/output).
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
const PATIENCE = 30_000;

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--disable-background-networking", "--disable-sync", "--no-first-run"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, colorScheme: "light" });
  page.setDefaultTimeout(PATIENCE);
  const errors = [];
  page.on("pageerror", (error) => errors.push(error.message));
  await page.goto(url);
  await page.getByTestId("show-optimise").click();

  const small = async (label, value) => {
    await page.getByLabel(label, { exact: true }).fill(value);
    await page.getByLabel(label, { exact: true }).press("Enter");
  };
  const generation = (n) =>
    page.waitForFunction(
      (least) => Number(document.querySelector("[data-testid=generation]")?.dataset.value) >= least,
      n,
      { timeout: PATIENCE },
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
  await generation(2);
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
  assert.deepEqual(errors, []);
  console.log("ok: search, front, take, undo, reload, go on");
} finally {
  await browser.close();
}
