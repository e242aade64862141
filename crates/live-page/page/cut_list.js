// The cut lines of lattices, to be typed.

import { cutEdit, cuts } from "#film_view";
import { element, rounded, set, short } from "#format";

/** @param {import("#model").Model} model @param {HTMLElement} place */
export function showCutList(model, place) {
  const lines = element("select", { "aria-label": "Cut line" });
  const at = element("input", { type: "number", step: "any", "aria-label": "place of the cut line, mm" });
  const row = element("p", { class: "controls" }, element("label", {}, "cut line ", lines), element("label", {}, "at ", at, " mm"));
  place.append(row);
  /** @type {{ lattice: number, axis: 0 | 1, line: { at_mm: number, section: number, before: number } }[]} */
  let all = [];

  at.addEventListener("change", () => {
    const chosen = all[Number(lines.value)];
    const document = model.state?.document;
    if (!chosen || at.value === "") return;
    const { lattice, axis, line } = chosen;
    model.change({ edits: [cutEdit(document, lattice, axis, line, Number(at.value) - line.at_mm, model.symmetry !== "none")] });
  });
  const show = () => {
    const chosen = all[Number(lines.value)];
    if (chosen) at.value = String(rounded(chosen.line.at_mm));
  };
  lines.addEventListener("change", show);

  /** @type {any} */
  let shown = null;
  model.listeners.push(() => {
    if (shown === model.state) return;
    shown = model.state;
    const lattices = /** @type {any[]} */ (model.state?.document?.lattice ?? []);
    all = lattices.flatMap((lattice, index) =>
      lattice.wave ? [] : /** @type {(0 | 1)[]} */ ([0, 1]).flatMap((axis) => cuts(lattice, axis).map((line) => ({ lattice: index, axis, line }))),
    );
    set(row, { hidden: all.length === 0 });
    const { value } = lines;
    lines.replaceChildren(...all.map(({ axis, line }, index) => new Option(`${"xy"[axis]} = ${short(line.at_mm, 6)} mm`, String(index))));
    if (all[Number(value)]) lines.value = value || "0";
    show();
  });
}
