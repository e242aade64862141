// Keyboard and screen reader: every control has a name, gets the focus visibly, and works by keys.
import assert from "node:assert/strict";

export async function checkControls(page, inVolume) {
  const session = await page.context().newCDPSession(page);
  const { nodes } = await session.send("Accessibility.getFullAXTree");
  const controls = nodes.filter((node) => ["button", "combobox", "slider", "checkbox", "link"].includes(node.role?.value));
  const nameless = controls.filter((node) => !node.name?.value);
  assert.deepEqual(nameless.map((node) => node.role.value), [], "controls without a name");
  const names = controls.map((node) => node.name.value);
  for (const name of ["Turn left", "Turn right", "Tilt up", "Tilt down", "Closer", "Farther", "From above", "Reset the view",
    "tile", ...(inVolume ? ["Show", "Point to the left", "Point below"] : [])]) {
    assert.ok(names.includes(name), `${name} is not among ${names}`);
  }

  // The tabulator key reaches each of them, and an outline shows the focus.
  const wanted = await page.evaluate(() =>
    [...document.querySelectorAll("button, select, input, a, canvas, summary")].filter((e) =>
      !e.disabled && e.getClientRects().length > 0).length);
  await page.evaluate(() => document.activeElement.blur());
  await page.mouse.move(2, 2);
  const reached = new Set();
  // Once more, because the focus may pass through the page.
  for (let n = 0; n <= wanted; n++) {
    await page.keyboard.press("Tab");
    const [index, outline] = await page.evaluate(() => {
      const all = [...document.querySelectorAll("button, select, input, a, canvas, summary")];
      const style = getComputedStyle(document.activeElement);
      return [all.indexOf(document.activeElement), style.outlineStyle === "none" ? 0 : parseFloat(style.outlineWidth)];
    });
    if (index < 0) continue;
    assert.ok(outline >= 2, `control ${index} has the focus without an outline`);
    reached.add(index);
  }
  assert.equal(reached.size, wanted, "controls that the tabulator key reaches");

  // The fraction of the view's pixels that differ clearly from the first call. Software rasterizers
  // draw thin lines a little differently each time.
  const changed = () => page.locator("#view").evaluate((canvas) => {
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const paper = copy.getContext("2d");
    paper.drawImage(canvas, 0, 0);
    const { data } = paper.getImageData(0, 0, copy.width, copy.height);
    window.firstView ??= data;
    let count = 0;
    for (let i = 0; i < data.length; i += 4) {
      count += [0, 1, 2].some((c) => Math.abs(data[i + c] - window.firstView[i + c]) > 60) ? 1 : 0;
    }
    return count / (copy.width * copy.height);
  });
  await page.locator("[data-turn=reset]").click();
  await changed();
  for (const turn of ["left", "right", "up", "down", "closer", "farther", "above"]) {
    await page.locator(`[data-turn=${turn}]`).focus();
    await page.keyboard.press("Enter");
    const turned = await changed();
    assert.ok(turned > 0.01, `the button ${turn} changes ${turned} of the view`);
    await page.locator("[data-turn=reset]").focus();
    await page.keyboard.press("Space");
    assert.ok((await changed()) < 0.005, "the button reset does not bring the view back");
  }
  for (const key of ["ArrowLeft", "ArrowUp", "+"]) {
    await page.locator("#view").focus();
    await page.keyboard.press(key);
    assert.ok((await changed()) > 0.01, `the key ${key} changes nothing`);
    await page.keyboard.press("Home");
    assert.ok((await changed()) < 0.005, "the key Home does not bring the view back");
  }
  if (!inVolume) return;
  const read = () => page.locator("#readout").textContent();
  await page.locator("[data-step=left]").focus();
  await page.keyboard.press("Enter");
  const middle = await read();
  assert.match(middle, / at x = 0, y = 0, /);
  await page.locator("#map").focus();
  for (const [key, at] of [["ArrowRight", /x = 0\.\d+, y = 0,/], ["ArrowUp", /x = 0\.\d+, y = 0\.\d+,/]]) {
    await page.keyboard.press(key);
    assert.match(await read(), at);
  }
  assert.equal(await page.locator("#readout").getAttribute("role"), "status");
}
