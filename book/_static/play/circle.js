"use strict";
/* Theorem 2: where a cos q + b sin q reaches c on the circle, and what eq. (31) says of it. */
{
  const TURN = 2 * Math.PI;
  const OPENS = [-1.5, 12.41, -7.5]; // the first component of B2, in cm
  const ARROW = 16; // length of the vector (a, b) that is drawn as long as the radius
  const MOST = 20; // largest size of a coefficient that the sliders reach

  const LONGEST =
    "Two roots: −100.00° and 100.00°; the sum reaches c on the 200.00° between them. Eq. (31) is 600.00° long, a full turn or more: it excludes no angle. Since a < 0, its ends are not even roots.";

  /* --- arithmetic: tests/book/test_play_arithmetic.py runs it beside the library -------------------- */

  /** The interval of eq. (31), k = 0: `quadrant` reads its arctangent as atan2, `struck` leaves out
      the -2 pi of its second line. None where the formula has no value.
   * @type {(a: number, b: number, c: number, quadrant: boolean, struck: boolean) => Pair | null} */
  function printed(a, b, c, quadrant, struck) {
    const { alpha, count } = qboundEngine.circleArc(a, b, c);
    if (count < 1 || (a === 0 && !quadrant)) return null;
    const theta = quadrant ? Math.atan2(b, a) : Math.atan(b / a);
    return [theta - alpha - (struck ? 0 : TURN), theta + alpha];
  }

  /* --- the figure ------------------------------------------------------------------------------- */

  /** @type {(from: number, to: number, radius: (angle: number) => number) => Point[]} */
  function sweep(from, to, radius) {
    const steps = Math.max(2, Math.ceil((to - from) / 0.03));
    return Array.from({ length: steps + 1 }, (_, i) => {
      const angle = from + ((to - from) * i) / steps;
      return [radius(angle) * Math.cos(angle), radius(angle) * Math.sin(angle)];
    });
  }

  /** A printed interval, wound round the circle: what it covers twice is seen twice.
   * @type {(interval: Pair | null, radius: number) => Point[]} */
  function spiral(interval, radius) {
    if (!interval) return [];
    const [low, high] = interval;
    return sweep(low, high, (angle) => radius + (0.1 * (angle - low)) / TURN);
  }

  /** @type {FigureKind} */
  function show(root) {
    const { between, circleArc, clear, draggable, element, handle, layer, make } = qboundEngine;
    const { pathText, picture, placeAt, valueRow, wrapped } = qboundEngine;
    const { buttons, canvas, degrees, moveTo, statusLine, tick, whenWidthChanges } = qboundParts;
    const state = { a: 0, b: 0, c: 0, q: 0, quadrant: false, struck: false };
    const { figure, svg } = canvas("The unit circle, cut by the line a x + b y = c.");
    const status = statusLine(LONGEST);
    /** @type {ReturnType<typeof newPicture>} */
    let drawn;

    /** @type {(change: Partial<typeof state>) => void} */
    const set = (change) => {
      Object.assign(state, change);
      update();
    };

    function opening() {
      const [a, b, c] = OPENS;
      set({ a, b, c, q: 2.6 });
    }

    /* Values */
    const coefficient = { low: -MOST, high: MOST, step: 0.01, digits: 2, unit: "cm" };
    const turn = { low: -180, high: 180, step: 0.1, digits: 1, unit: "°" };
    const rows = {
      a: valueRow({ ...coefficient, name: "a", spoken: "a in cm" }, (a) => set({ a })),
      b: valueRow({ ...coefficient, name: "b", spoken: "b in cm" }, (b) => set({ b })),
      c: valueRow({ ...coefficient, name: "c", spoken: "c in cm" }, (c) => set({ c })),
      q: valueRow({ ...turn, name: "q", spoken: "q in degrees" }, (q) =>
        set({ q: (q * Math.PI) / 180 }),
      ),
    };
    const touch = (/** @type {number} */ side) => set({ c: side * Math.hypot(state.a, state.b) });
    const row = buttons(
      ["As it opens", opening],
      ["c = d", () => touch(1)],
      ["c = −d", () => touch(-1)],
    );
    const ticks = [
      tick("Read the arctangent of b/a as atan2(b, a)", false, (quadrant) => set({ quadrant })),
      tick("Leave out −2π in the second line", false, (struck) => set({ struck })),
    ];
    const cells = [0, 1, 2].map(() => [0, 1, 2].map(() => element("td", { className: "number" })));
    const table = intervalTable(cells);
    const side = element("div", {}, ...Object.values(rows).map(({ row }) => row), row, ...ticks);
    root.append(
      element(
        "p",
        { className: "hint" },
        "Drag the arrow (a, b), the line through its square, or the round point q; or set numbers.",
      ),
      status.seen,
      status.spoken,
      element("div", { className: "panels" }, figure, side),
      table,
    );

    /* Pictures */
    function newPicture() {
      const margin = { left: 4, right: 4, top: 4, bottom: 4 };
      const fitted = picture(
        svg,
        [
          [-1.8, 1.8],
          [-1.8, 1.8],
        ],
        margin,
        true,
      );
      clear(fitted);
      const group = layer(fitted, "circle");
      /** @type {(name: string) => SVGPathElement} */
      const path = (name) => group.appendChild(make("path", { class: name }));
      /** @type {(name: string, look?: string) => SVGPathElement} */
      const interval = (name, look = name) => {
        const made = path(look);
        made.dataset.boundary = name; // for the words of the page
        return made;
      };
      const circle = sweep(0, TURN, () => 1);
      const parts = {
        above: path("home"),
        axes: path("grid"),
        circle: path("circle-line"),
        line: path("wall"),
        arc: interval("arc", "arc wide"),
        proof: interval("proof"),
        theorem: interval("printed"),
        arrow: path("wall"),
        names: ["θ − α", "θ + α", "(a, b)", "a cos q + b sin q = c"].map((text) =>
          group.appendChild(make("text", { class: "line-name", "text-anchor": "middle" }, text)),
        ),
        roots: [0, 1].map(() => group.appendChild(make("circle", { class: "root", r: 5 }))),
      };
      parts.circle.setAttribute("d", pathText(circle.map(fitted.at), true));
      const cross = [
        [
          [-1.8, 0],
          [1.8, 0],
        ],
        [
          [0, -1.8],
          [0, 1.8],
        ],
      ];
      parts.axes.setAttribute("d", cross.map((ends) => pathText(ends.map(fitted.at))).join(""));
      const vector = handle(svg, make("path", { class: "handle", d: "M-8 6L0 -9L8 6Z" }));
      const cut = handle(
        svg,
        make("rect", { class: "handle", x: -6, y: -6, width: 12, height: 12 }),
      );
      const point = handle(svg, make("circle", { class: "handle dot", r: 8 }));
      return { ...fitted, ...parts, vector, cut, point };
    }

    function draw() {
      drawn = newPicture();
      update();
    }

    function update() {
      if (!drawn) return;
      const { a, b, c, q, quadrant, struck } = state;
      const found = circleArc(a, b, c);
      const { d, theta, alpha, count, empty } = found;
      const [ux, uy] = [Math.cos(theta), Math.sin(theta)];
      const height = d > 0 ? between(c / d, -1.7, 1.7) : c > 0 ? 1.7 : -1.7;
      /** The point at so many radii along (a, b) and across.
       * @type {(along: number, across: number) => Point} */
      const at = (along, across) => drawn.at([along * ux - across * uy, along * uy + across * ux]);
      /** @type {(path: SVGPathElement, points: Point[], closed?: boolean) => void} */
      const put = (path, points, closed) => path.setAttribute("d", pathText(points, closed));
      put(drawn.above, [at(height, -5), at(height, 5), at(6, 5), at(6, -5)], true);
      put(drawn.line, [at(height, -5), at(height, 5)]);
      put(drawn.arrow, [at(0, 0), at(d / ARROW, 0)]);
      const all = count < 1 && !empty;
      const arc = all ? sweep(0, TURN, () => 1) : sweep(theta - alpha, theta + alpha, () => 1);
      put(drawn.arc, empty ? [] : arc.map(drawn.at));
      const interval = printed(a, b, c, quadrant, struck);
      const proof = interval && [interval[1] - TURN, interval[1]];
      put(drawn.proof, spiral(proof, 1.12).map(drawn.at));
      put(drawn.theorem, spiral(interval, 1.3).map(drawn.at));
      const ends = [theta - alpha, theta + alpha];
      for (const [i, root] of drawn.roots.entries()) {
        root.toggleAttribute("hidden", count < 1);
        placeAt(root, drawn.at([Math.cos(ends[i]), Math.sin(ends[i])]), "c");
        drawn.names[i].toggleAttribute("hidden", count < 2);
        placeAt(drawn.names[i], drawn.at([0.78 * Math.cos(ends[i]), 0.78 * Math.sin(ends[i])]));
      }
      placeAt(drawn.names[2], at((0.55 * d) / ARROW, 0.24)); // beside the arrow: around its tip are arcs
      const lean = 90 - (theta * 180) / Math.PI; // of the line, so that its name is not upside down
      const [lineX, lineY] = at(height - (uy < 0 ? -0.12 : 0.2), uy < 0 ? -0.1 : 0.1);
      placeAt(drawn.names[3], [lineX, lineY]);
      const turned = lean - 180 * Math.round(lean / 180);
      drawn.names[3].setAttribute("transform", `rotate(${turned} ${lineX} ${lineY})`);
      const inside = a * Math.cos(q) + b * Math.sin(q) >= c;
      moveTo(drawn.vector.group, at(d / ARROW, 0));
      drawn.vector.mark.setAttribute("transform", `rotate(${90 - (theta * 180) / Math.PI})`);
      moveTo(drawn.cut.group, at(height, 0));
      moveTo(drawn.point.group, drawn.at([Math.cos(q), Math.sin(q)]));
      drawn.point.mark.classList.toggle("violated", !inside);
      rows.a.set(a);
      rows.b.set(b);
      rows.c.set(c);
      rows.q.set((wrapped(q) * 180) / Math.PI);
      const own = empty ? null : all ? [-Math.PI, Math.PI] : ends;
      for (const [i, one] of [own, proof, interval].entries()) fill(cells[i], one);
      status.say(`${rootsText(found, c)} ${printedText(found, interval)}`, !inside);
    }

    /** @type {(row: HTMLElement[], interval: Pair | null) => void} */
    function fill(row, interval) {
      const texts = interval
        ? [interval[0], interval[1], interval[1] - interval[0]].map((angle) => degrees(angle, 2))
        : ["–", "–", "–"];
      for (const [i, text] of texts.entries()) row[i].textContent = text;
    }

    draggable(svg, (pixel, held) => {
      const [x, y] = drawn.from(pixel);
      const { a, b } = state;
      const d = Math.hypot(a, b);
      if (held === drawn.vector.room) {
        const cut = (/** @type {number} */ value) =>
          Math.round(100 * between(value, -MOST, MOST)) / 100;
        set({ a: cut(ARROW * x), b: cut(ARROW * y) });
      } else if (held === drawn.cut.room) {
        if (d === 0) return;
        const c = Math.round(100 * (a * x + b * y)) / 100;
        const near = Math.abs(Math.abs(c) - d) < 0.03 * d; // the tangent cannot be hit by hand
        set({ c: near ? Math.sign(c) * d : between(c, -MOST, MOST) });
      } else {
        set({ q: Math.atan2(y, x) });
      }
    });
    opening();
    qboundParts.lightable(root);
    whenWidthChanges(figure, draw);

    /** @type {(found: CircleArc, c: number) => string} */
    function rootsText({ d, theta, alpha, count, empty }, c) {
      if (count === -1) return "a = b = c = 0: every angle is a root.";
      if (d === 0)
        return c > 0
          ? "a = b = 0 < c: the sum reaches c at no angle."
          : "a = b = 0 > c: the sum reaches c at every angle.";
      if (empty) return "c > d: no root, and the sum reaches c at no angle.";
      if (count === 0) return "c < −d: no root, and the sum reaches c at every angle.";
      const low = degrees(theta - alpha, 2);
      if (count === 1)
        return c > 0
          ? `c = d: the line touches, with one double root, ${degrees(theta, 2)}; the sum reaches c there only.`
          : `c = −d: the line touches, with one double root, ${degrees(theta + Math.PI, 2)}; the sum reaches c at every angle.`;
      return `Two roots: ${low} and ${degrees(theta + alpha, 2)}; the sum reaches c on the ${degrees(2 * alpha, 2)} between them.`;
    }

    /** @type {(found: CircleArc, interval: Pair | null) => string} */
    function printedText({ theta, alpha, count }, interval) {
      if (count < 1) return "Eq. (31) has no value here.";
      if (!interval) return "For a = 0 the quotient b/a of eq. (31) does not exist.";
      const length = interval[1] - interval[0];
      const wrong = Math.abs(Math.sin((interval[1] - theta - alpha) / 2)) > 1e-9;
      if (length >= TURN - 1e-9) {
        const roots = wrong ? " Since a < 0, its ends are not even roots." : "";
        return `Eq. (31) is ${degrees(length, 2)} long, a full turn or more: it excludes no angle.${roots}`;
      }
      if (wrong)
        return "Eq. (31) is now shorter than a turn, but since a < 0 it lies on the wrong side.";
      return "Eq. (31) is now the arc itself.";
    }
  }

  /** @type {(cells: HTMLElement[][]) => HTMLElement} */
  function intervalTable(cells) {
    const { element, legendKey } = qboundEngine;
    const names = [
      ["arc wide", "a cos q + b sin q ≥ c"],
      ["proof", "proof, eq. (39)"],
      ["printed", "theorem, eq. (31)"],
    ];
    const head = ["interval", "from", "to", "length"].map((text, i) =>
      element("th", { scope: "col", className: i ? "number" : "" }, text),
    );
    const body = names.map(([name, text], i) => {
      const title = element("th", { scope: "row" }, legendKey(name, "M0 5H22", 10), text);
      return element("tr", {}, title, ...cells[i]);
    });
    const table = element("table", { className: "intervals" });
    table.append(element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...body));
    return table;
  }

  qboundFigures.circle = Object.assign(show, { printed, OPENS });
}
