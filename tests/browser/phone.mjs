// The page on a telephone: a tap keeps its value, a swipe scrolls, nothing is cut off or empty.
import assert from "node:assert/strict";

export async function checkPhone(browser, url, width, inVolume) {
  const context = await browser.newContext({
    viewport: { width, height: 740 }, isMobile: true, hasTouch: true, deviceScaleFactor: 2,
  });
  const page = await context.newPage();
  await page.goto(url);
  // No element is wider than the screen, and no text wider than its box.
  const wide = await page.evaluate(() => {
    const all = [...document.body.querySelectorAll("*")].filter((e) => !e.closest("script, option, optgroup"));
    const visible = all.filter((e) => e.getClientRects().length > 0);
    const beyond = visible.filter((e) => {
      const box = e.getBoundingClientRect();
      return box.right > innerWidth + 0.5 || box.left < -0.5 || e.scrollWidth > e.clientWidth + 1 && e.clientWidth > 0
        && getComputedStyle(e).display !== "inline" && !["SELECT", "INPUT"].includes(e.tagName);
    });
    return [document.documentElement.scrollWidth, ...beyond.map((e) => `${e.tagName} ${e.id} ${e.className}`)];
  });
  assert.deepEqual(wide, [width], "what is cut off at this width");
  // Numbers stay on one line.
  const broken = await page.locator(".numbers td").evaluateAll((cells) => cells.filter((cell) => {
    const range = document.createRange();
    range.selectNodeContents(cell);
    return new Set([...range.getClientRects()].map((box) => Math.round(box.top))).size > 1;
  }).map((cell) => cell.textContent));
  assert.deepEqual(broken, [], "numbers that are broken on a telephone");
  // A tap enlarges a figure beyond the screen, and the link in its corner closes it.
  const image = page.locator("figure img").first();
  assert.ok((await image.boundingBox()).width <= width);
  await image.tap();
  assert.ok((await image.boundingBox()).width > 1000, "a tap does not enlarge the figure");
  // A link that vanishes while it is touched may keep the browser from answering the driver.
  await page.locator("figure .close").first().evaluate((link) => link.click());
  assert.ok((await image.boundingBox()).width <= width, "the figure stays enlarged");
  // Each canvas is filled: its drawing covers most of its height.
  for (const id of inVolume ? ["#view", "#map"] : ["#view"]) {
    const filled = await page.locator(id).evaluate((canvas) => {
      const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
      const paper = copy.getContext("2d");
      paper.drawImage(canvas, 0, 0);
      const { data } = paper.getImageData(0, 0, copy.width, copy.height);
      let [low, high, left, right] = [copy.height, 0, copy.width, 0];
      for (let y = 0; y < copy.height; y++) for (let x = 0; x < copy.width; x++) {
        const at = 4 * (y * copy.width + x);
        if (data[at] + data[at + 1] + data[at + 2] > 740) continue;
        [low, high, left, right] = [Math.min(low, y), Math.max(high, y), Math.min(left, x), Math.max(right, x)];
      }
      return [(right - left) / copy.width, (high - low) / copy.height];
    });
    assert.ok(Math.max(...filled) > 0.6, `${id} is filled to ${filled} of its width and height`);
    if (id === "#map") assert.ok(Math.min(...filled) > 0.75, `${id} is filled to ${filled} of its width and height`);
  }

  // A swipe that begins on a drawing scrolls the page.
  const session = await context.newCDPSession(page);
  const touch = async (type, points) => session.send("Input.dispatchTouchEvent", {
    type, touchPoints: points.map(([x, y]) => ({ x, y })),
  });
  for (const id of inVolume ? ["#view", "#map"] : ["#view"]) {
    await page.locator(id).evaluate((canvas) => scrollTo(0, canvas.getBoundingClientRect().top + scrollY - 250));
    const before = await page.evaluate(() => scrollY);
    const box = await page.locator(id).boundingBox();
    const at = [box.x + box.width / 2, box.y + box.height / 2];
    await touch("touchStart", [at]);
    for (let n = 1; n <= 10; n++) await touch("touchMove", [[at[0], at[1] - 20 * n]]);
    await touch("touchEnd", []);
    await page.waitForFunction((before) => scrollY > before + 80, before, { timeout: 5000 }).catch(() => {
      assert.fail(`a swipe on ${id} does not scroll the page`);
    });
  }
  if (inVolume) {
    assert.match(await page.locator("#readout").textContent(), /^Point at/, "a swipe is no tap");
    const box = await page.locator("#map").boundingBox();
    await page.locator("#map").tap({ position: { x: 0.4 * box.width, y: 0.35 * box.height } });
    await page.waitForTimeout(300);
    assert.match(await page.locator("#readout").textContent(), / = \S+ .* at x = /, "a tap leaves its value");
  }
  // A tap on a tile keeps its name.
  await page.locator("[data-turn=above]").tap();
  const [name, [x, y]] = await page.locator("#view").evaluate((canvas) => {
    const tile = JSON.parse(document.getElementById("data").textContent).tiles[0];
    return [tile.name, canvas.place(tile.centre_mm)];
  });
  await page.locator("#view").tap({ position: { x, y } });
  await page.waitForTimeout(300);
  assert.ok((await page.locator("#tile").textContent()).startsWith(`${name}: J = (`), "a tap on a tile leaves its name");
  await context.close();
}
