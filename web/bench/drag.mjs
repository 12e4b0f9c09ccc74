// Time from a pointer's move to the repainted chart, in a real browser against a running designer: SEACRANE_URL is the
// address that `seacrane designer` prints, CHROMIUM names the browser (default /usr/bin/chromium).
import { chromium } from "playwright-core";

const url = process.env.SEACRANE_URL;
if (!url) {
  console.error("SEACRANE_URL must be the address that `seacrane designer` prints, with its token");
  process.exit(2);
}
const EVENTS = Number(process.argv[2] ?? 80);
const DESIGNS = ["offshore-100t", "gunnerus-pk65", "a-frame-30t", "dual-drag-link-60t", "gangway-24m"];
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-background-networking"],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
await page.goto(url);
const raster = page.getByTestId("raster");

/** In the page: for each move that is answered, when it came, when the chart was drawn, and what the worker took of it. */
function watch() {
  const canvas = document.querySelector("[data-testid=raster]");
  let moved = null;
  addEventListener("pointermove", () => (moved ??= performance.now()), { capture: true });
  new MutationObserver(() => {
    if (moved === null) return;
    globalThis.seen?.push({
      whole: performance.now() - moved,
      worker: Number(canvas.dataset.took),
      cells: `${canvas.width} x ${canvas.height}`,
    });
    moved = null;
  }).observe(canvas, { attributeFilter: ["data-painted"] });
}

const quantile = (values, share) => [...values].sort((a, b) => a - b)[Math.floor(share * (values.length - 1))];
const told = (values) => [0, 0.5, 0.9, 1].map((share) => quantile(values, share).toFixed(1).padStart(6)).join("");
console.log("least, median, nine of ten, most [ms]".padStart(60));
await page.waitForSelector("[data-testid=raster][data-painted]");
await page.evaluate(watch);
for (const design of DESIGNS) {
  await page.getByTestId("design-menu").click();
  await page.getByTestId(`open-${design}`).click();
  await page.waitForSelector("[data-testid=raster][data-complete=true]");
  await page.waitForTimeout(1500);
  const grip = page.locator("[data-testid^=end-]").last();
  const box = await grip.locator("circle.target").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.evaluate(() => {
    globalThis.seen = [];
  });
  await page.mouse.down();
  for (let i = 1; i <= EVENTS; i += 1) {
    const before = await raster.getAttribute("data-painted");
    await page.mouse.move(x + 30 * Math.sin(i / 6), y + 20 * Math.sin(i / 9));
    // a move that the snapping takes for none is not answered
    await page
      .waitForFunction((last) => document.querySelector("[data-testid=raster]").dataset.painted !== last, before, {
        timeout: 500,
        polling: 10,
      })
      .catch(() => {});
    await page.waitForTimeout(20);
  }
  await page.mouse.up();
  const seen = await page.evaluate(() => globalThis.seen);
  const cells = seen[seen.length - 1].cells;
  console.log(`${design.padEnd(20)} ${String(seen.length).padStart(3)} events, ${cells} cells`);
  console.log(
    `  move to drawn chart ${told(seen.map(({ whole }) => whole))}   worker ${told(seen.map(({ worker }) => worker))}`,
  );
}
await browser.close();
