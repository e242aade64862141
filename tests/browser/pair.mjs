// Opens the page of `magsplice report A.toml B.toml` in a headless browser.
// Usage: node pair.mjs BROWSER FOLDER
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

// Found through NODE_PATH, which `import` does not use.
const { chromium } = createRequire(import.meta.url)("playwright-core");
const [executablePath, folder] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
try {
  for (const width of [1280, 390, 320]) {
    const page = await browser.newPage({ viewport: { width, height: 900 } });
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    page.on("request", (request) => /^(file|data):/.test(request.url()) || errors.push(`asks for ${request.url()}`));
    await page.goto(pathToFileURL(resolve(folder, "report.html")).href);
    const rows = await page.locator(".numbers tbody tr").evaluateAll((rows) =>
      rows.map((row) => [...row.cells].map((cell) => cell.textContent)));
    assert.ok(rows.length > 20 && rows.every((row) => row.length === 4), `rows: ${rows.length}`);
    // Each number is on one line, and the table remains a table for screen readers.
    const broken = await page.locator(".numbers td").evaluateAll((cells) => cells.filter((cell) => {
      const range = document.createRange();
      range.selectNodeContents(cell);
      return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1
        || cell.scrollWidth > cell.clientWidth + 1;
    }).map((cell) => cell.textContent));
    assert.deepEqual(broken, [], `numbers that are broken or cut off at ${width} px`);
    assert.equal(await page.locator(".numbers").getByRole("rowheader").count(), rows.length);
    // Each table has columns for both films and the difference.
    const tables = await page.locator(".numbers").count();
    assert.ok(tables >= 3);
    assert.equal(await page.locator(".numbers [role=columnheader]").count(), 4 * tables);
    // The explanation of the numbers is below them.
    const [table, note] = await Promise.all([".numbers", "#about-rmse"].map((of) => page.locator(of).last().boundingBox()));
    assert.ok(note.height > 10 && note.y >= table.y + table.height && note.x + note.width <= width, JSON.stringify(note));
    // Figures of the same name are side by side, or stacked on a telephone.
    const boxes = await page.locator("figure img").evaluateAll(async (images) => {
      await Promise.all(images.map((image) => image.decode()));
      return images.map((image) => [image.closest("figure").id, image.getBoundingClientRect().toJSON()]);
    });
    assert.equal(boxes.length, 16);
    for (let n = 0; n < boxes.length; n += 2) {
      const [[first, a], [second, b]] = [boxes[n], boxes[n + 1]];
      assert.equal(first.replace("first-", ""), second.replace("second-", ""));
      assert.ok(Math.abs(a.width - b.width) < 1 && Math.abs(a.height - b.height) < 1, `${first}: ${a.width} and ${b.width}`);
      if (width > 600) assert.ok(a.top === b.top && a.right <= b.left, `${first} is not beside ${second}`);
      else assert.ok(a.bottom <= b.top, `${first} is not above ${second}`);
    }
    // Each film has its own view and map.
    for (const prefix of ["first-", "second-"]) {
      assert.match(await page.locator(`#${prefix}z`).textContent(), /^z = /);
      assert.ok(await page.locator(`#${prefix}tiles option`).count() > 50);
    }
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), width, "something is cut off");
    assert.deepEqual(errors, []);
    await page.close();
  }
  console.log(`${folder}/report.html: two films, no error`);
} finally {
  await browser.close();
}
