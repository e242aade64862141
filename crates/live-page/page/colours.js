// Colours of directions and of values, as in the figures of a report.

// Okabe and Ito: vermilion (+x), yellow (+y), blue (-x), purple (-y).
const CIRCLE = ["#d55e00", "#e8a317", "#f0e442", "#7fb86b", "#0072b2", "#7d7ab8", "#cc79a7", "#d4685a", "#d55e00"];
const VIRIDIS = ["#440154", "#482878", "#3e4989", "#31688e", "#26828e", "#1f9e89", "#35b779", "#6ece58", "#b5de2b", "#fde725"];
const RED_BLUE = ["#053061", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b", "#67001f"];

/** @param {string} colour @returns {number[]} */
const channels = (colour) => [1, 3, 5].map((at) => parseInt(colour.slice(at, at + 2), 16));

/** The colour at a share from 0 to 1 of a scale. @param {string[]} scale @param {number} share @returns {number[]} */
function between(scale, share) {
  const at = Math.min(1, Math.max(0, share)) * (scale.length - 1);
  const index = Math.min(Math.floor(at), scale.length - 2);
  const [a, b] = [channels(scale[index]), channels(scale[index + 1])];
  return a.map((value, i) => value + (b[i] - value) * (at - index));
}

/** The colour of a polarization: its direction in the plane, whiter if it points up, darker if it points down.
 * @param {number[]} j @returns {string} */
export function directionColour(j) {
  const strength = Math.hypot(...j);
  if (!(strength > 0)) return "rgb(190 190 190)";
  const turn = (Math.atan2(j[1], j[0]) / (2 * Math.PI) + 1) % 1;
  const up = j[2] / strength;
  const [end, share] = [up > 0 ? 250 : 70, up * up];
  const paler = between(CIRCLE, turn).map((c) => Math.round(0.5 * (c + (end - c) * share) + 127.5));
  return `rgb(${paler.join(" ")})`;
}

/** The colour scale of values: from blue to red about zero if both signs occur, else from the least to the most.
 * @param {(number | null)[]} values @returns {{ low: number, high: number, colour: (value: number) => number[] }} */
export function valueScale(values) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) [low, high] = [0, 1];
  const isSigned = low < -0.02 * (high - low) && high > 0.02 * (high - low);
  if (isSigned) {
    high = Math.max(-low, high);
    low = -high;
  }
  // A constant needs a range too.
  if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) {
    const half = high === 0 ? 1 : 0.1 * Math.abs(high);
    [low, high] = [low - half, high + half];
  }
  const scale = isSigned ? RED_BLUE : VIRIDIS;
  return { low, high, colour: (value) => between(scale, (value - low) / (high - low)) };
}
