"use strict";
/* Figure 4: the bounds of Table 6 in the square of both joints, each of which can be switched off. */
{
  const TURN = 2 * Math.PI;
  const SQUARE = [
    [-Math.PI, Math.PI],
    [-Math.PI, Math.PI],
  ];
  const SIX = ["1,3,1", "2,1,2", "3,3,1", "4,1,2", "7,3,1", "7,3,2"];

  const LONGEST =
    "Home is cut off by β₁,₁,₁, β₂,₁,₁, β₃,₃,₂. What is left: q₁ from −180.00° (edge of the square) to 180.00° (edge of the square), q₂ from −180.00° (edge of the square) to 180.00° (edge of the square), less what the curves cut off.";

  /* --- arithmetic: tests/book/test_play_arithmetic.py runs it beside the library -------------------- */

  /** The components of a pair of points that depend on its joint: a cos q + b sin q = c where one
      vanishes (eq. 29).
   * @type {(robot: Robot, pair: PairWall) => Coefficients[]} */
  function components(robot, pair) {
    const { framesOf, placeIn } = qboundEngine;
    const [near, far] = pair.points
      .map((i) => robot.points[i])
      .sort((one, other) => one.frame - other.frame);
    const joint = near.frame;
    /** @type {(q: number) => Place} */
    const vector = (q) => {
      const frames = framesOf(
        robot,
        robot.q.map((value, j) => (j === joint ? q : value)),
      );
      const { turn, place } = frames[joint];
      const back = { turn: [0, 1, 2].map((k) => turn.map((row) => row[k])), place: [0, 0, 0] };
      const seen = placeIn(frames[far.frame], far.at).map((value, k) => value - place[k]);
      return placeIn(back, seen).map((value, k) => value - near.at[k]);
    };
    const at = [0, TURN / 3, -TURN / 3];
    const seen = at.map(vector);
    return [0, 1, 2].flatMap((k) => {
      const values = seen.map((one) => one[k]);
      const [constant, a, b] = qboundEngine.throughThree("revolute", at, values);
      const moves = Math.hypot(a, b) > 1e-9;
      return moves ? [{ boundary: pair.name, component: k + 1, joint, a, b, c: -constant }] : [];
    });
  }

  /** The printed inverse tangent of b / a, as it may be read.
   * @type {(a: number, b: number, reading: Reading) => number} */
  function direction(a, b, reading) {
    if (reading === "atan2") return Math.atan2(b, a);
    return Math.atan(b / a) + (reading === "plus" && a < 0 ? Math.PI : 0);
  }

  /** The bounds of the pairs of points: q <= value for k = 1, q >= value for k = 2.
   * @type {(robot: Robot, reading: Reading) => StraightBound[]} */
  function straightBounds(robot, reading) {
    const found = robot.boundaries.flatMap((wall) =>
      wall.kind === "pair" ? components(robot, wall) : [],
    );
    return found.flatMap(({ a, b, c, ...rest }) => {
      const upper = direction(a, b, reading) + Math.acos(c / Math.hypot(a, b));
      return [1, 2].map((k) => ({ ...rest, k, value: k === 1 ? upper : upper - TURN }));
    });
  }

  /** The walls: forms of both joints, whose roots along the second one are two bounds each.
   * @type {(robot: Robot) => CurvedWall[]} */
  function curvedWalls(robot) {
    return robot.boundaries.flatMap((wall) => {
      if (wall.kind !== "half-space") return [];
      const sizes = wall.normal.map(Math.abs);
      const component = sizes.indexOf(Math.max(...sizes)) + 1;
      const matrix = qboundEngine.restrict(wall.form, robot, robot.q);
      return [{ boundary: wall.name, component, matrix }];
    });
  }

  /** The arc of the second joint on which a wall is respected: its middle, half its width, and
      whether it ends in roots (Theorem 2).
   * @type {(matrix: Matrix, first: number) => WallArc} */
  function arcAt(matrix, first) {
    const { alongSecond, basis, circleArc } = qboundEngine;
    const [constant, a, b] = alongSecond(matrix, basis("revolute", first));
    const { theta, alpha, count } = circleArc(a, b, -constant);
    return { middle: theta, alpha, cuts: count > 0 };
  }

  /** @type {(bound: Component2 & { k: number }) => string} */
  function nameOf({ boundary, component, k }) {
    return `${boundary.slice(1)},${component},${k}`;
  }

  /** The names of all bounds that a pose violates. A wall's bound forbids what lies between it and
      the direction opposite to the middle of its arc, modulo full turns.
   * @type {(straight: StraightBound[], walls: CurvedWall[], q: Pair) => string[]} */
  function violatedBounds(straight, walls, q) {
    const beyond = straight.filter(({ joint, k, value }) =>
      k === 1 ? q[joint] > value : q[joint] < value,
    );
    const curved = walls.flatMap(({ boundary, component, matrix }) => {
      const { middle, alpha } = arcAt(matrix, q[0]);
      const away = qboundEngine.wrapped(q[1] - middle);
      if (Math.abs(away) <= alpha) return [];
      return [nameOf({ boundary, component, k: away > 0 ? 1 : 2 })];
    });
    return [...beyond.map(nameOf), ...curved];
  }

  /** The box that straight bounds leave within a square: for each joint its lower and upper side,
      and the bound there.
   * @type {(straight: StraightBound[], square: number[][]) => BoxSide[][]} */
  function box(straight, square) {
    return square.map((range, joint) =>
      range.map((end, side) => {
        /** @type {BoxSide} */
        let found = { value: end, by: null };
        for (const bound of straight) {
          if (bound.joint !== joint || (bound.k === 2) !== (side === 0)) continue;
          const tighter = side === 0 ? bound.value > found.value : bound.value < found.value;
          if (tighter) found = { value: bound.value, by: nameOf(bound) };
        }
        return found;
      }),
    );
  }

  /** Values of the first joint at which to draw a wall's curves: closer and closer to where they
      meet and end.
   * @type {(matrix: Matrix) => number[]} */
  function columns(matrix) {
    const { alongSecond, basis, rootsWithin } = qboundEngine;
    const view = { low: -Math.PI, high: Math.PI, wraps: true };
    const even = Array.from({ length: 361 }, (_, i) => ((i - 180) * Math.PI) / 180);
    const [, a, b] = alongSecond(matrix, basis("revolute", 0));
    const size = Math.hypot(a, b);
    const folds = [size, -size].flatMap((height) =>
      rootsWithin("revolute", [matrix[0][0] + height, matrix[1][0], matrix[2][0]], view),
    );
    const near = folds.flatMap((q) =>
      Array.from({ length: 41 }, (_, i) => q + ((i - 20) * Math.abs(i - 20) * Math.PI) / 72000),
    );
    return [...even, ...near].filter((q) => Math.abs(q) <= Math.PI).sort((p, q) => p - q);
  }

  /** A wall's arcs over the first joint; their middles do not jump by a turn.
   * @type {(matrix: Matrix) => CurveRow[]} */
  function curveRows(matrix) {
    let before = 0;
    return columns(matrix).map((first) => {
      const { middle, alpha, cuts } = arcAt(matrix, first);
      before = middle + TURN * Math.round((before - middle) / TURN);
      return { first, middle: before, alpha, cuts };
    });
  }

  /* --- the figure ------------------------------------------------------------------------------- */

  /** @type {(name: string) => string} */
  const written = (name) => `β${name.replace(/\d/g, (digit) => "₀₁₂₃₄₅₆₇₈₉"[Number(digit)])}`;

  /** One bound of a wall, in every turn: its line, or all that it forbids.
   * @type {(rows: CurveRow[], k: number, drawn: Picture, whole: boolean) => string} */
  function curvePath(rows, k, drawn, whole) {
    const side = k === 1 ? 1 : -1;
    /** @type {Pair[][]} */
    const runs = [[]];
    for (const { first, middle, alpha, cuts } of rows) {
      if (cuts || whole) runs[runs.length - 1].push([first, middle + side * alpha]);
      else if (runs[runs.length - 1].length > 0) runs.push([]);
    }
    if (whole)
      runs[0].push(...[...rows].reverse().map((row) => [row.first, row.middle + side * Math.PI]));
    return [-2, -1, 0, 1, 2]
      .flatMap((turns) =>
        runs.map((run) =>
          qboundEngine.pathText(
            run.map(([p, q]) => drawn.at([p, q + turns * TURN])),
            whole,
          ),
        ),
      )
      .join("");
  }

  /** @type {(name: string, text: string) => HTMLLIElement[]} */
  function lineKey(name, text) {
    const { element, legendKey } = qboundEngine;
    return [element("li", {}, legendKey(`bound ${name}`, "M0 5H22", 10), text)];
  }

  /** @type {FigureKind} */
  function show(root, _options, { robot: given }) {
    if (!given) throw new Error("Figure 4 needs a robot.");
    const robot = given;
    const { clear, element, layer, make, ownColour, pathText, picture } = qboundEngine;
    const { AROUND, buttons, canvas, degrees, jointAxes, statusLine, whenWidthChanges } =
      qboundParts;
    const walls = curvedWalls(robot).map((wall) => ({ ...wall, rows: curveRows(wall.matrix) }));
    const names = [
      ...straightBounds(robot, "atan2").map(nameOf),
      ...walls.flatMap((wall) => [1, 2].map((k) => nameOf({ ...wall, k }))),
    ];
    /** @type {(name: string) => boolean} */
    const isUsed = (name) =>
      robot.boundaries.some((wall) => wall.used && wall.name === `B${name.split(",")[0]}`);
    const state = {
      reading: /** @type {Reading} */ ("atan2"),
      on: new Set(names.filter(isUsed)),
      hover: "",
    };
    const home = robot.free.map((j) => robot.q[j]);
    const { figure, svg } = canvas("The square of both joint angles with the bounds of Table 6.");
    const status = statusLine(LONGEST);
    /** @type {Picture} */
    let drawn;

    /* Switches */
    const readings = element(
      "fieldset",
      { className: "readings" },
      element("legend", {}, "The printed arctangent is"),
      ...readingChoice("arctan", "arctan(b/a)"),
      ...readingChoice("atan2", "atan2(b, a)"),
      ...readingChoice("plus", "arctan(b/a) + π where a < 0"),
    );
    const boxes = new Map(names.map((name) => [name, boundBox(name)]));
    const groups = robot.boundaries.map(({ name }) =>
      element(
        "fieldset",
        { className: "bounds" },
        ownColour(robot, element("legend", {}, `B${written(name.slice(1)).slice(1)}`), name),
        ...names
          .filter((one) => one.split(",")[0] === name.slice(1))
          .flatMap((one) => boxes.get(one)?.label ?? []),
      ),
    );
    root.append(
      element(
        "p",
        { className: "hint" },
        "Switch bounds on and off, and choose a reading. Shaded is exactly what they leave, bent sides and all.",
      ),
      status.seen,
      status.spoken,
      element(
        "div",
        { className: "panels" },
        figure,
        element(
          "div",
          {},
          readings,
          buttons(
            ["As it opens", open],
            ["Only the six of the region", () => turnOn(SIX)],
            ["None", () => turnOn([])],
          ),
          element(
            "ul",
            { className: "legend" },
            ...lineKey("binds", "on, and cuts the region or the square"),
            ...lineKey("on", "on, but another cuts before it"),
            ...lineKey("off", "off"),
          ),
        ),
      ),
      element("div", { className: "switches" }, ...groups),
      element(
        "p",
        { className: "hint" },
        "The bounds of B₅ to B₇ are the two roots of Theorem 2 along q₂, in every turn. For β₅,₁,₂ and " +
          "β₆,₁,₂ Table 6 prints the upper root once more, a turn lower, which would exclude nothing.",
      ),
    );

    /** @type {(reading: Reading, text: string) => (Node | string)[]} */
    function readingChoice(reading, text) {
      const choice = element("input", {
        type: "radio",
        name: `${svg.id}-reading`,
        value: reading,
      });
      choice.checked = reading === "atan2";
      choice.addEventListener("change", () => {
        state.reading = reading;
        redraw();
      });
      return [element("label", { className: "check" }, choice, text)];
    }

    /** @type {(name: string) => BoundBox} */
    function boundBox(name) {
      const box = element("input", { type: "checkbox", checked: state.on.has(name) });
      const value = element("span", { className: "value" });
      const label = element("label", { className: "check" }, box, written(name), value);
      box.addEventListener("change", () => {
        if (box.checked) state.on.add(name);
        else state.on.delete(name);
        redraw();
      });
      for (const [event, hover] of [
        ["pointerenter", name],
        ["pointerleave", ""],
        ["focusin", name],
        ["focusout", ""],
      ])
        label.addEventListener(event, () => {
          state.hover = hover;
          for (const line of svg.querySelectorAll("[data-bound]"))
            line.classList.toggle("lit", line.getAttribute("data-bound") === hover);
        });
      return { box, label, value };
    }

    function open() {
      state.reading = "atan2";
      for (const choice of readings.querySelectorAll("input"))
        choice.checked = choice.value === state.reading;
      turnOn(names.filter(isUsed));
    }

    /** @type {(on: string[]) => void} */
    function turnOn(on) {
      state.on = new Set(on);
      for (const [name, { box: input }] of boxes) input.checked = state.on.has(name);
      redraw();
    }

    function redraw() {
      drawn = picture(svg, SQUARE, AROUND, true);
      clear(drawn);
      const all = straightBounds(robot, state.reading);
      const straight = all.filter((bound) => state.on.has(nameOf(bound)));
      const sides = box(straight, SQUARE);
      fillRegion(sides);
      jointAxes(drawn, 90);
      drawLines(all, sides);
      const [x, y] = drawn.at(home);
      const cross = { class: "cross", d: `M${x - 7} ${y}h14M${x} ${y - 7}v14` };
      svg.append(make("path", cross), make("text", { x: x + 8, y: y - 6 }, "home"));
      for (const bound of all) {
        const value = boxes.get(nameOf(bound))?.value;
        const sign = bound.k === 1 ? "≤" : "≥";
        if (value) value.textContent = `q${"₁₂"[bound.joint]} ${sign} ${degrees(bound.value, 2)}`;
      }
      tell(straight, sides);
    }

    for (const wall of walls)
      for (const k of [1, 2]) {
        const value = boxes.get(nameOf({ ...wall, k }))?.value;
        if (value) value.textContent = k === 1 ? "q₂ ≤ upper root" : "q₂ ≥ lower root";
      }

    /** What every bound that is on leaves, cut out exactly: the box, and in it one clip a bound.
     * @type {(sides: BoxSide[][]) => void} */
    function fillRegion(sides) {
      const [[left, right], [bottom, top]] = sides.map((pair) => pair.map((side) => side.value));
      if (left > right || bottom > top) return;
      /** @type {SVGElement} */
      let inside = layer(drawn, "region");
      const whole = "M-9 -9H9999V9999H-9Z";
      for (const wall of walls) {
        for (const k of [1, 2]) {
          if (!state.on.has(nameOf({ ...wall, k }))) continue;
          const id = `${svg.id}-${wall.boundary}-${k}`;
          const clip = make("clipPath", { id });
          const d = whole + curvePath(wall.rows, k, drawn, true);
          clip.append(make("path", { d, "clip-rule": "evenodd" }));
          svg.append(clip);
          inside = inside.appendChild(make("g", { "clip-path": `url(#${id})` }));
        }
      }
      const corners = [
        [left, bottom],
        [right, bottom],
        [right, top],
        [left, top],
      ];
      inside.append(make("path", { class: "home", d: pathText(corners.map(drawn.at), true) }));
    }

    /** @type {(all: StraightBound[], sides: BoxSide[][]) => void} */
    function drawLines(all, sides) {
      const group = layer(drawn, "lines");
      const binding = new Set(sides.flat().map((side) => side.by));
      /** @type {(name: string, d: string, binds: boolean) => void} */
      const add = (name, d, binds) => {
        const on = state.on.has(name) ? (binds ? "binds" : "on") : "off";
        const line = make("path", { class: `bound ${on}`, d, "data-bound": name });
        ownColour(robot, line, `B${name.split(",")[0]}`);
        line.classList.toggle("lit", state.hover === name);
        group.append(line);
      };
      for (const bound of all) {
        const ends = SQUARE[1].map((end) =>
          bound.joint === 0 ? [bound.value, end] : [end, bound.value],
        );
        add(nameOf(bound), pathText(ends.map(drawn.at)), binding.has(nameOf(bound)));
      }
      for (const wall of walls)
        for (const k of [1, 2])
          add(nameOf({ ...wall, k }), curvePath(wall.rows, k, drawn, false), true);
      nameSides(sides);
    }

    /** @type {(sides: BoxSide[][]) => void} */
    function nameSides(sides) {
      const { left, top, right, bottom } = drawn.box;
      for (const [joint, pair] of sides.entries()) {
        for (const [side, { value, by }] of pair.entries()) {
          if (!by || Math.abs(value) > Math.PI) continue;
          const [x, y] = drawn.at([value, value]);
          const at =
            joint === 0
              ? { x: x + (side ? 5 : -5), y: top + 16, "text-anchor": side ? "start" : "end" }
              : { x: right - 4, y: y - 6, "text-anchor": "end" };
          at.x = Math.min(right - 2, Math.max(left + 2, at.x));
          at.y = Math.min(bottom - 4, at.y);
          const text = make("text", { class: "arc-name", ...at }, written(by));
          svg.append(ownColour(robot, text, `B${by.split(",")[0]}`));
        }
      }
    }

    /** @type {(straight: StraightBound[], sides: BoxSide[][]) => void} */
    function tell(straight, sides) {
      const on = walls.flatMap((wall) => {
        const kept = [1, 2].filter((k) => state.on.has(nameOf({ ...wall, k })));
        return kept.length > 0 ? [{ wall, kept }] : [];
      });
      const violated = violatedBounds(
        straight,
        on.map(({ wall }) => wall),
        home,
      ).filter((name) => state.on.has(name));
      const ranges = sides.map((pair, joint) => {
        const [low, high] = pair.map(
          ({ value, by }) => `${degrees(value, 2)}${by ? "" : " (edge of the square)"}`,
        );
        return `q${"₁₂"[joint]} from ${low} to ${high}`;
      });
      const empty = sides.some(([low, high]) => low.value > high.value);
      const left = empty
        ? "Nothing is left."
        : `What is left: ${ranges.join(", ")}${on.length > 0 ? ", less what the curves cut off" : ""}.`;
      const cut = violated.map(written).join(", ");
      const where = violated.length > 0 ? `Home is cut off by ${cut}.` : "Home is inside.";
      status.say(`${where} ${left}`, violated.length > 0 || empty);
    }

    qboundParts.lightable(root);
    whenWidthChanges(figure, redraw);
  }

  qboundFigures.switches = Object.assign(show, {
    straightBounds,
    curvedWalls,
    violatedBounds,
    box,
    curveRows,
    SIX,
  });
}
