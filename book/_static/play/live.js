"use strict";
/* Configuration space, live: an arm among obstacles, and the region of its free poses beside it. */
{
  const { DEGREE, LINKS, RANGES, SIZES, armOf, checked, freeName } = qboundLiveScene;
  const { TURN, leastBy, set, sum, wrapped } = qboundEngine;
  const VIEW = 2.1; // metres to each side of the base
  const FINEST = 1200; // columns, however wide the picture
  const TINTS = 4; // colours of the pieces that are cut off from home

  const PLANE_HELP =
    "Arrow keys move the chosen obstacle, or the tool where none is chosen; with Shift in larger steps. " +
    "O chooses the next obstacle, A the arm. R turns it, with Shift back. Plus and minus change its size. " +
    "Delete removes it, Control and Z undoes.";
  const JOINT_HELP =
    "Arrow keys turn the joints by one degree, with Shift by ten. H goes to the home pose.";

  /** @type {(values: number[], factor: number) => number[]} */
  function larger(values, factor) {
    return values.map((value) => value * factor);
  }

  /** What there is to say of where link and obstacle touch.
   * @type {(link: number, contact: LiveContact) => string} */
  function featureText(link, { end, part, number }) {
    const ends = link === 0 ? ["base end", "elbow end"] : ["elbow end", "tip"];
    const mine = end === null ? "side" : ends[end];
    return `${mine} on ${part === null ? "the disc" : `${part} ${number}`}`;
  }

  /** The contact through which a pose would leave an obstacle, turning the link alone; null where
      no turn of it does.
   * @type {(arm: LiveArm, shape: LiveShape, link: number, pair: Pair) => LiveContact | null} */
  function exitContact(arm, shape, link, pair) {
    const { forearm, upperArm } = qboundLiveSpace;
    const ends = link === 1 ? forearm(arm, shape, pair[0]) : upperArm(arm, shape);
    const real = ends.filter((value) => Math.abs(value) < Math.PI);
    if (real.length === 0) return null;
    const way = (/** @type {number} */ value) => Math.abs(wrapped(value - pair[link]));
    const nearest = leastBy(real, way) ?? 0;
    const touching = link === 1 ? [pair[0], nearest] : [nearest, pair[1]];
    const places = qboundLiveSpace.jointPlaces(arm, touching);
    return qboundLiveSpace.contact(places[link], places[link + 1], arm.radii[link], shape);
  }

  /** @type {FigureKind} */
  function show(root) {
    const {
      clear,
      draggable,
      drawScaleBar,
      element,
      handle,
      layer,
      make,
      number,
      onKeys,
      pathText,
    } = qboundEngine;
    const { CIRCLE, picture, pixelOf, valueRow, wholePicture } = qboundEngine;
    const { AROUND, armHandles, buttons, canvas, degrees, jointAxes, moveTo } = qboundParts;
    const { replaced, statusLine, whenWidthChanges } = qboundParts;

    /** @type {LiveScene} */
    let scene = qboundLiveScene.START;
    /** @type {number | null} */
    let chosen = null;
    let corner = 0; // of the chosen polygon
    /** @type {Pair | null} */
    let pointed = null; // a pose under the mouse
    /** @type {{ text: string, gesture: string }[]} */
    const past = [];
    let gesture = ""; // what is being changed: one step for undoing
    let strokes = 0;
    let arm = armOf(scene);
    /** @type {WeakMap<LiveObstacle, LiveShape>} */
    const known = new WeakMap();
    /** @type {LiveShape[]} */
    let shapes = [];
    /** @type {LiveRegions} */
    let regions;
    let space = qboundLiveSpace.freeSpace(360);
    /** @type {ReturnType<typeof newPictures>} */
    let drawn;
    /** @type {LiveObstacle[]} */
    let pictured = []; // what the elements of the obstacles show
    let [hasNewScene, isWaiting, isTouched] = [true, false, false];
    const timers = { link: 0 };

    /* --- changes -------------------------------------------------------------------------------- */

    /** Draw once, with the next frame. */
    function later() {
      if (isWaiting) return;
      isWaiting = true;
      window.requestAnimationFrame(() => {
        isWaiting = false;
        draw();
      });
    }

    /** @type {(next: Partial<LiveScene>, name: string) => void} */
    function change(next, name) {
      if (name !== gesture)
        past.push({ text: qboundLiveScene.textOf(scene, false), gesture: name });
      gesture = name;
      scene = { ...scene, ...next };
      hasNewScene = isTouched = true;
      later();
    }

    /** @type {(pair: Pair) => void} */
    function move(pair) {
      const q = pair.map((value) => wrapped(value));
      scene = { ...scene, q };
      isTouched = true;
      later();
    }

    /** @type {(next: LiveObstacle, name: string) => void} */
    function changeChosen(next, name) {
      const found = checked(next);
      if (chosen === null || !found) return;
      change({ obstacles: replaced(scene.obstacles, chosen, found) }, `${name} ${chosen}`);
    }

    /** @type {(index: number | null) => void} */
    function choose(index) {
      if (index !== chosen) gesture = "";
      chosen = index;
      corner = 0;
      hasNewScene = true;
      later();
    }

    /** @type {(kind: LiveObstacle["kind"]) => void} */
    function add(kind) {
      if (scene.obstacles.length >= qboundLiveScene.MOST_OBSTACLES) return;
      const obstacles = [...scene.obstacles, qboundLiveScene.newObstacle(scene, kind)];
      change({ obstacles }, `add ${strokes++}`);
      choose(obstacles.length - 1);
    }

    function remove() {
      if (chosen === null) return;
      const obstacles = scene.obstacles.filter((_, i) => i !== chosen);
      change({ obstacles }, `remove ${strokes++}`);
      choose(obstacles.length > 0 ? Math.min(chosen, obstacles.length - 1) : null);
    }

    function undo() {
      const last = past.pop();
      const old = last && qboundLiveScene.sceneOf(last.text);
      if (!old) return;
      scene = { ...old, q: scene.q };
      gesture = "";
      if (chosen !== null && chosen >= scene.obstacles.length) chosen = null;
      hasNewScene = true;
      later();
    }

    function reset() {
      change(qboundLiveScene.START, `reset ${strokes++}`);
      choose(null);
    }

    function restore() {
      const read = qboundLiveScene.sceneOf(window.location.hash.slice(1));
      if (!read) return;
      if (isTouched) change(read, `link ${strokes++}`);
      else scene = read;
      choose(null);
    }

    /** Write the scene into the address, once the hand rests. */
    function remember() {
      window.clearTimeout(timers.link);
      timers.link = window.setTimeout(() => {
        const address = `${window.location.href.split("#")[0]}#${qboundLiveScene.textOf(scene)}`;
        link.value = address;
        if (isTouched && window.location.href !== address)
          window.history.replaceState(null, "", address);
      }, 300);
    }

    function save() {
      const file = new Blob([qboundLiveScene.robotFile(scene)], { type: "application/toml" });
      const address = URL.createObjectURL(file);
      element("a", { href: address, download: "two-links.toml" }).click();
      window.setTimeout(() => URL.revokeObjectURL(address), 1000);
    }

    /* --- controls ------------------------------------------------------------------------------- */

    const [joints, plane] = [
      canvas(
        "Configuration space: a square of both joint angles. Free poses are coloured.",
        "Configuration space",
      ),
      canvas("Workspace: the arm among its obstacles.", "Workspace"),
    ];
    for (const [{ figure, svg }, help] of /** @type {const} */ ([
      [joints, JOINT_HELP],
      [plane, PLANE_HELP],
    ])) {
      const words = element("p", { className: "unseen", id: `${svg.id}-help`, textContent: help });
      svg.setAttribute("role", "application");
      svg.setAttribute("tabindex", "0");
      svg.setAttribute("aria-describedby", words.id);
      figure.append(words);
    }
    const status = statusLine(
      "Not safe: upper arm, a long name (elbow end on corner 10); forearm, another (elbow end on corner 10); and some more words.",
    );
    const totals = element("p", { className: "totals" });
    const under = element("p", { className: "under keys", ariaHidden: "true" });
    const link = element("input", {
      type: "text",
      readOnly: true,
      ariaLabel: "Link to this scene",
    });
    const choice = element("select", { ariaLabel: "Obstacle" });
    choice.addEventListener("change", () =>
      choose(choice.value === "" ? null : Number(choice.value)),
    );
    const fields = element("div", { className: "fields" });
    /** @type {((one: LiveObstacle) => void)[]} */
    let fillers = [];
    let fieldsOf = ""; // which obstacle's fields stand there

    const degreeRow = { low: -180, high: 180, step: 0.5, digits: 2, unit: "°" };
    const poseRows = [0, 1].map((k) =>
      valueRow({ ...degreeRow, name: `q${"₁₂"[k]}`, spoken: `q${k + 1} in degrees` }, (value) =>
        move(replaced(scene.q, k, value * DEGREE)),
      ),
    );
    /** @type {(key: "lengths" | "thicknesses", k: number, name: string, range: number[]) => SetRow} */
    const armRow = (key, k, name, [low, high]) =>
      valueRow(
        {
          name,
          spoken: `${LINKS[k]}, ${name}, in metres`,
          low,
          high,
          step: 0.01,
          digits: 3,
          unit: "m",
        },
        (value) => change({ [key]: replaced(scene[key], k, value) }, `${key} ${k}`),
      );
    const armRows = LINKS.map((_, k) => ({
      length: armRow("lengths", k, "length", RANGES.length),
      width: armRow("thicknesses", k, "width", RANGES.thickness),
    }));

    /** @type {(title: string, ...children: (Node | string)[]) => HTMLFieldSetElement} */
    function group(title, ...children) {
      return element("fieldset", {}, element("legend", {}, title), ...children);
    }

    /** The fields of the chosen obstacle. */
    function buildFields() {
      const one = chosen === null ? null : scene.obstacles[chosen];
      const key = one
        ? `${chosen} ${one.kind} ${one.kind === "polygon" && one.corners.length}`
        : "";
      if (key === fieldsOf) return;
      fieldsOf = key;
      fillers = [];
      fields.replaceChildren();
      if (!one) return;
      const name = element("input", {
        type: "text",
        ariaLabel: "Name",
        maxLength: qboundLiveScene.LONGEST_NAME,
      });
      let typed = false; // what a reader types stays, though the scene is drawn meanwhile
      name.addEventListener("input", () => {
        typed = true;
      });
      name.addEventListener("change", () => {
        typed = false;
        const now = nowChosen();
        if (now && chosen !== null)
          changeChosen({ ...now, name: freeName(scene, name.value, chosen) }, "name");
      });
      fields.append(element("label", { className: "slider" }, element("span", {}, "name"), name));
      fillers.push((now) => {
        if (!typed) name.value = now.name;
      });
      const { place, size, angle } = RANGES;
      field(
        "x",
        "x in metres",
        place,
        ({ x }) => x,
        (x) => ({ x }),
      );
      field(
        "y",
        "y in metres",
        place,
        ({ y }) => y,
        (y) => ({ y }),
      );
      for (const [k, name] of SIZES[one.kind].entries())
        field(
          name,
          `${name} in metres`,
          size,
          ({ sizes }) => sizes[k],
          (value, { sizes }) => ({ sizes: replaced(sizes, k, value) }),
        );
      if (one.kind !== "disc")
        field(
          "turned",
          "turned by, in degrees",
          angle,
          (now) => now.angle / DEGREE,
          (value) => ({ angle: value * DEGREE }),
        );
      if (one.kind === "polygon") buildCorners(one);
      fields.append(buttons([`Delete this ${one.kind}`, remove]));
    }

    /** A field of the chosen obstacle: how to get its value, and what another one changes.
     * @type {(name: string, spoken: string, range: number[], get: (now: LiveObstacle) => number, set: (value: number, now: LiveObstacle) => Partial<LiveObstacle>) => void} */
    function field(name, spoken, range, get, set) {
      const [low, high] = range;
      const look =
        range === RANGES.angle
          ? { step: 1, digits: 1, unit: "°" }
          : { step: 0.01, digits: 3, unit: "m" };
      const row = valueRow({ name, spoken, low, high, ...look }, (value) => {
        const now = nowChosen();
        if (now) changeChosen({ ...now, ...set(value, now) }, `field ${name}`);
      });
      fields.append(row.row);
      fillers.push((now) => row.set(get(now)));
    }

    /** One corner of the chosen polygon at a time, about the polygon's own place.
     * @type {(polygon: LiveObstacle) => void} */
    function buildCorners({ corners }) {
      const which = element("select", { ariaLabel: "Corner" });
      which.append(
        ...corners.map((_, i) => element("option", { value: String(i) }, `corner ${i}`)),
      );
      which.addEventListener("change", () => {
        corner = Number(which.value);
        hasNewScene = true;
        later();
      });
      fields.append(
        element("label", { className: "slider" }, element("span", {}, "corner"), which),
      );
      fillers.push(() => {
        corner = Math.min(corner, corners.length - 1);
        which.value = String(corner);
      });
      for (const k of [0, 1])
        field(
          `corner ${"xy"[k]}`,
          `${"xy"[k]} of the corner, in metres from the polygon's place`,
          RANGES.corner,
          (now) => now.corners[corner]?.[k] ?? 0,
          (value, { corners: all }) => ({
            corners: replaced(all, corner, replaced(all[corner], k, value)),
          }),
        );
      fields.append(
        buttons(["Add a corner after it", () => addCorner()], ["Remove it", () => dropCorner()]),
      );
    }

    function addCorner() {
      const now = nowChosen();
      if (now?.kind !== "polygon") return;
      const [a, b] = [now.corners[corner], now.corners[(corner + 1) % now.corners.length]];
      const middle = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
      const corners = [
        ...now.corners.slice(0, corner + 1),
        middle,
        ...now.corners.slice(corner + 1),
      ];
      changeChosen({ ...now, corners }, `corner ${strokes++}`);
      corner = Math.min(corner + 1, corners.length - 1);
    }

    function dropCorner() {
      const now = nowChosen();
      if (now?.kind !== "polygon") return;
      const corners = now.corners.filter((_, i) => i !== corner);
      changeChosen({ ...now, corners }, `corner ${strokes++}`);
    }

    /** @type {() => LiveObstacle | null} */
    function nowChosen() {
      return chosen === null ? null : (scene.obstacles[chosen] ?? null);
    }

    function copyLink() {
      link.select();
      navigator.clipboard?.writeText(link.value).catch(() => {});
    }

    const undoing = buttons(["Undo", undo], ["Reset", reset]);
    root.append(
      status.spoken,
      element(
        "div",
        { className: "stage" },
        status.seen,
        element("div", { className: "panels" }, joints.figure, plane.figure),
        under,
        totals,
      ),
      buttons(
        ["Add a disc", () => add("disc")],
        ["Add a box", () => add("box")],
        ["Add a polygon", () => add("polygon")],
        ["Make this pose home", () => change({ home: scene.q }, `home ${strokes++}`)],
      ),
      element(
        "div",
        { className: "sets" },
        group("Obstacle", element("label", { className: "field" }, choice), fields),
        group(
          "Arm",
          ...poseRows.map(({ row }) => row),
          ...LINKS.flatMap((name, k) => [
            element("p", { className: "set-name" }, name),
            armRows[k].length.row,
            armRows[k].width.row,
          ]),
        ),
        group(
          "Keep it",
          undoing,
          buttons(["Save as a robot file", save]),
          element("p", { className: "field" }, link),
          buttons(["Copy the link", copyLink]),
        ),
      ),
    );

    /* --- pictures ------------------------------------------------------------------------------- */

    function newPictures() {
      const square = picture(
        joints.svg,
        [
          [-Math.PI, Math.PI],
          [-Math.PI, Math.PI],
        ],
        AROUND,
        true,
      );
      clear(square);
      jointAxes(square, 90);
      const layers = {
        regions: layer(square, "regions"),
        shadow: layer(square, "shadow").appendChild(make("path", { class: "shadow" })),
        names: layer(square, "names"),
      };
      const cross = "M-8-2H-2V-8H2V-2H8V2H2V8H-2V2H-8Z"; // with a rim, to be seen on an edge, too
      const home = joints.svg.appendChild(make("path", { class: "home-mark", d: cross }));
      const dot = handle(joints.svg, make("circle", { class: "handle", r: 7 }));
      const view = [-VIEW, VIEW];
      const whole = wholePicture(plane.svg, [view, view]);
      drawScaleBar(whole, "m");
      const base = layer(whole, "base", false);
      const [x, y] = whole.at([0, 0]);
      base.append(make("circle", { class: "axle", cx: x, cy: y, r: 5 }));
      const obstacles = layer(whole, "obstacles");
      const ghost = layer(whole, "ghosts").appendChild(make("path", { class: "ghost" }));
      const links = LINKS.map((_, k) =>
        plane.svg.appendChild(make("line", { class: "link", "data-part": k, "data-frame": k + 1 })),
      );
      const spine = plane.svg.appendChild(make("path", { class: "spine" }));
      const gap = plane.svg.appendChild(make("path", { class: "gap" }));
      const { elbow, tool } = armHandles(plane.svg);
      const hands = layer(whole, "hands", false);
      return {
        square,
        whole,
        ...layers,
        home,
        dot,
        obstacles,
        ghost,
        links,
        spine,
        gap,
        elbow,
        tool,
        hands,
      };
    }

    function build() {
      drawn = newPictures();
      const { left, right } = drawn.square.box;
      const pixels = (right - left) * (window.devicePixelRatio || 1);
      pictured = [];
      space = qboundLiveSpace.freeSpace(Math.min(FINEST, Math.ceil(pixels)));
      hasNewScene = true;
      draw();
    }

    function draw() {
      if (!drawn) return;
      if (hasNewScene) drawScene();
      hasNewScene = false;
      drawPose();
      drawPointed();
      remember();
    }

    /** What changes with the obstacles and the links. */
    function drawScene() {
      const next = armOf(scene);
      const isSame = [0, 1].every(
        (k) => next.lengths[k] === arm.lengths[k] && next.radii[k] === arm.radii[k],
      );
      if (!isSame) arm = next;
      shapes = scene.obstacles.map((one) => {
        const shape = known.get(one) ?? qboundLiveSpace.placed(one);
        known.set(one, shape);
        return shape;
      });
      const columns = space.columnsOf(arm, shapes);
      regions = qboundLiveSpace.regions(columns, scene.home);
      drawRegions();
      drawObstacles();
      drawHands();
      showChoice();
      for (const [k, { length, width }] of armRows.entries()) {
        length.set(scene.lengths[k]);
        width.set(scene.thicknesses[k]);
      }
      showTotals();
      const [button] = undoing.children;
      if (button instanceof HTMLButtonElement) button.disabled = past.length === 0;
    }

    function showTotals() {
      const all = regions.areas.map((area) => `${number((100 * area) / TURN ** 2, 2)}\u00a0%`);
      const free = sum(regions.areas) / TURN ** 2;
      const count = all.length === 1 ? "one piece" : `${all.length} pieces`;
      const home = regions.home ? "" : " Home is not safe.";
      const parts =
        all.length > 1 ? ` (${all.slice(0, 6).join(", ")}${all.length > 6 ? ", …" : ""})` : "";
      totals.textContent = all.length
        ? `Free: ${number(100 * free, 2)}\u00a0% of all poses, in ${count}${parts}.${home}`
        : "No pose is free.";
    }

    /** @type {() => LiveScale} */
    function scale() {
      const [[x0, y0], [x1, y1]] = [drawn.square.at([0, 0]), drawn.square.at([1, 1])];
      return { x0, dx: x1 - x0, y0, dy: y1 - y0 };
    }

    /** @type {(i: number) => string} */
    function tint(i) {
      return regions.home && i === 0 ? "piece home" : `piece tint-${i % TINTS}`;
    }

    function drawRegions() {
      const { columns, of, areas } = regions;
      const outlines = qboundLiveSpace.outlines(columns, of, areas.length, scale());
      const paths = children(drawn.regions, "path", 2 * areas.length);
      for (const [i, { fill, edge }] of outlines.entries())
        for (const [k, d] of [fill, edge].entries())
          set(paths[2 * i + k], { class: k ? `${tint(i)} edge` : tint(i), d });
      const places = areas.length > 1 ? roomiest() : [];
      for (const [i, text] of children(drawn.names, "text", places.length).entries()) {
        const [x, y] = drawn.square.at(places[i].pair);
        set(text, { class: "piece-name", x, y: y + 5, "text-anchor": "middle" });
        text.textContent = places[i].room > 9 ? String(i + 1) : "";
      }
      drawShadow();
      moveTo(drawn.home, drawn.square.at(scene.home));
    }

    /** So many elements of a layer: those that are there are used again.
     * @template {keyof SVGElementTagNameMap} K
     * @param {SVGGElement} parent
     * @param {K} name
     * @param {number} count
     * @returns {SVGElement[]} */
    function children(parent, name, count) {
      while (parent.children.length > count) parent.lastElementChild?.remove();
      while (parent.children.length < count) parent.append(make(name, {}));
      return /** @type {SVGElement[]} */ ([...parent.children]);
    }

    /** A place for the name of each piece, with much room around it; the room is in pixels. */
    function roomiest() {
      const { columns, of, areas } = regions;
      const { dx, dy } = scale();
      const found = areas.map(() => ({ pair: [0, 0], room: -1 }));
      const step = Math.max(1, columns.length >> 7);
      for (let k = 0; k < columns.length; k += step)
        for (const [i, piece] of of[k].entries()) {
          const [low, high] = [columns[k].free[2 * i], columns[k].free[2 * i + 1]];
          const height = (high - low) * -dy;
          if (piece < 0 || height <= 2 * found[piece].room) continue;
          const middle = (low + high) / 2;
          let [left, right] = [k, k];
          while (left > 0 && qboundEngine.holds(columns[left - 1].free, middle)) left -= 1;
          while (columns[right + 1] && qboundEngine.holds(columns[right + 1].free, middle))
            right += 1;
          const { q } = columns[k];
          const beside = Math.min(q - columns[left].q, columns[right].q - q) * dx;
          const room = Math.min(height / 2, beside);
          if (room > found[piece].room) found[piece] = { pair: [q, middle], room };
        }
      return found;
    }

    /** What the chosen obstacle alone forbids. */
    function drawShadow() {
      if (chosen === null) {
        drawn.shadow.setAttribute("d", "");
        return;
      }
      const shape = shapes[chosen];
      const windows = qboundLiveSpace.upperArm(arm, shape);
      const columns = regions.columns.map(({ q }) => {
        const all = qboundEngine.holds(windows, q);
        const free = all ? CIRCLE : qboundLiveSpace.forearm(arm, shape, q);
        return { q, free, by: free.map(() => 0) };
      });
      const of = columns.map(({ free }) => new Array(free.length / 2).fill(0));
      const [{ fill }] = qboundLiveSpace.outlines(columns, of, 1, scale());
      drawn.shadow.setAttribute("d", fill);
    }

    /** The obstacles; those that are as they were stay. */
    function drawObstacles() {
      const { children: groups } = drawn.obstacles;
      for (const [i, one] of scene.obstacles.entries()) {
        if (pictured[i] !== one || !groups[i]) {
          const made = obstacleGroup(one, i);
          if (groups[i]) groups[i].replaceWith(made);
          else drawn.obstacles.append(made);
        }
        groups[i].classList.toggle("chosen", i === chosen);
      }
      while (groups.length > scene.obstacles.length) drawn.obstacles.lastElementChild?.remove();
      pictured = scene.obstacles;
    }

    /** @type {(one: LiveObstacle, i: number) => SVGGElement} */
    function obstacleGroup({ name }, i) {
      const d = shapePath(shapes[i]);
      const [x, y] = drawn.whole.at([shapes[i].x, shapes[i].y]);
      const group = make("g", { class: "one" });
      group.append(
        make("path", { class: "obstacle", d }),
        make("text", { class: "obstacle-name", x, y: y + 4, "text-anchor": "middle" }, name),
        make("path", { class: "reach-me", d, "data-body": i }),
      );
      return group;
    }

    /** @type {(shape: LiveShape) => string} */
    function shapePath({ points, radius }) {
      if (points.length > 1) return pathText(points.map(drawn.whole.at), true);
      const [x, y] = drawn.whole.at(points[0]);
      const r = pixels(radius);
      return `M${x - r} ${y}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0Z`;
    }

    /** @type {(length: number) => number} */
    function pixels(length) {
      return drawn.whole.at([length, 0])[0] - drawn.whole.at([0, 0])[0];
    }

    /** Handles of the chosen obstacle: to turn it, to change its size, its corners. */
    function drawHands() {
      drawn.hands.replaceChildren();
      const one = nowChosen();
      if (!one || chosen === null) return;
      const { size } = shapes[chosen];
      const far = size + 26 / pixels(1);
      if (one.kind !== "disc") {
        const [from, to] = [onObstacle(one, [0, 0]), onObstacle(one, [far, 0])].map(drawn.whole.at);
        drawn.hands.append(make("path", { class: "turn-line", d: pathText([from, to]) }));
        hand("turn", to);
      }
      if (one.kind === "disc") hand("size", drawn.whole.at([one.x + one.sizes[0], one.y]));
      if (one.kind === "box") hand("size", drawn.whole.at(onObstacle(one, larger(one.sizes, 0.5))));
      if (one.kind !== "disc")
        for (const [i, place] of shapes[chosen].points.entries()) {
          const [x, y] = drawn.whole.at(place);
          const [cx, cy] = drawn.whole.at([one.x, one.y]);
          const out = Math.hypot(x - cx, y - cy) || 1;
          const at = { x: x + (14 * (x - cx)) / out, y: y + 4 + (14 * (y - cy)) / out };
          drawn.hands.append(
            make("text", { class: "corner-name", "text-anchor": "middle", ...at }, `${i}`),
          );
          if (one.kind === "polygon") hand(`corner ${i}`, [x, y], i === corner);
        }
    }

    /** @type {(part: string, place: Point, isNow?: boolean) => void} */
    function hand(part, place, isNow = false) {
      const mark = make("circle", { class: isNow ? "hand now" : "hand", r: 5 });
      const room = make("circle", { class: "reach-me", r: 16, "data-hand": part });
      const one = make("g", { class: part === "turn" ? "turn" : "resize" });
      one.append(mark, room);
      moveTo(one, place);
      drawn.hands.append(one);
    }

    /** A place of an obstacle's own axes.
     * @type {(one: LiveObstacle, place: Point) => Point} */
    function onObstacle({ x, y, angle }, [a, b]) {
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      return [x + a * cos - b * sin, y + a * sin + b * cos];
    }

    /** @type {(one: LiveObstacle, place: Point) => Point} */
    function inObstacle({ x, y, angle }, [a, b]) {
      const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
      return [(a - x) * cos + (b - y) * sin, (b - y) * cos - (a - x) * sin];
    }

    function showChoice() {
      const names = ["none", ...scene.obstacles.map(({ name }) => name)];
      const isSame =
        names.length === choice.options.length &&
        names.every((n, i) => choice.options[i].text === n);
      if (!isSame)
        choice.replaceChildren(
          ...names.map((name, i) => element("option", { value: i > 0 ? String(i - 1) : "" }, name)),
        );
      choice.value = chosen === null ? "" : String(chosen);
      buildFields();
      const one = nowChosen();
      if (one) for (const fill of fillers) fill(one);
    }

    /* --- the pose ------------------------------------------------------------------------------- */

    /** What changes with the pose alone. */
    function drawPose() {
      const places = qboundLiveSpace.jointPlaces(arm, scene.q).map(drawn.whole.at);
      const found = qboundLiveSpace.encounters(arm, shapes, scene.q);
      const hits = found.filter(({ gap }) => gap < 0);
      const least = leastBy(found, ({ gap }) => gap);
      for (const [k, line] of drawn.links.entries()) {
        const [[x1, y1], [x2, y2]] = [places[k], places[k + 1]];
        set(line, { x1, y1, x2, y2, "stroke-width": 2 * pixels(arm.radii[k]) });
        line.classList.toggle(
          "hit",
          hits.some(({ link }) => link === k),
        );
      }
      drawn.spine.setAttribute("d", pathText(places));
      moveTo(drawn.elbow.group, places[1]);
      moveTo(drawn.tool.group, places[2]);
      moveTo(drawn.dot.group, drawn.square.at(scene.q));
      for (const { mark } of [drawn.dot, drawn.elbow, drawn.tool])
        mark.classList.toggle("violated", hits.length > 0);
      for (const [i, one] of [...drawn.obstacles.children].entries())
        one.classList.toggle(
          "hit",
          hits.some(({ obstacle }) => obstacle === i),
        );
      const isNear = hits.length === 0 && least;
      drawn.gap.setAttribute("d", isNear ? pathText(least.places.map(drawn.whole.at)) : "");
      for (const [k, row] of poseRows.entries()) row.set(scene.q[k] / DEGREE);
      status.say(poseText(scene.q), hits.length > 0);
    }

    /** What holds of a pose.
     * @type {(pair: Pair) => string} */
    function poseText(pair) {
      const found = qboundLiveSpace.encounters(arm, shapes, pair);
      const hits = found.filter(({ gap }) => gap < 0);
      if (hits.length > 0) return `Not safe: ${hits.map((hit) => hitText(hit, pair)).join("; ")}.`;
      if (found.length === 0) return "Safe. There is no obstacle.";
      const least = found.reduce((a, b) => (b.gap < a.gap ? b : a));
      const piece = qboundLiveSpace.regionOf(regions, pair);
      const count = regions.areas.length;
      const where =
        count < 2 || piece < 0
          ? ""
          : ` Piece ${piece + 1} of ${count}${regions.home ? (piece === 0 ? ", with home" : ", cut off from home") : ""}.`;
      const feature = featureText(least.link, least);
      return `Safe. Nearest: ${pairName(least)}, ${number(least.gap, 3)}\u00a0m (${feature}).${where}`;
    }

    /** @type {(one: LiveEncounter) => string} */
    function pairName({ link: k, obstacle }) {
      return `${LINKS[k]}, ${scene.obstacles[obstacle].name}`;
    }

    /** @type {(hit: LiveEncounter, pair: Pair) => string} */
    function hitText(hit, pair) {
      const exit = exitContact(arm, shapes[hit.obstacle], hit.link, pair);
      return `${pairName(hit)}${exit ? ` (${featureText(hit.link, exit)})` : ""}`;
    }

    /** The pose under the mouse: a second arm, and what holds of it. */
    function drawPointed() {
      const places = pointed ? qboundLiveSpace.jointPlaces(arm, pointed) : [];
      drawn.ghost.setAttribute("d", pathText(places.map(drawn.whole.at)));
      const there = pointed?.map((value) => degrees(value, 0)).join(", ");
      under.textContent = pointed
        ? `Under the pointer (${there}): ${poseText(pointed)}`
        : "Point anywhere in the square: the dashed arm shows that pose.";
    }

    /* --- hands and keys ------------------------------------------------------------------------- */

    /** @type {Point} */
    let grip = [0, 0]; // from the chosen obstacle's place to where it was taken

    /** @type {(pixel: Point, held: Element | null) => void} */
    function take(pixel, held) {
      gesture = "";
      strokes += 1;
      const body = held instanceof SVGElement ? held.dataset.body : undefined;
      if (body === undefined) return;
      choose(Number(body));
      const one = nowChosen();
      const [x, y] = drawn.whole.from(pixel);
      if (one) grip = [x - one.x, y - one.y];
    }

    /** @type {(place: Point, part: string) => void} */
    function drag([x, y], part) {
      const one = nowChosen();
      if (!one) return;
      const name = `drag ${strokes}`;
      const [a, b] = inObstacle(one, [x, y]);
      if (part === "") changeChosen({ ...one, x: x - grip[0], y: y - grip[1] }, name);
      else if (part === "turn")
        changeChosen({ ...one, angle: Math.atan2(y - one.y, x - one.x) }, name);
      else if (part !== "size") {
        corner = Number(part.split(" ")[1]);
        changeChosen({ ...one, corners: replaced(one.corners, corner, [a, b]) }, name);
      } else if (one.kind === "disc") changeChosen({ ...one, sizes: [Math.hypot(a, b)] }, name);
      else if (one.kind === "box")
        changeChosen({ ...one, sizes: [2 * Math.abs(a), 2 * Math.abs(b)] }, name);
    }

    /** @type {(pixel: Point, held: Element | null) => void} */
    function dragPlane(pixel, held) {
      const place = drawn.whole.from(pixel);
      const { body, hand: part } = held instanceof SVGElement ? held.dataset : {};
      if (part !== undefined) drag(place, part);
      else if (body !== undefined) drag(place, "");
      else if (held === drawn.elbow.room) move([Math.atan2(place[1], place[0]), scene.q[1]]);
      else {
        if (held === null && chosen !== null) choose(null);
        move(qboundLiveSpace.poseAt(arm, scene.q, place));
      }
    }

    /** @type {(direction: number[], large: boolean) => void} */
    function stepPlane([dx, dy], large) {
      const size = large ? 0.1 : 0.01;
      const one = nowChosen();
      if (one) changeChosen({ ...one, x: one.x + dx * size, y: one.y + dy * size }, "keys");
      else {
        const [, , [x, y]] = qboundLiveSpace.jointPlaces(arm, scene.q);
        move(qboundLiveSpace.poseAt(arm, scene.q, [x + dx * size, y + dy * size]));
      }
    }

    /** @type {(factor: number) => void} */
    function grow(factor) {
      const one = nowChosen();
      if (!one) return;
      const corners = one.corners.map((at) => larger(at, factor));
      changeChosen({ ...one, sizes: larger(one.sizes, factor), corners }, "grow");
    }

    draggable(plane.svg, dragPlane, take);
    draggable(joints.svg, (pixel) => move(drawn.square.from(pixel)));
    onKeys(plane.svg, stepPlane, {
      o: () => {
        const count = scene.obstacles.length;
        if (count > 0) choose(((chosen ?? -1) + 1) % count);
      },
      a: () => choose(null),
      delete: remove,
      backspace: remove,
      "+": () => grow(1.05),
      "-": () => grow(1 / 1.05),
    });
    plane.svg.addEventListener("keydown", (event) => {
      const one = nowChosen();
      if (event.key.toLowerCase() !== "r" || event.ctrlKey || event.metaKey || !one) return;
      changeChosen({ ...one, angle: one.angle + (event.shiftKey ? -5 : 5) * DEGREE }, "turn");
      event.preventDefault();
    });
    onKeys(
      joints.svg,
      ([dx, dy], large) => {
        const size = (large ? 10 : 1) * DEGREE;
        move([scene.q[0] + dx * size, scene.q[1] + dy * size]);
      },
      { h: () => move(scene.home) },
    );
    root.addEventListener("keydown", (event) => {
      const isTyping = event.target instanceof HTMLInputElement && event.target.type !== "range";
      if (isTyping || !(event.ctrlKey || event.metaKey) || event.key.toLowerCase() !== "z") return;
      undo();
      event.preventDefault();
    });
    joints.svg.addEventListener("pointermove", (event) => {
      if (event.pointerType === "touch") return;
      const pair = drawn.square.from(pixelOf(joints.svg, event));
      pointed = event.buttons === 0 && pair.every((v) => Math.abs(v) <= Math.PI) ? pair : null;
      later();
    });
    joints.svg.addEventListener("pointerleave", () => {
      pointed = null;
      later();
    });
    window.addEventListener("hashchange", restore);

    restore();
    whenWidthChanges(joints.figure, build);
  }

  qboundFigures.live = Object.assign(show, { exitContact, featureText });
}
