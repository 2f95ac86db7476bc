"use strict";
/* Whole bodies beside their points: outlines, what they share, how far apart they are. */
{
  const TOUCHING = 1e-9; // of a length: two bodies nearer than this touch

  /* --- arithmetic: tests/test_play.py runs it beside the library ------------------------------- */

  /** The outlines of all bodies in the plane of motion.
   * @type {(robot: Robot, q: Pose) => Point[][]} */
  function outlines(robot, q) {
    const { framesOf, placeIn, project, viewAxes } = qboundEngine;
    const [frames, axes] = [framesOf(robot, q), viewAxes(robot, q)];
    return robot.bodies.map(({ frame, outline }) =>
      anticlockwise(outline.map((at) => project(axes, placeIn(frames[frame], at)))),
    );
  }

  /** @type {(corners: Point[]) => Point[]} */
  function anticlockwise(corners) {
    return area(corners) < 0 ? [...corners].reverse() : corners;
  }

  /** @type {(corners: Point[]) => number} */
  function area(corners) {
    return corners.reduce((total, [x, y], i) => {
      const [nextX, nextY] = corners[(i + 1) % corners.length];
      return total + (x * nextY - nextX * y) / 2;
    }, 0);
  }

  /** How far a point lies on the outer side of the line from a to b.
   * @type {(a: Point, b: Point, p: Point) => number} */
  function beyond(a, b, p) {
    const [x, y] = [b[0] - a[0], b[1] - a[1]];
    return ((p[0] - a[0]) * y - (p[1] - a[1]) * x) / Math.hypot(x, y);
  }

  /** What two convex outlines share (Sutherland and Hodgman); no corners where nothing.
   * @type {(one: Point[], other: Point[]) => Point[]} */
  function shared(one, other) {
    return other.reduce((corners, a, i) => {
      const b = other[(i + 1) % other.length];
      return corners.flatMap((p, j) => {
        const r = corners[(j + 1) % corners.length];
        const [from, to] = [beyond(a, b, p), beyond(a, b, r)];
        const share = from / (from - to);
        const cut = [p[0] + share * (r[0] - p[0]), p[1] + share * (r[1] - p[1])];
        return [...(from <= 0 ? [p] : []), ...(from <= 0 !== to <= 0 ? [cut] : [])];
      });
    }, one);
  }

  /** How far two convex outlines are apart; where they overlap, minus the shortest way out
      (separating axes, as qbound.measures.bodies.gap).
   * @type {(one: Point[], other: Point[]) => number} */
  function gap(one, other) {
    const depth = Math.max(pastEdges(one, other), pastEdges(other, one));
    if (depth <= 0) return depth;
    return Math.min(nearestCorner(one, other), nearestCorner(other, one));
  }

  /** @type {(one: Point[], other: Point[]) => number} */
  function pastEdges(one, other) {
    const sides = one.map((a, i) =>
      Math.min(...other.map((p) => beyond(a, one[(i + 1) % one.length], p))),
    );
    return Math.max(...sides);
  }

  /** @type {(one: Point[], other: Point[]) => number} */
  function nearestCorner(one, other) {
    return Math.min(
      ...one.flatMap(([ax, ay], i) => {
        const [bx, by] = one[(i + 1) % one.length];
        const [x, y] = [bx - ax, by - ay];
        return other.map(([px, py]) => {
          const t = ((px - ax) * x + (py - ay) * y) / (x * x + y * y);
          const share = Math.min(1, Math.max(0, t));
          return Math.hypot(ax + share * x - px, ay + share * y - py);
        });
      }),
    );
  }

  /** Every pair of bodies: its frames, its gap and what it shares.
   * @type {(robot: Robot, q: Pose) => BodyPair[]} */
  function bodyPairs(robot, q) {
    const placed = outlines(robot, q);
    return placed.flatMap((one, i) =>
      placed.slice(i + 1).map((other, k) => ({
        frames: [robot.bodies[i].frame, robot.bodies[i + 1 + k].frame],
        gap: gap(one, other),
        shared: shared(one, other),
      })),
    );
  }

  /** The pose with one joint turned so that what it carries points to a place: the next joint, or
      the tool.
   * @type {(robot: Robot, q: Pose, joints: number[], target: Point) => Pose} */
  function turnedToward(robot, q, [joint, next], target) {
    const { framesOf, pointPlaces, project, viewAxes } = qboundEngine;
    /** The angle about the joint from what it carries to the target.
     * @type {(pose: Pose) => number} */
    const angle = (pose) => {
      const [frames, axes] = [framesOf(robot, pose), viewAxes(robot, pose)];
      const tool = pointPlaces(robot, pose)[robot.tool];
      const [x, y] = project(axes, frames[joint + 1].place);
      const [u, v] = project(axes, next === undefined ? tool : frames[next + 1].place);
      const [a, b] = [u - x, v - y];
      const [c, d] = [target[0] - x, target[1] - y];
      return Math.atan2(a * d - b * c, a * c + b * d);
    };
    /** @type {(change: number) => Pose} */
    const turned = (change) => q.map((value, j) => (j === joint ? value + change : value));
    const rest = angle(q);
    const [one, other] = [turned(rest), turned(-rest)]; // whichever way the joint counts
    return Math.abs(angle(one)) <= Math.abs(angle(other)) ? one : other;
  }

  /* --- the figure ------------------------------------------------------------------------------- */

  /** @type {FigureKind} */
  function show(root, options, { robot: given }) {
    if (!given || given.bodies.length < 2)
      throw new Error("This figure needs a robot with bodies.");
    const { clear, draggable, element, framesOf, handle, layer, make, number, pathText } =
      qboundEngine;
    const { isSafe, margins, picture, planeBox, project, tightest, viewAxes, withPair } =
      qboundEngine;
    const { AROUND, armParts, buttons, canvas, jointAxes, moveArm, moveTo, statusLine, valueRow } =
      qboundParts;
    const robot = given;
    const unit = robot.length_unit;
    const [first, second] = robot.free;
    const state = { q: [...robot.q] };
    const [joints, plane] = [
      canvas("The regions that the points leave, and the present pose in them."),
      canvas("The arm and the outlines of its bodies."),
    ];
    const status = statusLine("");
    /** @type {BodyPictures} */
    let drawn;

    const rows = robot.free.map((j, k) =>
      valueRow(
        {
          name: `q${"₁₂"[k]}`,
          spoken: `q${k + 1} in degrees`,
          low: -180,
          high: 180,
          step: 0.1,
          digits: 1,
          unit: "°",
        },
        (value) => set(state.q.map((old, i) => (i === j ? (value * Math.PI) / 180 : old))),
      ),
    );
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
      state.q = q.map((value) => value - 2 * Math.PI * Math.round(value / (2 * Math.PI)));
      update();
    }

    function draw() {
      const ranges = robot.views.map(({ low, high }) => [low, high]);
      const square = picture(joints.svg, ranges, AROUND, true);
      clear(square);
      jointAxes(square, 90);
      drawRegions(square);
      const dot = handle(joints.svg, make("circle", { class: "handle", r: 7 }));
      const fitted = picture(
        plane.svg,
        planeBox(robot),
        { left: 8, right: 8, top: 8, bottom: 8 },
        true,
      );
      const whole = {
        ...fitted,
        box: { left: 0, top: 0, right: fitted.width, bottom: fitted.height },
      };
      clear(whole);
      const [, ground] = whole.at([0, 0]);
      plane.svg.append(make("path", { class: "wall", d: `M0 ${ground}H${whole.width}` }));
      const arm = armParts(robot, whole);
      const overlap = layer(whole, "overlap").appendChild(make("path", { class: "overlap" }));
      const elbow = handle(plane.svg, make("circle", { class: "handle", r: 6 }));
      const tool = handle(
        plane.svg,
        make("rect", { class: "handle", x: -7, y: -7, width: 14, height: 14, rx: 2 }),
      );
      drawn = { joints: square, dot, plane: { ...arm, group: tool.group }, overlap, elbow, tool };
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
      const pairs = bodyPairs(robot, state.q);
      const worst = pairs.reduce((one, other) => (other.gap < one.gap ? other : one));
      const over = pairs.filter(({ gap }) => gap < -TOUCHING);
      const safe = isSafe(found);
      const near = tightest(robot, found);
      const violated = found.filter((one) => one.used && one.value < 0).map((one) => one.name);
      moveArm(robot, drawn.plane, state.q, violated);
      const shapes = over.map(({ shared }) => pathText(shared.map(drawn.plane.at), true));
      drawn.overlap.setAttribute("d", shapes.join(""));
      moveTo(drawn.dot.group, drawn.joints.at(robot.free.map((j) => state.q[j])));
      const elbow = framesOf(robot, state.q)[second + 1].place;
      moveTo(drawn.elbow.group, drawn.plane.at(project(viewAxes(robot, state.q), elbow)));
      for (const { mark } of [drawn.dot, drawn.tool, drawn.elbow])
        mark.classList.toggle("violated", over.length > 0 || !safe);
      tell(safe, near, over, worst);
    }

    /** @type {(name: string) => string} */
    function withPoints(name) {
      const indices = robot.boundaries.find((wall) => wall.name === name)?.points ?? [];
      const words = indices.map((i) => robot.points[i].name).join(" and ");
      return words ? `${name} (point${indices.length > 1 ? "s" : ""} ${words})` : name;
    }

    /** @type {(safe: boolean, near: Margin | null, over: BodyPair[], worst: BodyPair) => void} */
    function tell(safe, near, over, worst) {
      const names = (/** @type {BodyPair} */ { frames }) =>
        frames.map((frame) => (frame === 0 ? "base" : `link ${frame}`)).join(" and ");
      const length = (/** @type {number} */ value) => `${number(Math.abs(value), 2)} ${unit}`;
      const margin = near
        ? `${withPoints(near.name)}: ${length(near.value)} ${near.value < 0 ? "too near" : "to spare"}`
        : "";
      const words = {
        points: [safe ? "safe" : "not safe", margin],
        bodies: [
          over.length > 0 ? "overlap" : "apart",
          over.length > 0
            ? `${names(worst)}: ${length(worst.gap)} deep`
            : `${names(worst)}: ${length(worst.gap)} between them`,
        ],
      };
      for (const who of /** @type {const} */ (["points", "bodies"])) {
        verdicts[who].textContent = words[who][0];
        notes[who].textContent = words[who][1];
      }
      verdicts.points.classList.toggle("bad", !safe);
      verdicts.bodies.classList.toggle("bad", over.length > 0);
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

  qboundFigures.bodies = Object.assign(show, {
    outlines,
    area,
    gap,
    shared,
    bodyPairs,
    turnedToward,
  });
}
