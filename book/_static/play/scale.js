"use strict";
/* Figure 6: the polygon scaled about its centroid, and how far the tool goes below its limit. */
{
  const PIECES = 24; // of an edge: on none of them does the slope of a floor change its sign twice
  const TOUCHING = 1e-9; // of a length: an edge that goes less deep touches the limit
  const LEAST = 0.5; // scales of the slider
  const MOST = 1.05;

  const LONGEST =
    "Scale 1.000: the tool goes up to 10.000 cm below its limit, on the edge 3–4. Edges not allowed: 1–2, 2–3, 3–4, 4–5, 5–6, 6–1.";

  /* --- arithmetic: tests/book/test_play_arithmetic.py runs it beside the library -------------------- */

  /** The height of the tool above its limit as a form of both joints: the first half-space in use.
   * @type {(robot: Robot) => Matrix} */
  function floorOf(robot) {
    const floor = robot.boundaries.find((wall) => wall.kind === "half-space" && wall.used);
    if (!floor) throw new Error("Figure 6 needs a robot with a floor.");
    return qboundEngine.restrict(floor.form, robot, robot.q);
  }

  /** Least value of a form on a straight edge and where: at an end, or where the slope along the
      edge passes zero upward, found by bisection.
   * @type {(matrix: Matrix, start: Pair, end: Pair) => Lowest} */
  function leastOnEdge(matrix, start, end) {
    const { basis, basisSlope, evaluate } = qboundEngine;
    const along = start.map((value, k) => end[k] - value);
    /** @type {(t: number) => Pair} */
    const at = (t) => start.map((value, k) => value + t * along[k]);
    /** @type {(q: number) => number[]} */
    const rise = (q) => basisSlope("revolute", q);
    /** @type {(q: number) => number[]} */
    const here = (q) => basis("revolute", q);
    /** @type {(t: number) => number} */
    const slope = (t) => {
      const [p, q] = at(t);
      return (
        along[0] * evaluate(matrix, rise(p), here(q)) +
        along[1] * evaluate(matrix, here(p), rise(q))
      );
    };
    const places = [start, end];
    for (let i = 0; i < PIECES; i += 1) {
      let [low, high] = [i / PIECES, (i + 1) / PIECES];
      if (slope(low) > 0 || slope(high) <= 0) continue;
      for (let step = 0; step < 50; step += 1) {
        const middle = (low + high) / 2;
        if (slope(middle) > 0) high = middle;
        else low = middle;
      }
      places.push(at(low));
    }
    const heights = places.map(([p, q]) => evaluate(matrix, here(p), here(q)));
    const value = Math.min(...heights);
    return { value, q: places[heights.indexOf(value)] };
  }

  /** Every edge of the polygon at a scale: the least height of the tool above its limit, and where.
   * @type {(matrix: Matrix, polygon: VertexPolygon, factor: number) => Lowest[]} */
  function edges(matrix, { vertices, centroid }, factor) {
    const corners = qboundEngine.scaledPolygon(vertices, factor, centroid);
    return corners.map((corner, i) =>
      leastOnEdge(matrix, corner, corners[(i + 1) % corners.length]),
    );
  }

  /* --- the figure ------------------------------------------------------------------------------- */

  /** @type {FigureKind} */
  function show(root, options, { robot: given }) {
    if (!given?.polygon) throw new Error("Figure 6 needs a robot whose region has a polygon.");
    const { clear, drawGround, drawScaleBar, element, layer, make, number } = qboundEngine;
    const { overlapText, ownColour, pathText, picture, valueRow } = qboundEngine;
    const { placeAt, pointPlaces, project, scaledPolygon, viewAxes, wholePicture, withPair } =
      qboundEngine;
    const { AROUND, armParts, buttons, canvas, jointAxes, moveArm, statusLine } = qboundParts;
    const robot = given;
    const { polygon } = given;
    const { vertices, centroid, largest } = polygon;
    const unit = robot.length_unit;
    const floor = floorOf(robot);
    const [{ limit, name }] = robot.boundaries.flatMap((wall) =>
      wall.kind === "half-space" && wall.used ? [{ limit: wall.offset, name: wall.name }] : [],
    );
    const state = { scale: Number(options.scale ?? 0.95) };
    const [joints, plane] = [
      canvas(
        "The polygon in the square of both joint angles, scaled about its centroid.",
        "Joint space",
      ),
      canvas("The arm at the lowest point that the tool reaches on the polygon's edges.", "Arm"),
    ];
    const status = statusLine(LONGEST);
    /** @type {ReturnType<typeof drawJoints> & ReturnType<typeof drawPlane>} */
    let drawn;

    const row = valueRow(
      {
        name: "Scale",
        spoken: "Scale of the polygon",
        low: LEAST,
        high: MOST,
        step: 0.001,
        digits: 4,
        unit: "",
      },
      set,
    );
    const mark = element("span", {});
    mark.style.left = `${(100 * (largest - LEAST)) / (MOST - LEAST)}%`;
    root.append(
      element(
        "p",
        { className: "hint" },
        "Move the scale. Edges on which the tool goes below its limit light up.",
      ),
      status.seen,
      status.spoken,
      row.row,
      element("div", { className: "safe-mark", ariaHidden: "true" }, mark),
      buttons(
        ["1, the six points", () => set(1)],
        [`${number(largest, 6)}, the largest allowed scale`, () => set(largest)],
        ["0.95, as in Figure 6", () => set(0.95)],
      ),
      element("div", { className: "panels" }, joints.figure, plane.figure),
      element(
        "p",
        { className: "hint" },
        "The dot marks the pose in which the arm is drawn: of all on the polygon's edges the one with " +
          "the tool lowest, found where its height along an edge has slope zero, to the last digit.",
      ),
    );

    /** @type {(scale: number) => void} */
    function set(scale) {
      state.scale = scale;
      update();
    }

    function draw() {
      drawn = { ...drawJoints(), ...drawPlane() };
      update();
    }

    function drawJoints() {
      const pad = 0.25;
      const ranges = [0, 1].map((k) => {
        const values = vertices.map((vertex) => vertex[k]);
        return [Math.min(...values) - pad, Math.max(...values) + pad];
      });
      const fitted = picture(joints.svg, ranges, AROUND, true);
      clear(fitted);
      jointAxes(fitted, 45);
      const group = layer(fitted, "polygons");
      const before = make("path", { class: "before", d: pathText(vertices.map(fitted.at), true) });
      const inside = make("path", { class: "home" });
      group.append(inside, before);
      const lines = vertices.map(() => group.appendChild(make("path", { class: "arc" })));
      const arrows = vertices.map(() =>
        group.appendChild(make("path", { class: "heading", d: "M-5 -4.5L6 0L-5 4.5Z" })),
      );
      const [x, y] = fitted.at(centroid);
      group.append(make("path", { class: "centroid", d: `M${x - 6} ${y}h12M${x} ${y - 6}v12` }));
      const numbers = vertices.map((_, i) =>
        group.appendChild(
          make("text", { class: "vertex-name", "text-anchor": "middle" }, `${i + 1}`),
        ),
      );
      const dot = group.appendChild(make("circle", { class: "handle", r: 7 }));
      return { joints: fitted, inside, lines, arrows, numbers, dot };
    }

    /** The part of the plane that the arm takes where the tool is lowest, at any scale.
     * @type {() => number[][]} */
    function armBox() {
      const scales = Array.from({ length: 12 }, (_, i) => LEAST + (i / 11) * (MOST - LEAST));
      const places = scales.flatMap((scale) => {
        const found = edges(floor, polygon, scale);
        const { q } = found.reduce((one, other) => (other.value < one.value ? other : one));
        const pose = withPair(robot, robot.q, q);
        const frames = qboundEngine.framesOf(robot, pose).map((frame) => frame.place);
        const all = [...frames, ...pointPlaces(robot, pose)];
        return all.map((place) => project(viewAxes(robot, pose), place));
      });
      return [0, 1].map((k) => {
        const values = places.map((place) => place[k]);
        return [Math.min(...values, k ? 0 : Infinity) - 4, Math.max(...values) + 4];
      });
    }

    function drawPlane() {
      const whole = wholePicture(plane.svg, armBox());
      drawGround(robot, whole, viewAxes(robot, robot.q));
      drawScaleBar(whole, unit);
      const [, y] = whole.at([0, limit]);
      const at = { x: whole.width - 8, y: y + 15, "text-anchor": "end" };
      const words = `${name}, tool limit: ${number(limit, 2)} ${unit}`;
      layer(whole, "limit").append(
        ownColour(robot, make("path", { class: "wall limit", d: `M0 ${y}H${whole.width}` }), name),
        ownColour(robot, make("text", { class: "wall-name", ...at }, words), name),
      );
      const arm = armParts(robot, whole);
      const depth = layer(whole, "depth").appendChild(make("path", { class: "depth" }));
      return { plane: arm, depth };
    }

    function update() {
      row.set(state.scale);
      if (!drawn) return;
      const { scale } = state;
      const found = edges(floor, polygon, scale);
      const corners = scaledPolygon(vertices, scale, centroid);
      const places = corners.map(drawn.joints.at);
      const next = (/** @type {number} */ i) => (i + 1) % corners.length;
      const values = found.map((one) => one.value);
      const worst = values.indexOf(Math.min(...values));
      const { q, value } = found[worst];
      drawn.inside.setAttribute("d", pathText(places, true));
      for (const [i, line] of drawn.lines.entries()) {
        line.setAttribute("d", pathText([places[i], places[next(i)]]));
        line.classList.toggle("lit", values[i] < -TOUCHING);
        const [[ax, ay], [bx, by]] = [places[i], places[next(i)]];
        const turn = (Math.atan2(by - ay, bx - ax) * 180) / Math.PI;
        const [mx, my] = [(ax + bx) / 2, (ay + by) / 2].map((value) => value.toFixed(1));
        drawn.arrows[i].setAttribute("transform", `translate(${mx} ${my}) rotate(${turn})`);
      }
      const [gx, gy] = drawn.joints.at(centroid);
      for (const [i, text] of drawn.numbers.entries()) {
        const [x, y] = places[i];
        const size = Math.hypot(gx - x, gy - y) || 1;
        placeAt(text, [x + (17 * (gx - x)) / size, y + (17 * (gy - y)) / size + 4]);
      }
      placeAt(drawn.dot, drawn.joints.at(q), "c");
      drawn.dot.classList.toggle("violated", value < -TOUCHING);
      showArm(q);
      tell(values, worst, overlapText(robot, withPair(robot, robot.q, q)));
    }

    /** @type {(q: Pair) => void} */
    function showArm(q) {
      const pose = withPair(robot, robot.q, q);
      moveArm(robot, drawn.plane, pose);
      const tool = project(viewAxes(robot, pose), pointPlaces(robot, pose)[robot.tool]);
      drawn.depth.setAttribute("d", pathText([tool, [tool[0], limit]].map(drawn.plane.at)));
    }

    /** @type {(values: number[], worst: number, overlap: string) => void} */
    function tell(values, worst, overlap) {
      const edge = (/** @type {number} */ i) => `${i + 1}–${((i + 1) % values.length) + 1}`;
      const leaving = values.flatMap((value, i) => (value < -TOUCHING ? [edge(i)] : []));
      const size = `${number(Math.abs(values[worst]), 3)} ${unit}`;
      const many = leaving.length > 1 ? "Edges" : "Edge";
      const text =
        leaving.length > 0
          ? `the tool goes up to ${size} below its limit, on the edge ${edge(worst)}. ` +
            `${many} not allowed: ${leaving.join(", ")}.`
          : `the tool stays ${size} or more above its limit; lowest on the edge ${edge(worst)}.`;
      status.say(`Scale ${number(state.scale, 3)}: ${text} ${overlap}`.trim(), leaving.length > 0);
    }

    qboundParts.lightable(root);
    qboundParts.whenWidthChanges(joints.figure, draw);
  }

  qboundFigures.scale = Object.assign(show, { edges, floorOf });
}
