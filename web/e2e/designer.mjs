// The designer in a real browser against a running server: SEACRANE_URL is the address that `seacrane designer` prints.
// CHROMIUM names the browser (default /usr/bin/chromium), OUTPUT the folder of screenshots and downloads (default
// e2e/output). It waits on the state of the page, never on drawn frames.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
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
const SHIFT_Z = "Control+Shift+Z";

const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: [
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
  ],
});

const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** Waits until `look` gives something true, and returns it. */
async function until(what, look, patience = PATIENCE) {
  const end = Date.now() + patience;
  for (;;) {
    const seen = await look();
    if (seen) return seen;
    assert.ok(Date.now() < end, `waited ${patience / 1000} s in vain for: ${what}`);
    await pause(50);
  }
}

async function open(options = {}) {
  const context = await browser.newContext({
    viewport: { width: 1280, height: 800 },
    acceptDownloads: true,
    ...options,
  });
  const page = await context.newPage();
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(error.message));
  await page.goto(url);
  await painted(page);
  return page;
}

const raster = (page) => page.getByTestId("raster");
const painted = (page) => page.waitForSelector("[data-testid=raster][data-painted]", { timeout: PATIENCE });
const loads = (page) => page.getByTestId("curves").getAttribute("data-loads");
const reading = (page, grip) => page.getByTestId(grip).getAttribute("aria-valuetext");

/** Drags a handle by pixels, in steps, and gives the times that the worker took for each chart painted meanwhile [ms]. */
async function drag(page, grip, dx, dy, steps = 12) {
  const target = page.getByTestId(grip).locator("circle.target");
  let box = await target.boundingBox();
  await until(`${grip} to stand still`, async () => {
    const before = box;
    await pause(200);
    box = await target.boundingBox();
    return box.x === before.x && box.y === before.y;
  });
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const took = [];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 1; i <= steps; i += 1) {
    const before = await raster(page).getAttribute("data-painted");
    await page.mouse.move(x + (dx * i) / steps, y + (dy * i) / steps);
    await pause(30);
    if ((await raster(page).getAttribute("data-painted")) !== before)
      took.push(Number(await raster(page).getAttribute("data-took")));
  }
  await page.mouse.up();
  return took;
}

async function save(page) {
  await page.getByTestId("save-menu").click();
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByTestId("save-json").click()]);
  const path = join(output, download.suggestedFilename());
  await download.saveAs(path);
  return path;
}

/** The noticed text, once it has one that fits. */
const told = (page, text) =>
  until(`the page to say ${text}`, async () => {
    const notice = page.getByTestId("notice");
    return (await notice.count()) && text.test(await notice.innerText()) ? notice.innerText() : null;
  });

async function creates_drags_undoes_saves_and_opens_equal() {
  const page = await open();
  const first = await until("the curves of the first crane", async () => loads(page));
  await page.getByTestId("design-menu").click();
  await page.getByTestId("new").click();
  await page.getByTestId("new-dialog").getByLabel("Name").fill("tested crane");
  await page.getByTestId("new-dialog").getByLabel("Largest radius").fill("80 ft");
  await page.getByTestId("create").click();
  await page.getByTestId("select-tested crane").waitFor();
  await until("the dialog to close", async () => (await page.getByTestId("new-dialog").count()) === 0);
  await until("the curves of the new crane", async () => ![first, null].includes(await loads(page)));

  const [length, curve] = [await reading(page, "end-jib"), await loads(page)];
  const took = await drag(page, "end-jib", 60, 10);
  await until("a longer jib", async () => (await reading(page, "end-jib")) !== length);
  const longer = await reading(page, "end-jib");
  await until("another load curve", async () => (await loads(page)) !== curve);
  assert.ok(took.length > 0, "the section is painted again while dragging");

  await page.getByTestId("undo").click();
  await until("the jib as before after one undo", async () => (await reading(page, "end-jib")) === length);
  await until("the curve from before", async () => (await loads(page)) === curve);
  await page.keyboard.press(SHIFT_Z);
  await until("the longer jib after redo", async () => (await reading(page, "end-jib")) === longer);

  const path = await save(page);
  const written = JSON.parse(await readFile(path, "utf8"));
  assert.equal(written.format, "seacrane-crane/1");
  await page.getByTestId("design-menu").click();
  await page.getByTestId("open-gunnerus-pk65").click();
  await page.getByTestId("select-telescope").waitFor();
  await page.getByTestId("file").setInputFiles(path);
  await page.getByTestId("select-tested crane").waitFor();
  const again = JSON.parse(await readFile(await save(page), "utf8"));
  assert.deepEqual(again, written, "what was saved opens equal");

  assert.deepEqual(page.errors, []);
  await page.context().close();
  return took;
}

async function exports_and_imports_equal_through_the_server() {
  const page = await open();
  // Python writes out what the page leaves to its defaults: the first round makes both alike, the second must be equal
  const before = JSON.parse(await readFile(await save(page), "utf8"));
  const first = await throughArchive(page);
  for (const part of ["name", "links", "cylinders", "hoist", "rating", "capacity"])
    assert.deepEqual(subset(first.design[part], before[part]), before[part], `${part} came through the archive`);
  const second = await throughArchive(page);
  assert.deepEqual(second.design, first.design, "the archive brings the same design");
  const path = second.path;

  const torn = join(output, "torn.zip");
  await writeFile(torn, (await readFile(path)).subarray(0, 4000));
  await page.getByTestId("file").setInputFiles(torn);
  await told(page, /not a whole ZIP/);
  const odd = join(output, "odd.json");
  await writeFile(odd, JSON.stringify({ ...before, links: "none", colour: 1 }));
  await page.getByTestId("file").setInputFiles(odd);
  await told(page, /links: must be a list[\s\S]*|colour is not a field/);
  assert.equal(await page.getByTestId("select-offshore-100t").count(), 1, "the crane on the bench stays");
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

/** Exports the crane, opens another one, imports the archive, and gives the design that is then saved. */
async function throughArchive(page) {
  await page.getByTestId("save-menu").click();
  const [download] = await Promise.all([
    page.waitForEvent("download", { timeout: PATIENCE }),
    page.getByTestId("export-zip").click(),
  ]);
  const path = join(output, download.suggestedFilename());
  await download.saveAs(path);
  await page.getByTestId("design-menu").click();
  await page.getByTestId("open-a-frame-30t").click();
  await page.getByTestId("select-crossbeam").waitFor();
  await page.getByTestId("file").setInputFiles(path);
  await page.getByTestId("select-offshore-100t").waitFor();
  return { path, design: JSON.parse(await readFile(await save(page), "utf8")) };
}

/** What of `whole` there is in `part`. */
function subset(whole, part) {
  if (typeof part !== "object" || part === null) return whole;
  if (Array.isArray(part)) return whole.map((item, i) => subset(item, part[i]));
  return Object.fromEntries(Object.keys(part).map((key) => [key, subset(whole?.[key], part[key])]));
}

async function shows_what_cannot_be_built_in_place_and_in_words() {
  const page = await open();
  await page.getByTestId("select-boom_cylinder").click();
  const stroke = page.getByTestId("details").getByLabel("Stroke");
  await stroke.fill("1 m");
  await stroke.press("Enter");
  await page.getByTestId("problems").getByText("too short").waitFor();
  await page.getByTestId("details").locator(".wrong", { hasText: "too short" }).waitFor();
  await stroke.fill("420 bar");
  await stroke.press("Enter");
  await page.getByTestId("details").getByText("cannot be given in bar").waitFor();
  await stroke.press("Escape");
  await page.getByTestId("undo").click();
  await until("no problems", async () => (await page.getByTestId("problems").count()) === 0);

  await drag(page, "limit-jib-1", -40, 200, 20);
  await drag(page, "pin-boom_cylinder-eye", 300, 0);
  await page.getByTestId("problems").waitFor();
  await drag(page, "joint-boom", 0, -60);
  assert.deepEqual(page.errors, [], "an impossible crane breaks nothing");
  await page.context().close();
}

async function works_by_keyboard_alone() {
  const page = await open();
  const before = await reading(page, "joint-boom");
  await until("the tabulator at the boom's handle", async () => {
    await page.keyboard.press("Tab");
    return page.evaluate(() => document.activeElement?.getAttribute("data-testid") === "joint-boom");
  });
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("ArrowUp");
  await page.keyboard.press("Shift+ArrowUp");
  await until(`${before} and 2.1 degrees`, async () => {
    const raised = Number.parseFloat(await reading(page, "joint-boom"));
    return Math.abs(raised - Number.parseFloat(before) - 2.1) < 1e-6;
  });
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await page.keyboard.press("Control+z");
  await until("the posture from before", async () => (await reading(page, "joint-boom")) === before);
  await page.keyboard.press("?");
  await page.getByTestId("help-dialog").waitFor();
  await page.keyboard.press("Escape");
  await until("the dialog to close", async () => (await page.getByTestId("help-dialog").count()) === 0);
  await page.keyboard.press("3");
  await page.waitForSelector("[data-testid=solid] canvas[data-ready=true]", { timeout: PATIENCE });
  await page.keyboard.press("1");
  await painted(page);
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

async function steps_into_the_simulation() {
  const page = await open();
  const load = Number(await page.getByTestId("load").getAttribute("data-value"));
  const [operation] = await Promise.all([page.waitForEvent("popup"), page.getByTestId("simulate").click()]);
  await operation.locator("[data-testid=state][data-state=running]").waitFor({ timeout: PATIENCE });
  assert.ok(load > 1000, `a load of ${load} kg`);
  assert.match(await operation.locator("header.live-bar").innerText(), /offshore-100t/);
  await page.context().close();
}

async function recovers_the_work_after_a_reload() {
  const page = await open();
  await drag(page, "end-jib", 40, 0);
  const length = await reading(page, "end-jib");
  await pause(2000);
  await page.reload();
  await told(page, /Recovered the work on offshore-100t/);
  assert.equal(await reading(page, "end-jib"), length);
  await page.context().close();
}

async function has_no_serious_violation_and_looks_well() {
  const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
  for (const colorScheme of ["light", "dark"])
    for (const [width, height] of [
      [1280, 800],
      [1920, 1080],
    ]) {
      const page = await open({ viewport: { width, height }, colorScheme });
      const views = width === 1280 ? ["section", "solid"] : ["section", "both"];
      for (const view of views) {
        await page.getByTestId(`show-${view}`).click();
        if (view !== "section") await page.waitForSelector("canvas[data-ready=true]", { timeout: PATIENCE });
        await page.getByTestId("select-boom").click();
        await page.mouse.move(width / 2, 20);
        await pause(1000);
        await page.screenshot({ path: join(output, `designer-${view}-${colorScheme}-${width}.png`) });
        // in a world of its own, where the page's rules for scripts do not hold
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
        assert.deepEqual(serious, [], `axe, ${view} ${colorScheme} ${width}`);
      }
      assert.deepEqual(page.errors, []);
      await page.context().close();
    }
}

try {
  const took = (await creates_drags_undoes_saves_and_opens_equal()).sort((a, b) => a - b);
  console.log(
    `a drag's charts in the worker: least ${took[0]} ms, median ${took[took.length >> 1]} ms, ${took.length} painted`,
  );
  await exports_and_imports_equal_through_the_server();
  await shows_what_cannot_be_built_in_place_and_in_words();
  await works_by_keyboard_alone();
  await recovers_the_work_after_a_reload();
  await steps_into_the_simulation();
  await has_no_serious_violation_and_looks_well();
  console.log("all well");
} finally {
  await browser.close();
}
