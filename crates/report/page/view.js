// The tiles in three dimensions: boxes in the colours of the figure of the layout, with arrows
// along their polarization. The frame of the working volume is drawn over everything: solid where
// it is in front, dashed where tiles hide it.
function showTiles(data, page) {
  const { selection } = page;
  const canvas = page.part("view");
  const gl = canvas.getContext("webgl", { antialias: true, stencil: true, preserveDrawingBuffer: true });
  if (!gl) {
    canvas.replaceWith("The view in three dimensions needs WebGL, which this browser does not have.");
    return;
  }
  const add = (a, b, s = 1) => a.map((c, i) => c + s * b[i]);
  const dot = (a, b) => a.reduce((sum, c, i) => sum + c * b[i], 0);
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = (a) => add([0, 0, 0], a, 1 / Math.hypot(...a));
  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);

  // Nine numbers per vertex: position, normal (zero for lines, which are not shaded), colour.
  const solids = [], lines = [], arrows = [], frame = [], dashes = [];
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const quad = (into, [a, b, c, d], normal, colour) => {
    for (const p of [a, b, c, a, c, d]) into.push(...p, ...normal, ...colour);
  };
  // The corners of a box with these half sides as vectors. Bits of the index choose the ends.
  function cornersOf(centre, halves) {
    const corner = (i) => halves.reduce((p, half, axis) => add(p, half, (i >> axis) & 1 ? 1 : -1), centre);
    return [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
  }
  // The twelve edges of a box as pairs of corners.
  const edgePairs = [0, 1, 2].flatMap((axis) => {
    const [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
    return [0, u, v, u | v].map((from) => [from, from | (1 << axis)]);
  });
  function include(corners) {
    for (const p of corners) for (let i = 0; i < 3; i++) {
      low[i] = Math.min(low[i], p[i]);
      high[i] = Math.max(high[i], p[i]);
    }
  }
  // Adds a box with its edges.
  function box(centre, halves, colour, edges) {
    const corners = cornersOf(centre, halves);
    include(corners);
    for (let axis = 0; axis < 3; axis++) {
      const [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
      for (const side of [0, 1 << axis]) {
        const normal = add([0, 0, 0], unit(halves[axis]), side ? 1 : -1);
        quad(solids, [side, side | u, side | u | v, side | v].map((i) => corners[i]), normal, colour);
      }
    }
    for (const pair of edgePairs) for (const p of pair) lines.push(...corners[p], 0, 0, 0, ...edges);
  }
  // Adds a bar of square section, without shading, from `a` to `b`.
  function bar(into, a, b, halfWidth, colour) {
    const along = unit(add(b, a, -1));
    const across = unit(cross(along, Math.abs(along[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    const other = cross(along, across);
    const rim = (p, n) => add(add(p, across, [1, 1, -1, -1][n] * halfWidth), other, [1, -1, -1, 1][n] * halfWidth);
    for (let n = 0; n < 4; n++) {
      const next = (n + 1) % 4;
      quad(into, [rim(a, n), rim(b, n), rim(b, next), rim(a, next)], [0, 0, 0], colour);
    }
  }
  // Adds an arrow along a unit vector, with an octagonal shaft and head.
  function arrow(centre, direction, length, width) {
    const across = unit(cross(direction, Math.abs(direction[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
    const other = cross(direction, across);
    const rim = (p, radius, turn) => add(add(p, across, radius * Math.cos(turn)), other, radius * Math.sin(turn));
    const [tail, tip] = [add(centre, direction, -length / 2), add(centre, direction, length / 2)];
    const neck = add(tip, direction, -Math.min(0.4 * length, 4 * width));
    const dark = [0.1, 0.1, 0.1];
    for (let n = 0; n < 8; n++) {
      const [from, to] = [(n * Math.PI) / 4, ((n + 1) * Math.PI) / 4];
      const normal = unit(add(rim([0, 0, 0], 1, from), rim([0, 0, 0], 1, to)));
      const shaft = (p, turn) => rim(p, width / 2, turn);
      quad(arrows, [shaft(tail, from), shaft(tail, to), shaft(neck, to), shaft(neck, from)], normal, dark);
      const head = [rim(neck, 1.5 * width, from), rim(neck, 1.5 * width, to)];
      for (const p of [...head, tip]) arrows.push(...p, ...normal, ...dark);
      const back = add([0, 0, 0], direction, -1);
      for (const p of [neck, head[1], head[0]]) arrows.push(...p, ...back, ...dark);
    }
  }
  const most = Math.max(...data.tiles.map((tile) => Math.hypot(...tile.polarization_t)), 1e-300);
  const rooms = [];
  for (const tile of data.tiles) {
    const halves = tile.axes.map((axis, i) => add([0, 0, 0], axis, tile.size_mm[i] / 2));
    box(tile.centre_mm, halves, rgb(tile.colour), [0.25, 0.25, 0.25]);
    const strength = Math.hypot(...tile.polarization_t);
    if (strength <= 1e-6 * most) continue;
    const direction = unit(tile.polarization_t);
    const toSides = tile.axes.map((axis, i) => tile.size_mm[i] / Math.max(Math.abs(dot(axis, direction)), 1e-9));
    const room = Math.min(...toSides);
    rooms.push({ tile, direction, room, share: strength / most, width: 0.09 * Math.min(...tile.size_mm) });
  }
  const longest = 0.8 * (rooms.map((r) => r.room).sort((a, b) => a - b)[Math.floor(rooms.length / 20)] ?? 1);
  for (const { tile, direction, room, share, width } of rooms) {
    const length = Math.min(longest * share, 0.9 * room);
    arrow(tile.centre_mm, direction, length, Math.max(width, 0.05 * length));
  }
  let volumeCorners = null;
  if (data.volume) {
    const { lower_mm: lower, upper_mm: upper } = data.volume;
    const halves = [0, 1, 2].map((axis) => [0, 1, 2].map((i) => (i === axis ? (upper[i] - lower[i]) / 2 : 0)));
    volumeCorners = cornersOf(lower.map((c, i) => (c + upper[i]) / 2), halves);
  }
  const film = [[...low], [...high]];
  if (volumeCorners) include(volumeCorners);
  const middle = low.map((c, i) => (c + high[i]) / 2);
  const reach = Math.hypot(...high.map((c, i) => c - low[i])) / 2 || 1;
  // Half the width of the frame, as a fraction of the radius of everything: two pixels in a view of
  // 470 pixels.
  const FRAME_HALF_WIDTH = 0.0045;
  const DASHES = 9;

  // The colours of the page, which change with the colour scheme.
  const dark = window.matchMedia("(prefers-color-scheme: dark)");
  const themed = (name) => rgb(getComputedStyle(document.documentElement).getPropertyValue(name).trim().replace(
    /^#(.)(.)(.)$/, "#$1$1$2$2$3$3"));
  function buildFrame() {
    frame.length = dashes.length = 0;
    if (!volumeCorners) return;
    const colour = themed("--volume");
    for (const [from, to] of edgePairs) {
      const [a, b] = [volumeCorners[from], volumeCorners[to]];
      bar(frame, a, b, FRAME_HALF_WIDTH * reach, colour);
      const at = (n) => add(a, add(b, a, -1), n / DASHES);
      for (let n = 0; n < DASHES; n += 2) bar(dashes, at(n), at(n + 1), FRAME_HALF_WIDTH * reach, colour);
    }
  }
  const marked = [];
  function buildMark() {
    marked.length = 0;
    if (selection.chosen === null) return;
    const tile = data.tiles[selection.chosen];
    const corners = cornersOf(tile.centre_mm, tile.axes.map((axis, i) => add([0, 0, 0], axis, tile.size_mm[i] / 2)));
    for (const [from, to] of edgePairs) {
      bar(marked, corners[from], corners[to], 1.3 * FRAME_HALF_WIDTH * reach, themed("--ink"));
    }
  }

  const shader = (kind, text) => {
    const made = gl.createShader(kind);
    gl.shaderSource(made, text);
    gl.compileShader(made);
    if (!gl.getShaderParameter(made, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(made));
    return made;
  };
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, `
    attribute vec3 place, normal, colour;
    uniform vec3 middle;
    uniform mat3 turn;
    uniform vec2 stretch;
    uniform float depth;
    varying vec3 shaded;
    void main() {
      vec3 p = turn * (place - middle);
      float light = length(normal) > 0.0 ? 0.62 + 0.38 * abs(dot(turn * normal, vec3(0.27, 0.45, 0.85))) : 1.0;
      shaded = colour * light;
      gl_Position = vec4(p.xy * stretch, -depth * p.z, 1.0 - depth * p.z);
    }`));
  gl.attachShader(program, shader(gl.FRAGMENT_SHADER, `
    precision mediump float;
    varying vec3 shaded;
    void main() { gl_FragColor = vec4(shaded, 1.0); }`));
  gl.linkProgram(program);
  gl.useProgram(program);
  const upload = (buffer, numbers) => {
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    return [buffer, numbers.length / 9];
  };
  buildFrame();
  let shapes = [solids, lines, arrows, frame, dashes, marked].map((numbers) => upload(gl.createBuffer(), numbers));
  const place = (name) => gl.getUniformLocation(program, name);
  // The view opens at a height from which the film does not hide the volume below it, if that is
  // possible without looking along the film.
  function openingTilt() {
    if (!data.volume) return 0.95;
    const gap = film[0][2] - data.volume.upper_mm[2];
    if (gap <= 0) return 0.95;
    const across = Math.max(film[1][0] - film[0][0], film[1][1] - film[0][1]) / 2;
    return Math.PI / 2 - Math.min(0.6, Math.max(0.14, Math.atan((0.75 * gap) / across)));
  }
  const start = { round: -0.5, over: openingTilt(), close: 1 };
  const pose = { ...start };
  // Everything fills the view when it opens, and the frame stays inside however the view is turned.
  function openingZoom() {
    const ends = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [0, 1, 2].map((axis) => ((i >> axis) & 1 ? high : low)[axis]));
    const sides = [canvas.clientWidth, canvas.clientHeight];
    const parts = ends.flatMap((end) => canvas.place(end).map((c, i) => Math.abs((2 * c) / sides[i] - 1)));
    const radii = (volumeCorners ?? []).map((corner) => Math.hypot(...add(corner, middle, -1)) / reach);
    return Math.min(0.94 / Math.max(...parts, 0.01), 1 / Math.max(...radii, 0.05));
  }

  // How far the scene is stretched onto the canvas, and the matrix of the view, column by column: a
  // rotation about z, then one about the horizontal axis of the screen.
  function projection() {
    const [sr, cr, so, co] = [Math.sin(pose.round), Math.cos(pose.round), Math.sin(pose.over), Math.cos(pose.over)];
    const fit = (0.92 * pose.close) / reach;
    const wide = canvas.clientWidth / canvas.clientHeight;
    const stretch = [wide > 1 ? fit / wide : fit, wide > 1 ? fit : fit * wide];
    return { turned: [cr, co * sr, -so * sr, -sr, co * cr, -so * cr, 0, so, co], stretch, depth: 0.2 / reach };
  }
  // Where a point of the film is on the canvas, in CSS pixels from its upper left corner.
  canvas.place = (point) => {
    const { turned, stretch, depth } = projection();
    const away = add(point, middle, -1);
    const p = [0, 1, 2].map((row) => turned[row] * away[0] + turned[3 + row] * away[1] + turned[6 + row] * away[2]);
    const w = 1 - depth * p[2];
    return [
      (0.5 + (0.5 * p[0] * stretch[0]) / w) * canvas.clientWidth,
      (0.5 - (0.5 * p[1] * stretch[1]) / w) * canvas.clientHeight,
    ];
  };
  // The index of the tile at a position on the canvas; null if there is none.
  function tileAt(x, y) {
    const { turned, stretch, depth } = projection();
    const u = ((2 * x) / canvas.clientWidth - 1) / stretch[0];
    const v = (1 - (2 * y) / canvas.clientHeight) / stretch[1];
    // The points of the view are (u (1 - depth t), v (1 - depth t), t), from the largest t down.
    const back = (p) => [0, 1, 2].map((column) => dot(turned.slice(3 * column, 3 * column + 3), p));
    const [from, step] = [add(back([u, v, 0]), middle), back([-depth * u, -depth * v, 1])];
    let [nearest, found] = [-Infinity, null];
    data.tiles.forEach((tile, index) => {
      const away = add(tile.centre_mm, from, -1);
      let [enter, leave] = [-Infinity, Infinity];
      tile.axes.forEach((axis, i) => {
        const [approach, distance, half] = [dot(axis, step), dot(axis, away), tile.size_mm[i] / 2];
        const hits = Math.abs(approach) < 1e-12 * reach
          ? (Math.abs(distance) <= half ? [-Infinity, Infinity] : [Infinity, Infinity])
          : [(distance - half) / approach, (distance + half) / approach];
        enter = Math.max(enter, Math.min(...hits));
        leave = Math.min(leave, Math.max(...hits));
      });
      if (enter <= leave && leave > nearest) [nearest, found] = [leave, index];
    });
    return found;
  }

  start.close = pose.close = openingZoom();

  function draw() {
    const density = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * density);
    canvas.height = Math.round(canvas.clientHeight * density);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(...themed("--paper"), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const { turned, stretch, depth } = projection();
    gl.uniformMatrix3fv(place("turn"), false, turned);
    gl.uniform1f(place("depth"), depth);
    gl.uniform3fv(place("middle"), middle);
    gl.uniform2f(place("stretch"), ...stretch);
    const show = ([buffer, count], mode) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      ["place", "normal", "colour"].forEach((name, i) => {
        const attribute = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(attribute);
        gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 36, 12 * i);
      });
      gl.drawArrays(mode, 0, count);
    };
    const [boxes, edges, inner, near, hidden, chosen] = shapes;
    gl.depthRange(0.5, 1);
    gl.disable(gl.STENCIL_TEST);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 8);
    show(boxes, gl.TRIANGLES);
    show(edges, gl.LINES);
    gl.disable(gl.POLYGON_OFFSET_FILL);
    // The depth of the tiles decides which edges of the frame are dashed. The stencil keeps arrows
    // off the frame.
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.ALWAYS, 1, 1);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.REPLACE);
    gl.depthMask(false);
    show(near, gl.TRIANGLES);
    gl.depthFunc(gl.GREATER);
    show(hidden, gl.TRIANGLES);
    gl.depthFunc(gl.LESS);
    gl.depthMask(true);
    // Arrows lie inside their tiles. A range of depths in front of all tiles lets them show through.
    gl.stencilFunc(gl.NOTEQUAL, 1, 1);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.KEEP);
    gl.depthRange(0.1, 0.4);
    show(inner, gl.TRIANGLES);
    gl.depthRange(0, 0.05);
    show(chosen, gl.TRIANGLES);
  }
  function turn(across, along) {
    pose.round += across;
    pose.over = Math.min(Math.PI, Math.max(0, pose.over + along));
    draw();
  }
  function zoom(factor) {
    pose.close = Math.min(20, Math.max(0.3, pose.close * factor));
    draw();
  }
  function look(changes) {
    Object.assign(pose, changes);
    draw();
  }
  const moves = {
    left: () => turn(-0.1, 0), right: () => turn(0.1, 0), up: () => turn(0, -0.1), down: () => turn(0, 0.1),
    closer: () => zoom(1.25), farther: () => zoom(0.8),
    above: () => look({ round: 0, over: 0 }), reset: () => look(start),
  };
  for (const button of page.section.querySelectorAll("[data-turn]")) {
    button.addEventListener("click", moves[button.dataset.turn]);
  }
  const tip = page.part("tip");
  const placeOf = (event) => {
    const box = canvas.getBoundingClientRect();
    return [event.clientX - box.left - canvas.clientLeft, event.clientY - box.top - canvas.clientTop];
  };
  // Shows the name of the tile under the pointer.
  function hover(event) {
    const [x, y] = placeOf(event);
    const index = tileAt(x, y);
    selection.set({ hovered: index });
    tip.hidden = index === null;
    if (index === null) return;
    tip.textContent = data.tiles[index].name;
    tip.style.left = `${Math.max(0, Math.min(x + 14, canvas.clientWidth - tip.offsetWidth - 4))}px`;
    tip.style.top = `${y > 40 ? y - 34 : y + 18}px`;
  }
  function leave() {
    tip.hidden = true;
    selection.set({ hovered: null });
  }
  let held = null;
  // Whether the pointer has moved since it went down, so that its release is not a click.
  let dragged = false;
  canvas.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    dragged = false;
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) {
      if (event.pointerType !== "touch") hover(event);
      return;
    }
    const [across, along] = [event.clientX - held[0], event.clientY - held[1]];
    if (!dragged && Math.hypot(across, along) < 4) return;
    dragged = true;
    leave();
    turn(across * 0.01, event.pointerType === "touch" ? 0 : -along * 0.01);
    held = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointerup", (event) => {
    if (held && !dragged) {
      const index = tileAt(...placeOf(event));
      selection.set({ hovered: null, chosen: index === selection.chosen ? null : index });
    }
    held = null;
  });
  canvas.addEventListener("pointercancel", () => (held = null));
  canvas.addEventListener("pointerleave", leave);
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    zoom(Math.exp(-0.001 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("dblclick", moves.reset);
  canvas.addEventListener("keydown", (event) => {
    const keys = { ArrowLeft: "left", ArrowRight: "right", ArrowUp: "up", ArrowDown: "down", "+": "closer", "=": "closer",
      "-": "farther", Home: "reset" };
    const move = moves[keys[event.key]];
    if (!move || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    move();
  });
  function redress() {
    buildFrame();
    buildMark();
    shapes = [...shapes.slice(0, 3), ...[frame, dashes, marked].map((numbers, i) => upload(shapes[3 + i][0], numbers))];
    draw();
  }
  let drawn = null;
  selection.listeners.push(() => {
    if (selection.chosen === drawn) return;
    drawn = selection.chosen;
    redress();
  });
  dark.addEventListener("change", redress);
  window.addEventListener("resize", draw);
  draw();
}
