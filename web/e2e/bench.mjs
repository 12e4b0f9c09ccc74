// What the scripts that drive a page in a real browser share. Those of the designer are run as
// `node e2e/SCRIPT.mjs SCENARIO`, with SEACRANE_URL the address that `seacrane designer` prints, CHROMIUM the browser
// (default /usr/bin/chromium) and OUTPUT the folder of screenshots, downloads and `seen.json`, which gets what the
// scenario returns (default e2e/output). Scripts wait on the state of the page, never on time or drawn frames.
import assert from "node:assert/strict";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join } from "node:path";
import { fileURLToPath } from "node:url";
import { chromium } from "playwright-core";

/** [ms]; no page should take as long, but a busy machine that compiles a crane may. */
export const PATIENCE = 120_000;
export const output = process.env.OUTPUT ?? fileURLToPath(new URL("./output/", import.meta.url));
const url = process.env.SEACRANE_URL;

export function launch() {
  return chromium.launch({
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
}

/** Runs the scenario that the command names; it gets `open`, which gives a page with the first crane painted. */
export async function scenarios(all) {
  const name = process.argv[2];
  if (!url || !all[name]) {
    console.error(
      url
        ? `one of ${Object.keys(all).join(", ")} must be named`
        : "SEACRANE_URL must be the address that `seacrane designer` prints, with its token",
    );
    process.exit(2);
  }
  await mkdir(output, { recursive: true });
  const browser = await launch();
  const pages = [];
  const open = async (options = {}) => {
    const context = await browser.newContext({
      viewport: { width: 1280, height: 800 },
      acceptDownloads: true,
      ...options,
    });
    // of the pages that a page opens too
    context.setDefaultTimeout(PATIENCE);
    const page = await context.newPage();
    page.errors = [];
    page.on("pageerror", (error) => page.errors.push(error.message));
    pages.push(page);
    await page.goto(url);
    await painted(page);
    return page;
  };
  try {
    const seen = await all[name](open);
    for (const page of pages) assert.deepEqual(page.errors, [], "the page throws nothing");
    if (seen !== undefined) await writeFile(join(output, "seen.json"), JSON.stringify(seen));
    console.log(`ok: ${name}`);
  } catch (error) {
    console.error(
      error.stack,
      pages.flatMap((page) => page.errors),
    );
    process.exitCode = 1;
    await pages
      .at(-1)
      ?.screenshot({ path: join(output, `failed-${name}.png`) })
      .catch(() => undefined);
  } finally {
    await browser.close();
  }
}

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** Waits until `look` gives something true, and returns it. */
export async function until(what, look, patience = PATIENCE) {
  const end = Date.now() + patience;
  for (let wait = 5; ; wait = Math.min(2 * wait, 50)) {
    const seen = await look();
    if (seen) return seen;
    assert.ok(Date.now() < end, `waited ${patience / 1000} s in vain for: ${what}`);
    await pause(wait);
  }
}

/** Goes on with the tabulator until what has the focus fits, as somebody does who sees where it is. */
export async function tabTo(page, what, fits) {
  for (let steps = 0; steps < 250; steps += 1) {
    await page.keyboard.press("Tab");
    const found = await page.evaluate(() => {
      const element = document.activeElement;
      const label = element?.getAttribute("aria-label") ?? element?.labels?.[0]?.innerText ?? element?.innerText ?? "";
      const { width, height } = element?.getBoundingClientRect() ?? { width: 0, height: 0 };
      return { id: element?.getAttribute("data-testid") ?? "", label: label.trim(), seen: width * height > 0 };
    });
    assert.ok(found.seen || !fits(found), `${what} has the focus but is not seen`);
    if (fits(found)) return;
  }
  assert.fail(`the tabulator does not come to ${what}`);
}

export const raster = (page) => page.getByTestId("raster");
export const painted = (page) => page.waitForSelector("[data-testid=raster][data-painted]", { timeout: PATIENCE });
/** What a handle of the drawing says of its value. */
export const reading = (page, grip) => page.getByTestId(grip).getAttribute("aria-valuetext");
/** The loads of the curve shown, whole kilograms by band of radius. */
export const loads = (page) => page.getByTestId("curves").getAttribute("data-loads");

/** Drags a handle by pixels, in steps, and gives the times that the worker took for each chart painted meanwhile [ms]. */
export async function drag(page, grip, dx, dy, steps = 12) {
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

/** The notice, once it says something that fits. */
export const told = (page, text) =>
  until(`the page to say ${text}`, async () => {
    const notice = page.getByTestId("notice");
    return (await notice.count()) && text.test(await notice.innerText()) ? notice.innerText() : null;
  });

/** Keeps what `action` downloads in the output folder, as `name` or what the page calls it, and gives its path. */
export async function downloaded(page, action, name) {
  const [download] = await Promise.all([page.waitForEvent("download"), action()]);
  const path = join(output, name ?? download.suggestedFilename());
  await download.saveAs(path);
  return path;
}

/** The path of the design file that the page saves. */
export async function save(page, name) {
  await page.getByTestId("save-menu").click();
  return downloaded(page, () => page.getByTestId("save-json").click(), name);
}

/** The design that the page saves, parsed. */
export async function design(page) {
  return JSON.parse(await readFile(await save(page, "design.json"), "utf8"));
}

export async function choose(page, item) {
  await page.getByTestId("design-menu").click();
  await page.getByTestId(item).click();
}

/** Opens one of the ready designs; `link` is one that it has and the crane before has not. */
export async function ready(page, name) {
  await choose(page, `open-${name}`);
  await page.getByTestId(`select-${name}`).waitFor();
}

/** Gives a number of the form another value, as it is typed. */
export async function fill(page, label, value) {
  const field = page.getByTestId("details").getByLabel(label, { exact: true });
  await field.fill(value);
  await field.press("Enter");
}

/** Shows the crane in three dimensions ("both" editors, or "solid" alone) and waits until it stands there. */
export async function shown(page, view) {
  await page.getByTestId(`show-${view}`).click();
  if (view !== "section") await page.waitForSelector("[data-testid=solid] canvas[data-ready=true]");
}

/** Screenshots in both schemes of colours. */
export async function pictures(page, name) {
  for (const colorScheme of ["dark", "light"]) {
    await page.emulateMedia({ colorScheme });
    await page.screenshot({ path: join(output, `${name}-${colorScheme}.png`) });
  }
}

/** What axe finds that is serious or critical, in words. */
export async function violations(page) {
  const axe = await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
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
  await session.detach();
  return result.value
    .filter(({ impact }) => impact === "serious" || impact === "critical")
    .map(({ id, nodes }) => `${id}: ${nodes.map(({ html }) => html.slice(0, 160)).join("\n    ")}`);
}
