// The designer's first journey in a real browser: see bench.mjs.
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import {
  choose,
  downloaded,
  drag,
  loads,
  output,
  painted,
  pause,
  reading,
  ready,
  save,
  scenarios,
  shown,
  tabTo,
  told,
  until,
  violations,
} from "./bench.mjs";

const SHIFT_Z = "Control+Shift+Z";

async function creates_drags_undoes_saves_and_opens_equal(open) {
  const page = await open();
  const first = await until("the curves of the first crane", async () => loads(page));
  await choose(page, "new");
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
  await ready(page, "gunnerus-pk65");
  await page.getByTestId("file").setInputFiles(path);
  await page.getByTestId("select-tested crane").waitFor();
  const again = JSON.parse(await readFile(await save(page), "utf8"));
  assert.deepEqual(again, written, "what was saved opens equal");

  return took;
}

async function exports_and_imports_equal_through_the_server(open) {
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
}

/** Exports the crane, opens another one, imports the archive, and gives the design that is then saved. */
async function throughArchive(page) {
  await page.getByTestId("save-menu").click();
  const path = await downloaded(page, () => page.getByTestId("export-zip").click());
  await ready(page, "a-frame-30t");
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

async function shows_what_cannot_be_built_in_place_and_in_words(open) {
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
}

async function works_by_keyboard_alone(open) {
  const page = await open();
  const before = await reading(page, "joint-boom");
  await tabTo(page, "the boom's handle", ({ id }) => id === "joint-boom");
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
  await page.waitForSelector("[data-testid=solid] canvas[data-ready=true]");
  await page.keyboard.press("1");
  await painted(page);
}

async function steps_into_the_simulation(open) {
  const page = await open();
  const load = Number(await page.getByTestId("load").getAttribute("data-value"));
  const [operation] = await Promise.all([page.waitForEvent("popup"), page.getByTestId("simulate").click()]);
  await operation.locator("[data-testid=state][data-state=running]").waitFor();
  assert.ok(load > 1000, `a load of ${load} kg`);
  assert.match(await operation.locator("header.live-bar").innerText(), /offshore-100t/);
}

async function recovers_the_work_after_a_reload(open) {
  const page = await open();
  await drag(page, "end-jib", 40, 0);
  const length = await reading(page, "end-jib");
  await pause(2000);
  await page.reload();
  await told(page, /Recovered the work on offshore-100t/);
  assert.equal(await reading(page, "end-jib"), length);
}

async function has_no_serious_violation_and_looks_well(open) {
  for (const colorScheme of ["light", "dark"])
    for (const [width, height] of [
      [1280, 800],
      [1920, 1080],
    ]) {
      const page = await open({ viewport: { width, height }, colorScheme });
      for (const view of width === 1280 ? ["section", "solid"] : ["section", "both"]) {
        await shown(page, view);
        await page.getByTestId("select-boom").click();
        await page.mouse.move(width / 2, 20);
        await page.screenshot({ path: join(output, `designer-${view}-${colorScheme}-${width}.png`) });
        assert.deepEqual(await violations(page), [], `axe, ${view} ${colorScheme} ${width}`);
      }
      await page.context().close();
    }
}

await scenarios({
  creates_drags_undoes_saves_and_opens_equal,
  exports_and_imports_equal_through_the_server,
  shows_what_cannot_be_built_in_place_and_in_words,
  works_by_keyboard_alone,
  recovers_the_work_after_a_reload,
  steps_into_the_simulation,
  has_no_serious_violation_and_looks_well,
});
