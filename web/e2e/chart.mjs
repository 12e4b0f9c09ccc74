// What a crane may lift, as its rating is changed, and the step into the simulation from a cell of the chart; see
// bench.mjs. The numbers are compared with the package in tests/e2e/test_e2e_chart.py.
import assert from "node:assert/strict";
import { design, fill, loads, painted, pictures, scenarios, until } from "./bench.mjs";

const verdict = (page) => page.getByTestId("limits").innerText();

/** Does something that changes the limits, and gives what the page then says of the posture and of every radius. */
async function told(page, action, curves = true) {
  const [before, curve] = [await verdict(page), await loads(page)];
  await action();
  await until("other limits", async () => (await verdict(page)) !== before);
  if (curves) await until("another curve", async () => (await loads(page)) !== curve);
  const kept = await until("the state to be kept", async () => {
    const text = await page.evaluate(() => localStorage.getItem("seacrane.designer.current"));
    return text && JSON.parse(text);
  });
  return {
    design: await design(page),
    posture: kept.posture,
    mode: await chosen(page),
    load: Number(await page.getByTestId("load").getAttribute("data-value")),
    says: await page.locator(".verdict .load").innerText(),
    curve: (await loads(page)).split(",").map((load) => (load === "" ? null : Number(load))),
  };
}

const chosen = async (page) =>
  (await page.locator(".curves .modes [aria-pressed=true]").getAttribute("data-testid")).replace("mode-", "");

async function tells_the_load_as_the_rating_changes(open) {
  const page = await open();
  await until("the curves", () => loads(page));
  await page.getByTestId("load").waitFor();
  await page.getByTestId("select-boom").click();
  const first = await design(page);
  const seen = { higher: await told(page, () => fill(page, "luff now", "52 deg"), false) };
  for (const name of ["hs1.0", "hs1.5", "hs2.0", "hs2.5", "harbour"])
    seen[name] = await told(page, () => page.getByTestId(`mode-${name}`).click());
  await page.getByTestId("select-rating").click();
  seen.heel = await told(page, () => fill(page, "Heel", "4"));
  await pictures(page, "rating");
  await page.getByTestId("select-hoist").click();
  seen.falls = await told(page, () => fill(page, "Falls", "2"));
  seen.sheaves = await told(page, () => fill(page, "Sheave efficiency", "97 %"), false);
  seen.hook = await told(page, () => fill(page, "Hook block", "2.5 t"));

  // The usual sea states become the design's own, and change; then everything is undone, one step at a time.
  await page.getByTestId("select-rating").click();
  await page.locator(".absent", { hasText: "Sea states Hs: 1, 1.5, 2, 2.5 m" }).getByRole("button").click();
  const heights = page.getByTestId("details").getByRole("group", { name: "Sea states Hs" });
  assert.equal(await heights.locator("input").count(), 4);
  await heights.locator("input").last().fill("3");
  await heights.locator("input").last().press("Enter");
  await page.getByTestId("mode-hs3.0").waitFor();
  seen["hs3.0"] = await told(page, () => page.getByTestId("mode-hs3.0").click());
  for (let steps = 7; steps > 0; steps -= 1) await page.getByTestId("undo").click();
  assert.ok(await page.getByTestId("undo").isDisabled(), "each change was one step");
  assert.deepEqual(await design(page), first);
  return seen;
}

async function simulates_from_a_cell_of_the_chart(open) {
  const page = await open();
  await page.getByTestId("load").waitFor();
  const chart = await page.getByTestId("section").boundingBox();
  const handle = async (name) => {
    const box = await page.getByTestId(name).locator("circle.target").boundingBox();
    return [box.x + box.width / 2, box.y + box.height / 2];
  };
  // A place in the plane by two handles whose places in metres are known: the joint of the boom, and the tip
  const [foot, tip] = [await handle("end-column"), await handle("end-jib")];
  const numbers = await page.locator(".verdict .hint").innerText();
  const [radius, height] = [...numbers.matchAll(/([\d.]+) m/g)].map(([, number]) => Number(number));
  const scale = (tip[0] - foot[0]) / radius;
  const [x, y] = [foot[0] + 22 * scale, tip[1] + (height - 6) * scale];
  assert.ok(x < chart.x + chart.width && y < chart.y + chart.height);
  await painted(page);
  await page.mouse.move(x, y);
  const pointed = await page.locator(".tag", { hasText: "radius" }).textContent();
  const load = Number(await page.getByTestId("load").getAttribute("data-value"));
  await page.mouse.click(x, y);
  await until("another load", async () => Number(await page.getByTestId("load").getAttribute("data-value")) !== load);
  await page.mouse.move(chart.x + chart.width / 2, 5);
  await pictures(page, "cell");
  const [asked, operation] = await Promise.all([
    page.waitForRequest(/api\/design\/simulate/),
    page.waitForEvent("popup"),
    page.getByTestId("simulate").click(),
  ]);
  await operation.locator("[data-testid=state][data-state=running]").waitFor();
  assert.match(await operation.locator("header.live-bar").innerText(), /offshore-100t/);
  const reads = async (id) => Number(await operation.getByTestId(id).getAttribute("data-value"));
  await until("ten seconds of simulated time", async () => (await reads("sim-time")) > 10);
  const held = {
    boom: await reads("reading-boom"),
    radius: await reads("reading-radius"),
    load: await reads("reading-load"),
    pressures: { boom: await reads("pressure-boom"), jib: await reads("pressure-jib") },
  };
  const { posture, load: hung, hs } = asked.postDataJSON();
  await page.getByTestId("undo").click();
  assert.ok(await page.getByTestId("undo").isDisabled());
  return { posture, load: hung, hs, pointed, held, at: [22, 6] };
}

await scenarios({ tells_the_load_as_the_rating_changes, simulates_from_a_cell_of_the_chart });
