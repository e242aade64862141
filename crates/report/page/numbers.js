// Numbers as text: a true minus sign, few digits, 0 without a sign.
const minus = (text) => text.replace(/-/g, "\u2212");
const short = (value, digits = 6) => minus(String(Number(value.toPrecision(digits)) || 0));
const fluxUnits = [["T", 1], ["mT", 1e3], ["\u00b5T", 1e6], ["nT", 1e9]];
// The largest unit in which a flux density is at least 0.5, with its factor.
const fluxUnit = (most_t) => fluxUnits.find(([, perT]) => most_t * perT >= 0.5) ?? fluxUnits[3];
// A vector in a unit in which its longest component has few digits.
function fluxVector(b_t) {
  const [unit, factor] = fluxUnit(Math.max(...b_t.map(Math.abs)));
  return `(${b_t.map((c) => short(c * factor, 4)).join(", ")}) ${unit}`;
}
