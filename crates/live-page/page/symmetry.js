// The symmetry of a film: images of tiles, which a gesture moves together.

/** @typedef {{ exchange: boolean, signs: [number, number] }} Operation */
/** @typedef {{ name: string, position_mm: number[], size_mm: number[], polarization_t: number[], axes: number[][], is_strip: boolean }} Tile */
/** @typedef {{ position_mm: number[], size_mm: number[], polarization_t: number[] }} Shape */

/** What is said where the symmetry leaves nothing of a change. */
export const FIXED_BY_SYMMETRY = "The symmetry of the film fixes this number: switch off \u201ckeep the symmetry\u201d to change one tile alone.";

// Images agree to a millionth of their size, as in the search for films.
const SAME_TILE = 1e-6;
const SIGNS = /** @type {[number, number][]} */ ([[1, 1], [-1, 1], [1, -1], [-1, -1]]);

/** The operations of a symmetry of `[design]`, the identity first. @param {string} symmetry @returns {Operation[]} */
export function operations(symmetry) {
  const plain = SIGNS.map((signs) => ({ exchange: false, signs }));
  if (symmetry === "four-fold") return [...plain, ...SIGNS.map((signs) => ({ exchange: true, signs }))];
  return symmetry === "mirror" ? plain : plain.slice(0, 1);
}

/** The image of a point or of an arrow. @param {Operation} operation @param {number[]} vector @returns {number[]} */
export function image({ exchange, signs }, [x, y, z]) {
  const [a, b] = exchange ? [y, x] : [x, y];
  return [signs[0] * a + 0, signs[1] * b + 0, z];
}

/** @param {Operation} operation @param {Shape} shape @returns {Shape} */
function imageOfShape(operation, shape) {
  return {
    position_mm: image(operation, shape.position_mm),
    size_mm: image({ ...operation, signs: [1, 1] }, shape.size_mm),
    polarization_t: image(operation, shape.polarization_t),
  };
}

/** @param {Shape} a @param {Shape} b */
const isSame = (a, b) => /** @type {(keyof Shape)[]} */ (["position_mm", "size_mm", "polarization_t"]).every((key) => close(a[key], b[key], 1e-12));

/** @param {number[]} a @param {number[]} b @param {number} slack */
const close = (a, b, slack) => a.every((value, i) => Math.abs(value - b[i]) <= slack);

/** @param {Tile} tile */
export const isAligned = (tile) => tile.axes.every((axis, i) => Math.abs(axis[i] - 1) < 1e-12);

/** The tiles that are images of one tile, with their operations; the tile itself first. A tile without
 * an image, or with a rotation, stands alone.
 * @param {Tile[]} tiles @param {number} index @param {string} symmetry
 * @returns {{ tile: number, operation: Operation }[]} */
export function orbit(tiles, index, symmetry) {
  const alone = [{ tile: index, operation: operations("none")[0] }];
  const of = tiles[index];
  if (!isAligned(of)) return alone;
  const [length, strength] = [Math.max(...of.size_mm), Math.hypot(...of.polarization_t)];
  const found = operations(symmetry).map((operation) => {
    const wanted = imageOfShape(operation, of);
    const tile = tiles.findIndex(
      (other) =>
        isAligned(other) &&
        close(other.position_mm, wanted.position_mm, SAME_TILE * length) &&
        close(other.size_mm, wanted.size_mm, SAME_TILE * length) &&
        close(other.polarization_t, wanted.polarization_t, SAME_TILE * strength),
    );
    return { tile, operation };
  });
  return found.some(({ tile }) => tile < 0) ? alone : found;
}

/** The new shapes of all images of a tile, which had the shape `before`. A tile that is its own image
 * keeps that property: a pointer moves it along the mirror, a typed number also sets its image on the
 * diagonal, and the direction of its J stays. No shapes if that leaves nothing of the change.
 * @param {{ tile: number, operation: Operation }[]} images @param {Shape} before @param {Shape} shape @param {boolean} isTyped
 * @returns {{ tile: number, position_mm: number[], size_mm: number[], polarization_t: number[] }[]} */
export function editedImages(images, before, shape, isTyped = false) {
  const own = images.filter(({ tile }) => tile === images[0].tile).map(({ operation }) => operation);
  const kept = { ...shape };
  if (own.length > 1) {
    for (const key of /** @type {("position_mm" | "size_mm")[]} */ (["position_mm", "size_mm"])) {
      const by = shape[key].map((value, i) => value - before[key][i]);
      const all = own.map((operation) => imageOfShape(operation, { ...before, [key]: by })[key]);
      const mean = by.map((_, i) => all.reduce((sum, one) => sum + one[i], 0) / own.length);
      const typed = by.findIndex((value) => value !== 0);
      const factor = isTyped && mean[typed] ? by[typed] / mean[typed] : 1;
      kept[key] = before[key].map((value, i) => value + factor * mean[i]);
    }
    const [old, now] = [before.polarization_t, shape.polarization_t];
    const along = old.reduce((sum, c, i) => sum + c * now[i], 0);
    // J stays on its line: it is reversed, or has another strength.
    const isReversed = along < -(1 - SAME_TILE) * Math.hypot(...old) * Math.hypot(...now);
    const factor = ((isReversed ? -1 : 1) * Math.hypot(...now)) / Math.hypot(...old);
    if (Math.hypot(...old) > 0) kept.polarization_t = old.map((c) => c * factor + 0);
    if (isSame(kept, before)) return [];
  }
  const edits = new Map(images.map(({ tile, operation }) => [tile, { tile, ...imageOfShape(operation, kept) }]));
  return [...edits.values()];
}
