// The tiles as a list: the same as the picture, for the keyboard and for screen readers.

import { filmPolarization } from "#film_view";
import { element, rounded, set, snapped } from "#format";
import { FIXED_BY_SYMMETRY, editedImages, isAligned, orbit } from "#symmetry";

/** @typedef {import("#model").Model} Model */
/** @typedef {import("#symmetry").Tile} Tile */
/** @typedef {{ label: string, unit: string, read: (tile: Tile) => number, write: (tile: Tile, value: number) => any, isTurn?: boolean }} Field */

/** @param {"position_mm" | "size_mm"} name @param {number} i */
const component = (name, i) => (/** @type {Tile} */ tile, /** @type {number} */ value) => ({ [name]: tile[name].map((old, n) => (n === i ? value : old)) });
const degrees = (/** @type {number} */ radians) => (radians * 180) / Math.PI;
/** @param {Tile} tile @param {number} strength @param {number} direction_deg @param {number} tilt_deg */
function withPolarization({ axes }, strength, direction_deg, tilt_deg) {
  const [direction, tilt] = [direction_deg, tilt_deg].map((angle) => (angle * Math.PI) / 180);
  const j = [Math.cos(tilt) * Math.cos(direction), Math.cos(tilt) * Math.sin(direction), Math.sin(tilt)].map((c) => c * strength);
  return { polarization_t: axes.map((axis) => axis.reduce((sum, c, i) => sum + c * j[i], 0)) };
}
const strength = (/** @type {Tile} */ tile) => Math.hypot(...tile.polarization_t);
const direction = (/** @type {Tile} */ tile) => degrees(Math.atan2(filmPolarization(tile)[1], filmPolarization(tile)[0]));
const tilt = (/** @type {Tile} */ tile) => degrees(Math.asin(Math.max(-1, Math.min(1, filmPolarization(tile)[2] / (strength(tile) || 1)))));

/** @type {Field[]} */
const FIELDS = [
  ...["x", "y", "z"].map((axis, i) => ({ label: `centre ${axis}`, unit: "mm", read: (/** @type {Tile} */ tile) => tile.position_mm[i], write: component("position_mm", i) })),
  ...["x", "y", "z"].map((axis, i) => ({ label: `side ${axis}`, unit: "mm", read: (/** @type {Tile} */ tile) => tile.size_mm[i], write: component("size_mm", i) })),
  { label: "strength", unit: "T", read: strength, write: (tile, value) => withPolarization(tile, value, direction(tile), tilt(tile)) },
  { label: "direction", unit: "degrees", read: direction, write: (tile, value) => withPolarization(tile, strength(tile), value, tilt(tile)), isTurn: true },
  { label: "tilt", unit: "degrees", read: tilt, write: (tile, value) => withPolarization(tile, strength(tile), direction(tile), value), isTurn: true },
];
const ARROWS = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] });

/** @param {Model} model @param {HTMLElement} place */
export function showTileList(model, place) {
  const list = element("div", { class: "list", role: "listbox", tabindex: 0, "aria-label": "Tiles" });
  const fields = element("fieldset", { class: "fields" }, element("legend", {}, "No tile is chosen"));
  const legend = fields.querySelector("legend");
  const hint = element("p", { class: "hint" }, "");
  place.append(element("h2", {}, "Tiles"), element("div", { class: "tile-list" }, list, fields), hint);
  /** @type {string} */
  let names = "";
  /** Fields whose text is not taken yet. @type {Set<HTMLInputElement>} */
  const typing = new Set();
  const stepOf = (/** @type {Field} */ { unit }) => (unit === "mm" ? model.step_mm : unit === "T" ? 0.001 : 1);

  const inputs = FIELDS.map((field) => {
    const input = element("input", { type: "number", step: "any", "aria-label": `${field.label}, ${field.unit}` });
    input.addEventListener("input", () => typing.add(input));
    input.addEventListener("change", () => {
      typing.delete(input);
      if (input.value !== "") edit((tile) => field.write(tile, Number(input.value)));
      else model.show();
    });
    input.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
      const up = { ArrowUp: 1, ArrowDown: -1 }[event.key];
      if (up === undefined || input.value === "") return;
      event.preventDefault();
      const step = stepOf(field) * up * (event.shiftKey ? 10 : 1);
      edit((tile) => field.write(tile, rounded(field.read(tile) + step)));
    });
    fields.append(element("label", {}, `${field.label} `, input, ` ${field.unit}`));
    return input;
  });

  /** Changes the tile that is chosen, with its images. @param {(tile: Tile) => any} changed */
  function edit(changed) {
    const index = model.selected;
    if (index === null || model.tiles[index].is_strip) return;
    const tile = model.tiles[index];
    const { position_mm, size_mm, polarization_t } = tile;
    const shape = { position_mm, size_mm, polarization_t, ...changed(tile) };
    const tiles = editedImages(orbit(model.tiles, index, model.symmetry), tile, shape, true);
    if (tiles.length > 0) model.change({ tiles });
    else model.say(FIXED_BY_SYMMETRY);
  }

  list.addEventListener("keydown", (/** @type {KeyboardEvent} */ event) => {
    const last = model.tiles.length - 1;
    const index = model.selected ?? -1;
    const chosen = { PageDown: Math.min(last, index + 1), PageUp: Math.max(0, index - 1), Home: 0, End: last }[event.key];
    if (chosen !== undefined) {
      event.preventDefault();
      model.select(chosen);
      return;
    }
    const by = ARROWS[event.key];
    if (!by || event.ctrlKey || event.metaKey) return;
    event.preventDefault();
    if (model.selected === null) return model.select(0);
    const step = model.step_mm * (event.shiftKey ? 10 : 1);
    edit(({ position_mm: [x, y, z] }) => ({ position_mm: [snapped(x + by[0] * step, model.step_mm), snapped(y + by[1] * step, model.step_mm), z] }));
  });
  list.addEventListener("click", (/** @type {MouseEvent} */ event) => {
    const row = /** @type {Element} */ (event.target).closest("[data-row]");
    if (row) model.select(Number(/** @type {HTMLElement} */ (row).dataset.row));
  });

  model.listeners.push(() => {
    hint.textContent = `In the list, page up and page down choose a tile; the arrow keys move it by ${model.step_mm} mm, with Shift by ${rounded(10 * model.step_mm)} mm.`;
    const all = model.tiles.map((tile) => tile.name).join("\n");
    if (all !== names) {
      names = all;
      list.replaceChildren(
        ...model.tiles.map((tile, index) => element("div", { role: "option", id: `tile-${index}`, "data-row": index, "aria-selected": "false" }, tile.name)),
      );
    }
    for (const row of list.querySelectorAll("[aria-selected=true]")) set(row, { "aria-selected": "false" });
    const row = model.selected === null ? null : list.children[model.selected];
    set(list, { "aria-activedescendant": row ? row.id : null });
    if (row) {
      set(row, { "aria-selected": "true" });
      // Only the list scrolls, not the page.
      if (row.offsetTop < list.scrollTop) list.scrollTop = row.offsetTop;
      if (row.offsetTop + row.offsetHeight > list.scrollTop + list.clientHeight) list.scrollTop = row.offsetTop + row.offsetHeight - list.clientHeight;
    }
    const tile = model.selected === null ? null : model.tiles[model.selected];
    legend.textContent = tile ? `${tile.name}${tile.is_strip ? ": a strip of a disc, which is edited in the layout" : ""}${isAligned(tile) ? "" : ", turned: sides along its own axes"}` : "No tile is chosen";
    set(fields, { disabled: !tile || tile.is_strip });
    inputs.forEach((input, i) => {
      if (typing.has(input) && input === document.activeElement) return;
      input.value = tile ? String(rounded(FIELDS[i].read(tile))) : "";
    });
    const overlap = tile && model.overlapping.has(model.selected ?? -1);
    set(fields, { class: overlap ? "fields overlapping" : "fields" });
  });
}
