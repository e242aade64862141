// The film from above, to scale: tiles, cut lines, sensors and the working volume, which a pointer drags.

import { directionColour } from "#colours";
import { drawing, element, rounded, set, short, snapped } from "#format";
import { ticks } from "#axis";
import { FIXED_BY_SYMMETRY, editedImages, isAligned, orbit } from "#symmetry";

/** @typedef {import("#model").Model} Model */
/** @typedef {import("#symmetry").Tile} Tile */

/** J in the frame of the film. @param {Tile} tile @returns {number[]} */
export const filmPolarization = ({ axes, polarization_t: j }) => [0, 1, 2].map((i) => axes.reduce((sum, axis, n) => sum + axis[i] * j[n], 0));

/** The outline from above: the convex hull of the corners. @param {Tile} tile @returns {number[][]} */
export function outline({ position_mm, size_mm, axes }) {
  const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) =>
    [0, 1].map((i) => axes.reduce((sum, axis, k) => sum + (((n >> k) & 1) - 0.5) * size_mm[k] * axis[i], position_mm[i])),
  );
  corners.sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (/** @type {number[][]} */ points) => {
    /** @type {number[][]} */
    const hull = [];
    for (const p of points) {
      while (hull.length > 1) {
        const [a, b] = hull.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 1e-12) break;
        hull.pop();
      }
      hull.push(p);
    }
    return hull.slice(0, -1);
  };
  return [...half(corners), ...half(corners.reverse())];
}

/** A tile in one line. @param {Tile} tile */
function describe(tile) {
  const j = filmPolarization(tile);
  const three = (/** @type {number[]} */ v) => v.map((c) => short(c, 6)).join(", ");
  const direction = short((Math.atan2(j[1], j[0]) * 180) / Math.PI, 4);
  return `${tile.name}: centre (${three(tile.position_mm)}) mm, sides ${three(tile.size_mm)} mm, J at ${direction} degrees`;
}

/** The cut lines of a lattice along one axis: their coordinates, and which widths are beside them.
 * @param {any} lattice @param {0 | 1} axis @returns {{ at_mm: number, section: number, before: number }[]} */
export function cuts(lattice, axis) {
  const sections = (axis === 1 && lattice.y) || lattice.x || [];
  const lines = [];
  let at_mm = lattice.start_mm[axis];
  for (const [section, { widths_mm, times = 1 }] of sections.entries()) {
    for (let time = 0; time < times; time++) {
      for (const [before, width] of widths_mm.entries()) {
        at_mm += width;
        // A line between two sections, or two repetitions, has no two widths of its own.
        if (before + 1 < widths_mm.length) lines.push({ at_mm, section, before });
      }
    }
  }
  return lines;
}

/** The edit of a lattice whose line moves; the mirror image of the line moves with it.
 * @param {any} document @param {number} index @param {0 | 1} axis @param {{ section: number, before: number }} line
 * @param {number} by_mm @param {boolean} isSymmetric @returns {import("#model").TextEdit} */
export function cutEdit(document, index, axis, { section, before }, by_mm, isSymmetric) {
  const lattice = document.lattice[index];
  const key = axis === 1 && lattice.y ? "y" : "x";
  const widths = [...lattice[key][section].widths_mm];
  const mirrored = widths.length - 2 - before;
  const isPalindrome = lattice[key].length === 1 && widths.every((width, i) => Math.abs(width - widths[widths.length - 1 - i]) < 1e-9);
  const move = (/** @type {number} */ at, /** @type {number} */ by) => {
    widths[at] = rounded(widths[at] + by);
    widths[at + 1] = rounded(widths[at + 1] - by);
  };
  move(before, by_mm);
  if (isSymmetric && isPalindrome && mirrored !== before) move(mirrored, -by_mm);
  return { path: ["lattice", index, key, section, "widths_mm"], value: widths };
}

/** @param {Model} model @param {HTMLElement} place */
export function showFilm(model, place) {
  const svg = drawing("svg", { class: "film", role: "img", "aria-label": "The film from above; the list of tiles below has the same for the keyboard" });
  const flip = drawing("g", { transform: "scale(1 -1)" });
  const axes = drawing("g", { class: "axes" });
  const layers = Object.fromEntries(["tiles", "cuts", "volume", "sensors", "handles"].map((name) => [name, drawing("g", { class: name })]));
  flip.append(...Object.values(layers));
  svg.append(axes, flip);
  const readout = element("output", { class: "readout" });
  const hint = element("p", { class: "hint" });
  place.append(svg, readout, hint);

  /** @type {{ tile: Tile | null, group: any, shape: any, arrow: any, mark: any }[]} */
  let drawn = [];
  /** @type {any} */
  let shownState = null;
  let unit = 1;

  const at = (/** @type {PointerEvent} */ event) => {
    const matrix = flip.getScreenCTM().inverse();
    const point = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    return [point.x, point.y];
  };

  /** Drags from the event on. `step` gets the way in millimetres, and whether it is free of steps.
   * @param {PointerEvent} event @param {(by: number[], isFree: boolean) => import("#model").Step | null} step */
  function drag(event, step) {
    event.preventDefault();
    event.stopPropagation();
    const [from, gesture] = [at(event), model.begin()];
    const target = /** @type {Element} */ (event.currentTarget);
    const captured = event.pointerId;
    svg.setPointerCapture(captured);
    readout.textContent = "";
    let hasMoved = false;
    const move = (/** @type {PointerEvent} */ moved) => {
      const to = at(moved);
      const by = [to[0] - from[0], to[1] - from[1]];
      // A tap is no drag.
      if (!hasMoved && Math.hypot(...by) < 3 * unit) return;
      hasMoved = true;
      const next = step(by, moved.altKey);
      if (next) gesture.step(next);
    };
    const cancel = (/** @type {KeyboardEvent} */ pressed) => {
      if (pressed.key !== "Escape") return;
      gesture.cancel();
      end();
    };
    const end = () => {
      document.removeEventListener("keydown", cancel);
      svg.removeEventListener("pointermove", move);
      for (const name of ["pointerup", "pointercancel"]) svg.removeEventListener(name, end);
      gesture.end();
      set(target, { "data-held": false });
    };
    set(target, { "data-held": true });
    document.addEventListener("keydown", cancel);
    svg.addEventListener("pointermove", move);
    for (const name of ["pointerup", "pointercancel"]) svg.addEventListener(name, end);
  }

  const snap = (/** @type {number} */ value, /** @type {boolean} */ isFree) => (isFree ? rounded(value) : snapped(value, model.step_mm));

  /** @param {number} index @param {(tile: Tile, by: number[], isFree: boolean) => any} changed */
  const dragTile = (index, changed) => {
    const of = model.tiles[index];
    const images = orbit(model.tiles, index, model.symmetry);
    return (/** @type {number[]} */ by, /** @type {boolean} */ isFree) => {
      const { position_mm, size_mm, polarization_t } = of;
      const tiles = editedImages(images, of, { position_mm, size_mm, polarization_t, ...changed(of, by, isFree) });
      if (tiles.length > 0) return { tiles };
      model.say(FIXED_BY_SYMMETRY);
      return null;
    };
  };
  const moved = (/** @type {Tile} */ of, /** @type {number[]} */ by, /** @type {boolean} */ isFree) => ({
    position_mm: [snap(of.position_mm[0] + by[0], isFree), snap(of.position_mm[1] + by[1], isFree), of.position_mm[2]],
  });
  const resized = (/** @type {number[]} */ corner) => (/** @type {Tile} */ of, /** @type {number[]} */ by, /** @type {boolean} */ isFree) => {
    const size_mm = [...of.size_mm];
    const position_mm = [...of.position_mm];
    for (const i of [0, 1]) {
      const size = snap(of.size_mm[i] + corner[i] * by[i], isFree);
      // A tile keeps a side.
      size_mm[i] = Math.max(size, Math.min(model.step_mm, of.size_mm[i]));
      position_mm[i] = rounded(of.position_mm[i] + (corner[i] * (size_mm[i] - of.size_mm[i])) / 2);
    }
    return { size_mm, position_mm };
  };
  const turned = (/** @type {Tile} */ of, /** @type {number[]} */ by, /** @type {boolean} */ isFree) => {
    const j = filmPolarization(of);
    const length = arrowLength(of);
    const tip = [0, 1].map((i) => (j[i] / Math.hypot(...j)) * length + by[i]);
    const step_deg = isFree ? 0.001 : Math.max(model.state?.brief?.resolution_deg ?? 1, 1);
    const direction = (snapped((Math.atan2(tip[1], tip[0]) * 180) / Math.PI, step_deg) * Math.PI) / 180;
    const inPlane = Math.hypot(j[0], j[1]);
    const turnedJ = [inPlane * Math.cos(direction), inPlane * Math.sin(direction), j[2]];
    return { polarization_t: of.axes.map((axis) => axis.reduce((sum, c, i) => sum + c * turnedJ[i], 0)) };
  };

  /** @param {Tile} tile */
  const arrowLength = (tile) => 0.42 * Math.min(tile.size_mm[0], tile.size_mm[1]);

  function rebuild() {
    for (const layer of Object.values(layers)) layer.replaceChildren();
    drawn = model.tiles.map((_, index) => {
      const shape = drawing("polygon", {});
      const arrow = drawing("path", { class: "arrow" });
      const mark = drawing("path", { class: "mark" });
      const title = drawing("title");
      title.textContent = model.tiles[index].name;
      const group = drawing("g", { class: "tile", "data-tile": index }, shape, arrow, mark, title);
      group.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => {
        if (event.button !== 0 || model.tiles[index].is_strip) return model.select(index);
        // A finger scrolls the page unless the tile is chosen.
        const mayDrag = event.pointerType !== "touch" || model.selected === index;
        model.select(index);
        if (mayDrag) drag(event, dragTile(index, moved));
      });
      return { tile: null, group, shape, arrow, mark };
    });
    // Tiles of upper layers hide lower ones.
    const order = model.tiles.map((_, index) => index).sort((a, b) => model.tiles[a].position_mm[2] - model.tiles[b].position_mm[2]);
    layers.tiles.append(...order.map((index) => drawn[index].group));
  }

  /** @param {number} index */
  function drawTile(index) {
    const [tile, own] = [model.tiles[index], drawn[index]];
    if (own.tile !== tile) {
      own.tile = tile;
      const j = filmPolarization(tile);
      set(own.shape, { points: outline(tile).map((p) => p.map((c) => c.toFixed(4)).join(",")).join(" "), fill: directionColour(j) });
      const [strength, length] = [Math.hypot(...j), arrowLength(tile)];
      const [x, y] = tile.position_mm;
      const flat = strength > 0 ? Math.hypot(j[0], j[1]) / strength : 0;
      const arrow = () => {
        const [dx, dy] = [(j[0] / strength) * length, (j[1] / strength) * length];
        const [tx, ty] = [x + dx, y + dy];
        const wing = (/** @type {number} */ side) => `${tx - 0.35 * dx - side * 0.2 * dy} ${ty - 0.35 * dy + side * 0.2 * dx}`;
        return `M${x - dx} ${y - dy}L${tx} ${ty}M${wing(1)}L${tx} ${ty}L${wing(-1)}`;
      };
      const r = 0.12 * Math.min(tile.size_mm[0], tile.size_mm[1]);
      // A dot is the tip of an arrow that points up; a cross is the end of one that points down.
      const upright = () =>
        j[2] > 0 ? `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0` : `M${x - r} ${y - r}L${x + r} ${y + r}M${x - r} ${y + r}L${x + r} ${y - r}`;
      set(own.arrow, { d: flat > 0.1 ? arrow() : "", "stroke-width": Math.max(0.03 * length, unit) });
      set(own.mark, { d: strength > 0 && flat < 0.9 ? upright() : "", "stroke-width": Math.max(0.03 * length, unit) });
    }
    const isOverlapping = model.overlapping.has(index);
    set(own.group, { class: `tile${isOverlapping ? " overlapping" : ""}${model.selected === index ? " selected" : ""}` });
  }

  function drawHandles() {
    layers.handles.replaceChildren();
    if (model.selected === null || model.gesture) return;
    const index = model.selected;
    const tile = model.tiles[index];
    if (!tile || tile.is_strip) return;
    const handle = (/** @type {number[]} */ [x, y], /** @type {string} */ kind, /** @type {any} */ changed) => {
      const circle = drawing("circle", { class: `handle ${kind}`, cx: x, cy: y, r: 6 * unit });
      circle.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => drag(event, dragTile(index, changed)));
      layers.handles.append(circle);
    };
    if (isAligned(tile)) {
      for (const corner of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        handle([0, 1].map((i) => tile.position_mm[i] + (corner[i] * tile.size_mm[i]) / 2), "corner", resized(corner));
      }
    }
    const j = filmPolarization(tile);
    if (Math.hypot(j[0], j[1]) > 0.1 * Math.hypot(...j)) {
      handle([0, 1].map((i) => tile.position_mm[i] + (j[i] / Math.hypot(...j)) * arrowLength(tile)), "tip", turned);
    }
  }

  function drawSurroundings() {
    const { state } = model;
    if (!state) return;
    layers.volume.replaceChildren();
    layers.sensors.replaceChildren();
    layers.cuts.replaceChildren();
    const reference = state.volume?.reference_mm ?? [0, 0, 0];
    if (state.volume) {
      const { lower_mm: low, upper_mm: high } = state.volume;
      layers.volume.append(drawing("rect", { x: low[0], y: low[1], width: high[0] - low[0], height: high[1] - low[1] }));
    }
    const side = 10 * unit;
    state.sensors_mm.forEach((place, index) => {
      const [x, y] = [reference[0] + place[0], reference[1] + place[1]];
      const chip = drawing("rect", { class: "chip", x: x - side / 2, y: y - side / 2, width: side, height: side });
      const title = drawing("title");
      title.textContent = `sensor ${index + 1} at (${place.map((c) => short(c)).join(", ")}) mm on its board`;
      chip.append(title);
      const step = chipStep(index, place);
      if (step) {
        set(chip, { class: "chip movable" });
        chip.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => drag(event, step));
      }
      layers.sensors.append(chip);
    });
    const box = bounds();
    (state.document?.lattice ?? []).forEach((/** @type {any} */ lattice, /** @type {number} */ index) => {
      if (lattice.wave) return;
      for (const axis of /** @type {(0 | 1)[]} */ ([0, 1])) {
        for (const line of cuts(lattice, axis)) {
          // The grip is beside the film: above it, or left of it.
          const outside = axis === 0 ? box.high[1] : box.low[0];
          const out = axis === 0 ? 1 : -1;
          const point = (/** @type {number} */ along, /** @type {number} */ away) =>
            (axis === 0 ? [line.at_mm + along, outside + out * away] : [outside + out * away, line.at_mm + along]).join(",");
          const grip = drawing("polygon", { class: "grip", points: [point(0, 2 * unit), point(-7 * unit, 16 * unit), point(7 * unit, 16 * unit)].join(" ") });
          const title = drawing("title");
          title.textContent = `cut at ${"xy"[axis]} = ${short(line.at_mm, 5)} mm`;
          grip.append(title);
          const { document } = state;
          const isSymmetric = model.symmetry !== "none";
          grip.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) =>
            drag(event, (by, isFree) => {
              const to = snap(line.at_mm + by[axis], isFree);
              readout.textContent = `cut at ${"xy"[axis]} = ${short(to, 6)} mm`;
              return { edits: [cutEdit(document, index, axis, line, to - line.at_mm, isSymmetric)] };
            }),
          );
          layers.cuts.append(grip);
        }
      }
    });
  }

  /** The change of a chip's place: its own, or the spacing of its board.
   * @param {number} index @param {number[]} place */
  function chipStep(index, place) {
    const elements = model.state?.document?.sensor?.element;
    if (Array.isArray(elements)) {
      return (/** @type {number[]} */ by, /** @type {boolean} */ isFree) => ({
        edits: [{ path: ["sensor", "element", index, "position_mm"], value: [snap(place[0] + by[0], isFree), snap(place[1] + by[1], isFree), place[2]] }],
      });
    }
    const [spacing, away] = [model.state?.head_spacing_mm, Math.hypot(place[0], place[1])];
    if (!spacing || away < 1e-9) return null;
    return (/** @type {number[]} */ by, /** @type {boolean} */ isFree) => {
      const to = away + (by[0] * place[0] + by[1] * place[1]) / away;
      const value = snap(Math.max(model.step_mm, (spacing * to) / away), isFree);
      return { edits: [{ path: ["sensor", "spacing_mm"], value }] };
    };
  }

  function bounds() {
    const [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
    for (const tile of model.tiles) {
      for (const p of outline(tile)) {
        for (const i of [0, 1]) [low[i], high[i]] = [Math.min(low[i], p[i]), Math.max(high[i], p[i])];
      }
    }
    return low[0] <= high[0] ? { low, high } : { low: [-1, -1], high: [1, 1] };
  }

  function fit() {
    const { low, high } = bounds();
    const margin = 0.08 * Math.max(high[0] - low[0], high[1] - low[1]);
    const [width, height] = [high[0] - low[0] + 2 * margin, high[1] - low[1] + 2 * margin];
    set(svg, { viewBox: `${low[0] - margin} ${-high[1] - margin} ${width} ${height}` });
    // Millimetres of a pixel.
    unit = Math.max(width / (svg.clientWidth || 500), height / (svg.clientHeight || 500));
    const text = (/** @type {number} */ x, /** @type {number} */ y, /** @type {string} */ content, /** @type {string} */ anchor) =>
      drawing("text", { x, y, "text-anchor": anchor, "font-size": 11 * unit }, content);
    const [left, bottom] = [low[0] - margin + 3 * unit, -low[1] + margin - 4 * unit];
    axes.replaceChildren(
      ...ticks(low[0], high[0], 6).map((x) => text(x, bottom, `${short(x)}`, "middle")),
      ...ticks(low[1], high[1], 6).map((y) => text(left, -y + 4 * unit, `${short(y)}`, "start")),
      text(high[0] + margin - 3 * unit, bottom, "mm", "end"),
    );
  }

  model.listeners.push(() => {
    if (!model.state) return;
    const isNew = shownState !== model.state;
    const isSame = drawn.length === model.tiles.length && shownState?.tiles.every((/** @type {Tile} */ tile, /** @type {number} */ i) => tile.name === model.tiles[i].name);
    if (!model.gesture || drawn.length === 0) fit();
    if (!isSame) rebuild();
    model.tiles.forEach((_, index) => drawTile(index));
    if (isNew || !isSame) drawSurroundings();
    shownState = model.state;
    drawHandles();
    const symmetry = model.state.brief?.symmetry ?? "none";
    const together = symmetry !== "none" && model.isSymmetric ? ` The film has ${symmetry} symmetry: the images of a tile move with it.` : "";
    const tile = model.gesture && model.selected !== null ? model.tiles[model.selected] : null;
    if (tile && drawn[model.selected ?? 0]?.tile === tile && model.gesture?.origin !== model.tiles) readout.textContent = describe(tile);
    const sensor = layers.sensors.querySelector(".movable") ? ", a sensor" : "";
    const cut = layers.cuts.firstChild ? ", the triangle of a cut line" : "";
    hint.textContent = `Drag a tile, a corner, the tip of an arrow${cut}${sensor}. Dashed: range of the displacement; dark squares: sensors. Steps of ${short(model.step_mm)} mm; Alt drags freely.${together}`;
  });
  svg.addEventListener("pointerdown", (/** @type {PointerEvent} */ event) => {
    if (event.target === svg) model.select(null);
  });
  new ResizeObserver(() => {
    fit();
    for (const own of drawn) own.tile = null;
    if (model.state) {
      model.tiles.forEach((_, index) => drawTile(index));
      drawSurroundings();
      drawHandles();
    }
  }).observe(svg);
  return svg;
}
