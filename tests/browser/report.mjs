// Opens the page of `magsplice report` in a headless browser and uses it like a reader.
// Usage: node report.mjs PROGRAM BROWSER LAYOUT FOLDER
// FOLDER is the folder written by the program for LAYOUT.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { mkdtempSync, readFileSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

import { checkControls } from "./controls.mjs";
import { checkPhone } from "./phone.mjs";
import { checkScheme } from "./scheme.mjs";
import { checkTiles, nearest } from "./tiles.mjs";

// Found through NODE_PATH, which `import` does not use.
const { chromium } = createRequire(import.meta.url)("playwright-core");
const [program, executablePath, layout, folder] = process.argv.slice(2);
const run = (...args) => execFileSync(program, args, { encoding: "utf8" });

const browser = await chromium.launch({
  executablePath,
  args: ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"],
});
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 1000 } });
  const errors = [];
  page.on("console", (message) => message.type() === "error" && errors.push(message.text()));
  page.on("pageerror", (error) => errors.push(String(error)));
  page.on("request", (request) => /^(file|data):/.test(request.url()) || errors.push(`asks for ${request.url()}`));
  await page.goto(pathToFileURL(resolve(folder, "report.html")).href);

  // The mouse reaches only what is on the screen.
  await page.locator("#views").evaluate((views) => views.scrollIntoView());

  const data = JSON.parse(await page.locator("#data").textContent());
  const inVolume = Boolean(data.volume);
  const withIdeal = data.maps.some((map) => map.name === "R_x");

  // Figures.
  const figures = await page.locator("figure img").evaluateAll(async (images) => {
    await Promise.all(images.map((image) => image.decode()));
    return images.map((image) => [image.closest("figure").id, image.naturalWidth, image.naturalHeight]);
  });
  // The resolution of the sensor, and an experiment.
  const ofSensor = /^\[sensor\]$/m.test(readFileSync(layout, "utf8")) ? 2 : 0;
  assert.equal(figures.length, (withIdeal ? 8 : inVolume ? 5 : 1) + ofSensor, `figures: ${figures}`);
  for (const [name, width, height] of figures) assert.ok(width > 300 && height > 200, `${name}: ${width} x ${height}`);

  // The hash of the layout, and the printed results.
  const sha256 = createHash("sha256").update(readFileSync(layout)).digest("hex");
  assert.equal(await page.locator("#sha256").textContent(), sha256);
  if (withIdeal) {
    assert.match(await page.locator("#verdict").textContent(), /^The film (keeps|breaks)/);
    const numbers = JSON.parse(await page.locator("#numbers-json").textContent());
    // The page has the points in its maps instead.
    const { columns, shape, ...report } = JSON.parse(run("decouple", layout, "--format", "json"));
    assert.ok(columns && shape);
    assert.deepEqual(numbers, report);
  }
  assert.equal(await page.locator(".absent").count(), withIdeal ? 0 : inVolume ? 1 : 2);

  // The view of the tiles.
  const pixels = async (id) => {
    const image = await page.locator(id).evaluate((canvas) => canvas.toDataURL());
    return createHash("sha256").update(image).digest("hex");
  };
  // The fraction of the view's pixels that differ clearly from the first call with `false`, or, in
  // calls with `false`, from white.
  const changed = (sinceFirst) =>
    page.locator("#view").evaluate((canvas, sinceFirst) => {
      const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
      const paper = copy.getContext("2d");
      paper.drawImage(canvas, 0, 0);
      const { data } = paper.getImageData(0, 0, copy.width, copy.height);
      const old = sinceFirst ? window.kept : new Uint8ClampedArray(data.length).fill(255);
      window.kept ??= data;
      let count = 0;
      for (let i = 0; i < data.length; i += 4) {
        count += [0, 1, 2].some((c) => Math.abs(data[i + c] - old[i + c]) > 60) ? 1 : 0;
      }
      return count / (copy.width * copy.height);
    }, sinceFirst);
  // The fraction of the view's pixels that have the colour of a tile, in any shade.
  const coloured = (colours) =>
    page.locator("#view").evaluate((canvas, colours) => {
      const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
      const paper = copy.getContext("2d");
      paper.drawImage(canvas, 0, 0);
      const { data } = paper.getImageData(0, 0, copy.width, copy.height);
      const lit = (i, colour) => {
        const most = colour.indexOf(Math.max(...colour));
        const light = data[i + most] / colour[most];
        return light > 0.55 && light < 1.02 && colour.every((c, n) => Math.abs(data[i + n] - light * c) < 4);
      };
      let count = 0;
      for (let i = 0; i < data.length; i += 4) count += colours.some((colour) => lit(i, colour)) ? 1 : 0;
      return count / (copy.width * copy.height);
    }, colours);
  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  const tiles = await coloured([...new Set(data.tiles.map((tile) => tile.colour))].map(rgb));
  assert.ok(tiles > 0.01, `tiles cover ${tiles} of the view`);
  await changed(false);
  const view = await page.locator("#view").boundingBox();
  const middle = [view.x + view.width / 2, view.y + view.height / 2];
  for (const [across, along] of [[90, 0], [0, 60]]) {
    await page.mouse.move(...middle);
    assert.ok((await changed(true)) < 0.01, "the view turns without being dragged");
    await page.mouse.down();
    await page.mouse.move(middle[0] + across, middle[1] + along, { steps: 4 });
    await page.mouse.up();
    const turned = await changed(true);
    assert.ok(turned > 0.1 * tiles, `dragging by ${[across, along]} changes ${turned} of the view, tiles cover ${tiles}`);
    await page.mouse.dblclick(...middle);
  }
  assert.ok((await changed(true)) < 0.01, "a double click does not bring the view back");

  if (inVolume) await checkMap(page, data, withIdeal, pixels);
  await checkTiles(page, data, run);
  await checkControls(page, inVolume);
  for (const width of [390, 320]) await checkPhone(browser, page.url(), width, inVolume);
  await checkScheme(browser, page.url(), inVolume);
  assert.deepEqual(errors, []);
  const maps = inVolume ? `, ${data.maps.length} maps` : "";
  const counted = (number, noun) => `${number} ${noun}${number === 1 ? "" : "s"}`;
  const [figureCount, tileCount] = [counted(figures.length, "figure"), counted(data.tiles.length, "tile")];
  console.log(`${folder}/report.html: ${figureCount}, ${tileCount}${maps}, no error`);
} finally {
  await browser.close();
}

async function checkMap(page, data, withIdeal, pixels) {
  const { x_mm: xs, y_mm: ys, z_mm: zs } = data.volume;
  const number = (text) => Number(text.replace(/\u2212/g, "-"));
  const reading = async () => {
    const text = await page.locator("#readout").textContent();
    const parts = text.match(/^(.+) = (\S+) (.+) at x = (\S+), y = (\S+), z = (\S+) mm$/);
    assert.ok(parts, `the readout says: ${text}`);
    const [, name, value, unit, ...at] = parts;
    return { name, value: number(value), unit, at: at.map(number) };
  };

  // The slider.
  const slider = page.locator("#plane");
  const label = () => page.locator("#z").textContent();
  const [map, z] = [await pixels("#map"), await label()];
  const plane = Number(await slider.inputValue());
  assert.equal(number(z.match(/z = (\S+) mm/)[1]), zs[plane]);
  await slider.focus();
  await page.keyboard.press("ArrowRight");
  assert.equal(number((await label()).match(/z = (\S+) mm/)[1]), zs[plane + 1]);
  assert.notEqual(await label(), z, "the slider does not change z");
  assert.notEqual(await pixels("#map"), map, "the slider does not change the map");

  // Values under the cursor against the values printed by the program for the same points.
  const rowAt = (at) => {
    const points = join(mkdtempSync(join(tmpdir(), "magsplice-")), "point.csv");
    writeFileSync(points, `x_mm,y_mm,z_mm\n${[xs, ys, zs].map((of, i) => of[nearest(of, at[i])]).join(",")}\n`);
    return run("field", layout, "--points", points).trim().split("\n")[1].split(",").map(Number);
  };
  const perT = { T: 1, mT: 1e3, "\u00b5T": 1e6, nT: 1e9 };
  const box = await page.locator("#map").boundingBox();
  const seen = new Set();
  for (const [across, along] of [[0.3, 0.3], [0.5, 0.15], [0.65, 0.6], [0.2, 0.7], [0.4, 0.45]]) {
    await page.mouse.move(box.x + across * box.width, box.y + along * box.height);
    const { name, value, unit, at } = await reading();
    assert.equal(name, "B_x");
    const row = rowAt(at);
    assert.ok(row.slice(0, 3).every((c, i) => Math.abs(c - at[i]) < 1e-3), `no point of the grid at ${at}`);
    assert.equal(at[2], zs[plane + 1]);
    assert.ok(Math.abs(value / perT[unit] - row[3]) <= 1e-8 * Math.abs(row[3]), `${value} ${unit}, not ${row[3]} T`);
    seen.add(String(at));
  }
  assert.equal(seen.size, 5, "different places of the map are different points");
  // x grows to the right, y upwards.
  const places = [...seen].map((at) => at.split(",").map(Number));
  assert.ok(places[0][0] < places[2][0] && places[1][1] > places[2][1], `${places}`);

  if (!withIdeal) return;
  // On the axis of this film B_x is round-off, which is 0.
  await page.mouse.move(...(await page.locator("#map").evaluate((canvas) => {
    const box = canvas.getBoundingClientRect();
    const { left, top, width, height } = canvas.area;
    return [box.left + 1 + left + width / 2, box.top + 1 + top + height / 2];
  })));
  assert.match(await page.locator("#readout").textContent(), /^B_x = 0 \S+ at x = 0, y = 0,/);
  for (const name of ["B_z \u2212 ideal", "S_z"]) {
    await page.locator("#quantity").selectOption({ label: name });
    await page.mouse.move(box.x + 0.3 * box.width, box.y + 0.3 * box.height);
    const { name: shown, value, unit, at } = await reading();
    assert.equal(shown, name);
    const index = [xs, ys, zs].reduce((i, all, axis) => i * all.length + nearest(all, at[axis]), 0);
    const values = (name) => data.maps.find((map) => map.name === name).values[index];
    const expected = name === "S_z" ? values("S_z") : values("B_z") - values("ideal B_z");
    assert.ok(Math.abs(value / (perT[unit] ?? 1) - expected) <= 1e-7 * Math.abs(expected), `${name}: ${value}`);
  }
}
