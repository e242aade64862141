// Opens the live page in a headless browser and changes films on it like a designer.
// Usage: node live.mjs PROGRAM BROWSER ENGINE FOLDER LAYOUT...
// ENGINE is the module of the page, compressed; pages are written into FOLDER.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { pathToFileURL } from "node:url";

import { checkAccess, changeFilm, dragBy, gestureTimes, launch, numbers, opened, press, settled } from "./live_film.mjs";
import { fragmentOf } from "../../crates/live-page/page/link.js";

const { chromium } = createRequire(import.meta.url)("playwright-core");
const [program, executablePath, engine, folder, ...layouts] = process.argv.slice(2);

// A frame of a screen, and what two shared cores may take at most.
const [FRAME_MS, SLOWEST] = [16, 3];
// Bytes of the page of the published film, so that it goes by mail.
const MOST_BYTES = 1.2e6;

/** The page of a layout file. */
function written(layout, name) {
  const page = join(folder, `${name}.html`);
  execFileSync(program, ["report", layout, "--live", "--engine", engine, "-o", page]);
  return pathToFileURL(page).href;
}

/** Numbers that the program prints, by their names on the page. */
function printed(layout) {
  const text = execFileSync(program, ["decouple", layout], { encoding: "utf8" });
  const line = (label, after = "") => text.slice(text.indexOf(after)).split("\n").find((row) => row.trim().startsWith(label));
  const three = (row) => row.match(/(?:[-\d.]+(?:e-?\d+)?|one point|none)(?=\s|$)/g).slice(-3);
  const uniformity = three(line("uniformity RMSE"));
  const displacement = three(line("as displacement", "RMSE against the ideal film"));
  const of = (name, keys, values) => keys.map((key, i) => [`${name} ${key}`, values[i]]);
  return Object.fromEntries([
    ...of("displacement RMSE", ["x", "y", "z"], displacement),
    ...of("uniformity RMSE", ["R_x", "R_y", "S_z"], uniformity),
    ["amplitude", line("best-fit amplitude").trim().split(/\s+/).at(-1)],
  ]);
}

const browser = await launch(chromium, executablePath);
try {
  // The published film: size of the page, first paint, everything that a designer does.
  const published = written("layouts/published-film.toml", "published");
  const bytes = statSync(join(folder, "published.html")).size;
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, acceptDownloads: true });
  const page = await opened(context, published);
  const paint = await page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0].startTime);
  const ready = await page.evaluate(() => performance.getEntriesByName("ready")[0].startTime);
  await changeFilm(page);
  const median = await gestureTimes(page);
  await checkAccess(page);

  // The link of a state opens it again.
  const text = readFileSync("layouts/designed-displacement.toml", "utf8");
  const linked = await opened(context, published + (await fragmentOf(text)));
  assert.equal(await linked.textContent("#title"), "designed for displacement");
  await press(linked, "Undo");
  assert.equal(await linked.textContent("#title"), "published film");
  await linked.close();

  // The numbers at rest are those of the program, to the last printed digit.
  for (const layout of layouts) {
    const shown = await opened(context, published + (await fragmentOf(readFileSync(layout, "utf8"))));
    assert.equal(await shown.textContent("#message"), "", layout);
    const found = await numbers(shown);
    if (Object.keys(found).length === 0) {
      assert.match(await shown.textContent("#results"), /has no \[(ideal|volume)\] table/, layout);
    } else {
      const known = printed(layout);
      assert.deepEqual(Object.fromEntries(Object.keys(known).map((key) => [key, found[key]])), known, layout);
    }
    await shown.close();
  }

  // 800 tiles.
  const large = await opened(context, published + (await fragmentOf(readFileSync("layouts/film-80mm.toml", "utf8"))));
  await large.evaluate(() => performance.clearMeasures());
  await dragBy(large, large.locator("[data-tile='300']"), [[2, 0], [3, 1], [2, 2], [1, 1], [2, 1], [3, 2]]);
  const medianOfLarge = await gestureTimes(large);
  await large.close();

  // A hostile name is text, and a broken layout is shown with its message.
  const hostile = join(folder, "hostile.toml");
  const name = `</script><img src=x onerror=alert(1)>`;
  writeFileSync(hostile, readFileSync("layouts/published-film.toml", "utf8").replace("published film", name));
  const named = await opened(context, written(hostile, "hostile"));
  assert.equal(await named.textContent("#title"), name);
  assert.equal(await named.locator("img").count(), 0);
  await named.close();
  const broken = await opened(context, published + (await fragmentOf("format = 1\nname = [\n")));
  assert.match(await broken.textContent("#message"), /TOML|invalid|array/);
  assert.equal(await broken.textContent("#title"), "published film");
  await broken.close();

  // A telephone: nothing is cut off; a finger scrolls until a tile is chosen, and then drags it.
  const phone = await browser.newContext({ viewport: { width: 390, height: 740 }, isMobile: true, hasTouch: true });
  const small = await opened(phone, published);
  assert.equal(await small.evaluate(() => document.documentElement.scrollWidth), 390);
  const tile = small.locator("[data-tile='9']");
  await tile.tap();
  assert.equal(await small.locator(".tile.selected").count(), 1);
  const before = await small.getByLabel("centre x, mm").inputValue();
  const box = await tile.boundingBox();
  const session = await phone.newCDPSession(small);
  const touch = (type, points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  const [x, y] = [box.x + box.width / 4, box.y + box.height / 4];
  await touch("touchStart", [{ x, y }]);
  for (let n = 1; n <= 5; n++) await touch("touchMove", [{ x: x - 2 * n, y: y - n }]);
  assert.notEqual(await small.getByLabel("centre x, mm").inputValue(), before, "a finger does not drag the chosen tile");
  await touch("touchEnd", []);
  await settled(small);
  await phone.close();

  console.log(
    `a gesture takes ${median.toFixed(1)} ms, with 800 tiles ${medianOfLarge.toFixed(1)} ms (medians); first paint ` +
      `${paint.toFixed(0)} ms, ready ${ready.toFixed(0)} ms; the page has ${(bytes / 1e6).toFixed(2)} MB; ` +
      `${layouts.length} layouts have the numbers of the program`,
  );
  assert.ok(median < SLOWEST * FRAME_MS, `a gesture takes ${median} ms`);
  assert.ok(medianOfLarge < SLOWEST * 50, `a gesture of 800 tiles takes ${medianOfLarge} ms`);
  assert.ok(paint < SLOWEST * 500, `the first paint takes ${paint} ms`);
  assert.ok(bytes < MOST_BYTES, `the page has ${bytes} bytes`);
} finally {
  await browser.close();
}
