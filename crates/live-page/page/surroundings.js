// Switches and sliders of the surroundings: each sets keys of the layout.

import { element, rounded, set } from "#format";

/** @typedef {import("#model").Model} Model */
/** @typedef {import("#model").TextEdit} TextEdit */
/** @typedef {{ label: string, unit: string, range: [number, number, number], path: (string | number)[],
 *   read: (document: any) => number | null, write: (value: number, document: any, model: Model) => TextEdit[],
 *   start: number | ((model: Model) => number), needs?: (document: any) => boolean }} Slider
 *   a number that is absent until its switch is on; `range` is least, most and step */
/** @typedef {{ label: string, options: [string, string][], read: (document: any) => string,
 *   write: (value: string, document: any, model: Model) => TextEdit[] }} Choice */

/** @param {any} document @param {(string | number)[]} path */
const at = (document, path) => path.reduce((value, key) => value?.[key], document) ?? null;
/** The number of a distribution. @param {any} value @returns {number | null} */
const plain = (value) => (Array.isArray(value) ? plain(value[0]) : value !== null && typeof value === "object" ? (value.fixed ?? value.normal ?? value.uniform ?? null) : value);
const remove = (/** @type {(string | number)[]} */ path) => [{ path, value: null }];

/** @param {string[]} path @param {Omit<Slider, "read" | "write" | "path">} slider @param {(value: number) => any} [written]
 * @returns {Slider} */
const key = (path, slider, written = (value) => value) => ({
  ...slider,
  path,
  read: (document) => plain(at(document, path)),
  write: (value) => [{ path, value: written(value) }],
});

const PARTS = ["MLX90393", "TLV493D", "LIS3MDL", "MMC5983MA"];

/** Keys of the errors that tiles have. */
const TILE_ERRORS = ["position_mm", "rotation_deg", "size_mm", "strength", "direction_deg", "kind", "tile", "group"];
const OWN = "own";

/** @type {Choice[]} */
const CHOICES = [
  {
    label: "sensor part",
    options: [["", "none: no noise"], ...PARTS.map((part) => /** @type {[string, string]} */ ([part, part]))],
    read: (document) => at(document, ["sensor", "part"]) ?? "",
    // Keys of one part mean nothing to another.
    write: (value) => [
      ...["gain_sel", "res", "full_scale_gauss"].flatMap((name) => remove(["sensor", name])),
      { path: ["sensor", "part"], value: value || null },
    ],
  },
  {
    label: "sensors",
    options: [
      ["", "one"],
      ["pair-z", "two, one below the other"],
      ["pair-xy", "three: one aside along x, one along y"],
      ["cross", "five, at the corners of a square"],
      ["reskin", "five, board of ReSkin"],
    ],
    read: (document) => at(document, ["sensor", "head"]) ?? "",
    write: (value, _, model) => [
      ...remove(["sensor", "spacing_mm"]),
      ...remove(["sensor", "element"]),
      { path: ["sensor", "head"], value: value || null },
      // A quarter of the wavelength, where the field below has fallen to a fifth.
      ...(value === "pair-z" ? [{ path: ["sensor", "spacing_mm"], value: rounded(0.25 * (model.state?.document?.ideal?.wavelength_mm ?? 8)) }] : []),
    ],
  },
  {
    label: "errors of the tiles",
    options: [["", "none"], ["by-hand", "by hand: places 0.15 mm, sides 0.05 mm, 1.5 degrees, J 3 % and 2 degrees"], ["workshop", "workshop: places 0.05 mm, 0.5 degrees, J 1 %"], ["jig", "jig: places 0.02 mm, sides 0.02 mm, 0.2 degrees, J 1 % and 1 degree"], [OWN, "as the layout states them"]],
    read: (document) => at(document, ["tolerance", "preset"]) ?? (TILE_ERRORS.some((name) => at(document, ["tolerance", name])) ? OWN : ""),
    // A preset replaces the errors that the layout states.
    write: (value) =>
      value === OWN ? [] : [...TILE_ERRORS.flatMap((name) => remove(["tolerance", name])), { path: ["tolerance", "preset"], value: value || null }],
  },
];

// Remanence of NdFeB falls by 0.12 % per kelvin.
const NDFEB_PER_K = -0.0012;

/** @type {Slider[]} */
const SLIDERS = [
  {
    label: "least distance of the sensor below the film",
    unit: "mm",
    range: [0.5, 15, 0.1],
    start: 3,
    path: [],
    read: (document) => (at(document, ["volume", "z_mm"]) ? -Math.max(...document.volume.z_mm) : null),
    write: (value, document) => {
      const { z_mm, reference_mm } = document.volume;
      const by = -value - Math.max(...z_mm);
      const moved = (/** @type {number} */ z) => rounded(z + by);
      const edits = [{ path: ["volume", "z_mm"], value: z_mm.map(moved) }];
      return reference_mm ? [...edits, { path: ["volume", "reference_mm"], value: [reference_mm[0], reference_mm[1], moved(reference_mm[2])] }] : edits;
    },
  },
  key(["sensor", "spacing_mm"], { label: "spacing of the sensors", unit: "mm", range: [0.5, 10, 0.1], start: (model) => model.state?.head_spacing_mm ?? 2, needs: (document) => Boolean(at(document, ["sensor", "head"])) }),
  key(["tolerance", "sensor", "rotation_deg"], { label: "rotation of the sensor, standard deviation", unit: "degrees", range: [0, 5, 0.1], start: 1 }),
  key(["tolerance", "iron", "distance_mm"], { label: "iron plate above the film after the first reading, distance", unit: "mm", range: [1, 60, 0.5], start: 20 }),
  {
    ...key(["tolerance", "temperature", "change_k"], { label: "change of temperature after the first reading", unit: "K", range: [-40, 40, 1], start: 10 }),
    write: (value, document) => {
      const isKnown = at(document, ["tolerance", "temperature", "strength_per_k"]) !== null || at(document, ["material", "strength_per_k"]) !== null;
      const edits = [{ path: ["tolerance", "temperature", "change_k"], value: { fixed: value } }];
      return isKnown ? edits : [...edits, { path: ["tolerance", "temperature", "strength_per_k"], value: NDFEB_PER_K }];
    },
  },
];

/** The stray field has a strength and a direction. */
const STRAY = ["tolerance", "stray_field"];
const DIRECTIONS = /** @type {[string, string][]} */ ([["any", "of any direction"], ["0", "along x"], ["1", "along y"], ["2", "along z"]]);

/** @param {any} document @returns {{ ut: number, direction: string } | null} */
export function strayField(document) {
  const table = at(document, STRAY);
  if (!table) return null;
  if (table.any_direction_ut !== undefined) return { ut: plain(table.any_direction_ut) ?? 0, direction: "any" };
  const field = Array.isArray(table.field_ut) ? table.field_ut.map(plain) : [0, 1, 2].map(() => plain(table.field_ut) ?? 0);
  const axis = field.findIndex((/** @type {number} */ value) => value !== 0);
  return { ut: field[Math.max(0, axis)] ?? 0, direction: String(Math.max(0, axis)) };
}

/** @param {number} ut @param {string} direction @returns {TextEdit[]} */
function strayEdits(ut, direction) {
  const [any, along] = [[...STRAY, "any_direction_ut"], [...STRAY, "field_ut"]];
  const later = { path: [...STRAY, "when"], value: "after" };
  if (direction === "any") return [{ path: any, value: { fixed: ut } }, ...remove(along), later];
  const components = [0, 1, 2].map((axis) => ({ fixed: axis === Number(direction) ? ut : 0 }));
  return [{ path: along, value: components }, ...remove(any), later];
}

/** @param {Model} model @param {HTMLElement} place */
export function showSurroundings(model, place) {
  place.append(element("h2", {}, "Sensor and surroundings"));
  /** @type {((document: any) => void)[]} */
  const shown = [];
  const document = () => model.state?.document ?? {};

  for (const choice of CHOICES) {
    const id = `choice-${choice.label.replace(/ /g, "-")}`;
    const select = element("select", { id, onchange: () => model.change({ edits: choice.write(select.value, document(), model) }) });
    for (const [value, text] of choice.options) select.append(new Option(text, value));
    place.append(element("div", { class: "setting" }, element("label", { for: id }, choice.label), select));
    shown.push((of) => {
      const value = choice.read(of);
      if (![...select.options].some((option) => option.value === value)) select.append(new Option(value, value));
      select.value = value;
    });
  }

  for (const slider of SLIDERS) {
    const edits = (/** @type {number} */ value) => slider.write(value, document(), model);
    place.append(setting(slider, slider.path.length > 0, (value) => edits(value), () => switchedOff(slider.path)));
  }

  const direction = element("select", { "aria-label": "direction of the stray field" });
  for (const [value, text] of DIRECTIONS) direction.append(new Option(text, value));
  /** @type {Slider} */
  const stray = {
    label: "uniform stray field after the first reading", unit: "\u00b5T", range: [0, 500, 5], start: 50, path: STRAY,
    read: (of) => strayField(of)?.ut ?? null,
    write: (ut) => strayEdits(ut, direction.value),
  };
  direction.addEventListener("change", () => model.change({ edits: strayEdits(stray.read(document()) ?? startOf(stray), direction.value) }));
  place.append(setting(stray, true, (ut) => strayEdits(ut, direction.value), () => switchedOff(STRAY), direction));
  shown.push((of) => {
    const field = strayField(of);
    set(direction, { disabled: field === null });
    if (field) direction.value = field.direction;
  });

  /** The value with which a switch begins. @param {Slider} slider */
  const startOf = ({ start }) => (typeof start === "function" ? start(model) : start);

  /** The edits that switch a cause off: its table goes. @param {(string | number)[]} path */
  const switchedOff = (path) => remove(path[0] === "tolerance" && path.length > 2 && path[1] !== "sensor" ? path.slice(0, 2) : path);

  /** A number with its switch, its slider and a field to type in.
   * @param {Slider} slider @param {boolean} hasSwitch @param {(value: number) => TextEdit[]} edits @param {() => TextEdit[]} off
   * @param {HTMLElement[]} beside */
  function setting(slider, hasSwitch, edits, off, ...beside) {
    const [min, max, step] = slider.range;
    const range = element("input", { type: "range", min, max, step, "aria-label": slider.label });
    const typed = element("input", { type: "number", step: "any", "aria-label": `${slider.label}, ${slider.unit}` });
    const onOff = element("input", { type: "checkbox", "aria-label": slider.label });
    /** @type {import("#model").Gesture | null} */
    let gesture = null;
    range.addEventListener("input", () => {
      gesture ??= model.begin();
      gesture.step({ edits: edits(Number(range.value)) });
    });
    range.addEventListener("change", () => {
      gesture?.end();
      gesture = null;
    });
    let isTyping = false;
    typed.addEventListener("input", () => (isTyping = true));
    typed.addEventListener("change", () => {
      isTyping = false;
      if (typed.value !== "") model.change({ edits: edits(Number(typed.value)) });
      else model.show();
    });
    onOff.addEventListener("change", () => model.change({ edits: onOff.checked ? edits(startOf(slider)) : off() }));
    shown.push((of) => {
      const value = slider.read(of);
      set(onOff, { disabled: value === null && !(slider.needs?.(of) ?? true) });
      for (const input of [range, typed]) {
        set(input, { disabled: value === null });
        const isInUse = input === globalThis.document.activeElement && (input === typed ? isTyping : gesture !== null);
        if (!isInUse) input.value = value === null ? "" : String(value);
      }
      onOff.checked = value !== null;
    });
    const name = element(hasSwitch ? "label" : "span", {}, ...(hasSwitch ? [onOff, " "] : []), slider.label);
    return element("div", { class: "setting" }, name, element("span", { class: "number" }, range, typed, ` ${slider.unit} `, ...beside));
  }

  model.listeners.push(() => {
    for (const show of shown) show(document());
  });
}
