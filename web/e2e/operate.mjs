// The page in a real browser against a running server: SEACRANE_URL is the address that `seacrane demo` prints.
// CHROMIUM names the browser (default /usr/bin/chromium), OUTPUT the folder of screenshots and downloads (default
// e2e/output). It waits on the state of the page, never on drawn frames, which are few where the processor draws.
import assert from "node:assert/strict";
import { mkdir, readFile } from "node:fs/promises";
import { join } from "node:path";
import { launch, output, PATIENCE, pause, until } from "./bench.mjs";

const url = process.env.SEACRANE_URL;
if (!url) {
  console.error("SEACRANE_URL must be the address that `seacrane demo` prints, with its token");
  process.exit(2);
}
const origin = new URL(url).origin;
const RADIAN = Math.PI / 180;

const browser = await launch();

// ---------------------------------------------------------------- reading the page
async function value(page, id) {
  const text = await page.getByTestId(id).getAttribute("data-value");
  return text === null ? Number.NaN : Number(text);
}

/** While a second of simulated time goes by. */
async function aSecond(page) {
  const t = await value(page, "sim-time");
  await until("a second of simulated time", async () => (await value(page, "sim-time")) > t + 1);
}

/** A reading that changes by less than `tolerance` while a second of simulated time goes by. */
async function settled(page, id, tolerance) {
  return until(`${id} to settle within ${tolerance}`, async () => {
    const before = await value(page, id);
    await aSecond(page);
    const after = await value(page, id);
    return Math.abs(after - before) < tolerance ? { value: after } : null;
  }).then(({ value }) => value);
}

/** What is drawn in software takes the longer the larger it is; pictures to look at are taken at the end. */
const SMALL = { width: 1280, height: 480 };

async function open(address, options = {}) {
  const context = await browser.newContext({
    viewport: SMALL,
    acceptDownloads: true,
    ...options,
  });
  context.setDefaultTimeout(PATIENCE);
  const page = await context.newPage();
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(error.message));
  await page.goto(address);
  await page.waitForSelector("[data-testid=scene][data-ready=true]", { timeout: PATIENCE });
  await steady(page);
  return page;
}

/** The link holds and time runs on: compiling shaders may stall a page for so long that the server lets it go once. */
async function steady(page) {
  const running = async () => (await page.getByTestId("state").getAttribute("data-state")) === "running";
  await until("a steady link", async () => {
    await until("the page to run", running);
    await aSecond(page);
    return running();
  });
}

async function csvOf(page, button) {
  const waiting = page.waitForEvent("download");
  await page.getByTestId(button).click();
  const download = await waiting;
  const path = join(output, download.suggestedFilename());
  await download.saveAs(path);
  const [header, ...lines] = (await readFile(path, "utf8")).trim().split("\n");
  return { header: header.split(","), rows: lines.map((line) => line.split(",").map(Number)) };
}

// ---------------------------------------------------------------- what must hold
const tests = [];
const test = (claim, run) => tests.push({ claim, run });

let first;

test("without the token there is no page", async () => {
  const context = await browser.newContext();
  const page = await context.newPage();
  const answer = await page.goto(`${origin}/`);
  assert.ok([401, 403].includes(answer.status()), `the server answered ${answer.status()}`);
  await context.close();
});

test("the page shows the crane, running, with every instrument alive", async () => {
  first = await open(url);
  for (const id of ["slew", "boom", "jib", "load", "radius", "rated", "utilisation", "hook-height", "wire-speed"]) {
    assert.ok(Number.isFinite(await value(first, `reading-${id}`)), `${id} shows no number`);
  }
  for (const id of ["boom", "jib"]) assert.ok((await value(first, `pressure-${id}`)) > 10, `no pressure in the ${id}`);
});

test("a held key raises the boom, and letting go stops it", async () => {
  const rest = await settled(first, "reading-boom", 0.1);
  await first.keyboard.down("ArrowLeft");
  await until(
    "the dead man's lamp",
    async () => (await first.getByTestId("deadman").getAttribute("data-on")) === "true",
  );
  await until("the controls", async () => (await first.getByTestId("driver").getAttribute("data-mine")) === "true");
  await until("the boom to rise by 2 deg", async () => (await value(first, "reading-boom")) > rest + 2);
  await first.keyboard.up("ArrowLeft");
  const dark = async () => (await first.getByTestId("deadman").getAttribute("data-on")) === "false";
  await until("the lamp to go out", dark, 2000);
  const stopped = await settled(first, "reading-boom", 0.1);
  assert.ok(stopped > rest + 1.5, `the boom fell back from ${rest + 2} to ${stopped} deg`);
});

test("a page that loses the focus stops the crane although the key is still down", async () => {
  const rest = await settled(first, "reading-slew", 0.2);
  await first.keyboard.down("KeyA");
  const turned = (now) => Math.abs(((now - rest + 540) % 360) - 180);
  await until("the crane to slew by 1 deg", async () => turned(await value(first, "reading-slew")) > 1);
  await first.evaluate(() => window.dispatchEvent(new Event("blur")));
  await until(
    "the lamp to go out",
    async () => (await first.getByTestId("deadman").getAttribute("data-on")) === "false",
  );
  await settled(first, "reading-slew", 0.2);
  assert.equal(await first.getByTestId("deadman").getAttribute("data-on"), "false");
  await first.keyboard.up("KeyA");
});

test("two pages on one simulation agree, and only one drives until the other takes over", async () => {
  const second = await open(url);
  await until("two clients", async () => (await value(first, "clients")) >= 2);
  await first.keyboard.down("KeyS");
  await until(
    "the first to drive",
    async () => (await first.getByTestId("driver").getAttribute("data-mine")) === "true",
  );
  await first.keyboard.up("KeyS");
  await settled(first, "reading-jib", 0.1);
  await first.getByTestId("pause").click();
  await until("both to pause", async () => {
    const states = await Promise.all(
      [first, second].map((page) => page.getByTestId("state").getAttribute("data-state")),
    );
    return states.every((state) => state === "paused");
  });
  for (const id of ["sim-time", "reading-boom", "reading-jib", "reading-slew", "reading-radius", "reading-load"])
    await until(`the same ${id} on both pages`, async () => (await value(first, id)) === (await value(second, id)));
  await first.getByTestId("pause").click();
  await steady(first);
  await second.getByTestId("take-over").click();
  await until(
    "the second to drive",
    async () => (await second.getByTestId("driver").getAttribute("data-mine")) === "true",
  );
  await until(
    "the first to know",
    async () => (await first.getByTestId("driver").getAttribute("data-mine")) === "false",
  );
  await second.getByTestId("release").click();
  await second.context().close();
});

test("a gamepad drives only with its button held", async () => {
  const context = await browser.newContext({ viewport: SMALL });
  await context.addInitScript(() => {
    window.pad = {
      connected: true,
      mapping: "standard",
      axes: [0, -1, 0, 0],
      buttons: Array(17).fill({ pressed: false }),
    };
    navigator.getGamepads = () => [window.pad];
  });
  const page = await context.newPage();
  await page.goto(url);
  await page.waitForSelector("[data-testid=scene][data-ready=true]", { timeout: PATIENCE });
  await steady(page);
  const rest = await settled(page, "reading-jib", 0.2);
  await aSecond(page);
  assert.equal(await page.getByTestId("deadman").getAttribute("data-on"), "false");
  await page.evaluate(() => {
    window.pad.buttons = window.pad.buttons.map((_, i) => ({ pressed: i === 5 }));
  });
  await until("the jib to go out by 1 deg", async () => (await value(page, "reading-jib")) > rest + 1);
  await page.evaluate(() => {
    window.pad.buttons = window.pad.buttons.map(() => ({ pressed: false }));
  });
  await until(
    "the lamp to go out",
    async () => (await page.getByTestId("deadman").getAttribute("data-on")) === "false",
  );
  await settled(page, "reading-jib", 0.2);
  await page
    .getByTestId("release")
    .click({ timeout: 2000 })
    .catch(() => undefined); // its lease may have run out
  await context.close();
});

test("a plot follows a variable chosen from the tree, and its CSV holds what was plotted", async () => {
  await first.getByTestId("variable-search").fill("boom_drive cylinder pressure_a");
  await first.getByTestId("variable-boom_drive.cylinder.pressure_a").check();
  await first.getByTestId("variable-search").fill("");
  const panel = first.getByTestId("plot-bar");
  const points = async () => Number(await panel.getAttribute("data-points"));
  const before = await until("points in the plot", points);
  await until("more points", async () => (await points()) > before + 20);
  const shown = await value(first, "plotted-boom_drive.cylinder.pressure_a");
  assert.ok(shown > 1e6, `the plot shows ${shown} Pa`);

  await first.getByTestId("plot-hold").click();
  await until("the plot to hold", async () => (await panel.getAttribute("data-held")) === "true");
  await aSecond(first);
  const held = await points();
  const csv = await csvOf(first, "download-plotted");
  assert.deepEqual(csv.header, [
    "time [s]",
    "crane.luff [rad]",
    "crane.rope.tension [N]",
    "boom_drive.cylinder.pressure_a [Pa]",
  ]);
  assert.equal(csv.rows.length, held, "the file and the plot hold as many frames");
  const last = csv.rows[csv.rows.length - 1];
  assert.equal(last[3], await value(first, "plotted-boom_drive.cylinder.pressure_a"));
  assert.ok(
    csv.rows.every((row, i) => i === 0 || row[0] > csv.rows[i - 1][0]),
    "time runs on",
  );
  const boom = await value(first, "reading-boom");
  assert.ok(
    Math.abs(last[1] / RADIAN - boom) < 2,
    `the file ends at ${last[1] / RADIAN} deg, the instrument shows ${boom}`,
  );
  await first.getByTestId("plot-hold").click();
});

test("all variables can be downloaded, and agree with what was plotted", async () => {
  const csv = await csvOf(first, "download-all");
  assert.equal(csv.header[0], "time [s]");
  const luff = csv.header.indexOf("crane.luff [rad]");
  assert.ok(luff > 0 && csv.header.length > 50, `only ${csv.header.length} columns`);
  assert.ok(csv.rows.length > 50 && csv.rows.every((row) => row.length === csv.header.length));
  const top = Math.max(...csv.rows.map((row) => row[luff])) / RADIAN;
  assert.ok(top > 51, `the recording knows nothing of the boom being raised: it was at ${top} deg at most`);
});

test("the help opens with a question mark and closes with escape", async () => {
  await first.keyboard.press("?");
  await first.getByRole("dialog").waitFor();
  await first.keyboard.press("Escape");
  await first.getByRole("dialog").waitFor({ state: "detached" });
});

test("every view is drawn anew, and a crane that stands still is not", async () => {
  await first.setViewportSize({ width: 1600, height: 900 });
  await first.getByTestId("pause").click();
  await until(
    "the page to pause",
    async () => (await first.getByTestId("state").getAttribute("data-state")) === "paused",
  );
  const canvas = first.locator("[data-testid=scene] canvas");
  const drawn = async () => Number(await canvas.getAttribute("data-drawn"));
  /** Once all that was asked for is drawn. */
  const still = () =>
    until("the picture to stand still", async () => {
      const before = await drawn();
      await pause(1000);
      return (await drawn()) === before;
    });
  await still();
  const pictures = new Set();
  for (const view of ["side", "deck", "cab", "hook", "overview"]) {
    const before = await drawn();
    await first.getByTestId(`view-${view}`).click();
    await until(`the view ${view} to be drawn`, async () => (await drawn()) > before);
    pictures.add((await canvas.screenshot({ path: join(output, `${view}.png`) })).toString("base64"));
  }
  assert.equal(pictures.size, 5, "no two views are alike");
  await still();
  assert.deepEqual(first.errors, []);
});

// ---------------------------------------------------------------- run
await mkdir(output, { recursive: true });
let failed = 0;
for (const { claim, run } of tests) {
  const begun = Date.now();
  try {
    await run();
    console.log(`ok    ${claim} (${((Date.now() - begun) / 1000).toFixed(1)} s)`);
  } catch (error) {
    failed += 1;
    console.log(`FAIL  ${claim}\n      ${error.stack}`);
    await first?.screenshot({ path: join(output, `failed-${failed}.png`) }).catch(() => undefined);
    await first?.keyboard.up("ArrowLeft").catch(() => undefined);
    if (!first) break;
  }
}
await browser.close();
console.log(failed ? `${failed} of ${tests.length} failed` : `all ${tests.length} passed`);
process.exit(failed ? 1 : 0);
