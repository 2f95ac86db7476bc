"use strict";
/* Whole bodies beside their points: what each of both says of a pose. */
{
  /* --- the figure ------------------------------------------------------------------------------- */

  /** @type {FigureKind} */
  function show(root, options, { robot: given }) {
    if (!given || given.bodies.length < 2)
      throw new Error("This figure needs a robot with bodies.");
    const { bodyGaps, bodyName, clear, draggable, element, framesOf, handle, layer, make } =
      qboundEngine;
    const { number, pathText, placedParts } = qboundEngine;
    const {
      drawGround,
      drawScaleBar,
      isSafe,
      margins,
      picture,
      planeBox,
      project,
      tightest,
      viewAxes,
      wholePicture,
    } = qboundEngine;
    const { withPair, wrapped } = qboundEngine;
    const { AROUND, armParts, buttons, canvas, jointAxes, moveArm, moveTo, statusLine } =
      qboundParts;
    const { armHandles, jointRows, replaced, turnedToward } = qboundParts;
    const robot = given;
    const unit = robot.length_unit;
    const [first, second] = robot.free;
    const state = { q: [...robot.q] };
    const [joints, plane] = [
      canvas("The regions that the points leave, and the present pose in them.", "Joint space"),
      canvas("The arm and the outlines of its bodies.", "Arm"),
    ];
    const status = statusLine("");
    /** @type {ReturnType<typeof newPictures>} */
    let drawn;

    const rows = jointRows(robot, (j, value) => set(replaced(state.q, j, value)));
    /** @type {[string, () => void][]} */
    const regions = robot.components.map(({ centroid }, i) => [
      `Region ${i + 1}`,
      () => centroid && set(withPair(robot, state.q, centroid)),
    ]);
    const verdicts = { points: element("td", {}), bodies: element("td", {}) };
    const notes = { points: element("td", {}), bodies: element("td", {}) };
    const table = element("table", { className: "verdicts" });
    table.append(
      element(
        "tbody",
        {},
        .../** @type {const} */ (["points", "bodies"]).map((who) =>
          element(
            "tr",
            {},
            element("th", { scope: "row" }, who === "points" ? "Points" : "Bodies"),
            verdicts[who],
            notes[who],
          ),
        ),
      ),
    );
    root.append(
      element(
        "p",
        { className: "hint" },
        "Drag the tool or the elbow of the arm, or the dot from region to region; or set the angles.",
      ),
      status.spoken,
      table,
      element("div", { className: "panels" }, joints.figure, plane.figure),
      ...rows.map(({ row }) => row),
      buttons(...regions),
    );

    /** @type {(q: Pose) => void} */
    function set(q) {
      state.q = q.map((value) => wrapped(value));
      update();
    }

    function newPictures() {
      const ranges = robot.views.map(({ low, high }) => [low, high]);
      const square = picture(joints.svg, ranges, AROUND, true);
      clear(square);
      jointAxes(square, 90);
      drawRegions(square);
      const dot = handle(joints.svg, make("circle", { class: "handle", r: 7 }));
      const whole = wholePicture(plane.svg, planeBox(robot));
      drawGround(robot, whole, viewAxes(robot, robot.q));
      drawScaleBar(whole, unit);
      const arm = armParts(robot, whole);
      const { elbow, tool } = armHandles(plane.svg);
      return { joints: square, dot, plane: { ...arm, group: tool.group }, elbow, tool };
    }

    function draw() {
      drawn = newPictures();
      update();
    }

    /** @type {(square: Picture) => void} */
    function drawRegions(square) {
      const group = layer(square, "regions");
      for (const [i, { loops, home, centroid }] of robot.components.entries()) {
        const outlines = loops.map((loop) =>
          pathText(loop.flatMap((arc) => arc.points).map(square.at), true),
        );
        group.append(make("path", { class: home ? "home" : "away", d: outlines.join("") }));
        if (!centroid) continue;
        const [x, y] = square.at(centroid);
        group.append(
          make("text", { class: "arc-name", x, y: y - 10, "text-anchor": "middle" }, `${i + 1}`),
        );
      }
    }

    function update() {
      for (const [k, row] of rows.entries()) row.set((state.q[robot.free[k]] * 180) / Math.PI);
      if (!drawn) return;
      const found = margins(robot, state.q);
      const pairs = bodyGaps(robot, placedParts(robot, framesOf(robot, state.q)));
      const worst = pairs.reduce((one, other) => (other.gap < one.gap ? other : one));
      const over = pairs.some(({ overlap }) => overlap);
      const safe = isSafe(found);
      const near = tightest(robot, found);
      const violated = found.filter((one) => one.used && one.value < 0).map((one) => one.name);
      moveArm(robot, drawn.plane, state.q, violated);
      moveTo(drawn.dot.group, drawn.joints.at(robot.free.map((j) => state.q[j])));
      const elbow = framesOf(robot, state.q)[second + 1].place;
      moveTo(drawn.elbow.group, drawn.plane.at(project(viewAxes(robot, state.q), elbow)));
      for (const { mark } of [drawn.dot, drawn.tool, drawn.elbow])
        mark.classList.toggle("violated", over || !safe);
      tell(safe, near, over, worst);
    }

    /** @type {(name: string) => string} */
    function withPoints(name) {
      const indices = robot.boundaries.find((wall) => wall.name === name)?.points ?? [];
      const words = indices.map((i) => robot.points[i].name).join(" and ");
      return words ? `${name} (point${indices.length > 1 ? "s" : ""} ${words})` : name;
    }

    /** @type {(safe: boolean, near: Margin | null, over: boolean, worst: BodyGap) => void} */
    function tell(safe, near, over, worst) {
      const names = worst.bodies.map((i) => bodyName(robot, i)).join(" and ");
      const length = (/** @type {number} */ value) => `${number(Math.abs(value), 2)} ${unit}`;
      const margin = near
        ? `${withPoints(near.name)}: ${length(near.value)} ${near.value < 0 ? "too near" : "to spare"}`
        : "";
      const words = {
        points: [safe ? "allowed" : "forbidden", margin],
        bodies: [
          over ? "overlap" : "apart",
          `${names}: ${length(worst.gap)} ${over ? "deep" : "between them"}`,
        ],
      };
      for (const who of /** @type {const} */ (["points", "bodies"])) {
        verdicts[who].textContent = words[who][0];
        notes[who].textContent = words[who][1];
      }
      verdicts.points.classList.toggle("bad", !safe);
      verdicts.bodies.classList.toggle("bad", over);
      status.say(`Points: ${words.points.join(", ")}. Bodies: ${words.bodies.join(", ")}.`, false);
    }

    draggable(joints.svg, (pixel) => set(withPair(robot, state.q, drawn.joints.from(pixel))));
    draggable(plane.svg, (pixel, held) => {
      const isElbow = held === drawn.elbow.room;
      set(
        turnedToward(robot, state.q, isElbow ? [first, second] : [second], drawn.plane.from(pixel)),
      );
    });

    const start = robot.components[Number(options.region ?? 2) - 1]?.centroid;
    if (start) set(withPair(robot, state.q, start));
    qboundParts.whenWidthChanges(joints.figure, draw);
  }

  qboundFigures.bodies = show;
}
