// The dark scheme: text and drawings contrast with a dark page, and figures are on white paper.
import assert from "node:assert/strict";

export async function checkScheme(browser, url, inVolume) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 1000 }, colorScheme: "dark" });
  const page = await context.newPage();
  await page.goto(url);
  const contrasts = await page.evaluate(() => {
    const luminance = (colour) => {
      const [r, g, b] = colour.match(/[\d.]+/g).slice(0, 3).map(Number).map((c) => c / 255)
        .map((c) => (c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4));
      return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const page = luminance(getComputedStyle(document.body).backgroundColor);
    const texts = ["h1", "dt", "dd", ".numbers th", "figcaption", "figcaption a", "#tile", ".hint"]
      .filter((text) => document.querySelector(text));
    const contrast = (colour) => (luminance(colour) + 0.05) / (page + 0.05);
    return [["the page", page < 0.05 ? 21 : 0],
      ...texts.map((text) => [text, contrast(getComputedStyle(document.querySelector(text)).color)])];
  });
  assert.ok(contrasts.length > 4, `few texts: ${contrasts}`);
  // 4.5 is the minimum contrast of text in WCAG.
  for (const [text, contrast] of contrasts) assert.ok(contrast >= 4.5, `${text} has a contrast of ${contrast}`);
  const corner = (id) => page.locator(id).evaluate((canvas) => {
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const paper = copy.getContext("2d");
    paper.drawImage(canvas, 0, 0);
    return [...paper.getImageData(2, 2, 1, 1).data.slice(0, 3)];
  });
  for (const id of inVolume ? ["#view", "#map"] : ["#view"]) {
    assert.ok((await corner(id)).every((c) => c < 60), `the paper of ${id} is ${await corner(id)}`);
  }
  const figure = await page.locator("figure img").first().evaluate((image) => getComputedStyle(image).backgroundColor);
  assert.equal(figure, "rgb(255, 255, 255)");
  await context.close();
}
