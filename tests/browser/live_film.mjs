// What a designer does with a film on the live page, wherever the page gets its numbers from.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(import.meta.url);

export const launch = (chromium, executablePath) => chromium.launch({ executablePath, args: ["--no-sandbox"] });

/** A page that is ready. It fails where the page asks for anything but its own address. */
export async function opened(context, url) {
  const page = await context.newPage();
  const fail = (what) => {
    page.failures = [...(page.failures ?? []), what];
  };
  page.on("pageerror", (error) => fail(String(error)));
  page.on("console", (message) => message.type() === "error" && !page.mayFail && fail(message.text()));
  page.on("request", (request) => {
    const to = new URL(request.url());
    if (!/^(data|blob|file):$/.test(to.protocol) && to.host !== new URL(url).host) fail(`asks for ${to}`);
  });
  await page.goto(url);
  await page.waitForSelector("html[data-ready]");
  await settled(page);
  return page;
}

/** Waits until nothing is computed for the page itself. */
export async function settled(page) {
  await page.evaluate(() => new Promise((done) => requestAnimationFrame(() => setTimeout(done, 20))));
  await page.waitForSelector("main[aria-busy=false]");
  assert.deepEqual(page.failures ?? [], []);
}

export const press = async (page, name) => {
  await page.getByRole("button", { name, exact: true }).click();
  await settled(page);
};

/** The numbers of the page by their names, as the program writes them. */
export async function numbers(page) {
  const cells = await page.locator(".results:visible [data-number]").evaluateAll((all) => all.map((cell) => [cell.dataset.number, cell.querySelector(".value").textContent]));
  return Object.fromEntries(cells.map(([name, text]) => [name, text.replace(/\u2212/g, "-")]));
}

/** Drags something by steps in pixels. `before` is called before it is let go. */
export async function dragBy(page, what, steps, before = async () => {}) {
  await what.scrollIntoViewIfNeeded();
  const box = await what.boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (const [dx, dy] of steps) await page.mouse.move(x + dx * 3, y + dy * 3);
  await settled(page);
  await before();
  await page.mouse.up();
  await settled(page);
}

/** Median time of the steps of gestures, as the page measures it. */
export async function gestureTimes(page) {
  const times = await page.evaluate(() => performance.getEntriesByName("gesture", "measure").map(({ duration }) => duration));
  assert.ok(times.length > 4, `${times.length} steps`);
  return times.sort((a, b) => a - b)[times.length >> 1];
}

const field = (page, label) => page.getByLabel(label, { exact: true });
const centre = async (page) => Promise.all(["x", "y"].map(async (axis) => Number(await field(page, `centre ${axis}, mm`).inputValue())));

/** Everything that a film is changed by. The page has the published film, and has it again at the end. */
export async function changeFilm(page) {
  const begun = await numbers(page);
  assert.equal(begun["displacement RMSE x"], "0.242179");
  const list = page.getByRole("listbox", { name: "Tiles" });
  const lock = page.getByLabel("keep the symmetry");
  const cause = (name) => page.locator(".causes li", { hasText: name });
  const reset = async () => {
    await press(page, "Reset");
    assert.deepEqual(await numbers(page), begun);
  };

  // A tile that is dragged onto its neighbours is red with its images, and is not kept.
  const tile = page.locator("[data-tile='20']");
  await dragBy(page, tile, [[1, 0], [2, -1], [3, -2], [2, -2]], async () => {
    assert.ok((await page.locator(".overlapping.tile").count()) >= 8);
    assert.notDeepEqual(await numbers(page), begun);
  });
  assert.match(await page.textContent("#message"), /overlapped: the change is not kept/);
  assert.deepEqual(await numbers(page), begun);
  assert.ok(await page.getByRole("button", { name: "Undo" }).isDisabled());

  // A corner that makes the tile smaller is kept, in one step of the history, with all eight images.
  await page.locator(".handle.corner").first().waitFor();
  await dragBy(page, page.locator(".handle.corner").nth(2), [[-1, 1], [-2, 2], [-3, 3]]);
  const smaller = await numbers(page);
  assert.notDeepEqual(smaller, begun);
  const widths = await page.locator(".tile polygon").evaluateAll((all) => all.map((shape) => shape.getBBox().width.toFixed(4)));
  const width = Number(await field(page, "side x, mm").inputValue());
  assert.ok(width < 3.3);
  assert.ok(widths.filter((of) => of === width.toFixed(4)).length >= 4, "images do not follow");
  await press(page, "Undo");
  assert.deepEqual(await numbers(page), begun);
  await press(page, "Redo");
  assert.deepEqual(await numbers(page), smaller);
  await reset();

  // The tip of an arrow turns J; the strength stays.
  await list.focus();
  await page.keyboard.press("Home");
  await page.locator(".handle.tip").waitFor();
  await lock.uncheck();
  await dragBy(page, page.locator(".handle.tip"), [[2, 0], [4, 0]]);
  assert.equal(await field(page, "strength, T").inputValue(), "0.12");
  assert.notEqual(Math.abs(Number(await field(page, "direction, degrees").inputValue())), 90);
  await lock.check();
  await reset();

  // A cut line moves all faces on it.
  const edges = () => page.locator(".tile polygon").evaluateAll((all) => new Set(all.map((shape) => shape.getBBox().x.toFixed(3))).size);
  const faces = await edges();
  await dragBy(page, page.locator(".grip").nth(2), [[1, 0], [2, 0]]);
  assert.notDeepEqual(await numbers(page), begun);
  assert.equal(await edges(), faces);
  await reset();

  // Keys move a tile by the resolution, with Shift by ten; typed numbers are taken with their unit.
  await list.focus();
  await page.keyboard.press("Home");
  await page.keyboard.press("PageDown");
  await page.keyboard.press("PageDown");
  await page.keyboard.press("PageUp");
  assert.equal(await page.locator("[role=option][aria-selected=true]").count(), 1);
  await lock.uncheck();
  await field(page, "side x, mm").fill("0.5");
  await page.keyboard.press("Tab");
  await settled(page);
  const from = await centre(page);
  await list.focus();
  await page.keyboard.press("ArrowRight");
  await settled(page);
  await page.keyboard.press("Shift+ArrowRight");
  await settled(page);
  const to = await centre(page);
  assert.deepEqual([to[0] - from[0], to[1] - from[1]].map((c) => c.toFixed(6)), ["0.011000", "0.000000"]);
  const alone = await page.locator(".tile polygon").evaluateAll((all) => all.filter((shape) => shape.getBBox().width < 0.51).length);
  assert.equal(alone, 1, "without the symmetry one tile changes");
  await lock.check();
  await reset();

  // An impossible number is refused with its rule, and the field has the old one again.
  await tile.click();
  await field(page, "side x, mm").fill("-1");
  await page.keyboard.press("Tab");
  await settled(page);
  assert.match(await page.textContent("#message"), /size\[0\] = -1/);
  assert.equal(await field(page, "side x, mm").inputValue(), "3.3");
  // A typed number of a tile on the diagonal is taken as it is; a turn is refused.
  await field(page, "side x, mm").fill("3");
  await page.keyboard.press("Tab");
  await settled(page);
  assert.deepEqual([await field(page, "side x, mm").inputValue(), await field(page, "side y, mm").inputValue()], ["3", "3"]);
  assert.match(await page.textContent("#message"), /The lattice is written as 56 tiles/);
  await field(page, "direction, degrees").fill("10");
  await page.keyboard.press("Tab");
  await settled(page);
  assert.match(await page.textContent("#message"), /symmetry of the film fixes/);
  assert.equal(await field(page, "strength, T").inputValue(), "0.12");
  await reset();

  // A cut line is typed.
  await page.getByLabel("Cut line", { exact: true }).selectOption({ index: 1 });
  await page.getByLabel("place of the cut line, mm").fill("-5.5");
  await page.keyboard.press("Tab");
  await settled(page);
  assert.match(await page.getByLabel("Cut line", { exact: true }).locator("option").nth(1).textContent(), /x = \u22125.5 mm/);
  assert.notDeepEqual(await numbers(page), begun);
  await reset();

  // A change of temperature needs no other number.
  await page.getByRole("checkbox", { name: "change of temperature" }).check();
  await cause("temperature").waitFor();
  assert.equal(await page.textContent("#message"), "");
  await reset();

  // Sensor and surroundings: a second sensor rejects a stray field.
  await page.getByLabel("errors of the tiles").selectOption("workshop");
  await page.getByRole("checkbox", { name: "uniform stray field after the first reading" }).check();
  await cause("stray field").waitFor();
  const total = async () => Number((await page.textContent(".total")).split(" ")[0]);
  await page.waitForFunction(() => /mm RMS/.test(document.querySelector(".total").textContent));
  const withOne = await total();
  await page.getByLabel("sensors", { exact: true }).selectOption("pair-z");
  await page.locator(".causes li", { hasText: /stray field\s*0 mm/ }).waitFor();
  assert.ok((await total()) < withOne);
  await page.getByRole("slider", { name: "least distance of the sensor below the film" }).fill("4");
  await settled(page);
  assert.equal(await page.getByRole("spinbutton", { name: "least distance of the sensor below the film, mm" }).inputValue(), "4");
  await press(page, "Simulate 200 films");
  await page.locator(".made p", { hasText: "200 films" }).waitFor({ timeout: 60000 });

  // Two states are compared.
  await press(page, "Pin this film");
  await page.getByRole("slider", { name: "least distance of the sensor below the film" }).fill("3.5");
  await settled(page);
  const nearer = await numbers(page);
  assert.match(await page.textContent(".results"), /[+\u2212]0\.0/);
  await press(page, "Swap with the pinned film");
  assert.notDeepEqual(await numbers(page), nearer);
  await press(page, "Swap with the pinned film");
  assert.deepEqual(await numbers(page), nearer);
  await press(page, "Unpin");

  // The text keeps the comments of the layout.
  const [saved] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Download TOML" }).click()]);
  assert.equal(saved.suggestedFilename(), "published-film.toml");
  const text = readFileSync(await saved.path(), "utf8");
  assert.match(text, /# The sensor of Dai 2024/);
  assert.match(text, /preset = "workshop"/);
  assert.match(text, /\[\[lattice\]\]/);
  const [picture] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Download PNG" }).click()]);
  const png = readFileSync(await picture.path());
  assert.deepEqual([png.subarray(1, 4).toString(), png.readUInt32BE(16)], ["PNG", 2126]);
  await reset();

  // A search that is stopped keeps its best film.
  await page.getByRole("button", { name: "Improve" }).click();
  await page.waitForFunction(() => /error of the goal .* \(\d+ rounds?\)/.test(document.querySelector(".search").textContent), null, { timeout: 60000 });
  await page.getByRole("button", { name: "Stop" }).click();
  await page.waitForFunction((old) => document.querySelector("[data-number='displacement RMSE x'] .value").textContent !== old, begun["displacement RMSE x"]);
  assert.ok(Number((await numbers(page))["displacement RMSE x"]) < 0.2);
  await reset();
}

/** No serious finding of an accessibility check. */
export async function checkAccess(page) {
  await page.evaluate(readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"));
  const { violations } = await page.evaluate(() => globalThis.axe.run({ resultTypes: ["violations"] }));
  const serious = violations.filter(({ impact }) => ["serious", "critical"].includes(impact));
  assert.deepEqual(serious.map(({ id, nodes }) => [id, nodes.map(({ target }) => target.join(" "))]), []);
}
