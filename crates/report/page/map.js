// The map of the working volume: one quantity on one plane of constant z, with a slider for z and
// the value at the point that the mouse, a tap or the keyboard points at.
function showMap(data, page) {
  const { selection } = page;
  const canvas = page.part("map");
  if (!canvas || !data.volume) return;
  const paper = canvas.getContext("2d");
  const quantity = page.part("quantity");
  const plane = page.part("plane");
  const ownScale = page.part("own-scale");
  const readout = page.part("readout");
  const { x_mm: xs, y_mm: ys, z_mm: zs } = data.volume;
  const maps = data.maps;
  for (const map of maps) {
    if (map.difference_of) {
      const [a, b] = map.difference_of.map((name) => maps.find((other) => other.name === name).values);
      map.values = a.map((value, i) => {
        if (value === null || b[i] === null) return null;
        const difference = value - b[i];
        return Math.abs(difference) <= map.round_off ? 0 : difference;
      });
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

  const at = (map, i, j) => map.values[(i * ys.length + j) * zs.length + Number(plane.value)];
  const most = (map) => map.values.reduce((most, v) => Math.max(most, Math.abs(v ?? 0)), 0);
  // A map that is 0 everywhere has the unit of |B|.
  const most_t = most(maps.find((map) => map.name === "|B|"));
  // The unit that is shown and its factor. Flux densities are stored in tesla and shown in a unit
  // in which they have few digits.
  const unitOf = (map) => (map.unit === "T" ? fluxUnit(most(map) || most_t) : [map.unit, 1]);
  // The range of the colour scale, and whether it is symmetric about zero.
  function rangeOf(map) {
    let low = Infinity, high = -Infinity;
    map.values.forEach((value, index) => {
      if (value === null || (ownScale.checked && index % zs.length !== Number(plane.value))) return;
      low = Math.min(low, value);
      high = Math.max(high, value);
    });
    // One quantity has one palette everywhere: |B| and S_z have no meaningful zero between them.
    const signed = map.signed;
    if (low > high) return [0, 1, signed];
    if (signed) {
      // Values of one sign have all colours of the other palette, from zero or from the value
      // nearest to it, as in the figures.
      const slight = 0.02 * (high - low);
      const reach = Math.max(-low, high) || most_t || 1;
      const [below, above] = [low < -slight, high > slight];
      if (below === above) return [-reach, reach, signed];
      if (above && low <= 0.5 * high) low = 0;
      if (below && high >= 0.5 * low) high = 0;
      return spread(low, high, false);
    }
    return spread(low, high, signed);
  }
  // A constant also needs a range.
  function spread(low, high, signed) {
    if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) {
      const half = low === 0 ? 1 : 0.1 * Math.abs(low);
      return [low - half, high + half, signed];
    }
    return [low, high, signed];
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
  // The sides of the cells. A side lies half way between two neighbouring coordinates, and the map
  // ends at the first and the last point, where the volume ends.
  function sides(coordinates) {
    const n = coordinates.length;
    if (n === 1) return [coordinates[0] - 0.5, coordinates[0] + 0.5];
    const middles = coordinates.slice(1).map((c, i) => (c + coordinates[i]) / 2);
    return [coordinates[0], ...middles, coordinates[n - 1]];
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
      const reach = Math.max(-low, high);
      const part = signed ? (value + reach) / (2 * reach) : (value - low) / (high - low);
      const index = Math.round(255 * Math.min(1, Math.max(0, part)));
      return "#" + colours.slice(6 * index, 6 * index + 6);
    };
    const style = getComputedStyle(document.documentElement);
    const [ink, background] = ["--ink", "--paper"].map((name) => style.getPropertyValue(name).trim());
    // The map is as wide as the page allows, and only as high as it needs to be.
    const narrow = canvas.clientWidth < 440;
    const [left, right] = narrow ? [50, 88] : [62, 108];
    const width = canvas.clientWidth;
    const most_px = narrow ? 420 : 470;
    const scale = Math.min((width - left - right) / (x1 - x0), (most_px - 16 - 48) / (y1 - y0));
    const size = [x1 - x0, y1 - y0].map((extent) => Math.max(60, scale * extent));
    const height = narrow ? size[1] + 16 + 48 : most_px;
    canvas.style.height = `${height + canvas.offsetHeight - canvas.clientHeight}px`;
    const density = window.devicePixelRatio || 1;
    canvas.width = Math.round(width * density);
    canvas.height = Math.round(height * density);
    paper.setTransform(density, 0, 0, density, 0, 0);
    paper.fillStyle = background;
    paper.fillRect(0, 0, width, height);
    const spare = (room, used) => Math.max(0, (room - used) / 2);
    area = {
      left: left + spare(width - left - right, size[0]),
      top: 16 + spare(height - 16 - 48, size[1]),
      width: size[0],
      height: size[1],
    };
    canvas.area = area;
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
    paper.strokeStyle = paper.fillStyle = ink;
    paper.lineWidth = 1;
    paper.font = `${narrow ? 11 : 13}px system-ui, sans-serif`;
    paper.strokeRect(area.left, area.top, area.width, area.height);
    paper.textAlign = "center";
    const zero = map.values.every((value) => value === 0);
    if (zero) {
      paper.fillStyle = "#1e1e1e";
      paper.textBaseline = "middle";
      paper.fillText("0 everywhere", area.left + area.width / 2, area.top + area.height / 2);
      paper.fillStyle = ink;
    }
    paper.textBaseline = "top";
    const bottom = area.top + area.height;
    const line = (a, b, c, d) => {
      paper.beginPath();
      paper.moveTo(a, b);
      paper.lineTo(c, d);
      paper.stroke();
    };
    for (const x of ticks(x0, x1, narrow ? 4 : 6)) {
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
    paper.fillStyle = ink;
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
    upright("y (mm)", area.left - (narrow ? 38 : 48));
    upright(`${map.name} (${unit})`, bar + (narrow ? 62 : 80));
    if (pointed) {
      const [i, j] = pointed;
      paper.lineWidth = 2;
      paper.strokeStyle = "#1e1e1e";
      const box = [px(xSides[i]), py(ySides[j + 1])];
      paper.strokeRect(box[0], box[1], px(xSides[i + 1]) - box[0], py(ySides[j]) - box[1]);
    }
    const z = zs[Number(plane.value)];
    const zText = `z = ${short(z)} mm`;
    page.part("z").textContent = zText;
    plane.setAttribute("aria-valuetext", zText);
    tell(map, unit, factor, z);
  }

  // Writes the value at the point below the map, and passes the point to the line about tiles.
  function tell(map, unit, factor, z) {
    if (!pointed) {
      readout.textContent = "Point at the map, or tap it, to read a value.";
      selection.set({ point: null });
      return;
    }
    const position = [xs[pointed[0]], ys[pointed[1]], z];
    const where = position.map((c, i) => `${"xyz"[i]} = ${short(c)}`).join(", ") + " mm";
    const value = at(map, ...pointed);
    const b_t = ["B_x", "B_y", "B_z"].map((name) => at(maps.find((other) => other.name === name), ...pointed));
    selection.set({ point: { at: position, b_t } });
    if (value === null) {
      readout.textContent = `${map.name} has no value at ${where}`;
      return;
    }
    readout.textContent = `${map.name} = ${short(value * factor, 9)} ${unit} at ${where}`;
  }

  // Points at the cell under the mouse or the finger.
  function point(event) {
    const box = canvas.getBoundingClientRect();
    const [left, top] = [box.left + canvas.clientLeft + area.left, box.top + canvas.clientTop + area.top];
    const x = x0 + ((event.clientX - left) / area.width) * (x1 - x0);
    const y = y1 - ((event.clientY - top) / area.height) * (y1 - y0);
    const i = xSides.findIndex((side, n) => x >= side && x < xSides[n + 1]);
    const j = ySides.findIndex((side, n) => y >= side && y < ySides[n + 1]);
    pointed = i < 0 || j < 0 ? null : [i, j];
    kept = false;
    draw();
  }
  // Moves the point by cells, from the middle if there is none.
  function step(di, dj) {
    const [i, j] = pointed ?? [xs.length >> 1, ys.length >> 1];
    const moved = pointed ? [i + di, j + dj] : [i, j];
    pointed = moved.map((c, axis) => Math.min((axis ? ys : xs).length - 1, Math.max(0, c)));
    kept = true;
    draw();
  }
  // Whether the value stays when the mouse leaves: after a click, a tap or a step.
  let kept = false;
  const isTouch = (event) => event.pointerType === "touch";
  canvas.addEventListener("pointermove", (event) => isTouch(event) || kept || point(event));
  canvas.addEventListener("pointerleave", (event) => {
    if (isTouch(event) || kept) return;
    pointed = null;
    draw();
  });
  // A click keeps its value until the next one. A swipe that scrolls the page is no click.
  canvas.addEventListener("click", (event) => {
    const before = kept && pointed;
    point(event);
    kept = pointed !== null && !(before && before.join() === pointed.join() && !isTouch(event));
  });
  const steps = { left: [-1, 0], right: [1, 0], up: [0, 1], down: [0, -1] };
  for (const button of page.section.querySelectorAll("[data-step]")) {
    button.addEventListener("click", () => step(...steps[button.dataset.step]));
  }
  canvas.addEventListener("keydown", (event) => {
    const by = steps[event.key.replace("Arrow", "").toLowerCase()];
    if (!by || !event.key.startsWith("Arrow")) return;
    event.preventDefault();
    step(...by);
  });
  for (const control of [quantity, plane, ownScale]) control.addEventListener("input", draw);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  window.addEventListener("resize", draw);
  draw();
}
