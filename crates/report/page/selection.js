// The tile that is chosen, the tile under the pointer and the point of the map that is pointed at.
// Views set them and are told of changes.
const newSelection = () => ({
  chosen: null,
  hovered: null,
  point: null,
  listeners: [],
  set(changes) {
    if (Object.entries(changes).every(([key, value]) => this[key] === value)) return;
    Object.assign(this, changes);
    for (const listener of this.listeners) listener();
  },
});

// The line below the view: the tile, its J, and its share of B at the point of the map.
function showTile(data, page) {
  const { selection } = page;
  const line = page.part("tile");
  const list = page.part("tiles");
  // Contributions of more tiles take too long to add up while the pointer moves.
  const MOST_TILES = 2000;
  list.append(new Option("none", ""));
  data.tiles.forEach((tile, index) => list.append(new Option(tile.name, String(index))));
  list.addEventListener("input", () => selection.set({ chosen: list.value === "" ? null : Number(list.value) }));

  const share = (tile, { at, b_t }) => {
    const own = tileField(tile, at);
    const squared = b_t.reduce((sum, c) => sum + c * c, 0);
    if (!own || !(squared > 0)) return null;
    return { own, part: own.reduce((sum, c, i) => sum + c * b_t[i], 0) / squared };
  };
  const percent = (part) => `${short(100 * part, 3)} %`;
  const where = (at) => at.map((c, i) => `${"xyz"[i]} = ${short(c)}`).join(", ") + " mm";

  function describe(index) {
    const tile = data.tiles[index];
    const j = tile.polarization_t.map((c) => short(c, 4)).join(", ");
    const size = tile.size_mm.map((c) => short(c, 4)).join(" \u00d7 ");
    const strength = short(Math.hypot(...tile.polarization_t), 4);
    const text = `${tile.name}: J = (${j}) T, |J| = ${strength} T, ${size} mm.`;
    if (!data.volume) return text;
    if (!selection.point) return `${text} Point at the map for its share of B there.`;
    const found = share(tile, selection.point);
    if (!found) return `${text} Its share of B at ${where(selection.point.at)} is not defined.`;
    return `${text} At ${where(selection.point.at)} its B is ${fluxVector(found.own)}, ${percent(found.part)} of B.`;
  }
  function describeLargest() {
    if (!selection.point || data.tiles.length > MOST_TILES) return "Point at a tile, or choose one.";
    const shares = data.tiles.map((tile) => [tile.name, share(tile, selection.point)]).filter(([, found]) => found);
    shares.sort(([, a], [, b]) => Math.abs(b.part) - Math.abs(a.part));
    const largest = shares.slice(0, 3).map(([name, { part }]) => `${name} ${percent(part)}`);
    return largest.length ? `Largest shares of B at ${where(selection.point.at)}: ${largest.join(", ")}.` : "";
  }
  selection.listeners.push(() => {
    list.value = selection.chosen === null ? "" : String(selection.chosen);
    const index = selection.hovered ?? selection.chosen;
    line.textContent = index === null ? describeLargest() : describe(index);
  });
  line.textContent = "Point at a tile, or choose one.";
}
