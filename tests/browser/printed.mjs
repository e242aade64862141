// Opens the pages of `magsplice assign --page` and `magsplice tiles --page` in a headless browser.
// Usage: node printed.mjs BROWSER FILE ROWS...
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

// Found through NODE_PATH, which `import` does not use.
const { chromium } = createRequire(import.meta.url)("playwright-core");
const [executablePath, file, ...rows] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
try {
  for (const [width, media] of [[1280, "screen"], [390, "screen"], [718, "print"]]) {
    const page = await browser.newPage({ viewport: { width, height: 900 } });
    await page.emulateMedia({ media });
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("request", (request) => /^(file|data):/.test(request.url()) || errors.push(`asks for ${request.url()}`));
    await page.goto(pathToFileURL(resolve(file)).href);
    const counts = await page.locator("table").evaluateAll((tables) => tables.map((table) => table.tBodies[0].rows.length));
    assert.deepEqual(counts, rows.map(Number));
    // Each row has a cell for each heading.
    const ragged = await page.locator("table").evaluateAll((tables) => tables.flatMap((table) =>
      [...table.tBodies[0].rows].filter((row) => row.cells.length !== table.tHead.rows[0].cells.length)));
    assert.equal(ragged.length, 0);
    const image = await page.locator("figure img").evaluate(async (image) => {
      await image.decode();
      const box = image.getBoundingClientRect();
      return [box.left, box.right, box.height, image.naturalWidth / image.naturalHeight - box.width / box.height];
    });
    assert.ok(image[0] >= 0 && image[1] <= width && image[2] > 150 && Math.abs(image[3]) < 0.02, `${image}`);
    // On paper, and on a screen of this width, nothing is cut off; wide tables scroll by themselves.
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width, "something is cut off");
    assert.deepEqual(errors, []);
    await page.close();
  }
  console.log(`${file}: ${rows.join(" and ")} rows, no error`);
} finally {
  await browser.close();
}
