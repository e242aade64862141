// Each film has its own section, data and selection; the ids of its elements begin with its prefix.
for (const section of document.querySelectorAll("[data-film]")) {
  const part = (id) => document.getElementById(section.dataset.film + id);
  const data = JSON.parse(part("data").textContent);
  const page = { section, part, selection: newSelection() };
  showTile(data, page);
  showTiles(data, page);
  showMap(data, page);
}
