// B of one tile in tesla at a point, in closed form: the second derivatives of the integral of
// 1 / (4 pi r) over the tile, times J, plus J inside. `null` on an edge, where B is unbounded.
// Double precision without the care of the program: good to about ten digits near the film.
function tileField(tile, point) {
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const away = point.map((c, i) => c - tile.centre_mm[i]);
  const p = tile.axes.map((axis) => dot(axis, away));
  const j = tile.axes.map((axis) => dot(axis, tile.polarization_t));
  const half = tile.size_mm.map((side) => side / 2);
  const b = p.every((c, i) => Math.abs(c) < half[i]) ? [...j] : [0, 0, 0];
  for (let corner = 0; corner < 8; corner++) {
    const u = p.map((c, i) => ((corner >> i) & 1 ? c + half[i] : c - half[i]));
    const sign = ((corner ^ (corner >> 1) ^ (corner >> 2)) & 1 ? 1 : -1) / (4 * Math.PI);
    const r = Math.hypot(...u);
    for (let a = 0; a < 3; a++) {
      const [v, w] = [(a + 1) % 3, (a + 2) % 3];
      b[a] -= sign * Math.atan2(u[v] * u[w] * Math.sign(u[a] || 1), Math.abs(u[a]) * r) * j[a];
      // ln(r + u) without cancellation where u is negative.
      const log = Math.log(u[a] >= 0 ? r + u[a] : (u[v] * u[v] + u[w] * u[w]) / (r - u[a]));
      b[v] += sign * log * j[w];
      b[w] += sign * log * j[v];
    }
  }
  if (!b.every(Number.isFinite)) return null;
  return [0, 1, 2].map((i) => tile.axes.reduce((sum, axis, n) => sum + axis[i] * b[n], 0));
}
