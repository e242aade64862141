// Round numbers on axes.

/** Round numbers from `low` to `high`, about `most` of them.
 * @param {number} low @param {number} high @param {number} most @returns {number[]} */
export function ticks(low, high, most) {
  if (!(high > low)) return [low];
  const rough = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((n) => n * power).find((candidate) => candidate >= rough * 0.999) ?? 10 * power;
  const values = [];
  for (let n = Math.ceil(low / step - 1e-9); n <= Math.floor(high / step + 1e-9); n++) values.push(n * step);
  return values;
}
