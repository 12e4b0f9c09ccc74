// The designer's page about the crane, in a real browser: commands, panels, links, fields. SEACRANE_URL is the address that
// `seacrane designer` prints. CHROMIUM names the browser (default /usr/bin/chromium), OUTPUT the folder of screenshots
// (default e2e/output). It waits on the state of the page, never on drawn frames.
import assert from "node:assert/strict";
import { mkdir, readFile } from "node:fs/promises";
import { createRequire } from "node:module";
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
const PATIENCE = 60_000;
const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-sync",
    "--no-first-run",
  ],
});

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** Waits until `look` gives something true, and returns it. */
async function until(what, look) {
  const end = Date.now() + PATIENCE;
  for (;;) {
    const seen = await look();
    if (seen) return seen;
    assert.ok(Date.now() < end, `waited ${PATIENCE / 1000} s in vain for: ${what}`);
    await pause(50);
  }
}

const painted = (page) => page.waitForSelector("[data-testid=raster][data-painted]", { timeout: PATIENCE });

async function open(options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, ...options });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(error.message));
  await page.goto(url);
  await painted(page);
  return page;
}

async function close(page) {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

/** Nothing that keeps people from using the page, by axe, in a world of its own where the page's rules do not hold. */
async function accessible(page, where) {
  const session = await page.context().newCDPSession(page);
  const { frameTree } = await session.send("Page.getFrameTree");
  const world = { frameId: frameTree.frame.id, worldName: "axe" };
  const { executionContextId } = await session.send("Page.createIsolatedWorld", world);
  const run = (expression) =>
    session.send("Runtime.evaluate", {
      expression,
      contextId: executionContextId,
      awaitPromise: true,
      returnByValue: true,
    });
  await run(axe);
  const { result } = await run("axe.run().then((found) => found.violations)");
  const serious = result.value
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join("\n    ")}`);
  assert.deepEqual(serious, [], `axe, ${where}`);
}

const width = async (page, panel) => Math.round((await page.locator(`#panel-${panel}`).boundingBox())?.width ?? 0);

async function gives_every_command_by_a_few_letters_and_keys_alone() {
  const page = await open();
  const palette = page.getByTestId("palette");
  const field = palette.getByRole("combobox", { name: "Find a command" });
  const focused = () =>
    until("the focus in the field", () => field.evaluate((element) => element === document.activeElement));
  const active = () =>
    page.evaluate(
      () => document.getElementById(document.activeElement.getAttribute("aria-activedescendant"))?.innerText,
    );
  await page.keyboard.press("Control+k");
  await focused();
  await accessible(page, "palette");
  await page.screenshot({ path: join(output, "page-palette.png") });
  const all = await palette.getByRole("option").count();
  assert.ok(all > 50, `${all} commands`);
  await page.keyboard.type("mech");
  await until("fewer commands", async () => (await palette.getByRole("option").count()) < 5);
  assert.match(await active(), /Mechanical/);
  await page.keyboard.press("Enter");
  await page.getByTestId("solid").waitFor();
  await until("the palette to close", async () => (await palette.count()) === 0);
  assert.equal(await page.getByTestId("show-solid").getAttribute("aria-pressed"), "true");

  await page.keyboard.press("Control+k");
  await focused();
  await page.keyboard.type("open pk65");
  await until("the crane", async () => /gunnerus/.test((await active()) ?? ""));
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("ArrowDown");
  await page.keyboard.press("Enter");
  await page.getByTestId("select-telescope").waitFor();

  // What cannot be done is said, and Enter leaves the palette open; the help leads to it too.
  await page.keyboard.press("?");
  await page.getByTestId("help-dialog").waitFor();
  await accessible(page, "help");
  assert.match(await page.getByTestId("help-dialog").innerText(), /Save the design file \(JSON\)\s*Ctrl\s*S/);
  await page.getByTestId("open-palette").click();
  await focused();
  await page.keyboard.type("redo");
  await until("redo", async () => /nothing to redo/.test((await active()) ?? ""));
  await page.keyboard.press("Enter");
  assert.equal(await palette.count(), 1);
  await page.keyboard.press("Escape");
  await until("the palette to close", async () => (await palette.count()) === 0);
  await close(page);
}

async function moves_folds_and_swaps_panels_and_remembers_them() {
  const page = await open();
  const edge = page.getByTestId("edge-panel-design");
  const [usual, results] = [await width(page, "design"), await width(page, "results")];
  await edge.focus();
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Shift+ArrowLeft");
  await until("31 pixels more", async () => (await width(page, "design")) === usual + 31);
  assert.equal(await edge.getAttribute("aria-valuenow"), String(usual + 31));

  // By the pointer, and Escape takes it back; a panel on the right grows to the left.
  const box = await page.getByTestId("edge-panel-results").boundingBox();
  const [x, y] = [box.x + 3, box.y + 100];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 100, y, { steps: 4 });
  await until("the results to grow", async () => (await width(page, "results")) === results + 100);
  await page.keyboard.press("Escape");
  await until("the results as before", async () => (await width(page, "results")) === results);
  await page.mouse.up();
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x - 80, y, { steps: 4 });
  await page.mouse.up();
  await until("the results to grow", async () => (await width(page, "results")) === results + 80);

  await page.getByTestId("panels-menu").click();
  await page.getByTestId("panel-swap").click();
  await until("the results on the left", async () => (await page.locator("#panel-results").boundingBox()).x === 0);
  await page.getByTestId("fold-design").click();
  await until("the design folded away", async () => !(await page.locator("#panel-design").isVisible()));
  await page.screenshot({ path: join(output, "page-panels.png") });
  await accessible(page, "panels");
  await page.reload();
  await painted(page);
  assert.equal(await width(page, "results"), results + 80);
  assert.equal((await page.locator("#panel-results").boundingBox()).x, 0);
  assert.equal(await page.locator("#panel-design").isVisible(), false);

  await page.getByTestId("panels-menu").click();
  await page.getByTestId("panel-reset").click();
  await until("the usual layout", async () => (await width(page, "design")) === usual);
  assert.equal(await width(page, "results"), results);

  await page.keyboard.press("2");
  const both = page.getByTestId("edge-workspace");
  await both.focus();
  await page.keyboard.press("End");
  await until("most for the workspace", async () => {
    const [section, stage] = [
      await page.getByTestId("section").boundingBox(),
      await page.locator("main").boundingBox(),
    ];
    return Math.abs(section.width / stage.width - 0.8) < 0.01;
  });
  await close(page);
}

const ALL = { gives_every_command_by_a_few_letters_and_keys_alone, moves_folds_and_swaps_panels_and_remembers_them };

try {
  for (const [claim, check] of Object.entries(ALL)) {
    await check();
    console.log(`ok: ${claim.replaceAll("_", " ")}`);
  }
} finally {
  await browser.close();
}
