// The mechanical editor in a real browser, see bench.mjs; what it shows is compared in tests/e2e/test_e2e_mechanical.py.
import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { basename, join } from "node:path";
import {
  design,
  downloaded,
  drag,
  fill,
  output,
  pause,
  pictures,
  reading,
  ready,
  scenarios,
  shown,
  until,
} from "./bench.mjs";

const tool = (page, name) => page.locator(".solid-tools").getByRole("button", { name, exact: true });
const canvas = (page) => page.locator("[data-testid=solid] canvas");
const distance = (page) => page.getByTestId("distance");
const numbers = (text) => text.split(" ").map(Number);

/** Does something that changes the picture in three dimensions, and waits until it is drawn. */
async function drawn(page, action) {
  const before = Number(await canvas(page).getAttribute("data-drawn"));
  await action();
  await until("the picture to be drawn", async () => Number(await canvas(page).getAttribute("data-drawn")) > before);
}

const slide = (page, label, value) =>
  drawn(page, () => page.locator(".solid-tools").getByLabel(label).fill(String(value)));

/** What was measured last. */
async function measured(page) {
  const seen = distance(page);
  return {
    from: numbers(await seen.getAttribute("data-from")),
    to: numbers(await seen.getAttribute("data-to")),
    value: Number(await seen.getAttribute("data-value")),
    text: await seen.innerText(),
  };
}

/** Clicks on a link half way between two pins, and gives where that is in the page [px]. */
async function clickBetween(page, a, b) {
  const middles = [];
  for (const name of [a, b]) {
    const box = await page.getByTestId(`mark-${name}`).boundingBox();
    middles.push([box.x + box.width / 2, box.y + box.height / 2]);
  }
  const at = [0, 1].map((i) => 0.5 * (middles[0][i] + middles[1][i]));
  await page.mouse.click(...at);
  return at;
}

/** Measures from the middle of the boom to that of the jib, where they are hit. */
async function measureSteel(page) {
  await clickBetween(page, "joint luff", "joint jib");
  await page.locator(".measured", { hasText: "From a point of boom to" }).waitFor();
  const at = await clickBetween(page, "joint jib", "tip");
  await distance(page).filter({ hasText: "a point of boom to a point of jib" }).waitFor();
  return { ...(await measured(page)), at };
}

async function measures_between_pins_and_on_the_steel(open) {
  const page = await open({ viewport: { width: 1000, height: 700 } });
  await page.emulateMedia({ reducedMotion: "reduce" });
  await shown(page, "solid");
  await tool(page, "Animate").click();
  await slide(page, "Range", 0.42);
  const posture = JSON.parse(await page.getByTestId("moved-posture").getAttribute("data-posture"));
  await tool(page, "Measure").click();
  await page.locator(".measured", { hasText: "Choose two pins" }).waitFor();
  const pins = {};
  for (const [from, to] of [
    ["joint luff", "tip"],
    ["boom_cylinder base", "boom_cylinder eye"],
    ["jib_cylinder base", "jib_cylinder eye"],
    ["drum", "sheave 1"],
  ]) {
    // by keyboard, as without a pointer
    for (const name of [from, to]) await page.getByTestId(`mark-${name}`).press("Enter");
    await distance(page)
      .filter({ hasText: `${from} to ${to}` })
      .waitFor();
    pins[`${from} to ${to}`] = await measured(page);
  }
  await pictures(page, "measured");

  await tool(page, "Animate").click();
  await tool(page, "Measure").click();
  await tool(page, "Fit").click();
  await tool(page, "Measure").click();
  const steel = await measureSteel(page);
  await tool(page, "Measure").click();
  await page.getByTestId("select-hoist").click();
  await page.mouse.click(...steel.at);
  await page.waitForSelector("[data-testid=select-jib][aria-current=true]");

  // Of a crane cut open, only what is left can be clicked.
  await drawn(page, () => tool(page, "Section").click());
  await tool(page, "Measure").click();
  const left = await measureSteel(page);
  await pictures(page, "cut");
  return { posture, pins, steel, left };
}

async function shows_the_workspace_and_the_centre_of_mass(open) {
  const page = await open();
  await shown(page, "solid");
  const seen = {};
  for (const name of ["offshore-100t", "gunnerus-pk65", "a-frame-30t"]) {
    await ready(page, name);
    await tool(page, "Workspace").click();
    await tool(page, "Centres").click();
    const reach = page.getByTestId("reach");
    await reach.waitFor();
    await tool(page, "Animate").click();
    await slide(page, "Range", 0.2);
    // at one instant, for the crane moves on
    const [posture, at] = await page.evaluate(() =>
      [
        ["moved-posture", "data-posture"],
        ["whole-centre", "data-at"],
      ].map(([id, name]) => document.querySelector(`[data-testid=${id}]`).getAttribute(name)),
    );
    seen[name] = {
      area: Number(await reach.getAttribute("data-area")),
      volume: Number(await reach.getAttribute("data-volume")),
      text: await reach.innerText(),
      posture: JSON.parse(posture),
      centre: numbers(at),
    };
    await pictures(page, `workspace-${name}`);
    for (const one of ["Animate", "Workspace", "Centres"]) await tool(page, one).click();
    await reach.waitFor({ state: "detached" });
  }
  return seen;
}

/** The picture in three dimensions alone, as a file. */
async function picture(page, name) {
  const path = join(output, `${name}.png`);
  await canvas(page).screenshot({ path });
  return path;
}

async function cuts_open_takes_apart_and_moves(open) {
  const page = await open({ viewport: { width: 1000, height: 700 } });
  await page.emulateMedia({ reducedMotion: "reduce" });
  await shown(page, "solid");
  await drawn(page, () => tool(page, "Fit").click());
  const seen = { whole: await picture(page, "whole") };
  await slide(page, "Explode", 1);
  seen.apart = await picture(page, "apart");
  await slide(page, "Explode", 0);
  seen.together = await picture(page, "together");
  await drawn(page, () => tool(page, "Section").click());
  seen.cut = await picture(page, "cut");
  await slide(page, "Cut at y", 1);
  seen.gone = await picture(page, "gone");
  await drawn(page, () => tool(page, "Section").click());
  seen.closed = await picture(page, "closed");

  // With less motion asked for, the crane goes through its range by hand only.
  await tool(page, "Animate").click();
  const range = page.locator(".solid-tools").getByLabel("Range");
  assert.equal(await range.inputValue(), "0");
  seen.postures = [];
  for (let i = 0; i <= 24; i += 1) {
    await range.fill(String(i / 24));
    seen.postures.push(JSON.parse(await page.getByTestId("moved-posture").getAttribute("data-posture")));
  }
  await tool(page, "Animate").click();
  await range.waitFor({ state: "detached" });

  await page.emulateMedia({ reducedMotion: "no-preference" });
  await tool(page, "Animate").click();
  for (let i = 0; i < 2; i += 1) {
    const at = await range.inputValue();
    await until("the crane to move by itself", async () => (await range.inputValue()) !== at);
  }
  await tool(page, "Animate").click();
  assert.ok(await page.getByTestId("undo").isDisabled(), "looking changes nothing in the design");

  // A crane at rest is not drawn again and again.
  const drawings = () => canvas(page).getAttribute("data-drawn");
  await until("the picture to stand still", async () => {
    const before = await drawings();
    await pause(1000);
    return (await drawings()) === before;
  });
  return seen;
}

async function edits_parts_in_both_editors_at_once(open) {
  const page = await open();
  await shown(page, "both");
  await page.getByTestId("select-boom").click();
  await page.getByTestId("own-parts").click();
  await page
    .locator(".parts")
    .getByRole("button", { name: /^boom\s*girder/ })
    .click();
  const outline = () => page.locator(".crane .link").nth(1).locator("polygon").first().getAttribute("points");
  const mass = async () => Number(await page.getByTestId("parts-mass").getAttribute("data-value"));
  const first = { outline: await outline(), mass: await mass() };

  await drawn(page, () => fill(page, "Plate", "40 mm"));
  const thinner = await mass();
  assert.ok(thinner < first.mass, `${thinner} kg with thinner plates`);
  const station = page.getByTestId("details").locator("[data-shape=station]").nth(2);
  await drawn(page, async () => {
    await station.getByLabel("Top").fill("1.6");
    await station.getByLabel("Top").press("Enter");
  });
  assert.notEqual(await outline(), first.outline, "the side view shows the higher girder");
  const own = await design(page);
  const higher = await mass();
  assert.ok(higher > thinner);
  await pictures(page, "parts");

  await page.getByRole("button", { name: "Take mass, centre and inertia from the parts" }).click();
  const weighed = await design(page);

  // and the other way: a drag in the side view is drawn in the other editor
  const length = await reading(page, "end-jib");
  await drawn(page, () => drag(page, "end-jib", 30, 0, 4));
  await until("a longer jib", async () => (await reading(page, "end-jib")) !== length);

  // every step, one by one, back and forth
  const back = async (what, look, wanted) => {
    await page.getByTestId("undo").click();
    await until(what, async () => (await look()) === wanted);
  };
  await back("the jib from before", () => reading(page, "end-jib"), length);
  await page.getByTestId("select-boom").click();
  await back("the mass of the design", async () => (await design(page)).links[1].mass, own.links[1].mass);
  await back("the lower girder", outline, first.outline);
  await back("the thicker plates", mass, first.mass);
  await page.getByTestId("undo").click();
  await page.getByTestId("own-parts").waitFor();
  for (let i = 0; i < 4; i += 1) await page.getByTestId("redo").click();
  await until("the weighed crane", async () => (await design(page)).links[1].mass === weighed.links[1].mass);
  return { own, weighed, mass: higher };
}

async function saves_meshes_as_stl(open) {
  const page = await open();
  const seen = {};
  for (const name of ["offshore-100t", "gunnerus-pk65"]) {
    await ready(page, name);
    const links = (await design(page)).links.map((link) => link.name);
    const files = [];
    const keep = async (download) => {
      const path = join(output, download.suggestedFilename());
      await download.saveAs(path);
      files.push(path);
    };
    page.on("download", keep);
    await page.getByTestId("save-menu").click();
    await page.getByRole("menuitem", { name: "Meshes (STL)" }).click();
    await until("a file for each link", async () => files.length === links.length);
    page.off("download", keep);
    seen[name] = Object.fromEntries(files.map((path) => [basename(path).slice(name.length + 1, -".stl".length), path]));
  }
  return seen;
}

/** What the page exports as an archive, and as a design file. */
async function exports_what_is_designed(open) {
  const page = await open();
  await page.getByTestId("select-jib").click();
  await page.getByTestId("own-parts").click();
  await page.getByTestId("save-menu").click();
  const path = await downloaded(page, () => page.getByTestId("export-zip").click());
  assert.equal((await readFile(path)).subarray(0, 2).toString(), "PK");
  return { path, design: await design(page) };
}

await scenarios({
  measures_between_pins_and_on_the_steel,
  shows_the_workspace_and_the_centre_of_mass,
  cuts_open_takes_apart_and_moves,
  edits_parts_in_both_editors_at_once,
  saves_meshes_as_stl,
  exports_what_is_designed,
});
