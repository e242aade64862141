// The error of the sensor in use, by cause, and the films that a workshop makes.

import { NO_CHANGE, difference, element, number, set, short } from "#format";
import { Background } from "#background";

// Exact samples that check the first order of the budget.
const CHECKING_SAMPLES = 20;
// Number of simulated films, and of films after which the page shows the result.
const [FILMS, STEP] = [200, 20];
const BINS = 24;
const SIMULATE = `Simulate ${FILMS} films`;

/** @typedef {{ name: string, squares: number, rms_mm: number }} CauseRow */
/** @typedef {{ total_mm: number, rows: CauseRow[], isFirstOrder?: boolean }} Causes */

// A share of the total below this is round-off: a head rejects a stray field to the last digit.
const ROUND_OFF = 1e-12;

/** The causes of a budget, the largest first: mean squares along all axes together.
 * @param {any} budget @returns {Causes} */
export function causesOf(budget) {
  const sum = (/** @type {any} */ of) => of.x + of.y + of.z;
  const rows = budget.parts.map((/** @type {any} */ part) => {
    const squares = sum(part.mean_square_mm2);
    return { name: part.name, squares, rms_mm: Math.sign(squares) * Math.sqrt(Math.abs(squares)) };
  });
  rows.sort((/** @type {CauseRow} */ a, /** @type {CauseRow} */ b) => b.squares - a.squares);
  const total = Math.max(0, sum(budget.total_mm2));
  for (const row of rows) if (Math.abs(row.squares) <= ROUND_OFF * total) [row.squares, row.rms_mm] = [0, 0];
  return { total_mm: Math.sqrt(total), rows };
}

/** @param {import("#model").Model} model @param {HTMLElement} place @param {() => import("#engine").Engine} newEngine */
export function showCauses(model, place, newEngine) {
  const title = element("h2", {}, "In use: the error by cause");
  const total = element("p", { class: "total", role: "status" });
  const list = element("ol", { class: "causes", "aria-label": "Causes of the displacement error" });
  const button = element("button", { type: "button", onclick: () => made() }, SIMULATE);
  const films = element("div", { class: "made", role: "status" });
  const note = element("p", { class: "hint" });
  place.append(title, total, list, note, button, films);
  const [background, making] = [new Background(newEngine), new Background(newEngine)];
  /** @type {Causes | null} */
  let before = null;
  /** @type {Causes | null} */
  let now = null;

  const layout = () => ({ text: model.state?.text ?? "", name: model.name });

  async function evaluate() {
    making.stop();
    films.replaceChildren();
    set(button, { disabled: !model.state?.document?.tolerance });
    if (!model.state?.document?.tolerance) {
      background.stop();
      [before, now] = [null, null];
      list.replaceChildren();
      note.textContent = "";
      total.textContent = "No disturbances are set. Choose errors of the tiles, a stray field or iron at \u201cSensor and surroundings\u201d: each is then shown here with its part of the error.";
      return;
    }
    const own = model.state.text;
    try {
      const budget = await background.run(layout(), (engine) => engine.ask({ budget: { samples: CHECKING_SAMPLES } }));
      if (own !== model.state?.text) return;
      [before, now] = [now, { ...causesOf(budget), isFirstOrder: budget.is_first_order }];
      show();
    } catch (error) {
      if (own !== model.state?.text) return;
      list.replaceChildren();
      total.textContent = /** @type {Error} */ (error).message;
    }
  }

  function show() {
    if (!now) return;
    const known = before;
    const by_mm = known ? now.total_mm - known.total_mm : 0;
    const change = by_mm && difference(by_mm) !== NO_CHANGE ? ` (${difference(by_mm)} mm by the last change)` : "";
    total.textContent = `${number(now.total_mm)} mm RMS along x, y, z together${change}`;
    const noise = model.evaluated?.resolution_mm;
    const beside = noise ? ` The noise of one reading adds ${short(Math.hypot(...noise), 3)} mm.` : "";
    const large = now.isFirstOrder ? "" : " The disturbances are so large that their parts do not add up: they come from a few samples.";
    note.textContent = `Bars: shares of the squared error.${beside}${large}`;
    const most = Math.max(...now.rows.map((row) => row.squares), 1e-300);
    list.replaceChildren(
      ...now.rows.map((row) => {
        const old = known?.rows.find(({ name }) => name === row.name);
        const by = known ? difference(row.rms_mm - (old?.rms_mm ?? 0)).replace(NO_CHANGE, "") : "";
        const share = (row.squares / most) * 100;
        return element(
          "li",
          {},
          element("span", { class: "name" }, row.name),
          element("span", { class: "bar" }, element("span", { style: `width:${Math.max(0, share).toFixed(1)}%` })),
          element("span", { class: "value" }, row.squares < 0 ? `reduces by ${short(-row.rms_mm, 3)} mm` : row.squares === 0 ? "0 mm" : `${short(row.rms_mm, 3)} mm`),
          element("span", { class: "change" }, by),
        );
      }),
    );
  }

  async function made() {
    if (making.isRunning) return making.stop();
    const own = model.state?.text;
    button.textContent = "Stop";
    try {
      await making.run(layout(), async (engine) => {
        for (let count = 0; count < FILMS; count += STEP) {
          const answer = await engine.ask({ made: { add: STEP, seed: 1 } });
          if (own !== model.state?.text) return;
          showFilms(answer);
        }
      });
    } catch (error) {
      const { message } = /** @type {Error} */ (error);
      if (message !== "stopped") films.replaceChildren(element("p", { class: "message" }, message));
    }
    button.textContent = SIMULATE;
  }

  /** @param {any} answer */
  function showFilms(answer) {
    const values = answer.displacements_mm;
    const [low, high] = [Math.min(...values), Math.max(...values)];
    const counts = Array(BINS).fill(0);
    for (const value of values) counts[Math.min(BINS - 1, Math.floor(((value - low) / (high - low || 1)) * BINS))] += 1;
    const most = Math.max(...counts);
    const bars = counts.map((count) => element("span", { style: `height:${((100 * count) / most).toFixed(1)}%` }));
    const percentile = (/** @type {any} */ of) => short(of.p95.value, 3);
    const axes = ["x", "y", "z"].map((axis) => `${axis} ${percentile(answer.displacement_rmse_mm[axis])}`).join(", ");
    films.replaceChildren(
      element("p", {}, `${answer.samples} films, each with the disturbances above: 95 % of them have a displacement RMSE of at most ${percentile(answer.displacement_mm)} mm (${axes} mm).`),
      element("div", { class: "histogram", role: "img", "aria-label": `Displacement RMSE of the films, from ${short(low, 3)} to ${short(high, 3)} mm` }, ...bars),
      element("p", { class: "range" }, element("span", {}, `${short(low, 3)} mm`), element("span", {}, `${short(high, 3)} mm`)),
    );
  }

  model.restListeners.push(evaluate);
}
