// The tiles in three dimensions: boxes in the colours of the figure of the layout, with arrows
// along their polarization.
function showTiles(data) {
  const canvas = document.getElementById("view");
  const gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true });
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
  const solids = [], lines = [], arrows = [];
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const quad = (into, [a, b, c, d], normal, colour) => {
    for (const p of [a, b, c, a, c, d]) into.push(...p, ...normal, ...colour);
  };
  // Adds a box with these half sides as vectors. Without a colour it has edges only.
  function box(centre, halves, colour, edges) {
    const corner = (i) => halves.reduce((p, half, axis) => add(p, half, (i >> axis) & 1 ? 1 : -1), centre);
    const corners = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
    for (const p of corners) for (let i = 0; i < 3; i++) {
      low[i] = Math.min(low[i], p[i]);
      high[i] = Math.max(high[i], p[i]);
    }
    for (let axis = 0; axis < 3; axis++) {
      const [u, v] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
      for (const side of [0, 1 << axis]) {
        const normal = add([0, 0, 0], unit(halves[axis]), side ? 1 : -1);
        if (colour) quad(solids, [side, side | u, side | u | v, side | v].map((i) => corners[i]), normal, colour);
      }
      for (const from of [0, u, v, u | v]) {
        for (const p of [from, from | (1 << axis)]) lines.push(...corners[p], 0, 0, 0, ...edges);
      }
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
  if (data.volume) {
    const { lower_mm: lower, upper_mm: upper } = data.volume;
    const halves = [0, 1, 2].map((axis) => [0, 1, 2].map((i) => (i === axis ? (upper[i] - lower[i]) / 2 : 0)));
    box(lower.map((c, i) => (c + upper[i]) / 2), halves, null, [0, 0.3, 0.8]);
  }
  const middle = low.map((c, i) => (c + high[i]) / 2);
  const reach = Math.hypot(...high.map((c, i) => c - low[i])) / 2 || 1;

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
  const buffers = [solids, lines, arrows].map((numbers) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.STATIC_DRAW);
    return [buffer, numbers.length / 9];
  });
  const place = (name) => gl.getUniformLocation(program, name);
  const start = { round: -0.5, over: 0.95, close: 1.2 };
  const pose = { ...start };

  function draw() {
    const density = window.devicePixelRatio || 1;
    canvas.width = Math.round(canvas.clientWidth * density);
    canvas.height = Math.round(canvas.clientHeight * density);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(1, 1, 1, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    const [sr, cr, so, co] = [Math.sin(pose.round), Math.cos(pose.round), Math.sin(pose.over), Math.cos(pose.over)];
    // A matrix, column by column: a rotation about z, then one about the horizontal axis of the
    // screen.
    const turned = [cr, co * sr, -so * sr, -sr, co * cr, -so * cr, 0, so, co];
    gl.uniformMatrix3fv(place("turn"), false, turned);
    gl.uniform1f(place("depth"), 0.2 / reach);
    gl.uniform3fv(place("middle"), middle);
    const fit = (0.92 * pose.close) / reach;
    const wide = canvas.width / canvas.height;
    gl.uniform2f(place("stretch"), wide > 1 ? fit / wide : fit, wide > 1 ? fit : fit * wide);
    const show = ([buffer, count], mode) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      ["place", "normal", "colour"].forEach((name, i) => {
        const attribute = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(attribute);
        gl.vertexAttribPointer(attribute, 3, gl.FLOAT, false, 36, 12 * i);
      });
      gl.drawArrays(mode, 0, count);
    };
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(1.5, 8);
    show(buffers[0], gl.TRIANGLES);
    show(buffers[1], gl.LINES);
    // Arrows lie inside their tiles. Clearing the depth buffer lets them show through.
    gl.clear(gl.DEPTH_BUFFER_BIT);
    show(buffers[2], gl.TRIANGLES);
  }
  function turn(across, along) {
    pose.round += across;
    pose.over = Math.min(Math.PI, Math.max(0, pose.over + along));
    draw();
  }
  let held = null;
  canvas.addEventListener("pointerdown", (event) => {
    held = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!held) return;
    turn((event.clientX - held[0]) * 0.01, (held[1] - event.clientY) * 0.01);
    held = [event.clientX, event.clientY];
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => (held = null));
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    pose.close = Math.min(20, Math.max(0.3, pose.close * Math.exp(-0.001 * event.deltaY)));
    draw();
  }, { passive: false });
  canvas.addEventListener("dblclick", () => {
    Object.assign(pose, start);
    draw();
  });
  canvas.addEventListener("keydown", (event) => {
    const by = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (!by) return;
    event.preventDefault();
    turn(...by);
  });
  window.addEventListener("resize", draw);
  draw();
}

const data = JSON.parse(document.getElementById("data").textContent);
showTiles(data);
showMap(data);
