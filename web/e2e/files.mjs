// Designs kept, compared, lost and brought in, in a real browser: see bench.mjs and tests/e2e/test_e2e_files.py.
import assert from "node:assert/strict";
import { readdir } from "node:fs/promises";
import { join } from "node:path";
import { choose, design, fill, painted, pictures, reading, scenarios, told, until } from "./bench.mjs";

const bore = async (page) => (await design(page)).cylinders[0].bore;
const closed = (page) => until("the dialog to close", async () => (await page.getByRole("dialog").count()) === 0);
const undoable = async (page) => page.getByTestId("undo").isEnabled();

async function keeps_versions_and_duplicates(open) {
  const page = await open();
  const first = await design(page);
  const keep = async (name) => {
    await choose(page, "versions");
    if (name) await page.getByRole("dialog").getByLabel("Name").fill(name);
    await page.getByTestId("keep-version").click();
  };
  await keep("as it was");
  await pictures(page, "versions");
  await page.keyboard.press("Escape");
  await closed(page);
  await page.getByTestId("select-boom_cylinder").click();
  await fill(page, "Bore", "380");
  const thinner = await design(page);
  await keep();
  const listed = () => page.getByRole("dialog").locator(".versions li").allInnerTexts();
  assert.deepEqual(
    (await listed()).map((text) => text.replace(/(as it was|offshore-100t 1)[\s\S]*/, "$1")),
    ["offshore-100t 1", "as it was"],
  );

  // What is removed by mistake comes back; what was kept outlives the page.
  await page.getByRole("button", { name: "Remove as it was" }).click();
  assert.equal((await listed()).length, 1);
  await page.getByRole("button", { name: "Put it back" }).click();
  assert.equal((await listed()).length, 2);
  await page.reload();
  await painted(page);
  await choose(page, "versions");
  await page.getByRole("button", { name: "Open as it was" }).click();
  await closed(page);
  assert.deepEqual(await design(page), first);
  await page.getByTestId("undo").click();
  assert.deepEqual(await design(page), thinner, "undo brings back what the version took the place of");

  await choose(page, "duplicate");
  await page.getByTestId("select-offshore-100t copy").waitFor();
  assert.deepEqual(await design(page), { ...thinner, name: "offshore-100t copy" });
  await page.getByTestId("undo").click();
  assert.deepEqual(await design(page), thinner);
}

async function compares_two_designs(open) {
  const page = await open();
  await choose(page, "versions");
  await page.getByTestId("keep-version").click();
  await page.keyboard.press("Escape");
  await closed(page);
  await page.getByTestId("select-boom_cylinder").click();
  await fill(page, "Bore", "300");
  await fill(page, "Rod", "8 in");
  await choose(page, "compare");
  const dialog = page.getByTestId("compare-dialog");
  const rows = () => dialog.locator("tbody tr").allInnerTexts();
  await until("what differs", async () => (await rows()).length > 0);
  assert.deepEqual(
    (await rows()).map((row) => row.split("\t").map((cell) => cell.trim())),
    [
      ["cylinders[boom_cylinder].bore", "300 mm", "420 mm"],
      ["cylinders[boom_cylinder].rod", "203.2 mm", "300 mm"],
    ],
  );
  const lines = dialog.locator(".plot polyline");
  await until("both curves", async () => (await lines.count()) === 2);
  const shapes = await lines.evaluateAll((all) => all.map((one) => one.getAttribute("points")));
  assert.notEqual(shapes[0], shapes[1], "a thinner cylinder lifts less");
  const sections = () => dialog.locator("figure canvas").evaluateAll((all) => all.map((one) => one.toDataURL()));
  const scales = () => dialog.locator("figure[data-most]").evaluateAll((all) => all.map((one) => one.dataset.most));
  await until("both sections", async () => (await scales()).length === 2);
  assert.equal(new Set(await scales()).size, 1, "one scale of colours");
  await until("sections that differ", async () => new Set(await sections()).size === 2);
  await dialog.getByTestId("compare-with").selectOption("gunnerus-pk65");
  await until("another crane", async () => (await rows()).length > 50);
  await until("its curve", async () => (await lines.count()) === 2);
  await until("its section", async () => (await scales()).length === 2);
  await pictures(page, "compared");
}

async function loses_at_most_two_seconds_in_a_crash(open) {
  const page = await open();
  const [context, address] = [page.context(), page.url()];
  const again = await context.newPage();
  // The page's own clock, by which two seconds are let pass
  await page.clock.install();
  await page.reload();
  await painted(page);
  await page.getByTestId("select-boom_cylinder").click();
  await page.clock.pauseAt(Date.now() + 60_000);
  await fill(page, "Bore", "380");
  const length = await reading(page, "end-jib");
  await page.getByTestId("end-jib").press("ArrowRight");
  await until("a longer jib", async () => (await reading(page, "end-jib")) !== length);
  const longer = await reading(page, "end-jib");
  await page.clock.runFor(2000);
  const session = await context.newCDPSession(page);
  const crashed = page.waitForEvent("crash");
  // it does not live to answer
  session.send("Page.crash").catch(() => undefined);
  await crashed;

  await page.close();
  await context.clock.resume();
  await again.goto(address);
  await painted(again);
  await told(again, /Recovered the work on offshore-100t/);
  assert.equal(await reading(again, "end-jib"), longer);
  assert.equal(await bore(again), 0.38);
}

/** What the page says to each file of the folder that the second argument names. */
async function refuses_hostile_files(open) {
  const page = await open();
  const first = await design(page);
  const [, , , folder] = process.argv;
  const said = {};
  page.on("dialog", () => assert.fail("a file may run nothing"));
  for (const name of (await readdir(folder)).sort()) {
    await page.getByTestId("file").setInputFiles(join(folder, name));
    const notice = page.locator("[data-testid=notice][data-kind=wrong]");
    await notice.waitFor().catch(() => assert.fail(`${name} is not refused`));
    said[name] = await notice.locator("p").innerText();
    assert.equal(await notice.locator("p *").count(), 0, "words, not markup");
    await page.getByRole("button", { name: "Close the message" }).click();
    await notice.waitFor({ state: "detached" });
  }
  await pictures(page, "refused");
  assert.deepEqual(await design(page), first);
  assert.ok(!(await undoable(page)), "what is refused changes nothing");
  return said;
}

/** The link with the good meshes of the folder as parts, and what is said to the others. */
async function takes_meshes_of_other_programs(open) {
  const page = await open();
  const [, , , folder] = process.argv;
  await page.getByTestId("select-column").click();
  const refused = {};
  for (const name of (await readdir(folder)).sort()) {
    await page.getByTestId("mesh-file").setInputFiles(join(folder, name));
    if (name.endsWith(".stl")) await page.getByTestId("mesh-mm").click();
    const [taken, wrong] = [page.getByTestId("notice"), page.getByTestId("mesh-refused")];
    await taken
      .filter({ hasText: name })
      .or(wrong.filter({ hasText: name }))
      .first()
      .waitFor();
    if (await wrong.count()) refused[name] = await wrong.innerText();
  }
  await pictures(page, "meshes");
  const made = await design(page);
  while (await undoable(page)) await page.getByTestId("undo").click();
  assert.equal((await design(page)).links[0].parts, undefined);
  return { design: made, refused };
}

await scenarios({
  keeps_versions_and_duplicates,
  compares_two_designs,
  loses_at_most_two_seconds_in_a_crash,
  refuses_hostile_files,
  takes_meshes_of_other_programs,
});
