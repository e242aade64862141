// *Improve*: the search for a better film by `[design]`, on an engine of its own.

import { drawing, element, set, short } from "#format";
import { Background } from "#background";

// Steps of the search after which the page shows the film, and after which it may be stopped.
const STEPS = 4;
// The search has ended where so many rounds in a row gain less than a thousandth.
const [ROUNDS_WITHOUT_GAIN, GAIN] = [3, 1e-3];

/** @param {import("#model").Model} model @param {HTMLElement} place @param {() => import("#engine").Engine} newEngine */
export function showImprove(model, place, newEngine) {
  const background = new Background(newEngine);
  const button = element("button", { type: "button", onclick: () => improve() }, "Improve");
  const curve = drawing("svg", { class: "progress", viewBox: "0 0 120 24", role: "img" }, drawing("path", {}));
  const status = element("span", { role: "status", class: "search" });
  place.append(button, curve, status);
  set(curve, { hidden: true });

  /** @param {number[]} errors @param {string} unit */
  function show(errors, unit) {
    const [high, low] = [Math.max(...errors), Math.min(...errors)];
    const points = errors.map((error, i) => `${(2 + (116 * i) / Math.max(1, errors.length - 1)).toFixed(1)} ${(22 - (20 * (error - low)) / (high - low || 1)).toFixed(1)}`);
    set(/** @type {Element} */ (curve.firstChild), { d: `M${points.join("L")}` });
    set(curve, { hidden: false, "aria-label": `Error of the search: from ${short(high)} to ${short(low)}` });
    status.textContent = `error of the goal ${short(errors[0])} \u2192 ${short(errors[errors.length - 1])}${unit} (${errors.length - 1} rounds)`;
  }

  /** The film that the status is about. */
  let found = "";
  model.restListeners.push(() => {
    if (background.isRunning || model.state?.text === found) return;
    status.textContent = "";
    set(curve, { hidden: true });
  });

  async function improve() {
    if (background.isRunning) return background.stop();
    if (!model.state) return;
    const begun = model.state.text;
    button.textContent = "Stop";
    // What the film found is compared with.
    if (!model.pinned) model.pin();
    const unit = model.state.brief?.goal === "displacement" ? " mm" : "";
    /** @type {string | null} */
    let best = null;
    /** @type {number[]} */
    const errors = [];
    let message = "";
    try {
      await background.run({ text: begun, name: model.name }, async (engine) => {
        for (let idle = 0; idle < ROUNDS_WITHOUT_GAIN; ) {
          const found = await engine.ask({ improve: { steps: STEPS } });
          if (errors.length === 0 && found.before !== null) errors.push(found.before);
          const last = errors[errors.length - 1] ?? Infinity;
          if (found.after === null || found.after > last * (1 - GAIN)) idle += 1;
          else idle = 0;
          if (found.after !== null && found.after < last) {
            errors.push(found.after);
            best = found.state.text;
            show(errors, unit);
          }
        }
      });
    } catch (error) {
      message = /** @type {Error} */ (error).message;
    }
    button.textContent = "Improve";
    if (best === null) {
      status.textContent = message && message !== "stopped" ? message : "no better film was found";
    } else if (model.state.text !== begun) {
      status.textContent = "The layout changed during the search: its film is not taken.";
    } else {
      found = best;
      await model.open(best);
    }
  }
}
