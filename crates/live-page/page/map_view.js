// One quantity over a plane of the working volume, and its value under the pointer.

import { valueScale } from "#colours";
import { ticks } from "#axis";
import { element, number, set, short } from "#format";

const QUANTITIES = [
  { key: "flux_density", name: "B", unit: "mT", factor: 1e3 },
  { key: "displacement_error", name: "displacement error", unit: "\u00b5m", factor: 1e3 },
  { key: "resolution", name: "noise of one reading", unit: "\u00b5m", factor: 1e3 },
];
// Points along an axis: the map follows a drag within a frame, and is finer at rest.
const [COARSE, FINE] = [13, 41];
// Films of more tiles have their map at rest only.
const MOST_TILES_IN_MOTION = 100;

/** @param {import("#model").Model} model @param {HTMLElement} place */
export function showMap(model, place) {
  const quantity = element("select", { "aria-label": "Quantity of the map" });
  for (const [index, { name }] of QUANTITIES.entries()) {
    for (const [axis, letter] of ["x", "y", "z"].entries()) quantity.append(new Option(`${name}, ${letter}`, `${index} ${axis}`));
  }
  quantity.value = "1 0";
  const height = element("input", { type: "range", min: 0, max: 1, step: "any", value: 0.5, "aria-label": "Height of the map" });
  const heightText = element("output", { class: "height" });
  const canvas = element("canvas", { class: "map", role: "img", "aria-label": "Map of the chosen quantity" });
  const readout = element("p", { class: "readout", role: "status" });
  const controls = element("div", { class: "controls" }, element("label", {}, "map of ", quantity), element("label", {}, "at ", height, heightText));
  place.append(controls, canvas, readout);
  /** @type {any} */
  let map = null;
  /** @type {string} */
  let asked = "";

  const z = () => {
    const volume = model.state?.volume;
    if (!volume) return 0;
    const [low, high] = [volume.lower_mm[2], volume.upper_mm[2]];
    return low + Number(height.value) * (high - low);
  };

  /** @param {number} points @param {boolean} rigid */
  async function ask(points, rigid) {
    const volume = model.state?.volume;
    set(canvas, { hidden: !volume });
    set(controls, { hidden: !volume });
    if (!volume) return;
    heightText.textContent = `z = ${short(z(), 4)} mm`;
    const [index, axis] = quantity.value.split(" ").map(Number);
    const { key } = QUANTITIES[index];
    const request = { map: { quantity: key, axis, z_mm: z(), counts: [points, points], rigid } };
    asked = JSON.stringify(request);
    const own = asked;
    try {
      const answer = await model.engine.ask(request);
      if (own !== asked) return;
      map = { ...answer, ...QUANTITIES[index], letter: "xyz"[axis] };
      draw();
    } catch (error) {
      map = null;
      readout.textContent = /** @type {Error} */ (error).message;
      canvas.getContext("2d").clearRect(0, 0, canvas.width, canvas.height);
    }
  }

  function draw() {
    const { x_mm, y_mm, values } = map;
    const [nx, ny] = [x_mm.length, y_mm.length];
    const { low, high, colour } = valueScale(values);
    const density = window.devicePixelRatio || 1;
    const width = canvas.clientWidth;
    const [left, right, top, bottom] = [40, 84, 8, 36];
    const extent = [x_mm[nx - 1] - x_mm[0], y_mm[ny - 1] - y_mm[0]];
    const scale = Math.min((width - left - right) / (extent[0] || 1), 300 / (extent[1] || 1));
    const area = { width: Math.max(60, extent[0] * scale), height: Math.max(60, extent[1] * scale) };
    const tall = area.height + top + bottom;
    canvas.style.height = `${tall}px`;
    [canvas.width, canvas.height] = [Math.round(width * density), Math.round(tall * density)];
    const paper = canvas.getContext("2d");
    paper.scale(density, density);
    const pixels = new ImageData(nx, ny);
    values.forEach((/** @type {number | null} */ value, /** @type {number} */ n) => {
      const at = 4 * (Math.floor(n / ny) + (ny - 1 - (n % ny)) * nx);
      pixels.data.set([...(value === null ? [190, 190, 190] : colour(value)), 255], at);
    });
    const image = new OffscreenCanvas(nx, ny);
    /** @type {any} */ (image.getContext("2d")).putImageData(pixels, 0, 0);
    paper.imageSmoothingEnabled = false;
    paper.drawImage(image, left, top, area.width, area.height);
    const ink = getComputedStyle(canvas).color;
    paper.strokeStyle = paper.fillStyle = ink;
    paper.font = "12px system-ui, sans-serif";
    paper.strokeRect(left, top, area.width, area.height);
    const px = (/** @type {number} */ x) => left + ((x - x_mm[0]) / (extent[0] || 1)) * area.width;
    const py = (/** @type {number} */ y) => top + area.height - ((y - y_mm[0]) / (extent[1] || 1)) * area.height;
    paper.textAlign = "center";
    for (const x of ticks(x_mm[0], x_mm[nx - 1], 5)) paper.fillText(short(x, 3), px(x), top + area.height + 14);
    paper.fillText("x (mm)", left + area.width / 2, top + area.height + 30);
    paper.textAlign = "right";
    for (const y of ticks(y_mm[0], y_mm[ny - 1], 5)) paper.fillText(short(y, 3), left - 5, py(y) + 4);
    const bar = left + area.width + 12;
    for (let n = 0; n < area.height; n++) {
      paper.fillStyle = `rgb(${colour(high - ((n + 0.5) / area.height) * (high - low)).join(" ")})`;
      paper.fillRect(bar, top + n, 12, 1.5);
    }
    paper.fillStyle = ink;
    paper.strokeRect(bar, top, 12, area.height);
    paper.textAlign = "left";
    for (const value of ticks(low * map.factor, high * map.factor, 6)) {
      paper.fillText(short(value, 3), bar + 16, top + area.height - ((value / map.factor - low) / (high - low)) * area.height + 4);
    }
    map.pointed = (/** @type {number} */ x, /** @type {number} */ y) => {
      const [i, j] = [Math.round(((x - left) / area.width) * (nx - 1)), Math.round(((top + area.height - y) / area.height) * (ny - 1))];
      return i >= 0 && i < nx && j >= 0 && j < ny ? { at: [x_mm[i], y_mm[j]], value: values[i * ny + j] } : null;
    };
    describe(null);
  }

  /** @param {{ at: number[], value: number | null } | null} point */
  function describe(point) {
    const of = `${map.name}, ${map.letter}`;
    const inUnit = (/** @type {number | null} */ value) => (value === null ? "has no value" : `= ${number(value * map.factor)} ${map.unit}`);
    const known = map.values.filter((/** @type {number | null} */ value) => value !== null);
    const [least, most] = known.reduce((/** @type {number[]} */ [a, b], /** @type {number} */ v) => [Math.min(a, v), Math.max(b, v)], [Infinity, -Infinity]);
    const range = known.length ? `from ${number(least * map.factor)} to ${number(most * map.factor)} ${map.unit}` : "has no value";
    readout.textContent = point ? `${of} ${inUnit(point.value)} at x = ${short(point.at[0])}, y = ${short(point.at[1])} mm` : `${of} on this plane: ${range}`;
  }

  canvas.addEventListener("pointermove", (/** @type {PointerEvent} */ event) => {
    if (map?.pointed) describe(map.pointed(event.offsetX, event.offsetY));
  });
  canvas.addEventListener("pointerleave", () => map && describe(null));
  const isRigid = () => Boolean(model.gesture);
  for (const control of [quantity, height]) control.addEventListener("input", () => ask(FINE, isRigid()));
  model.listeners.push(() => {
    if (model.gesture && model.tiles.length <= MOST_TILES_IN_MOTION) ask(COARSE, true);
  });
  model.restListeners.push(() => ask(FINE, false));
  window.addEventListener("resize", () => map && draw());
}
