/* A surface of three joints, to turn by hand. Nothing moves by itself. */

/** The first view: from the side and a little from above, rad.
 * @type {View3} */
const FIRST_VIEW = { yaw: -0.96, pitch: 0.38, distance: 5 };
const STRAIGHT_UP = Math.PI / 2;
const NEAREST = 2.2;
const FARTHEST = 9;
const FIELD = 2.5; // how large a length of 1 at distance 1 is, in halves of the picture

const SURFACE_SHADERS = [
  `#version 300 es
  uniform mat4 view; in vec3 place; in vec3 normal; out vec3 n;
  void main() { gl_Position = view * vec4(place, 1.0); n = normal; }`,
  `#version 300 es
  precision mediump float;
  uniform vec3 colour; uniform vec3 light; uniform float lit; in vec3 n; out vec4 pixel;
  void main() {
    float shade = lit > 0.5 ? 0.6 + 0.4 * abs(dot(normalize(n), light)) : 1.0;
    pixel = vec4(colour * shade, 1.0);
  }`,
];

/** Numbers that stand in the page as base 64.
 * @type {(text: string) => ArrayBuffer} */
function unpacked(text) {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;
}

/** Places in a cube from -1 to 1, of whole numbers.
 * @type {(data: SurfaceData) => Float32Array} */
function cubePlaces(data) {
  return Float32Array.from(new Uint16Array(unpacked(data.places)), (x) => (2 * x) / 65535 - 1);
}

/** One pair of links: corners that it shares with no other, so that edges stay sharp.
 * @type {(places: Float32Array, triangles: Uint32Array) => { place: Float32Array, normal: Float32Array, index: Uint32Array }} */
function piece(places, triangles) {
  /** @type {Map<number, number>} */
  const own = new Map();
  const index = triangles.map((vertex) => {
    const known = own.get(vertex) ?? own.size;
    own.set(vertex, known);
    return known;
  });
  const place = new Float32Array(3 * own.size);
  for (const [vertex, k] of own) place.set(places.subarray(3 * vertex, 3 * vertex + 3), 3 * k);
  return { place, normal: smoothNormals(place, index), index };
}

/** @type {(place: Float32Array, index: Uint32Array) => Float32Array} */
function smoothNormals(place, index) {
  const normal = new Float32Array(place.length);
  for (let t = 0; t < index.length; t += 3) {
    const [a, b, c] = [0, 1, 2].map((k) => [0, 1, 2].map((j) => place[3 * index[t + k] + j]));
    const [u, v] = [b, c].map((end) => end.map((x, j) => x - a[j]));
    for (const k of [0, 1, 2])
      for (const j of [0, 1, 2])
        normal[3 * index[t + k] + j] +=
          u[(j + 1) % 3] * v[(j + 2) % 3] - u[(j + 2) % 3] * v[(j + 1) % 3];
  }
  return normal;
}

/** From the cube to the picture, column by column.
 * @type {(view: View3, width: number, height: number) => number[]} */
function viewMatrix({ yaw, pitch, distance }, width, height) {
  const [c, s, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  const right = [-s, c, 0];
  const up = [-sp * c, -sp * s, cp];
  const towards = [cp * c, cp * s, sp];
  const [fx, fy] = [FIELD * Math.min(1, height / width), FIELD * Math.min(1, width / height)];
  const [near, far] = [0.1, 20];
  const rows = [
    [...right.map((x) => x * fx), 0],
    [...up.map((x) => x * fy), 0],
    [
      ...towards.map((x) => (-x * (far + near)) / (far - near)),
      (distance * (far + near) - 2 * far * near) / (far - near),
    ],
    [...towards.map((x) => -x), distance],
  ];
  return [0, 1, 2, 3].flatMap((column) => rows.map((row) => row[column]));
}

/** Where places are in the picture: x, y in pixels, and how far from the eye.
 * @type {(matrix: number[], place: ArrayLike<number>, width: number, height: number) => number[]} */
function seenAt(matrix, place, width, height) {
  const [x, y, , w] = [0, 1, 2, 3].map(
    (row) =>
      matrix[row] * place[0] +
      matrix[4 + row] * place[1] +
      matrix[8 + row] * place[2] +
      matrix[12 + row],
  );
  return [((1 + x / w) * width) / 2, ((1 - y / w) * height) / 2, w];
}

/** Each axis as the edge of the cube beside which its numbers stand best: upright ones on the left,
    the others below.
 * @type {(matrix: number[], width: number, height: number) => number[][][]} */
function namedEdges(matrix, width, height) {
  return [0, 1, 2].map((axis) => {
    const corners = [
      [-1, -1],
      [-1, 1],
      [1, -1],
      [1, 1],
    ];
    const edges = corners.map(([one, other]) =>
      [-1, 1].map((end) => {
        const corner = [one, other];
        corner.splice(axis, 0, end);
        return corner;
      }),
    );
    const score = edges.map((edge) => {
      const [a, b] = edge.map((corner) => seenAt(matrix, corner, width, height));
      return axis === 2 ? -a[0] - b[0] : a[1] + b[1];
    });
    return edges[score.indexOf(Math.max(...score))];
  });
}

/** What lies under a place of the picture: the nearest triangle, and where on it.
 * @type {(pieces: SurfacePiece[], matrix: number[], pixel: number[], width: number, height: number) => { piece: SurfacePiece, place: number[] } | null} */
function picked(pieces, matrix, [x, y], width, height) {
  /** @type {{ piece: SurfacePiece, place: number[] } | null} */
  let found = null;
  let nearest = Infinity;
  for (const one of pieces.filter((each) => each.shown)) {
    const { place, index } = one;
    const seen = new Float64Array(place.length);
    for (let k = 0; k < place.length; k += 3)
      seen.set(seenAt(matrix, place.subarray(k, k + 3), width, height), k);
    for (let t = 0; t < index.length; t += 3) {
      const [a, b, c] = [3 * index[t], 3 * index[t + 1], 3 * index[t + 2]];
      const area = cross2(seen, a, b, seen[c], seen[c + 1]);
      const parts = [
        cross2(seen, b, c, x, y) / area / seen[a + 2],
        cross2(seen, c, a, x, y) / area / seen[b + 2],
        cross2(seen, a, b, x, y) / area / seen[c + 2],
      ];
      const far = 1 / (parts[0] + parts[1] + parts[2]);
      if (Math.min(...parts) < 0 || !(far < nearest)) continue;
      nearest = far;
      found = {
        piece: one,
        place: [0, 1, 2].map(
          (j) =>
            far * (parts[0] * place[a + j] + parts[1] * place[b + j] + parts[2] * place[c + j]),
        ),
      };
    }
  }
  return found;
}

/** @type {(seen: Float64Array, a: number, b: number, x: number, y: number) => number} */
function cross2(seen, a, b, x, y) {
  return (seen[b] - seen[a]) * (y - seen[a + 1]) - (seen[b + 1] - seen[a + 1]) * (x - seen[a]);
}

/** @type {(gl: WebGL2RenderingContext) => WebGLProgram} */
function surfaceProgram(gl) {
  const program = gl.createProgram();
  for (const [k, source] of SURFACE_SHADERS.entries()) {
    const shader = gl.createShader(k ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
    if (!shader) throw new Error("no shader");
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    gl.attachShader(program, shader);
  }
  for (const [k, name] of ["place", "normal"].entries()) gl.bindAttribLocation(program, k, name);
  gl.linkProgram(program);
  return program;
}

/** Load a list of corners; return what draws it.
 * @type {(gl: WebGL2RenderingContext, place: Float32Array, normal: Float32Array, index: Uint32Array, mode: number) => () => void} */
function loaded(gl, place, normal, index, mode) {
  const state = gl.createVertexArray();
  gl.bindVertexArray(state);
  for (const [k, values] of [place, normal].entries()) {
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, values, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(k);
    gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 0, 0);
  }
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
  gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, index, gl.STATIC_DRAW);
  return () => {
    gl.bindVertexArray(state);
    gl.drawElements(mode, index.length, gl.UNSIGNED_INT, 0);
  };
}

/** The edges of the cube.
 * @type {(gl: WebGL2RenderingContext) => () => void} */
function loadedCube(gl) {
  const place = Float32Array.from({ length: 24 }, (_, k) =>
    (Math.floor(k / 3) >> (k % 3)) & 1 ? 1 : -1,
  );
  const ends = [0, 1, 2, 3, 4, 5, 6, 7].flatMap((corner) =>
    [1, 2, 4].filter((bit) => !(corner & bit)).flatMap((bit) => [corner, corner | bit]),
  );
  return loaded(gl, place, place, Uint32Array.from(ends), gl.LINES);
}

/** @type {(colour: string) => number[]} */
function rgb(colour) {
  return [1, 3, 5].map((k) => Number.parseInt(colour.slice(k, k + 2), 16) / 255);
}

/** The values of the joints at a place in the cube, as people read them.
 * @type {(data: SurfaceData, place: number[]) => string} */
function jointWords(data, place) {
  return data.axes
    .map(({ name, unit, ends }, k) => {
      const value = ends[0] + ((place[k] + 1) / 2) * (ends[1] - ends[0]);
      return `${name} ${axisNumber(value, ends)}${unit === "°" ? "" : " "}${unit}`;
    })
    .join(", ");
}

/** A number with as many digits as a thousandth of its range needs.
 * @type {(value: number, ends: number[]) => string} */
function axisNumber(value, [low, high]) {
  return number(value, Math.max(0, 2 - Math.floor(Math.log10(high - low))));
}

/** @type {(root: HTMLElement, data: SurfaceData) => Surface3 | null} */
function showSurface(root, data) {
  /** @type {(name: string) => HTMLElement} */
  const part = (name) => {
    const found = root.querySelector(`[data-part="${name}"]`);
    if (!(found instanceof HTMLElement)) throw new Error(`The page has no ${name}.`);
    return found;
  };
  const [stage, labels, readout] = ["stage", "labels", "readout"].map(part);
  const canvas = root.querySelector("canvas");
  const gl = canvas?.getContext("webgl2", { antialias: true });
  if (!canvas || !gl) {
    part("no-webgl").hidden = false;
    return null;
  }
  const program = surfaceProgram(gl);
  gl.useProgram(program);
  gl.enable(gl.DEPTH_TEST);
  /** @type {(name: string) => WebGLUniformLocation | null} */
  const uniform = (name) => gl.getUniformLocation(program, name);
  const [viewAt, colourAt, lightAt, litAt] = ["view", "colour", "light", "lit"].map(uniform);

  const places = cubePlaces(data);
  const triangles = new Uint32Array(unpacked(data.triangles));
  const cube = loadedCube(gl);
  /** @type {SurfacePiece[]} */
  const pieces = data.pairs.map(({ name, colour, triangles: [from, to] }) => {
    const { place, normal, index } = piece(places, triangles.subarray(3 * from, 3 * to));
    const draw = loaded(gl, place, normal, index, gl.TRIANGLES);
    return { name, colour, place, index, draw, shown: true };
  });

  const view = { ...FIRST_VIEW };
  let [width, height] = [1, 1];
  let waiting = false;

  const spots = data.axes.map(({ name, unit, ends }) => {
    const texts = [...ends.map((end) => axisNumber(end, ends)), `${name} / ${unit}`];
    return texts.map((text, k) => {
      const spot = labels.appendChild(document.createElement("span"));
      spot.className = k === 2 ? "axis-name" : "axis-end";
      spot.textContent = text;
      return spot;
    });
  });

  function placeLabels(/** @type {number[]} */ matrix) {
    const middle = seenAt(matrix, [0, 0, 0], width, height);
    for (const [axis, edge] of namedEdges(matrix, width, height).entries()) {
      const [a, b] = edge.map((corner) => seenAt(matrix, corner, width, height));
      const way = minus(partWay(a, b, 0.5), middle);
      const size = Math.hypot(...way) || 1;
      const at = [0.06, 0.94, 0.5].map((t) => partWay(a, b, t));
      for (const [k, spot] of spots[axis].entries()) {
        const away = k === 2 ? 34 : 16;
        const half = [spot.offsetWidth / 2 + 2, spot.offsetHeight / 2 + 2];
        const [x, y] = at[k].map((value, j) => value + (way[j] / size) * away);
        spot.style.left = `${between(x, half[0], width - half[0])}px`;
        spot.style.top = `${between(y, half[1], height - half[1])}px`;
      }
    }
  }

  function draw() {
    waiting = false;
    if (!canvas || !gl) return;
    const matrix = viewMatrix(view, width, height);
    const style = getComputedStyle(stage);
    gl.viewport(0, 0, canvas.width, canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.uniformMatrix4fv(viewAt, false, matrix);
    const { yaw, pitch } = view;
    const [c, s] = [Math.cos(yaw + 0.5), Math.sin(yaw + 0.5)];
    const [cp, sp] = [Math.cos(pitch + 0.4), Math.sin(pitch + 0.4)];
    gl.uniform3f(lightAt, cp * c, cp * s, sp);
    gl.uniform1f(litAt, 0);
    const ink = (style.color.match(/[\d.]+/g) ?? []).slice(0, 3).map((x) => Number(x) / 255);
    gl.uniform3f(colourAt, ink[0] ?? 0.5, ink[1] ?? 0.5, ink[2] ?? 0.5);
    cube();
    gl.uniform1f(litAt, 1);
    for (const one of pieces.filter((each) => each.shown)) {
      const [red, green, blue] = rgb(one.colour);
      gl.uniform3f(colourAt, red, green, blue);
      one.draw();
    }
    placeLabels(matrix);
  }

  function redraw() {
    if (!waiting) requestAnimationFrame(draw);
    waiting = true;
  }

  function turn(/** @type {number} */ right, /** @type {number} */ up) {
    view.yaw -= right;
    view.pitch = between(view.pitch + up, -STRAIGHT_UP, STRAIGHT_UP);
    redraw();
  }

  function zoom(/** @type {number} */ factor) {
    view.distance = between(view.distance * factor, NEAREST, FARTHEST);
    redraw();
  }

  function reset() {
    Object.assign(view, FIRST_VIEW);
    redraw();
  }

  function tell(/** @type {number[]} */ pixel) {
    const found = picked(pieces, viewMatrix(view, width, height), pixel, width, height);
    readout.textContent = found
      ? `${jointWords(data, found.place)}: ${found.piece.name}`
      : "No surface is there.";
  }

  surfaceHands(canvas, { turn, zoom, reset, tell });
  const buttons = { closer: () => zoom(0.8), farther: () => zoom(1.25), reset };
  for (const [name, act] of Object.entries(buttons)) part(name).addEventListener("click", act);
  for (const [k, one] of pieces.entries()) {
    const box = part("pairs").querySelectorAll("input")[k];
    box.addEventListener("change", () => {
      one.shown = box.checked;
      redraw();
    });
  }
  new ResizeObserver(() => {
    ({ clientWidth: width, clientHeight: height } = stage);
    const dots = Math.min(2, window.devicePixelRatio || 1);
    [canvas.width, canvas.height] = [Math.round(width * dots), Math.round(height * dots)];
    draw();
  }).observe(stage);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
  return { view, pieces, redraw, tell };
}

/** Drag turns, two fingers and the wheel come closer, a tap tells; arrow keys, + and -, 0.
 * @type {(canvas: HTMLCanvasElement, acts: SurfaceActs) => void} */
function surfaceHands(canvas, { turn, zoom, reset, tell }) {
  /** @type {Map<number, number[]>} */
  const held = new Map();
  let moved = 0;
  const spread = () => {
    const [a, b] = [...held.values()];
    return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
  };
  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    if (!held.size) moved = 0;
    held.set(event.pointerId, [event.clientX, event.clientY]);
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const last = held.get(event.pointerId);
    if (!last) return;
    const before = spread();
    const [dx, dy] = [event.clientX - last[0], event.clientY - last[1]];
    held.set(event.pointerId, [event.clientX, event.clientY]);
    moved += Math.hypot(dx, dy);
    if (before > 0) zoom(before / Math.max(1, spread()));
    else turn(dx / 150, dy / 150);
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => {
      if (!(event instanceof PointerEvent && held.delete(event.pointerId))) return;
      const box = canvas.getBoundingClientRect();
      if (name === "pointerup" && moved < 5)
        tell([event.clientX - box.left, event.clientY - box.top]);
    });
  canvas.addEventListener(
    "wheel",
    (event) => {
      // In a frame the wheel moves the page around it, until the picture has been chosen.
      if (window.parent !== window && document.activeElement !== canvas) return;
      event.preventDefault();
      zoom(Math.exp(Math.sign(event.deltaY) * 0.08));
    },
    { passive: false },
  );
  /** @type {Record<string, () => void>} */
  const keys = {
    arrowleft: () => turn(-0.1, 0),
    arrowright: () => turn(0.1, 0),
    arrowup: () => turn(0, -0.1),
    arrowdown: () => turn(0, 0.1),
    "+": () => zoom(0.9),
    "=": () => zoom(0.9),
    "-": () => zoom(1 / 0.9),
    0: reset,
  };
  canvas.addEventListener("keydown", (event) => {
    const act = keys[event.key.toLowerCase()];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    act();
  });
}
