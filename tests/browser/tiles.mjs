// The view of the tiles: the frame of the working volume, names of tiles, their share of B.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export async function checkTiles(page, data, run) {
  await page.locator("[data-turn=reset]").click();
  if (data.volume) await checkFrame(page);
  await checkNames(page, data);
  if (data.volume) await checkShares(page, data, run);
}

// The fraction of each of the twelve edges of the working volume that has the colour of the frame.
const frameEdges = (page) =>
  page.locator("#view").evaluate((canvas) => {
    const { lower_mm, upper_mm } = JSON.parse(document.getElementById("data").textContent).volume;
    const copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
    const paper = copy.getContext("2d");
    paper.drawImage(canvas, 0, 0);
    const { data } = paper.getImageData(0, 0, copy.width, copy.height);
    const hex = getComputedStyle(document.documentElement).getPropertyValue("--volume").trim();
    const colour = [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
    const blue = (x, y) => {
      for (let dx = -2; dx <= 2; dx++) for (let dy = -2; dy <= 2; dy++) {
        const at = 4 * ((Math.round(y) + dy) * copy.width + Math.round(x) + dx);
        if (colour.every((c, i) => Math.abs(data[at + i] - c) < 30)) return true;
      }
      return false;
    };
    const corner = (i) => [0, 1, 2].map((axis) => ((i >> axis) & 1 ? upper_mm : lower_mm)[axis]);
    const edges = [];
    for (let axis = 0; axis < 3; axis++) for (let from = 0; from < 8; from++) {
      if ((from >> axis) & 1) continue;
      const [a, b] = [corner(from), corner(from | (1 << axis))];
      let seen = 0;
      for (let n = 0; n <= 40; n++) {
        const [x, y] = canvas.place(a.map((c, i) => c + (n / 40) * (b[i] - c)));
        seen += blue(x, y) ? 1 : 0;
      }
      edges.push(seen / 41);
    }
    return edges;
  });

async function checkFrame(page) {
  const opening = await frameEdges(page);
  const solid = opening.filter((part) => part > 0.9).length;
  assert.ok(solid >= 9, `the view opens with ${solid} solid edges of the working volume: ${opening}`);
  const view = await page.locator("#view").boundingBox();
  const middle = [view.x + view.width / 2, view.y + view.height / 2];
  for (const by of [[0, 0], [120, 0], [150, 20], [0, 60], [70, -120], [-200, 90], [10, 250]]) {
    await page.mouse.move(...middle);
    await page.mouse.down();
    await page.mouse.move(middle[0] + by[0], middle[1] + by[1], { steps: 5 });
    await page.mouse.up();
    const edges = await frameEdges(page);
    assert.ok(edges.every((part) => part > 0.4), `after a drag by ${by} the frame shows ${edges}`);
  }
  await page.locator("[data-turn=reset]").click();
}

// The position of the middle of a tile's upper face in the view from above.
async function above(page, tile) {
  await page.locator("[data-turn=above]").click();
  const view = await page.locator("#view").boundingBox();
  const [x, y] = await page.locator("#view").evaluate((canvas, point) => canvas.place(point), tile.centre_mm);
  return [view.x + 1 + x, view.y + 1 + y];
}

async function checkNames(page, data) {
  for (const tile of new Set([data.tiles[0], data.tiles.at(-1)])) {
    const at = await above(page, tile);
    await page.mouse.move(...at);
    assert.equal(await page.locator("#tip").textContent(), tile.name);
    assert.ok(await page.locator("#tip").isVisible(), "the name appears under the mouse");
    const line = await page.locator("#tile").textContent();
    assert.ok(line.startsWith(`${tile.name}: J = (`), line);
    // A click keeps the tile when the mouse leaves.
    await page.mouse.click(...at);
    await page.mouse.move(2, 2);
    assert.ok(!(await page.locator("#tip").isVisible()), "the name leaves with the mouse");
    assert.ok((await page.locator("#tile").textContent()).startsWith(`${tile.name}: J = (`));
    assert.equal(await page.locator("#tiles option:checked").textContent(), tile.name);
  }
  await page.locator("#tiles").selectOption("");
  await page.locator("[data-turn=reset]").click();
}

// The index of the coordinate that is shown as `c`, rounded.
export function nearest(all, c) {
  return all.reduce((best, other, i) => (Math.abs(other - c) < Math.abs(all[best] - c) ? i : best), 0);
}

async function checkShares(page, data, run) {
  // The fields of all tiles add up to the field of the film.
  const worst = await page.evaluate(() => {
    const data = JSON.parse(document.getElementById("data").textContent);
    const { x_mm: xs, y_mm: ys, z_mm: zs } = data.volume;
    const names = ["B_x", "B_y", "B_z"].map((name) => data.maps.find((map) => map.name === name).values);
    let worst = 0;
    for (const [i, j, k] of [[0, 0, 0], [1, 2, 1], [xs.length - 1, 0, zs.length - 1]]) {
      const index = (i * ys.length + j) * zs.length + k;
      const sum = [0, 0, 0];
      for (const tile of data.tiles) tileField(tile, [xs[i], ys[j], zs[k]]).forEach((c, n) => (sum[n] += c));
      const b = names.map((values) => values[index]);
      worst = Math.max(worst, Math.hypot(...sum.map((c, n) => c - b[n])) / Math.hypot(...b));
    }
    return worst;
  });
  assert.ok(worst < 1e-10, `the tiles add up to B but for ${worst}`);

  // The share of one tile, against its field by the program.
  const tile = data.tiles[0];
  const map = await page.locator("#map").boundingBox();
  await page.mouse.move(map.x + 0.3 * map.width, map.y + 0.3 * map.height);
  const largest = await page.locator("#tile").textContent();
  assert.match(largest, /^Largest shares of B at x = .*: .+ \S+ %/);
  await page.locator("#tiles").selectOption(tile.name);
  const line = await page.locator("#tile").textContent();
  const found = line.match(/At x = (\S+), y = (\S+), z = (\S+) mm its B is .*, (\S+) % of B\.$/);
  assert.ok(found, line);
  const [x, y, z, percent] = found.slice(1).map((text) => Number(text.replace(/\u2212/g, "-")));
  const folder = mkdtempSync(join(tmpdir(), "magsplice-"));
  const [layout, points] = [join(folder, "tile.toml"), join(folder, "points.csv")];
  assert.deepEqual(tile.axes, [[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
  const { centre_mm, size_mm, polarization_t } = tile;
  writeFileSync(layout, `format = 1\nname = "one"\n[[tile]]\nposition_mm = ${JSON.stringify(centre_mm)}\n`
    + `size_mm = ${JSON.stringify(size_mm)}\npolarization_t = ${JSON.stringify(polarization_t)}\n`);
  writeFileSync(points, `x_mm,y_mm,z_mm\n${x},${y},${z}\n`);
  const own = run("field", layout, "--points", points).trim().split("\n")[1].split(",").slice(3, 6).map(Number);
  rmSync(folder, { recursive: true });
  const { x_mm, y_mm, z_mm } = data.volume;
  const index = [[x_mm, x], [y_mm, y], [z_mm, z]].reduce((i, [all, c]) => i * all.length + nearest(all, c), 0);
  const b = ["B_x", "B_y", "B_z"].map((name) => data.maps.find((map) => map.name === name).values[index]);
  const dot = (p, q) => p.reduce((sum, c, i) => sum + c * q[i], 0);
  const expected = (100 * dot(own, b)) / dot(b, b);
  assert.ok(Math.abs(percent - expected) <= 0.006 * Math.abs(expected), `${percent} %, not ${expected} %`);
  await page.locator("#tiles").selectOption("");
}
