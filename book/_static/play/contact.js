"use strict";
/* Boundary functions: the arm is dragged until something touches. Beside it stand the functions along
   the second joint, each in its colour; the one that vanishes is where the arm stops. Options:
   data-only (names of boundaries), data-passes (the arm does not stop: a value becomes negative). */
{
  const STEPS = 240; // places of the second joint at which a curve is computed
  const HIGH = 0.9; // of the reach: most of what the picture shows
  const ZERO = 1e-3; // of the reach: a function so near to zero has vanished for the eye

  const LONGEST =
    "B3 vanishes: points 10 and 11 are 0.1 cm apart, as near as they may be. The arm stops here. Overlap: link 1 and link 2, 10.98 cm deep.";

  /** @type {(robot: Robot, wall: Wall) => string} */
  function aboutText(robot, { kind, points }) {
    const [one, other] = points.map((i) => robot.points[i].name);
    const tool = points[0] === robot.tool ? " (the tool)" : "";
    return kind === "pair" ? `points ${one} and ${other}` : `point ${one}${tool} and its limit`;
  }

  /** The margins of boundaries at places of the second joint, the first one held.
   * @type {(robot: Robot, rules: Rule[], first: number) => Pair[][]} */
  function curves(robot, rules, first) {
    const { basis, evaluate, lengthOf } = qboundEngine;
    const [one, other] = robot.free.map((j) => robot.joints[j].kind);
    const { low, high } = robot.views[1];
    const values = Array.from({ length: STEPS + 1 }, (_, i) => low + ((high - low) * i) / STEPS);
    const held = basis(one, first);
    return rules.map(({ wall, form }) =>
      values.map((value) => [
        value,
        form ? lengthOf(wall, evaluate(form, held, basis(other, value))) : Infinity,
      ]),
    );
  }

  /** @type {FigureKind} */
  function show(root, options, { robot: given }) {
    if (!given) throw new Error("This figure needs a robot.");
    const { clear, draggable, drawGround, drawScaleBar, element, framesOf, handle } = qboundEngine;
    const { layer, legendKey, make, margins, number, overlapText, ownColour } = qboundEngine;
    const { pathText, picture, placeAt, planeBox, project, viewAxes } = qboundEngine;
    const { wholePicture, withPair } = qboundEngine;
    const { AROUND, armParts, buttons, canvas, degreeTicks, moveArm, moveTo } = qboundParts;
    const { armHandles, jointRows, replaced, statusLine, turnedToward } = qboundParts;
    const { whenWidthChanges } = qboundParts;
    const { rulesOf, slide } = /** @type {RegionsKind} */ (
      /** @type {unknown} */ (qboundFigures.regions)
    );
    const robot = given;
    const unit = robot.length_unit;
    const [first, second] = robot.free;
    const only = options.only?.split(/[ ,]+/);
    const passes = options.passes !== undefined;
    const lowest = passes ? -0.9 : -0.2; // of the reach: least of what the picture shows
    const rules = rulesOf(robot).filter(({ wall }) => only?.includes(wall.name) ?? true);
    const walls = rules.map(({ wall }) => wall);
    const names = walls.map(({ name }) => name);
    const state = { q: [...robot.q], by: /** @type {string | null} */ (null) };
    const [plane, plot] = [
      canvas("The arm, and the points that must not touch.", "Arm"),
      canvas("Each boundary function along the second joint.", "Boundary functions along q₂"),
    ];
    const status = statusLine(LONGEST);
    /** @type {ReturnType<typeof newPictures>} */
    let drawn;
    /** @type {number | null} */
    let drawnFor = null; // the first joint's value of which the curves are

    const rows = jointRows(robot, (j, value) => go(replaced(state.q, j, value)));
    const values = walls.map(() => element("td", { className: "number" }));
    const lines = walls.map((wall, i) => {
      const head = element("th", { scope: "row" }, legendKey("arc", "M0 5H22", 10), wall.name);
      const line = element("tr", {}, head, element("td", {}, aboutText(robot, wall)), values[i]);
      line.addEventListener("pointerenter", () => light(wall.name));
      line.addEventListener("pointerleave", () => light(state.by));
      return ownColour(robot, line, wall.name);
    });
    const table = element("table", { className: "functions" }, element("tbody", {}, ...lines));
    root.append(
      element(
        "p",
        { className: "hint" },
        passes
          ? "Drag the tool or the elbow: the arm may pass its limit here."
          : "Drag the tool or the elbow until the arm stops.",
      ),
      status.seen,
      status.spoken,
      element("div", { className: "panels" }, plane.figure, plot.figure),
      table,
      ...rows.map(({ row }) => row),
      buttons(["Home", () => put([...robot.q], null)]),
    );

    /** Go towards a pose; a boundary stops the arm, if it may not pass.
     * @type {(wanted: Pose) => void} */
    function go(wanted) {
      if (passes) {
        const negative = margins(robot, wanted).find(
          ({ name, value }) => names.includes(name) && value < 0,
        );
        put(wanted, negative?.name ?? null);
        return;
      }
      const [from, to] = [state.q, wanted].map((q) => robot.free.map((j) => q[j]));
      const slid = slide(robot, rules, from, to);
      put(withPair(robot, state.q, slid.at), slid.by[0]?.name ?? null);
    }

    /** The nearest pose that brings the tool to a place; both joints turn.
     * @type {(target: Point) => Pose} */
    function reaching(target) {
      const { armOf, leastBy, postures, sum, toolMap, wayTo } = qboundEngine;
      const now = /** @type {Pair} */ (robot.free.map((j) => state.q[j]));
      const all = postures(armOf(toolMap(robot, state.q)), target);
      const nearest = leastBy(all, (pair) => sum(wayTo(robot, now, pair).map(Math.abs)));
      return nearest ? withPair(robot, state.q, nearest) : state.q;
    }

    /** @type {(q: Pose, by: string | null) => void} */
    function put(q, by) {
      state.q = q.map((value) => qboundEngine.wrapped(value));
      state.by = by;
      update();
    }

    function newPictures() {
      const whole = wholePicture(plane.svg, planeBox(robot), 26);
      drawGround(robot, whole, viewAxes(robot, robot.q));
      drawScaleBar(whole, unit);
      const limits = walls.flatMap((wall) => {
        if (wall.kind !== "half-space") return [];
        const [, y] = whole.at([0, wall.offset]);
        const limit = make("path", { class: "wall limit", d: `M0 ${y}H${whole.width}` });
        return [ownColour(robot, limit, wall.name)];
      });
      whole.svg.append(...limits);
      const arm = armParts(robot, whole);
      const { elbow, tool } = armHandles(plane.svg);
      const { low, high } = robot.views[1];
      const ends = [lowest * robot.reach, HIGH * robot.reach];
      const graph = picture(plot.svg, [[low, high], ends], AROUND, false);
      clear(graph);
      const step = robot.reach > 40 ? 20 : 10;
      const count = Math.floor(ends[1] / step) - Math.ceil(ends[0] / step) + 1;
      const ticks = Array.from({ length: count }, (_, i) => (Math.ceil(ends[0] / step) + i) * step);
      qboundEngine.drawAxes(graph, [
        { name: "q2", unit: "°", ticks: degreeTicks(low, high, 90) },
        {
          name: "margin",
          unit,
          ticks: ticks.map((value) => ({ value, text: String(value).replace("-", "−") })),
        },
      ]);
      const group = layer(graph, "curves");
      const zero = pathText(
        [
          [low, 0],
          [high, 0],
        ].map(graph.at),
      );
      const forbidden = pathText(
        [
          [low, 0],
          [high, 0],
          [high, ends[0]],
          [low, ends[0]],
        ].map(graph.at),
        true,
      );
      group.append(
        make("path", { class: "below", d: forbidden }),
        make("path", { class: "wall", d: zero }),
      );
      const arcs = names.map((name) =>
        group.appendChild(ownColour(robot, make("path", { class: "arc" }), name)),
      );
      const now = group.appendChild(make("path", { class: "now" }));
      const dots = names.map((name) =>
        group.appendChild(ownColour(robot, make("circle", { class: "value-dot", r: 5 }), name)),
      );
      const knob = handle(plot.svg, make("circle", { class: "handle", r: 7 }));
      const parts = [...limits, ...arcs, ...dots];
      const moving = { ...arm, group: tool.group };
      return { plane: moving, elbow, tool, graph, arcs, now, dots, knob, parts };
    }

    function draw() {
      drawn = newPictures();
      drawnFor = null;
      update();
    }

    function update() {
      for (const [k, row] of rows.entries()) row.set((state.q[robot.free[k]] * 180) / Math.PI);
      if (!drawn) return;
      const { graph } = drawn;
      const q2 = state.q[second];
      if (state.q[first] !== drawnFor) {
        drawnFor = state.q[first];
        for (const [i, points] of curves(robot, rules, drawnFor).entries())
          drawn.arcs[i].setAttribute("d", pathText(points.map(graph.at)));
      }
      const { top, bottom } = graph.box;
      const [x, y] = graph.at([q2, 0]);
      drawn.now.setAttribute("d", `M${x} ${top}V${bottom}`);
      moveTo(drawn.knob.group, [x, y]);
      const found = margins(robot, state.q);
      const numbers = names.map((name) => found.find((one) => one.name === name)?.value ?? 0);
      for (const [i, value] of numbers.entries()) {
        placeAt(drawn.dots[i], graph.at([q2, value]), "c");
        values[i].textContent = `${number(value, 2)} ${unit}`.replace("−0.00", "0.00");
      }
      const elbow = framesOf(robot, state.q)[second + 1].place;
      moveTo(drawn.elbow.group, drawn.plane.at(project(viewAxes(robot, state.q), elbow)));
      light(state.by);
      tell(numbers);
    }

    /** Let a boundary stand out, in the arm, in its curve and in the table.
     * @type {(name: string | null) => void} */
    function light(name) {
      moveArm(robot, drawn.plane, state.q, name === null ? [] : [name], passes);
      for (const one of [...drawn.parts, ...lines])
        one.classList.toggle("lit", one.dataset.boundary === name);
    }

    /** @type {(numbers: number[]) => void} */
    function tell(numbers) {
      const least = numbers.indexOf(Math.min(...numbers));
      const overlap = overlapText(robot, state.q);
      const wall = walls[names.indexOf(state.by ?? names[least])];
      const size = `${number(numbers[least], 2)} ${unit}`;
      const near =
        wall.kind === "pair"
          ? `are ${number(wall.required, 1)} ${unit} apart, as near as they may be`
          : "meet";
      const vanishes =
        state.by !== null && numbers[names.indexOf(state.by)] < ZERO * robot.reach
          ? `${state.by} vanishes: ${aboutText(robot, wall)} ${near}. The arm stops here.`
          : `No function vanishes. The smallest is ${names[least]}, ${size}.`;
      const words = passes ? signText(wall, numbers[least], size) : vanishes;
      status.say(`${words} ${overlap}`.trim(), state.by !== null || overlap !== "");
    }

    /** @type {(wall: Wall, value: number, size: string) => string} */
    function signText(wall, value, size) {
      const point = aboutText(robot, wall).replace(" and its limit", "");
      if (Math.abs(value) < ZERO * robot.reach)
        return `${wall.name} is zero: ${point} is at its limit.`;
      return value > 0
        ? `${wall.name} is positive, ${size}: ${point} keeps its limit. It says nothing of other contacts.`
        : `${wall.name} is negative, ${size}: ${point} is below its limit.`;
    }

    root.addEventListener("qbound-light", (event) => {
      light((event instanceof CustomEvent && event.detail) || state.by);
    });
    draggable(plane.svg, (pixel, held) => {
      const [target, isElbow] = [drawn.plane.from(pixel), held === drawn.elbow.room];
      const joints = isElbow ? [first, second] : [second];
      go(passes && !isElbow ? reaching(target) : turnedToward(robot, state.q, joints, target));
    });
    draggable(plot.svg, (pixel) => {
      const [value] = drawn.graph.from(pixel);
      go(replaced(state.q, second, value));
    });
    whenWidthChanges(plot.figure, draw);
  }

  qboundFigures.contact = Object.assign(show, { curves });
}
