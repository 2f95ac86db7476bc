"use strict";
/* What the figures that one moves in a chapter share: boxes to tick, words that say what holds. */
const qboundParts = (() => {
  const { addArm, element, handle, isInside, make, newPrefix, number, placeArm } = qboundEngine;
  const { valueRow } = qboundEngine;

  /** A box to tick.
   * @type {(text: string, checked: boolean, change: (checked: boolean) => void) => HTMLLabelElement} */
  function tick(text, checked, change) {
    const box = element("input", { type: "checkbox", checked });
    box.addEventListener("change", () => change(box.checked));
    return element("label", { className: "check" }, box, text);
  }

  /** @type {(text: string, press: () => void) => HTMLButtonElement} */
  function button(text, press) {
    const made = element("button", { type: "button", textContent: text });
    made.addEventListener("click", press);
    return made;
  }

  /** Buttons side by side, with what they do.
   * @type {(...all: [string, () => void][]) => HTMLParagraphElement} */
  function buttons(...all) {
    return element(
      "p",
      { className: "buttons" },
      ...all.map(([text, press]) => button(text, press)),
    );
  }

  /** What holds now: seen at once, spoken when the hand has come to rest. It is as high as the
      longest text makes it, so that nothing moves under a hand that drags.
   * @type {(longest: string) => StatusLine} */
  function statusLine(longest) {
    const [text, room] = [element("span", {}), element("span", { ariaHidden: "true" }, longest)];
    const seen = element("p", { className: "status" }, text, room);
    const spoken = element("p", { className: "unseen", role: "status" });
    let [timer, told] = [0, ""];
    return {
      seen,
      spoken,
      say(words, bad) {
        text.textContent = words;
        seen.classList.toggle("violated", bad);
        told ||= words; // what a figure opens with is read where it stands
        window.clearTimeout(timer);
        timer = window.setTimeout(() => {
          if (words !== told) spoken.textContent = words;
          told = words;
        }, 700);
      },
    };
  }

  /** A picture with a title, and words for those who do not see it.
   * @type {(label: string, title?: string) => { figure: HTMLElement, svg: SVGSVGElement }} */
  function canvas(label, title) {
    const svg = make("svg", { role: "img", "aria-label": label });
    svg.id = `${newPrefix()}picture`;
    const head = title ? [element("p", { className: "picture-title" }, title)] : [];
    return { figure: element("div", { className: "picture" }, ...head, svg), svg };
  }

  /** Call at once, and whenever the element has a new width.
   * @type {(watched: HTMLElement, draw: () => void) => void} */
  function whenWidthChanges(watched, draw) {
    let width = -1;
    new ResizeObserver(() => {
      if (Math.abs(watched.clientWidth - width) < 1) return;
      width = watched.clientWidth;
      draw();
    }).observe(watched);
    width = watched.clientWidth;
    draw();
  }

  /** @type {(angle: number, digits?: number) => string} */
  function degrees(angle, digits = 1) {
    return `${number((angle * 180) / Math.PI, digits)}°`;
  }

  /** Room around a picture of two joint angles. */
  const AROUND = { left: 62, right: 18, top: 12, bottom: 38 };

  /** @template T
   * @param {T[]} all
   * @param {number} index
   * @param {T} value */
  function replaced(all, index, value) {
    return all.map((old, i) => (i === index ? value : old));
  }

  /** A slider and a field for each free joint, in degrees; `turn` hears of radians.
   * @type {(robot: Robot, turn: (joint: number, value: number) => void) => SetRow[]} */
  function jointRows(robot, turn) {
    const look = { low: -180, high: 180, step: 0.1, digits: 1, unit: "°" };
    return robot.free.map((j, k) =>
      valueRow({ ...look, name: `q${"₁₂"[k]}`, spoken: `q${k + 1} in degrees` }, (value) =>
        turn(j, (value * Math.PI) / 180),
      ),
    );
  }

  /** Handles of an arm of two links: a dot at the elbow, a square at the tool.
   * @type {(svg: SVGSVGElement) => { elbow: Handle, tool: Handle }} */
  function armHandles(svg) {
    const square = { class: "handle", x: -7, y: -7, width: 14, height: 14, rx: 2 };
    const elbow = handle(svg, make("circle", { class: "handle", r: 6 }));
    return { elbow, tool: handle(svg, make("rect", square)) };
  }

  /** Numbers of an axis in degrees, one every so many, between two angles in rad.
   * @type {(low: number, high: number, step: number) => JointAxis["ticks"]} */
  function degreeTicks(low, high, step) {
    const [from, to] = [low, high].map((value) => (value * 180) / Math.PI / step);
    const first = Math.ceil(from - 1e-9);
    return Array.from({ length: Math.floor(to + 1e-9) - first + 1 }, (_, i) => {
      const value = (first + i) * step;
      return { value: (value * Math.PI) / 180, text: String(value).replace("-", "−") };
    });
  }

  /** Axes of q1 and q2 in degrees, with a number every so many.
   * @type {(drawn: Picture, step: number) => void} */
  function jointAxes(drawn, step) {
    const { left, top, right, bottom } = drawn.box;
    const [low, high] = [drawn.from([left, bottom]), drawn.from([right, top])];
    const axes = [0, 1].map((k) => ({
      name: `q${k + 1}`,
      unit: "°",
      ticks: degreeTicks(low[k], high[k], step),
    }));
    qboundEngine.drawAxes(drawn, axes);
  }

  /** The arm's parts in a picture of its plane, to be moved by `moveArm`.
   * @type {(robot: Robot, drawn: Picture) => PlanePicture} */
  function armParts(robot, drawn) {
    const none = make("path", {});
    const rest = { group: make("g", {}), mark: none, room: make("circle", {}), walls: [] };
    return { ...drawn, ...addArm(robot, drawn), ...rest, path: none, ghost: none };
  }

  /** Show the arm in a pose; the boundaries `lit` stand out with their points, as violated ones if
      not said otherwise.
   * @type {(robot: Robot, drawn: PlanePicture, q: Pose, lit?: Iterable<string>, violated?: boolean) => void} */
  function moveArm(robot, drawn, q, lit = [], violated = true) {
    const names = new Set(lit);
    const walls = robot.boundaries.filter((wall) => names.has(wall.name));
    const points = new Set(walls.flatMap((wall) => wall.points));
    const shown = { q, show: { names: false } };
    placeArm(robot, drawn, /** @type {State} */ (/** @type {unknown} */ (shown)), {
      violated: violated ? names : new Set(),
      bold: names,
      closest: null,
      boundaries: names,
      points,
      named: points,
    });
  }

  /** @type {(element: SVGElement, point: Point) => void} */
  function moveTo(element, [x, y]) {
    element.setAttribute("transform", `translate(${x.toFixed(2)} ${y.toFixed(2)})`);
  }

  /** Whole turns of the joints that wrap: none, and one back or on.
   * @type {(robot: Robot) => Pair[]} */
  function turns(robot) {
    const [first, second] = robot.views.map(({ wraps }) =>
      wraps ? [0, -2 * Math.PI, 2 * Math.PI] : [0],
    );
    return first.flatMap((a) => second.map((b) => [a, b]));
  }

  /** The number of the region in which a pose lies, from 1 as the library counts; null for none.
   * @type {(robot: Robot, pair: Pair) => number | null} */
  function regionAt(robot, pair) {
    const all = turns(robot).map((by) => pair.map((value, k) => value + by[k]));
    /** @type {(component: Component, at: Pair) => boolean} */
    const holds = ({ loops }, at) =>
      loops.filter((loop) =>
        isInside(
          loop.flatMap((arc) => arc.points),
          at,
        ),
      ).length %
        2 ===
      1;
    const i = robot.components.findIndex((one) => all.some((at) => holds(one, at)));
    return i < 0 ? null : i + 1;
  }

  /** The pose with one joint turned so that what it carries points to a place: the next joint, or
      the tool.
   * @type {(robot: Robot, q: Pose, joints: number[], target: Point) => Pose} */
  function turnedToward(robot, q, [joint, next], target) {
    const { angle, framesOf, minus, pointPlaces, project, viewAxes, wrapped } = qboundEngine;
    /** The angle about the joint from what it carries to the target.
     * @type {(pose: Pose) => number} */
    const turn = (pose) => {
      const [frames, axes] = [framesOf(robot, pose), viewAxes(robot, pose)];
      const tool = pointPlaces(robot, pose)[robot.tool];
      const at = project(axes, frames[joint + 1].place);
      const carried = project(axes, next === undefined ? tool : frames[next + 1].place);
      return wrapped(angle(minus(target, at)) - angle(minus(carried, at)));
    };
    /** @type {(change: number) => Pose} */
    const turned = (change) => q.map((value, j) => (j === joint ? value + change : value));
    const rest = turn(q);
    const [one, other] = [turned(rest), turned(-rest)]; // whichever way the joint counts
    return Math.abs(turn(one)) <= Math.abs(turn(other)) ? one : other;
  }

  /** Let the words of a page light what they name: the parts with that `data-boundary`.
   * @type {(root: HTMLElement) => void} */
  function lightable(root) {
    root.addEventListener("qbound-light", (event) => {
      const name = event instanceof CustomEvent ? event.detail : null;
      for (const part of root.querySelectorAll("[data-boundary]"))
        part.classList.toggle("lit", part.getAttribute("data-boundary") === name);
    });
  }

  /** Whether two poses are one and the same: pictures that are drawn anew move no arm.
   * @type {(one: Pair, other: Pair) => boolean} */
  function isSame(one, other) {
    return one.every((value, k) => Math.abs(value - other[k]) < 1e-9);
  }

  return {
    isSame,
    lightable,
    turns,
    regionAt,
    tick,
    buttons,
    statusLine,
    canvas,
    whenWidthChanges,
    degrees,
    AROUND,
    replaced,
    jointRows,
    armHandles,
    degreeTicks,
    jointAxes,
    turnedToward,
    armParts,
    moveArm,
    moveTo,
  };
})();
