// The designer without a pointer, with less motion, and by axe in every state, in a real browser: see bench.mjs.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { join } from "node:path";
import { choose, downloaded, output, reading, ready, scenarios, shown, tabTo, until, violations } from "./bench.mjs";

const at = (id) => (found) => found.id === id;
const called = (label) => (found) => found.label === label;

async function goes_from_an_empty_page_to_an_exported_crane_by_keyboard(open) {
  const page = await open();
  // a new crane, of a size and a type
  await page.keyboard.press("n");
  await page.getByTestId("new-dialog").waitFor();
  await tabTo(page, "the name", called("Name"));
  await page.keyboard.press("Control+a");
  await page.keyboard.type("by keys");
  await tabTo(page, "the types", ({ label }) => label === "Knuckle boom");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("ArrowLeft");
  await tabTo(page, "the radius", called("Largest radius"));
  await page.keyboard.type("20");
  await tabTo(page, "Create", at("create"));
  await page.keyboard.press("Enter");
  await page.getByTestId("select-by keys").waitFor();
  await until("the dialog to close", async () => (await page.getByRole("dialog").count()) === 0);

  // a longer jib in the drawing, a wider bore in its field
  const length = await reading(page, "end-jib");
  await tabTo(page, "the end of the jib", at("end-jib"));
  for (let i = 0; i < 3; i += 1) await page.keyboard.press("ArrowRight");
  await until("a longer jib", async () => (await reading(page, "end-jib")) !== length);
  await page.keyboard.press("Control+z");
  await tabTo(page, "the jib's cylinder", at("select-jib_cylinder"));
  await page.keyboard.press("Enter");
  await tabTo(page, "its bore", called("Bore"));
  await page.keyboard.type("350 mm");
  await page.keyboard.press("Enter");

  // looked at, and taken along
  await tabTo(page, "the mechanical editor", at("show-solid"));
  await page.keyboard.press("Enter");
  await page.waitForSelector("[data-testid=solid] canvas[data-ready=true]");
  await tabTo(page, "the measuring", called("Measure"));
  await page.keyboard.press("Enter");
  await tabTo(page, "the tip", at("mark-tip"));
  await page.keyboard.press("Enter");
  await page.locator(".measured", { hasText: "From tip to" }).waitFor();
  await tabTo(page, "the menu of files", at("save-menu"));
  await page.keyboard.press("Enter");
  await page.getByTestId("export-zip").waitFor();
  await until("the item for everything", async () => {
    await page.keyboard.press("ArrowDown");
    return page.getByTestId("export-zip").evaluate((item) => item === document.activeElement);
  });
  const path = await downloaded(page, () => page.keyboard.press("Enter"));
  const saved = await downloaded(page, () => page.keyboard.press("Control+s"));
  return { path, design: JSON.parse(await readFile(saved, "utf8")) };
}

/** All that the page can show, each from the state that the one before leaves. */
const STATES = {
  crane: async () => {},
  column: (page) => page.getByTestId("select-column").click(),
  cylinder: (page) => page.getByTestId("select-boom_cylinder").click(),
  hoist: (page) => page.getByTestId("select-hoist").click(),
  rating: (page) => page.getByTestId("select-rating").click(),
  problems: async (page) => {
    await page.getByTestId("select-boom_cylinder").click();
    const stroke = page.getByTestId("details").getByLabel("Stroke");
    await stroke.fill("1 m");
    await stroke.press("Enter");
    await page.getByTestId("problems").waitFor();
  },
  refused: async (page) => {
    await page.getByTestId("undo").click();
    const file = { name: "words.json", mimeType: "application/json", buffer: Buffer.from("words") };
    await page.getByTestId("file").setInputFiles(file);
    await page.getByTestId("notice").waitFor();
  },
  optimise: async (page) => {
    await page.getByRole("button", { name: "Close the message" }).click();
    await page.getByTestId("show-optimise").click();
  },
  parts: async (page) => {
    await page.getByTestId("show-chart").click();
    await page.getByTestId("select-boom").click();
    await page.getByTestId("own-parts").click();
    await page.locator(".parts .twig").first().click();
    await shown(page, "both");
  },
  tools: async (page) => {
    await page.emulateMedia({ reducedMotion: "reduce" });
    await shown(page, "solid");
    for (const name of ["Section", "Measure", "Animate", "Workspace", "Centres"])
      await page.locator(".solid-tools").getByRole("button", { name, exact: true }).click();
    await page.getByTestId("reach").waitFor();
  },
  unlike: (page) => ready(page, "gangway-24m"),
  design_menu: (page) => page.getByTestId("design-menu").click(),
  save_menu: async (page) => {
    await page.keyboard.press("Escape");
    await page.getByTestId("save-menu").click();
  },
  new: async (page) => {
    await page.keyboard.press("Escape");
    await choose(page, "new");
  },
  versions: async (page) => {
    await away(page);
    await choose(page, "versions");
    await page.getByTestId("keep-version").click();
    await page
      .getByRole("dialog")
      .getByRole("button", { name: /^Remove / })
      .click();
  },
  compare: async (page) => {
    await away(page);
    await choose(page, "compare");
    await page.getByTestId("compare-with").selectOption("gunnerus-pk65");
    await until("what differs", async () => (await page.locator(".differences tbody tr").count()) > 10);
  },
  help: async (page) => {
    await away(page);
    await page.keyboard.press("?");
    await page.getByTestId("help-dialog").waitFor();
  },
};

async function away(page) {
  await page.keyboard.press("Escape");
  await until("the dialog to close", async () => (await page.getByRole("dialog").count()) === 0);
}

async function has_no_serious_violation_in_any_state(open) {
  const [, , , colorScheme, width] = process.argv;
  const page = await open({ viewport: { width: Number(width), height: Number(width) * 0.6 }, colorScheme });
  const found = {};
  for (const [state, show] of Object.entries(STATES)) {
    await show(page);
    await page.screenshot({ path: join(output, `${state}-${colorScheme}-${width}.png`) });
    const serious = await violations(page);
    if (serious.length) found[state] = serious;
  }
  assert.deepEqual(found, {});
}

async function moves_nothing_by_itself_where_less_motion_is_asked_for(open) {
  const page = await open({ reducedMotion: "reduce" });
  await page.keyboard.press("?");
  await page.getByTestId("help-dialog").waitFor();
  const running = () => page.evaluate(() => document.getAnimations().map((one) => one.effect?.target?.className));
  assert.deepEqual(await running(), [], "the dialog is there at once");
  await page.keyboard.press("Escape");
  await until("the dialog to close", async () => (await page.getByRole("dialog").count()) === 0);
  await shown(page, "solid");
  await page.locator(".solid-tools").getByRole("button", { name: "Animate" }).click();
  const posture = page.getByTestId("moved-posture");
  const stands = await posture.innerText();
  // The slider moves it; nothing else has by then
  await page.locator(".solid-tools").getByLabel("Range").fill("0");
  assert.equal(await posture.innerText(), stands);
  await page.locator(".solid-tools").getByLabel("Range").fill("0.5");
  await until("another posture", async () => (await posture.innerText()) !== stands);
  assert.deepEqual(await running(), []);
}

await scenarios({
  goes_from_an_empty_page_to_an_exported_crane_by_keyboard,
  has_no_serious_violation_in_any_state,
  moves_nothing_by_itself_where_less_motion_is_asked_for,
});
