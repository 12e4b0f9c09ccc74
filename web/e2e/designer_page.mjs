// What is about the crane on the designer's page: commands, panels, links, fields. See bench.mjs.
import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import { join } from "node:path";
import {
  choose,
  downloaded,
  drag,
  output,
  painted,
  reading,
  scenarios,
  shown,
  told,
  until,
  violations,
} from "./bench.mjs";

const width = async (page, panel) => Math.round((await page.locator(`#panel-${panel}`).boundingBox())?.width ?? 0);

async function gives_every_command_by_a_few_letters_and_keys_alone(open) {
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
  assert.deepEqual(await violations(page), []);
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
  assert.deepEqual(await violations(page), []);
  assert.match(await page.getByTestId("help-dialog").innerText(), /Save the design file \(JSON\)\s*Ctrl\s*S/);
  await page.getByTestId("open-palette").click();
  await focused();
  await page.keyboard.type("redo");
  await until("redo", async () => /nothing to redo/.test((await active()) ?? ""));
  await page.keyboard.press("Enter");
  assert.equal(await palette.count(), 1);
  await page.keyboard.press("Escape");
  await until("the palette to close", async () => (await palette.count()) === 0);
}

async function moves_folds_and_swaps_panels_and_remembers_them(open) {
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
  assert.deepEqual(await violations(page), []);
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
}

async function saves_a_front_and_opens_it_again(open) {
  const page = await open();
  await page.getByTestId("show-optimise").click();
  for (const [label, value] of [
    ["Population", "6"],
    ["Generations", "2"],
  ]) {
    await page.getByLabel(label, { exact: true }).fill(value);
    await page.getByLabel(label, { exact: true }).press("Enter");
  }
  const ended = (n) => page.waitForSelector(`[data-testid=generation][data-value="${n}"][data-running=false]`);
  await page.getByTestId("search-start").click();
  await ended(2);
  const before = await page.locator(".front-table").innerText();
  const path = await downloaded(page, () => page.getByTestId("front-save").click());

  await page.getByRole("button", { name: "Go on for 2 more" }).click();
  await ended(4);
  await page.getByTestId("front-file").setInputFiles(path);
  await ended(2);
  assert.equal(await page.locator(".front-table").innerText(), before);

  const damaged = join(output, "damaged.json");
  await writeFile(damaged, JSON.stringify({ ...JSON.parse(await readFile(path, "utf8")), values: [[1]], seed: "x" }));
  await page.getByTestId("front-file").setInputFiles(damaged);
  const failure = page.getByTestId("search-failure");
  await failure.waitFor();
  assert.match(
    await failure.innerText(),
    /damaged\.json is not opened[\s\S]*seed: must be a whole[\s\S]*values: must be/,
  );
  await ended(2);
  assert.deepEqual(await violations(page), []);

  // Another page finds the server's front through the palette.
  const other = await open();
  await other.keyboard.press("Control+k");
  await other.keyboard.type("instead chart");
  await other.keyboard.press("Enter");
  await other.waitForSelector("[data-testid=generation][data-value='2']");
}

async function opens_a_copied_link_as_it_was_seen_and_loses_no_work(open) {
  const page = await open({ permissions: ["clipboard-read", "clipboard-write"] });
  await drag(page, "end-jib", 40, 0);
  await page.getByTestId("mode-hs1.5").click();
  await page.getByTestId("select-jib_cylinder").click();
  await shown(page, "both");
  await page.getByRole("button", { name: "Closer" }).click();
  const solid = await page.locator("[data-testid=solid] canvas").boundingBox();
  await page.mouse.move(solid.x + 100, solid.y + 300);
  await page.mouse.down();
  await page.mouse.move(solid.x + 160, solid.y + 320, { steps: 5 });
  await page.mouse.up();
  // The clipboard and the versions are looked at, not the notices: those go by themselves.
  const copied = (of, before = "") =>
    until("a link in the clipboard", async () => {
      const text = await of.evaluate(() => navigator.clipboard.readText());
      return text !== before && text;
    });
  await page.keyboard.press("l");
  const address = await copied(page);
  assert.match(address, /^http:\/\/127\.0\.0\.1:\d+\/designer\.html#crane=1\.[\w-]+$/, "no token is in it");
  const seen = async (of) => ({
    jib: await reading(of, "end-jib"),
    posture: await reading(of, "joint-boom"),
    mode: await of.getByTestId("mode-hs1.5").getAttribute("aria-pressed"),
    selected: await of.getByTestId("select-jib_cylinder").getAttribute("aria-current"),
    show: await of.getByTestId("show-both").getAttribute("aria-pressed"),
    scale: await of.locator(".grid .axis").getAttribute("x1"),
  });
  const sent = await seen(page);

  // Somebody else, in the middle of work of their own.
  const other = await open({ permissions: ["clipboard-read", "clipboard-write"] });
  const shipped = await reading(other, "end-jib");
  await drag(other, "end-jib", -30, 0);
  await until("a shorter jib", async () => (await reading(other, "end-jib")) !== shipped);
  await until("the drag to be one step", () => other.getByTestId("undo").isEnabled());
  const [jib, name] = [await reading(other, "end-jib"), "offshore-100t before a link"];
  await until("the work to be kept", () =>
    other.evaluate(() => localStorage.getItem("seacrane.designer.current") !== null),
  );
  await other.goto(address);
  await until(
    "the crane of the link, seen as it was",
    async () => JSON.stringify(await seen(other)) === JSON.stringify(sent),
  );
  assert.equal(await other.evaluate(() => location.hash), "", "a reload does not open it again");
  await other.evaluate(() => navigator.clipboard.writeText("something else"));
  await other.getByTestId("copy-link").click();
  const back = await copied(other, "something else");
  assert.equal(back, address, "the link of what was opened is the same, with camera and zoom");
  await other.getByTestId("undo").click();
  await until("the work from before", async () => (await reading(other, "end-jib")) === jib);
  await choose(other, "versions");
  await other.getByText(name).waitFor();
  await other.keyboard.press("Escape");

  // A broken one is refused in words, in the address or in the dialog, and nothing changes.
  await other.goto(address.slice(0, -20));
  await told(other, /The link is not opened. It is cut off or damaged: copy all of it/);
  assert.equal(await reading(other, "end-jib"), jib);
  await choose(other, "link");
  const dialog = other.getByTestId("link-dialog");
  await dialog.getByLabel("Open a link").fill("https://example.org/#crane=7.x");
  await dialog.getByRole("button", { name: "Open" }).click();
  await dialog.getByRole("alert").getByText("is of a later version (7)").waitFor();
  assert.deepEqual(await violations(other), []);
  await dialog.getByLabel("Open a link").fill(address);
  await dialog.getByLabel("Open a link").press("Enter");
  await until("the jib of the link", async () => (await reading(other, "end-jib")) === sent.jib);
  await until("the dialog to close", async () => (await dialog.count()) === 0);
}

async function drags_numbers_finely_and_reckons_them(open) {
  const page = await open();
  await page.getByTestId("select-boom_cylinder").click();
  const details = page.getByTestId("details");
  const stroke = details.getByLabel("Stroke", { exact: true });
  const before = Number(await stroke.inputValue());
  const box = await stroke.boundingBox();
  const pull = async (dx, { shift = false, abandon = false } = {}) => {
    const [x, y] = [box.x + 20, box.y + box.height / 2];
    await page.mouse.move(x, y);
    await page.mouse.down();
    if (shift) await page.keyboard.down("Shift");
    await page.mouse.move(x + dx, y, { steps: 6 });
    if (shift) await page.keyboard.up("Shift");
    if (abandon) await page.keyboard.press("Escape");
    await page.mouse.up();
  };
  const value = (wanted) =>
    until(`a stroke of ${wanted}`, async () => Math.abs(Number(await stroke.inputValue()) - wanted) < 1e-9);
  await pull(21);
  await value(before + 0.5);
  await pull(21, { shift: true });
  await value(before + 0.55);
  await pull(40, { abandon: true });
  await value(before + 0.55);
  await page.getByTestId("undo").click();
  await value(before + 0.5);
  await page.getByTestId("undo").click();
  await value(before);

  // Pressed and not moved, it is typed in.
  await stroke.click();
  assert.ok(await stroke.evaluate((element) => element === document.activeElement));
  await page.keyboard.type("2*1.5 m + 8 in");
  await page.keyboard.press("Enter");
  await value(3.2032);
}

await scenarios({
  gives_every_command_by_a_few_letters_and_keys_alone,
  moves_folds_and_swaps_panels_and_remembers_them,
  saves_a_front_and_opens_it_again,
  opens_a_copied_link_as_it_was_seen_and_loses_no_work,
  drags_numbers_finely_and_reckons_them,
});
