// The map of the working volume: one quantity on one plane of constant z, with a slider for z and
// the value under the cursor.
function showMap(data) {
  const canvas = document.getElementById("map");
  if (!canvas || !data.volume) return;
  const paper = canvas.getContext("2d");
  const quantity = document.getElementById("quantity");
  const plane = document.getElementById("plane");
  const ownScale = document.getElementById("own-scale");
  const readout = document.getElementById("readout");
  const { x_mm: xs, y_mm: ys, z_mm: zs } = data.volume;
  const maps = data.maps;
  for (const map of maps) {
    if (map.difference_of) {
      const [a, b] = map.difference_of.map((name) => maps.find((other) => other.name === name).values);
      map.values = a.map((value, i) => (value === null || b[i] === null ? null : value - b[i]));
    }
  }
  let group = null;
  maps.forEach((map, i) => {
    if (!group || group.label !== map.group) {
      group = document.createElement("optgroup");
      group.label = map.group;
      quantity.append(group);
    }
    group.append(new Option(map.name, String(i)));
  });
  plane.max = String(zs.length - 1);
  plane.disabled = zs.length < 2;
  plane.value = String(zs.length >> 1);

  const minus = (text) => text.replace(/-/g, "\u2212");
  const short = (value) => minus(String(Number(value.toPrecision(6))));
  const at = (map, i, j) => map.values[(i * ys.length + j) * zs.length + Number(plane.value)];
  const units = [["T", 1], ["mT", 1e3], ["\u00b5T", 1e6], ["nT", 1e9]];
  // The unit that is shown and its factor. Flux densities are stored in tesla and shown in a unit
  // in which they have few digits.
  function unitOf(map) {
    if (map.unit !== "T") return [map.unit, 1];
    const most = map.values.reduce((most, v) => Math.max(most, Math.abs(v ?? 0)), 0);
    return units.find(([, perT]) => most * perT >= 0.5) ?? units[3];
  }
  // The range of the colour scale, and whether it is symmetric about zero.
  function rangeOf(map) {
    let low = Infinity, high = -Infinity;
    map.values.forEach((value, index) => {
      if (value === null || (ownScale.checked && index % zs.length !== Number(plane.value))) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    });
    if (low > high) return [0, 1, false];
    const slight = 0.02 * (high - low);
    const signed = map.difference_of !== undefined || (map.name !== "S_z" && low < -slight && high > slight);
    if (signed) {
      const reach = Math.max(-low, high) || 1;
      return [-reach, reach, true];
    }
    if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) {
      const half = low === 0 ? 1 : 0.1 * Math.abs(low);
      return [low - half, high + half, false];
    }
    return [low, high, false];
  }
  // Round numbers from `low` to `high`, at most about `most` of them.
  function ticks(low, high, most) {
    const rough = (high - low) / most;
    const power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((n) => n * power).find((step) => step >= rough * 0.999);
    const values = [];
    for (let n = Math.ceil(low / step - 1e-9); n <= Math.floor(high / step + 1e-9); n++) values.push(n * step);
    return values;
  }
  // The sides of the cells. A side lies half way between two neighbouring coordinates.
  function sides(coordinates) {
    const n = coordinates.length;
    if (n === 1) return [coordinates[0] - 0.5, coordinates[0] + 0.5];
    const middles = coordinates.slice(1).map((c, i) => (c + coordinates[i]) / 2);
    return [2 * coordinates[0] - middles[0], ...middles, 2 * coordinates[n - 1] - middles[n - 2]];
  }
  const [xSides, ySides] = [sides(xs), sides(ys)];
  const [x0, x1, y0, y1] = [xSides[0], xSides[xs.length], ySides[0], ySides[ys.length]];
  let area = null;
  let pointed = null;

  function draw() {
    const map = maps[Number(quantity.value)];
    const [unit, factor] = unitOf(map);
    const [low, high, signed] = rangeOf(map);
    const colours = signed ? data.colours.signed : data.colours.one_signed;
    const colour = (value) => {
      if (value === null) return "#bebebe";
      const index = Math.round(255 * Math.min(1, Math.max(0, (value - low) / (high - low))));
      return "#" + colours.slice(6 * index, 6 * index + 6);
    };
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    const density = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(height * density);
    paper.setTransform(density, 0, 0, density, 0, 0);
    paper.fillStyle = "#fff";
    paper.fillRect(0, 0, width, height);
    const room = [width - 62 - 108, height - 16 - 48];
    const scale = Math.min(room[0] / (x1 - x0), room[1] / (y1 - y0));
    const size = [Math.max(40, scale * (x1 - x0)), Math.max(40, scale * (y1 - y0))];
    area = { left: 62 + Math.max(0, (room[0] - size[0]) / 2), top: 16, width: size[0], height: size[1] };
    const px = (x) => area.left + ((x - x0) / (x1 - x0)) * area.width;
    const py = (y) => area.top + ((y1 - y) / (y1 - y0)) * area.height;
    for (let i = 0; i < xs.length; i++) {
      for (let j = 0; j < ys.length; j++) {
        paper.fillStyle = colour(at(map, i, j));
        // Rounded to whole pixels, so that no gap appears between cells.
        const [left, right] = [xSides[i], xSides[i + 1]].map((x) => Math.round(px(x)));
        const [top, bottom] = [ySides[j + 1], ySides[j]].map((y) => Math.round(py(y)));
        paper.fillRect(left, top, right - left, bottom - top);
      }
    }
    paper.strokeStyle = paper.fillStyle = "#1e1e1e";
    paper.lineWidth = 1;
    paper.font = "13px system-ui, sans-serif";
    paper.strokeRect(area.left, area.top, area.width, area.height);
    paper.textAlign = "center";
    paper.textBaseline = "top";
    const bottom = area.top + area.height;
    const line = (a, b, c, d) => {
      paper.beginPath();
      paper.moveTo(a, b);
      paper.lineTo(c, d);
      paper.stroke();
    };
    for (const x of ticks(x0, x1, 6)) {
      line(px(x), bottom, px(x), bottom + 4);
      paper.fillText(short(x), px(x), bottom + 7);
    }
    paper.fillText("x (mm)", area.left + area.width / 2, bottom + 26);
    paper.textAlign = "right";
    paper.textBaseline = "middle";
    for (const y of ticks(y0, y1, 6)) {
      line(area.left - 4, py(y), area.left, py(y));
      paper.fillText(short(y), area.left - 7, py(y));
    }
    const bar = area.left + area.width + 16;
    const level = (value) => bottom - ((value - low) / (high - low)) * area.height;
    for (let n = 0; n < area.height; n++) {
      paper.fillStyle = colour(low + ((area.height - n - 0.5) / area.height) * (high - low));
      paper.fillRect(bar, area.top + n, 14, Math.min(1.5, area.height - n));
    }
    paper.strokeRect(bar, area.top, 14, area.height);
    paper.fillStyle = "#1e1e1e";
    paper.textAlign = "left";
    for (const value of ticks(low * factor, high * factor, 7)) {
      line(bar + 14, level(value / factor), bar + 18, level(value / factor));
      paper.fillText(short(value), bar + 21, level(value / factor));
    }
    const upright = (text, x) => {
      paper.save();
      paper.translate(x, area.top + area.height / 2);
      paper.rotate(-Math.PI / 2);
      paper.textAlign = "center";
      paper.fillText(text, 0, 0);
      paper.restore();
    };
    upright("y (mm)", area.left - 48);
    upright(`${map.name} (${unit})`, bar + 80);
    if (pointed) {
      const [i, j] = pointed;
      paper.lineWidth = 2;
      const box = [px(xSides[i]), py(ySides[j + 1])];
      paper.strokeRect(box[0], box[1], px(xSides[i + 1]) - box[0], py(ySides[j]) - box[1]);
    }
    const z = zs[Number(plane.value)];
    document.getElementById("z").textContent = `z = ${short(z)} mm`;
    if (!pointed) {
      readout.textContent = "Point at the map to read a value.";
      return;
    }
    const value = at(map, ...pointed);
    const where = `x = ${short(xs[pointed[0]])}, y = ${short(ys[pointed[1]])}, z = ${short(z)} mm`;
    if (value === null) {
      readout.textContent = `${map.name} has no value at ${where}`;
      return;
    }
    const digits = minus(String(Number((value * factor).toPrecision(9))));
    readout.textContent = `${map.name} = ${digits} ${unit} at ${where}`;
  }

  // Marks the cell under the cursor.
  function point(event) {
    const box = canvas.getBoundingClientRect();
    const x = x0 + ((event.clientX - box.left - area.left) / area.width) * (x1 - x0);
    const y = y1 - ((event.clientY - box.top - area.top) / area.height) * (y1 - y0);
    const i = xSides.findIndex((side, n) => x >= side && x < xSides[n + 1]);
    const j = ySides.findIndex((side, n) => y >= side && y < ySides[n + 1]);
    pointed = i < 0 || j < 0 ? null : [i, j];
    draw();
  }
  canvas.addEventListener("pointermove", point);
  canvas.addEventListener("pointerdown", point);
  canvas.addEventListener("pointerleave", () => {
    pointed = null;
    draw();
  });
  for (const control of [quantity, plane, ownScale]) control.addEventListener("input", draw);
  window.addEventListener("resize", draw);
  draw();
}
