// The numbers of the film, each with its difference from the state before, and the expectations.

import { NO_CHANGE, difference, element, number, set, short } from "#format";

/** @typedef {import("#model").Model} Model */

const AXES = ["x", "y", "z"];
const PARAMETERS = ["r_x", "r_y", "s_z"];

/** A number of the page: its name, its unit, and where it is in the answer of the engine.
 * @type {{ name: string, unit: string, columns: string[], of: (evaluated: any) => (number | null)[],
 *   note?: (evaluated: any) => string }[]} */
const NUMBERS = [
  { name: "displacement RMSE", unit: "mm", columns: AXES, of: (e) => AXES.map((axis) => e.evaluation.displacement_rmse_mm[axis]) },
  { name: "worst displacement error", unit: "mm", columns: [""], of: (e) => [e.worst_displacement_error_mm && Math.hypot(...e.worst_displacement_error_mm)], note: (e) => place(e.worst_displacement_at_mm) },
  { name: "uniformity RMSE", unit: "", columns: ["R_x", "R_y", "S_z"], of: (e) => PARAMETERS.map((key) => e.evaluation.uniformity_rmse[key]) },
  { name: "noise of one reading", unit: "mm", columns: AXES, of: (e) => e.resolution_mm ?? [null, null, null] },
  { name: "amplitude", unit: "", columns: [""], of: (e) => [e.evaluation.comparison.amplitude] },
];

/** @param {number[] | null} at_mm */
const place = (at_mm) => (at_mm ? ` at (${at_mm.map((c) => short(c)).join(", ")}) mm` : "");

/** The numbers of a film by their names: `displacement RMSE x, mm`. @param {any} evaluated
 * @returns {Record<string, number | null>} */
export function numbersOf(evaluated) {
  return Object.fromEntries(
    NUMBERS.flatMap(({ name, unit, columns, of }) =>
      of(evaluated).map((value, i) => [`${name}${columns[i] ? ` ${columns[i]}` : ""}${unit ? `, ${unit}` : ""}`, value]),
    ),
  );
}

/** @param {Model} model @param {HTMLElement} place */
export function showResults(model, place) {
  const status = element("p", { class: "verdict", role: "status" });
  const reason = element("p", { class: "message" });
  const body = element("tbody");
  const cells = NUMBERS.flatMap(({ name, unit, columns, of, note }) => {
    const pairs = columns.map(() => ({ value: element("span", { class: "value" }), beside: element("span"), change: element("span", { class: "change" }) }));
    const row = element("tr", {}, element("th", { scope: "row" }, unit ? `${name}, ${unit}` : name));
    columns.forEach((column, i) => {
      const cell = element("td", { colspan: columns.length === 1 ? 3 : 1, "data-number": `${name} ${column}`.trim() });
      cell.append(element("span", { class: "column" }, column), pairs[i].value, pairs[i].beside, pairs[i].change);
      row.append(cell);
    });
    body.append(row);
    return pairs.map((pair, i) => ({ ...pair, note, of: (/** @type {any} */ evaluated) => of(evaluated)[i] }));
  });
  const table = element("table", { class: "results" }, element("caption", { class: "hidden" }, "Numbers of the film, with the difference from before"), body);
  const expectations = element("ul", { class: "expectations", "aria-label": "Expectations of the layout" });
  const hint = element("p", { class: "hint" });
  place.append(element("h2", {}, "The film as drawn, without disturbances"), status, reason, table, hint, expectations);

  model.listeners.push(() => {
    const { evaluated, before } = model;
    set(table, { hidden: !evaluated });
    hint.textContent = !evaluated || !before || before === evaluated ? "" : `Small numbers: difference from ${model.pinned ? "the pinned film" : "the state before the last change"}.`;
    reason.textContent = evaluated ? "" : model.unevaluated;
    set(reason, { hidden: Boolean(evaluated) });
    expectations.replaceChildren();
    status.textContent = "";
    if (!evaluated) return;
    for (const { value, beside, change, of, note } of cells) {
      const now = of(evaluated);
      value.textContent = number(now);
      beside.textContent = note?.(evaluated) ?? "";
      const old = before && of(before);
      const isBoth = typeof now === "number" && typeof old === "number";
      change.textContent = before && before !== evaluated ? (isBoth ? difference(now - old) : now === old ? NO_CHANGE : `was ${number(old)}`) : "";
    }
    const checked = evaluated.expectations.filter((/** @type {any} */ one) => one.value !== null);
    const failed = checked.filter((/** @type {any} */ one) => one.status !== "ok").length;
    set(status, { class: `verdict ${checked.length === 0 ? "" : failed ? "broken" : "kept"}` });
    status.textContent =
      checked.length === 0 ? "The layout expects nothing: [expect] sets bounds." : failed === 0 ? `All ${checked.length} expectations are kept.` : `${failed} of ${checked.length} expectations are broken.`;
    for (const one of evaluated.expectations) {
      const bound = one.at_most !== undefined ? `at most ${number(one.at_most)}` : one.at_least !== undefined ? `at least ${number(one.at_least)}` : "";
      const text = one.value === null ? `${one.expectation}: not checked here` : `${one.expectation} ${number(one.value)}, ${bound}`;
      expectations.append(element("li", { class: one.value === null ? "unchecked" : one.status === "ok" ? "kept" : "broken" }, text));
    }
  });
}
