// The modules without a page: `node --test crates/live-page/page`.
import assert from "node:assert/strict";
import test from "node:test";

import { ticks } from "#axis";
import { causesOf } from "#causes";
import { directionColour, valueScale } from "#colours";
import { cutEdit, cuts, outline } from "#film_view";
import { difference, number, short, snapped } from "#format";
import { fragmentOf, textIn } from "#link";
import { strayField } from "#surroundings";
import { editedImages, operations, orbit } from "#symmetry";

const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const tile = (name, position_mm, size_mm, polarization_t) => ({ name, position_mm, size_mm, polarization_t, axes: AXES, is_strip: false });

test("numbers have the digits of the program", () => {
  assert.equal(number(0.0628714), "0.062871");
  assert.equal(number(6.08541e-4), "6.08541e\u22124");
  assert.equal(number(-123456.7), "\u22121.23457e5");
  assert.equal(number(-0), "0.000000");
  assert.equal(number(null), "none");
  assert.equal(number(Infinity), "none");
  assert.equal(short(-0.12345678), "\u22120.1235");
  assert.equal(difference(1e-8), "no change");
  assert.equal(difference(0.25), "+0.25");
  assert.equal(snapped(1.23456, 0.01), 1.23);
  assert.equal(snapped(-0.0001, 0.01), 0);
});

test("operations map a film onto itself", () => {
  assert.deepEqual([operations("none"), operations("mirror"), operations("four-fold")].map((all) => all.length), [1, 4, 8]);
  const eight = operations("four-fold").flatMap(({ exchange, signs: [a, b] }) => {
    const [x, y] = exchange ? [2, 3] : [3, 2];
    const j = exchange ? [0.1, 0.2] : [0.2, 0.1];
    return [tile("t", [a * x, b * y, 0.5], exchange ? [2, 1, 1] : [1, 2, 1], [a * j[0], b * j[1], 0])];
  });
  const images = orbit(eight, 5, "four-fold");
  assert.equal(new Set(images.map(({ tile: of }) => of)).size, 8);
  const edits = editedImages(images, eight[5], { ...eight[5], position_mm: eight[5].position_mm.map((c, i) => (i === 0 ? c * 1.1 : c)) });
  edits.forEach((edit) => Object.assign(eight[edit.tile], edit));
  assert.equal(new Set(orbit(eight, 0, "four-fold").map(({ tile: of }) => of)).size, 8, "the symmetry is kept");
  // Without an image, or without the symmetry, a tile moves alone.
  assert.equal(orbit(eight.slice(0, 7), 0, "four-fold").length, 1);
  assert.equal(orbit(eight, 0, "none").length, 1);
});

test("a tile on a mirror stays on it", () => {
  const pair = [tile("a", [0, 3, 0.5], [2, 1, 1], [0, 0.1, 0]), tile("b", [0, -3, 0.5], [2, 1, 1], [0, -0.1, 0])];
  const edited = (shape, isTyped) => editedImages(orbit(pair, 0, "mirror"), pair[0], { ...pair[0], ...shape }, isTyped);
  for (const isTyped of [false, true]) {
    assert.deepEqual(edited({ position_mm: [0.4, 3.2, 0.5] }, isTyped).map(({ position_mm }) => position_mm), [[0, 3.2, 0.5], [0, -3.2, 0.5]]);
    assert.deepEqual(edited({ size_mm: [3, 1, 1] }, isTyped).map(({ size_mm }) => size_mm), [[3, 1, 1], [3, 1, 1]]);
    // Nothing is left of a motion across the mirror, or of a turn.
    assert.deepEqual(edited({ position_mm: [0.4, 3, 0.5] }, isTyped), []);
    assert.deepEqual(edited({ polarization_t: [0.1, 0, 0] }, isTyped), []);
    // Reversed, it has the same line.
    assert.deepEqual(edited({ polarization_t: [0, -0.1, 0] }, isTyped)[0].polarization_t, [0, -0.1, 0]);
    const stronger = edited({ polarization_t: [0, 0.2, 0] }, isTyped).map(({ polarization_t }) => polarization_t);
    assert.deepEqual(stronger, [[0, 0.2, 0], [0, -0.2, 0]]);
  }
});

test("a typed number of a tile on a diagonal is taken as it is", () => {
  const four = [[1, 1], [-1, 1], [1, -1], [-1, -1]].map(([a, b], i) => tile(String(i), [2 * a, 2 * b, 0.5], [3, 3, 1], [0.1 * a, 0.1 * b, 0]));
  const edited = (shape, isTyped) => editedImages(orbit(four, 0, "four-fold"), four[0], { ...four[0], ...shape }, isTyped)[0];
  assert.deepEqual(edited({ size_mm: [2.5, 3, 1] }, true).size_mm, [2.5, 2.5, 1]);
  assert.deepEqual(edited({ size_mm: [-1, 3, 1] }, true).size_mm, [-1, -1, 1]);
  assert.deepEqual(edited({ position_mm: [2.25, 2, 0.5] }, true).position_mm, [2.25, 2.25, 0.5]);
  assert.deepEqual(edited({ position_mm: [2, 2, 0.75] }, true).position_mm, [2, 2, 0.75]);
  // A pointer moves it along the diagonal.
  assert.deepEqual(edited({ position_mm: [2.5, 2.25, 0.5] }, false).position_mm, [2.375, 2.375, 0.5]);
});

test("a cut line moves with its mirror image, and widths keep their sum", () => {
  const lattice = { start_mm: [-3, -3, 0], x: [{ widths_mm: [1, 2, 2, 1], pattern: [0, 1, -1, 0] }] };
  assert.deepEqual(cuts(lattice, 1).map(({ at_mm }) => at_mm), [-2, 0, 2]);
  const document = { lattice: [lattice] };
  const edit = (line, symmetric) => cutEdit(document, 0, 0, cuts(lattice, 0)[line], 0.25, symmetric);
  assert.deepEqual(edit(0, true), { path: ["lattice", 0, "x", 0, "widths_mm"], value: [1.25, 1.75, 1.75, 1.25] });
  assert.deepEqual(edit(0, false).value, [1.25, 1.75, 2, 1]);
  // A line on the mirror has no image.
  assert.deepEqual(edit(1, true).value, [1, 2.25, 1.75, 1]);
  const repeated = { start_mm: [0, 0, 0], x: [{ widths_mm: [1, 2], times: 2 }] };
  assert.deepEqual(cuts(repeated, 0), [{ at_mm: 1, section: 0, before: 0 }, { at_mm: 4, section: 0, before: 0 }]);
});

test("the outline of a turned tile is its convex hull", () => {
  assert.deepEqual(outline(tile("a", [1, 2, 0], [2, 4, 1], [0, 0, 1])), [[0, 0], [2, 0], [2, 4], [0, 4]]);
  const r = Math.SQRT1_2;
  const turned = { ...tile("b", [0, 0, 0], [2, 2, 2], [0, 0, 1]), axes: [[1, 0, 0], [0, r, r], [0, -r, r]] };
  const ys = outline(turned).map(([, y]) => y);
  assert.ok(Math.abs(Math.max(...ys) - Math.SQRT2) < 1e-12);
});

test("colours follow directions and values", () => {
  assert.notEqual(directionColour([1, 0, 0]), directionColour([-1, 0, 0]));
  assert.equal(directionColour([0, 0, 0]), "rgb(190 190 190)");
  const signed = valueScale([-1, 0.5, null]);
  assert.deepEqual([signed.low, signed.high], [-1, 1]);
  assert.ok(signed.colour(-1)[2] > signed.colour(-1)[0] && signed.colour(1)[0] > signed.colour(1)[2]);
  const constant = valueScale([3, 3]);
  assert.ok(constant.low < 3 && constant.high > 3);
  assert.ok(valueScale([null]).high > valueScale([null]).low);
});

test("ticks are round and inside", () => {
  assert.deepEqual(ticks(-2, 2, 4), [-2, -1, 0, 1, 2]);
  assert.ok(ticks(0.013, 0.094, 5).every((value) => value >= 0.013 && value <= 0.094));
  assert.deepEqual(ticks(1, 1, 4), [1]);
});

test("a link holds a layout, and nothing else is read from one", async () => {
  const text = 'name = "\u00fc \u2212 </script>"\n'.repeat(50);
  const fragment = await fragmentOf(text);
  assert.ok(fragment.length < 200, fragment);
  assert.equal(await textIn(fragment), text);
  for (const broken of ["", "#numbers", "#layout=", "#layout=%%%", "#layout=AAAA", `${fragment.slice(0, 30)}`]) assert.equal(await textIn(broken), null);
  // A small fragment that unpacks to much is refused.
  assert.equal(await textIn(await fragmentOf("x".repeat(5e6))), null);
});

test("causes are sorted, and their squares add up", () => {
  const part = (name, x, y, z) => ({ name, mean_square_mm2: { x, y, z } });
  const budget = { total_mm2: { x: 4, y: 4, z: 1 }, parts: [part("a", 1, 0, 0), part("b", 3, 4, 2), part("c", 0, 0, -1), part("d", 0, 0, 0)] };
  const { total_mm, rows } = causesOf(budget);
  assert.equal(total_mm, 3);
  assert.deepEqual(rows.map(({ name, rms_mm }) => [name, rms_mm]), [["b", 3], ["a", 1], ["d", 0], ["c", -1]]);
});

test("a stray field is read in each of its forms", () => {
  const of = (stray_field) => strayField({ tolerance: { stray_field } });
  assert.deepEqual(of({ any_direction_ut: { fixed: 50 } }), { ut: 50, direction: "any" });
  assert.deepEqual(of({ any_direction_ut: 30 }), { ut: 30, direction: "any" });
  assert.deepEqual(of({ field_ut: [0, { fixed: 20 }, 0] }), { ut: 20, direction: "1" });
  assert.equal(strayField({}), null);
});
