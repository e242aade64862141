// What each displacement shows along its axis, minus the true one: mean and spread over the other axes.

import { ticks } from "#axis";
import { drawing, element, set, short } from "#format";

const [WIDTH, HEIGHT, LEFT, RIGHT, TOP, BOTTOM] = [230, 170, 48, 14, 22, 34];
const UM_PER_MM = 1e3;

/** @param {import("#model").Model} model @param {HTMLElement} place */
export function showCurves(model, place) {
  const panels = ["x", "y", "z"].map((axis, index) => panel(axis, ["R_x", "R_y", "S_z"][index]));
  const row = element("div", { class: "curves" }, ...panels.map(({ svg }) => svg));
  const hint = element("p", { class: "hint" }, "Error of the displacement that R_x, R_y and S_z show, along their axes. Line: mean over the two other axes; blue: least to most; green: bound of [expect] for the RMS; dashed: before.");
  place.append(row, hint);
  model.listeners.push(() => {
    set(row, { hidden: !model.evaluated });
    if (!model.evaluated) return;
    const bounds = Object.fromEntries(
      model.evaluated.expectations.filter((/** @type {any} */ e) => e.at_most !== undefined).map((/** @type {any} */ e) => [e.expectation, e.at_most]),
    );
    for (const { axis, draw } of panels) {
      draw(model.evaluated.residuals_mm[axis], model.before?.residuals_mm?.[axis], bounds[`displacement_rmse_mm.${axis}`]);
    }
  });
}

/** @param {string} axis @param {string} parameter */
function panel(axis, parameter) {
  const svg = drawing("svg", { class: "curve", viewBox: `0 0 ${WIDTH} ${HEIGHT}`, role: "img" });
  const bound = drawing("rect", { class: "bound" });
  const band = drawing("path", { class: "band" });
  const zero = drawing("path", { class: "zero" });
  const old = drawing("path", { class: "old" });
  const mean = drawing("path", { class: "mean" });
  const frame = drawing("rect", { class: "frame", x: LEFT, y: TOP, width: WIDTH - LEFT - RIGHT, height: HEIGHT - TOP - BOTTOM });
  const axes = drawing("g", { class: "ticks" });
  const title = drawing("text", { x: LEFT, y: 14, class: "title" });
  const clip = `inside-${axis}`;
  svg.append(drawing("clipPath", { id: clip }, drawing("rect", { x: LEFT, y: TOP, width: WIDTH - LEFT - RIGHT, height: HEIGHT - TOP - BOTTOM })));
  svg.append(drawing("g", { "clip-path": `url(#${clip})` }, bound, band, zero, old, mean), frame, axes, title);

  /** @typedef {{ at_mm: number, mean: number, least: number, most: number }} Plane */
  /** @param {Plane[]} planes @param {Plane[] | undefined} before @param {number | undefined} bound_mm */
  function draw(planes, before, bound_mm) {
    const at = planes.map((plane) => plane.at_mm);
    const [low, high] = [Math.min(...at), Math.max(...at)];
    const all = [...planes, ...(before ?? [])].flatMap((plane) => [plane.least, plane.most]).concat([0, bound_mm ?? 0, -(bound_mm ?? 0)]);
    const reach = Math.max(...all.map((value) => Math.abs(value * UM_PER_MM)), 0.1);
    const [least, most] = [Math.min(...all) * UM_PER_MM - 0.06 * reach, Math.max(...all) * UM_PER_MM + 0.06 * reach];
    const x = (/** @type {number} */ mm) => LEFT + ((mm - low) / (high - low || 1)) * (WIDTH - LEFT - RIGHT);
    const y = (/** @type {number} */ um) => HEIGHT - BOTTOM - ((um - least) / (most - least)) * (HEIGHT - TOP - BOTTOM);
    const line = (/** @type {Plane[]} */ of, /** @type {"mean" | "least" | "most"} */ key) =>
      of.map((plane) => `${x(plane.at_mm).toFixed(2)} ${y(plane[key] * UM_PER_MM).toFixed(2)}`);
    set(band, { d: planes.length ? `M${[...line(planes, "most"), ...line(planes, "least").reverse()].join("L")}Z` : "" });
    set(mean, { d: planes.length ? `M${line(planes, "mean").join("L")}` : "" });
    set(old, { d: before?.length && before !== planes ? `M${line(before, "mean").join("L")}` : "" });
    set(zero, { d: `M${LEFT} ${y(0)}H${WIDTH - RIGHT}` });
    const [up, down] = bound_mm ? [y(bound_mm * UM_PER_MM), y(-bound_mm * UM_PER_MM)] : [0, 0];
    set(bound, { x: LEFT, y: up, width: WIDTH - LEFT - RIGHT, height: down - up, hidden: !bound_mm });
    axes.replaceChildren(
      ...ticks(low, high, 4).map((mm) => drawing("text", { x: x(mm), y: HEIGHT - BOTTOM + 13, "text-anchor": "middle" }, short(mm, 3))),
      ...ticks(least, most, 4).map((um) => drawing("text", { x: LEFT - 4, y: y(um) + 3.5, "text-anchor": "end" }, short(um, 3))),
      drawing("text", { x: (LEFT + WIDTH - RIGHT) / 2, y: HEIGHT - 6, "text-anchor": "middle" }, `${axis} (mm)`),
    );
    title.textContent = `\u0394${axis} by ${parameter} (\u00b5m)`;
    const worst = Math.max(...planes.flatMap((plane) => [Math.abs(plane.least), Math.abs(plane.most)]));
    set(svg, { "aria-label": `Residual of ${parameter} along ${axis}: at most ${short(worst * UM_PER_MM, 3)} micrometres` });
  }
  return { axis, svg, draw };
}
