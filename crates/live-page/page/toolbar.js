// History, comparison, downloads.

import { fragmentOf } from "#link";
import { element, set } from "#format";

/** @typedef {import("#model").Model} Model */

/** @param {Model} model @param {HTMLElement} place @param {SVGSVGElement} film
 * @param {boolean} isServed whether the address is that of a program on this machine, which nobody else can open */
export function showToolbar(model, place, film, isServed) {
  const button = (/** @type {string} */ text, /** @type {() => any} */ onclick) => element("button", { type: "button", onclick }, text);
  const undo = button("Undo", () => model.go(-1));
  const redo = button("Redo", () => model.go(1));
  const reset = button("Reset", () => model.open(model.texts[0]));
  const pin = button("Pin this film", () => model.pin());
  const exchange = button("Swap with the pinned film", () => model.exchange());
  const lock = element("input", { type: "checkbox", checked: true });
  lock.addEventListener("change", () => {
    model.isSymmetric = lock.checked;
    model.show();
  });
  const symmetric = element("label", {}, lock, " keep the symmetry");
  const link = button("Copy a link", async () => {
    const url = new URL(location.href);
    url.hash = await fragmentOf(model.state?.text ?? "");
    history.replaceState(null, "", url);
    try {
      await navigator.clipboard.writeText(url.href);
      model.say("The link is copied. It holds the whole layout.");
    } catch {
      model.say("The address of this page now holds the whole layout.");
    }
  });
  const toml = button("Download TOML", () => download(new Blob([model.state?.text ?? ""]), stem(model.name) + ".toml"));
  const png = button("Download PNG", async () => download(await picture(film), stem(model.name) + ".png"));
  place.append(undo, redo, reset, symmetric, pin, exchange, toml, ...(isServed ? [] : [link]), png);
  model.listeners.push(() => {
    set(undo, { disabled: !model.canUndo });
    set(redo, { disabled: !model.canRedo });
    set(reset, { disabled: model.at < 1 && model.texts.length < 2 });
    set(symmetric, { hidden: (model.state?.brief?.symmetry ?? "none") === "none" });
    pin.textContent = model.pinned ? "Unpin" : "Pin this film";
    set(exchange, { hidden: !model.pinned });
  });
  document.addEventListener("keydown", (event) => {
    if (!(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
    // A field undoes what is typed into it.
    if (event.target instanceof HTMLInputElement && event.target.type === "number") return;
    event.preventDefault();
    model.go(event.shiftKey ? 1 : -1);
  });
}

const stem = (/** @type {string} */ name) => name.replace(/\.toml$/, "").replace(/[^\p{L}\p{N}._-]+/gu, "-") || "film";

/** @param {Blob} blob @param {string} name */
function download(blob, name) {
  const url = URL.createObjectURL(blob);
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

// Pixels of the picture: 180 mm at 300 dpi.
const PIXELS = 2126;

/** The film from above. @param {SVGSVGElement} film @returns {Promise<Blob>} */
async function picture(film) {
  const copy = /** @type {SVGSVGElement} */ (film.cloneNode(true));
  copy.querySelectorAll(".handles, .cuts").forEach((layer) => layer.remove());
  const { width, height } = film.viewBox.baseVal;
  const tall = Math.round((PIXELS * height) / width);
  // Styles of the page do not reach an image.
  for (const [i, shape] of film.querySelectorAll(".tiles *, .volume *, .sensors *").entries()) {
    const own = copy.querySelectorAll(".tiles *, .volume *, .sensors *")[i];
    const { fill, stroke, strokeWidth, strokeDasharray, vectorEffect } = getComputedStyle(shape);
    own?.setAttribute("style", `fill:${fill};stroke:${stroke};stroke-width:${strokeWidth};stroke-dasharray:${strokeDasharray};vector-effect:${vectorEffect}`);
  }
  set(copy, { width: PIXELS, height: tall, xmlns: "http://www.w3.org/2000/svg" });
  const url = URL.createObjectURL(new Blob([new XMLSerializer().serializeToString(copy)], { type: "image/svg+xml" }));
  const image = new Image();
  image.src = url;
  await image.decode();
  const canvas = element("canvas", { width: PIXELS, height: tall });
  const paper = canvas.getContext("2d");
  paper.fillStyle = "#fff";
  paper.fillRect(0, 0, PIXELS, tall);
  paper.drawImage(image, 0, 0, PIXELS, tall);
  URL.revokeObjectURL(url);
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}
