// Numbers as text, and elements of the page.

const MINUS = "\u2212";

/** A number as the program prints it: six decimals, or six digits where those would lose it.
 * @param {number | null | undefined} value @returns {string} */
export function number(value) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "none";
  const most = Math.abs(value);
  const text = value === 0 || (most >= 1e-3 && most < 1e5) ? (value + 0).toFixed(6) : value.toExponential(5).replace("e+", "e");
  return text.replace("-", MINUS).replace("e-", `e${MINUS}`);
}

/** A number with few digits. @param {number} value @param {number} [digits] @returns {string} */
export function short(value, digits = 4) {
  return String(Number(value.toPrecision(digits)) + 0).replace("-", MINUS);
}

export const NO_CHANGE = "no change";

/** A difference with its sign; "no change" below a millionth. @param {number} value @returns {string} */
export function difference(value) {
  if (Math.abs(value) < 5e-7) return NO_CHANGE;
  return (value > 0 ? "+" : "") + short(value, 3);
}

/** A number without the round-off of a gesture, as it is written into a layout: to 1e-6.
 * @param {number} value @returns {number} */
export const rounded = (value) => Number(value.toFixed(6)) + 0;

/** The multiple of a step that is nearest. @param {number} value @param {number} step @returns {number} */
export const snapped = (value, step) => rounded(Math.round(value / step) * step);

/** An HTML element with attributes, listeners (`onclick`) and children.
 * @param {string} name @param {Record<string, any>} [attributes] @param {(Node | string)[]} children
 * @returns {any} */
export function element(name, attributes = {}, ...children) {
  return dressed(document.createElement(name), attributes, children);
}

/** The same for SVG. @param {string} name @param {Record<string, any>} [attributes]
 * @param {(Node | string)[]} children @returns {any} */
export function drawing(name, attributes = {}, ...children) {
  return dressed(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

/** Sets attributes; `null` and `false` remove them. @param {Element} of @param {Record<string, any>} attributes */
export function set(of, attributes) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) of.removeAttribute(key);
    else of.setAttribute(key, value === true ? "" : String(value));
  }
}

/** @param {any} made @param {Record<string, any>} attributes @param {(Node | string)[]} children */
function dressed(made, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(key.slice(2), value);
    else set(made, { [key]: value });
  }
  made.append(...children);
  return made;
}
