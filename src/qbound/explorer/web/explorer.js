/* The explorer's state and what a reader does to it: drag, type, press, play. One way round: an
   action changes the state, `refresh` shows it. */

const robot = JSON.parse(document.getElementById("robot-data").textContent);
const byId = (id) => document.getElementById(id);
const DEGREE = Math.PI / 180;
const COLUMNS = 240; // fibres of a slice: one every pixel and a half
const NEAR_SINGULAR = 0.02; // of the largest |det J|: here the arm looks stretched
const reachable = planeBox(robot);
const calm = window.matchMedia("(prefers-reduced-motion: reduce)");

const state = {
  q: [...robot.q],
  scale: robot.polygon ? robot.polygon.largest : 0,
  walk: 0,
  progress: 0,
  speed: 1,
  show: { workspace: true, polygon: Boolean(robot.polygon), sample: false, names: false },
  path: null, // stops of the path that is drawn
  mirror: null, // the pose that the task asks for
  hover: null, // a boundary pointed at in the table
};
let slice = null; // what depends on the held joints alone
let joints = null; // the picture of joint space
let plane = null; // the picture of the arm
let playing = 0; // the animation frame that is asked for

/* --- what depends on the held joints ----------------------------------------------------------- */

/** The slice's cells, arcs, images and singular lines; the library's exact arcs where it has them.
 * @type {() => Slice} */
function findSlice() {
  const problem = sliceProblem(robot, state.q);
  const cells = sliceCells(problem, COLUMNS);
  const home = pieceAt(cells, inView(robot.free.map((j) => robot.q[j])));
  const exact = robot.joints.every((_, j) => robot.free.includes(j) || state.q[j] === robot.q[j]);
  const map = toolMap(robot, state.q);
  const arm = armOf(map);
  const regular = map.planar && sweepsAnArea(arm, robot.reach);
  const inside = cells.filter((cell) => cell.piece === home);
  return {
    cells,
    home,
    exact,
    map,
    arm,
    regular,
    arcs: exact
      ? exactArcs()
      : cellEdges(problem, cells).map((edge) => ({
          ...edge,
          branch: "",
          home: edge.piece === home,
        })),
    images: regular ? postureImages(map, arm, inside, problem.ranges[1]) : {},
    lines: regular
      ? singularValues(arm).flatMap((value) => turnsWithin(map.kinds[1], value, robot.views[1]))
      : [],
    largest: largestDeterminant(map),
  };
}

/** @type {() => DrawnArc[]} */
function exactArcs() {
  return robot.components.flatMap((component) =>
    component.loops.flatMap((loop) => loop.map((arc) => ({ ...arc, home: component.home }))),
  );
}

/** @type {(map: ToolMap) => number} */
function largestDeterminant(map) {
  const steps = Array.from({ length: 37 }, (_, i) => i / 36);
  const [a, b] = robot.views;
  const value = (s, t) =>
    Math.abs(determinant(map, [a.low + s * (a.high - a.low), b.low + t * (b.high - b.low)]));
  return Math.max(...steps.flatMap((s) => steps.map((t) => value(s, t))));
}

/** @type {() => SamplePose[]} */
function judgeSample() {
  return robot.sample.map((pair) => {
    const q = withPair(robot, state.q, pair);
    return { pair, safe: isSafe(margins(robot, q)), tool: toolAt(slice.map, pair) };
  });
}

/* --- poses ------------------------------------------------------------------------------------- */

/** Bring both free joints into what is drawn: turn whole turns, stop at limits.
 * @type {(pair: Pair) => Pair} */
function inView(pair) {
  return pair.map((value, k) => {
    const { low, high, wraps } = robot.views[k];
    return wraps
      ? value - TURN * Math.floor((value - low) / TURN)
      : Math.min(high, Math.max(low, value));
  });
}

/** @type {(q: Pose) => Pair} */
function pairOf(q) {
  return robot.free.map((j) => q[j]);
}

/** @type {(pair: Pair) => void} */
function setPair(pair) {
  state.q = withPair(robot, state.q, inView(pair));
}

/** The reader moved the arm: a running path stops.
 * @type {(pair: Pair) => void} */
function movePose(pair) {
  stop();
  setPair(pair);
  refresh();
}

/** Bring the tool to a place of the plane, in the posture that it has.
 * @type {(target: Point) => void} */
function moveTool(target) {
  if (!slice.regular) return;
  const now = pairOf(state.q);
  const side = determinant(slice.map, now) >= 0;
  const found = possible(robot, slice.arm, target);
  const same = found.filter((pair) => determinant(slice.map, pair) >= 0 === side);
  const best = nearest(same.length > 0 ? same : found, now);
  if (best) movePose(best);
}

/** @type {(pairs: Pair[], now: Pair) => Pair | null} */
function nearest(pairs, now) {
  const far = (pair) =>
    pair.reduce((sum, value, k) => sum + Math.abs(shortWay(k, value - now[k])), 0);
  return pairs.reduce((best, pair) => (best === null || far(pair) < far(best) ? pair : best), null);
}

/** @type {(k: number, difference: number) => number} */
function shortWay(k, difference) {
  return robot.views[k].wraps ? difference - TURN * Math.round(difference / TURN) : difference;
}

/** The same place of the tool in the other posture, if the joints' limits allow it.
 * @type {() => Pair | null} */
function otherPosture() {
  if (!slice.regular) return null;
  const now = pairOf(state.q);
  const side = determinant(slice.map, now) >= 0;
  const found = possible(robot, slice.arm, toolAt(slice.map, now)).filter(
    (pair) => determinant(slice.map, pair) >= 0 !== side,
  );
  return nearest(found, now);
}

/* --- words ------------------------------------------------------------------------------------- */

/** @type {(value: number, digits: number) => string} */
function number(value, digits) {
  return value
    .toFixed(digits)
    .replace(/^-(0(\.0+)?)$/, "$1")
    .replace("-", "−");
}

/** @type {(value: number) => string} */
function length(value) {
  return `${number(value, robot.reach < 10 ? 4 : 2)} ${robot.length_unit}`;
}

/** @type {(margin: Margin) => string} */
function marginText({ value, unit }) {
  return unit === "angle" ? `${number(value / DEGREE, 1)}°` : length(value);
}

/** @type {(j: number, value: number) => string} */
function jointText(j, value) {
  const joint = robot.joints[j];
  return joint.kind === "revolute" ? `${number(value / DEGREE, 1)}°` : length(value);
}

/** @type {(row: number) => string} */
function betweenText(row) {
  const limit = robot.limits[row - robot.boundaries.length]; // they follow the boundaries
  if (limit)
    return `${robot.rule === "paper" ? "window" : "limit"} of ${robot.joints[limit.joint].name}`;
  const wall = robot.boundaries[row];
  const points = wall.points.map((i) => robot.points[i].name);
  return wall.kind === "pair"
    ? `points ${points[0]} and ${points[1]}`
    : `point ${points[0]} and a wall`;
}

/** Whether the pose is safe, and whether the home pose can be reached from it.
 * @type {(found: Margin[]) => string[]} */
function statusText(found) {
  const bad = found.filter((one) => one.used && one.value < 0);
  if (bad.length > 0) {
    return [
      "Not safe.",
      bad
        .map((one) => `${one.name} is violated by ${marginText({ ...one, value: -one.value })}`)
        .join(", ") + ".",
    ];
  }
  const close = tightest(robot, found);
  const nearby = close
    ? `Closest: ${close.name}, ${marginText(close)} to spare.`
    : "Nothing bounds this arm.";
  const away = slice.home !== null && pieceAt(slice.cells, inView(pairOf(state.q))) !== slice.home;
  return [away ? "Safe, but cut off from home." : "Safe.", nearby];
}

/** @type {() => string} */
function postureText() {
  if (!slice.regular) return "The tool leaves the plane: move the arm in joint space.";
  const det = determinant(slice.map, pairOf(state.q));
  if (slice.lines.length === 0) return "One posture only: det J is never 0.";
  if (Math.abs(det) <= NEAR_SINGULAR * slice.largest)
    return "Singular: det J = 0. Here one posture turns into the other.";
  const other = otherPosture();
  const there =
    other === null
      ? "beyond a limit"
      : isSafe(margins(robot, withPair(robot, state.q, other)))
        ? "safe"
        : "not safe";
  return `Posture ${det > 0 ? "A (det J > 0)" : "B (det J < 0)"}. The other one at this place is ${there}.`;
}

/** The exact areas of the workspace, as the library found them for the slice it was given.
 * @type {() => string} */
function areaText() {
  if (!robot.workspace || !slice.exact || !state.show.workspace) return "";
  const area = (value) => `${Number(value.toPrecision(6))} ${robot.length_unit}²`;
  const { area: whole, covered_twice: twice } = robot.workspace;
  return `Reached from home: ${area(whole)}${twice > 0 ? `, of it ${area(twice)} in both postures` : ""}.`;
}

/* --- showing ----------------------------------------------------------------------------------- */

/** Everything anew: the window or a held joint has changed. */
function rebuild() {
  slice = findSlice();
  redraw();
}

/** Both pictures anew, from the slice there is. */
function redraw() {
  state.sample = state.show.sample ? judgeSample() : [];
  joints = drawJointSpace(robot, state, slice);
  plane = drawPlane(robot, state, slice, reachable);
  byId("joints-legend").replaceChildren(
    ...legend([
      ["home", "safe, with home"],
      ["away", "safe, cut off", slice.cells.some((cell) => cell.piece !== slice.home)],
      [
        "singular",
        slice.arm.kind === "rr"
          ? "arm stretched or folded: det J = 0"
          : "singular curve: det J = 0",
        slice.lines.length > 0,
      ],
      [
        "polygon",
        `polygon of the vertices, at scale ${number(state.scale, 4)}`,
        state.show.polygon && slice.exact,
      ],
      ["dots", "random, safe", state.show.sample],
      ["crosses", "random, not safe", state.show.sample],
    ]),
  );
  byId("plane-legend").replaceChildren(
    ...legend([
      ["workspace", "one safe posture", state.show.workspace && slice.regular],
      ["workspace twice", "both postures safe", state.show.workspace && slice.lines.length > 0],
      [
        "beyond",
        "behind a wall",
        robot.boundaries.some((wall) => wall.kind === "half-space" && wall.used),
      ],
    ]),
  );
  byId("area").textContent = areaText();
  if (robot.polygon) byId("show-polygon").disabled = !slice.exact;
  refresh();
}

/** @type {(rows: [name: string, text: string, shows?: boolean][]) => HTMLLIElement[]} */
function legend(rows) {
  return rows
    .filter(([, , shows]) => shows !== false)
    .map(([name, text]) => {
      const key = make("svg", {
        width: 22,
        height: 14,
        viewBox: "0 0 22 14",
        "aria-hidden": "true",
      });
      const shapes = {
        singular: "M0 7H22",
        polygon: "M1 12L11 2L21 12Z",
        dots: "M5 7h0M15 7h0",
        crosses: "M9 5l4 4m0 -4l-4 4",
      };
      const d = shapes[name] || "M0 0H22V14H0Z";
      for (const part of name === "workspace twice" ? [0, 1] : [0])
        key.append(make("path", { class: name, d, "data-part": part }));
      const row = document.createElement("li");
      row.append(key, text);
      return row;
    });
}

/** What moves with the pose. */
function refresh() {
  const found = margins(robot, state.q);
  const lit = litParts(found);
  const [x, y] = joints.at(inView(pairOf(state.q)));
  joints.group.setAttribute("transform", `translate(${x} ${y})`);
  joints.mark.classList.toggle("violated", lit.violated.size > 0);
  for (const arc of joints.arcs) arc.classList.toggle("lit", lit.bold.has(arc.dataset.boundary));
  for (const wall of plane.walls) wall.classList.toggle("lit", lit.bold.has(wall.dataset.boundary));
  placeArm(robot, plane, state, lit);
  plane.mark.classList.toggle("violated", lit.violated.size > 0);
  plane.room.toggleAttribute("hidden", !slice.regular);
  drawPaths();
  showStatus(found);
  showMargins(found, lit);
  showPose();
  showScale();
  showTask();
  remember();
}

/** The boundaries that stand out: violated ones, the one pointed at, and those that are near.
 * @type {(found: Margin[]) => Lit} */
function litParts(found) {
  const used = found.filter((one) => one.used);
  const violated = new Set(used.filter((one) => one.value < 0).map((one) => one.name));
  const bold = new Set([...violated, ...(state.hover ? [state.hover] : [])]);
  const near = used
    .filter((one) => one.unit === "length" && one.value < 0.04 * robot.reach)
    .map((one) => one.name);
  const boundaries = new Set([...bold, ...near]);
  const points = new Set(
    robot.boundaries.filter((wall) => bold.has(wall.name)).flatMap((wall) => wall.points),
  );
  return { violated, bold, boundaries, points };
}

function drawPaths() {
  const path = state.path || [];
  joints.path.setAttribute("d", pathText(path.map(joints.at)));
  const count = 30 * Math.max(1, path.length - 1);
  const steps = Array.from({ length: count + 1 }, (_, i) => i / count);
  const tool =
    path.length > 1 && slice.map.planar
      ? steps.map((s) => plane.at(toolAt(slice.map, alongPath(robot, path, s))))
      : [];
  plane.path.setAttribute("d", pathText(tool));
  joints.ghost.toggleAttribute("hidden", state.mirror === null);
  plane.ghost.toggleAttribute("hidden", state.mirror === null);
  if (state.mirror === null) return;
  moveTo(joints.ghost, joints.at(inView(state.mirror)), "c");
  plane.ghost.setAttribute("d", skeleton(robot, plane, withPair(robot, state.q, state.mirror)));
}

/** @type {(found: Margin[]) => void} */
function showStatus(found) {
  const [verdict, reason] = statusText(found);
  const strong = document.createElement("strong");
  strong.textContent = verdict;
  byId("status").replaceChildren(strong, reason);
  byId("status").classList.toggle("violated", !isSafe(found));
  byId("posture").textContent = postureText();
  byId("flip").disabled = otherPosture() === null;
  say(
    `${robot.free.map((j) => `${robot.joints[j].name} ${jointText(j, state.q[j])}`).join(", ")}. ${verdict} ${reason} ${postureText()}`,
  );
}

/** Tell a screen reader, once the arm rests.
 * @type {(text: string) => void} */
function say(text) {
  window.clearTimeout(say.timer);
  say.timer = window.setTimeout(() => {
    byId("live").textContent = text;
  }, 600);
}

/** @type {(found: Margin[], lit: Lit) => void} */
function showMargins(found, lit) {
  found.forEach((one, i) => {
    const row = byId("margins").children[i];
    row.lastElementChild.textContent = marginText(one);
    row.classList.toggle("lit", lit.violated.has(one.name));
  });
}

function showPose() {
  robot.joints.forEach((joint, j) => {
    const unit = joint.kind === "revolute" ? DEGREE : 1;
    const digits = joint.kind === "revolute" ? 1 : 4;
    for (const id of [`value-${j}`, `slide-${j}`]) {
      const input = byId(id);
      if (document.activeElement !== input || input.type === "range")
        input.value = Number((state.q[j] / unit).toFixed(digits));
    }
    byId(`slide-${j}`).setAttribute("aria-valuetext", jointText(j, state.q[j]));
  });
}

function showScale() {
  if (!robot.polygon) return;
  const { vertices, centroid, largest } = robot.polygon;
  byId("scaling").hidden = !slice.exact;
  byId("scale").value = state.scale;
  byId("scale-value").textContent = number(state.scale, 4);
  if (showScale.scale === state.scale) return;
  showScale.scale = state.scale;
  const least = smallestClearance(robot, robot.q, vertices, state.scale, centroid);
  const safe = state.scale <= largest;
  byId("clearance").textContent =
    least.name === null
      ? "No boundary has a length."
      : `${safe ? "Safe everywhere inside" : "Not safe everywhere"}. Smallest clearance ${length(least.value)} (${least.name}).`;
  byId("clearance").classList.toggle("lit", !safe);
}

/* --- the task: why the arm must stretch -------------------------------------------------------- */

/** @type {() => boolean} */
function hasTask() {
  return slice.regular && slice.arm.kind === "rr";
}

function setMirror() {
  state.mirror = inView(mirroredPose(slice.arm, pairOf(state.q)));
  state.sides = Math.sign(determinant(slice.map, pairOf(state.q)));
  state.crossed = false;
}

function showTask() {
  byId("task").hidden = !hasTask();
  if (!hasTask()) return;
  if (state.mirror === null) setMirror();
  const now = pairOf(state.q);
  const det = determinant(slice.map, now);
  if (Math.sign(det) !== state.sides) state.crossed = true;
  const gap = Math.max(...now.map((value, k) => Math.abs(shortWay(k, state.mirror[k] - value))));
  const bent = (i) => Math.abs(shortWay(1, now[1] - slice.lines[i])) > 45 * DEGREE;
  joints.singular.forEach((line, i) =>
    line.classList.toggle("lit", Math.abs(det) <= NEAR_SINGULAR * slice.largest && !bent(i)),
  );
  const text = taskText(det, gap < 6 * DEGREE);
  if (byId("task-text").textContent !== text) byId("task-text").textContent = text;
}

/** @type {(det: number, there: boolean) => string} */
function taskText(det, there) {
  if (there) {
    return (
      "There. On the way you crossed the dashed line, where the arm is stretched or folded. A mirrored pose bends " +
      "the other way, it is the other posture; so every way to it crosses that line."
    );
  }
  if (Math.abs(det) <= NEAR_SINGULAR * slice.largest) {
    return "Now both links lie in one line: det J = 0. The arm can go on and bend to either side.";
  }
  if (state.crossed)
    return "You are on the other side of the dashed line: the arm bends the other way. Go on to the dotted pose.";
  return "Bring the arm to its mirror image, the dotted arm. Can you get there without crossing the dashed line?";
}

/* --- paths that play --------------------------------------------------------------------------- */

function walkStops() {
  const corners = scaledPolygon(robot.polygon.vertices, state.scale, robot.polygon.centroid);
  return robot.polygon.walks[state.walk].map((i) => corners[i]);
}

/** @type {(stops: Pair[], from: number, each: (done: number) => void) => void} */
function play(stops, from, each) {
  stop();
  byId("plane").scrollIntoView({ block: "nearest", behavior: calm.matches ? "auto" : "smooth" });
  state.path = stops;
  byId("play").setAttribute("aria-pressed", "true");
  byId("play").textContent = "Pause";
  const duration = 14000 * pieceLengths(robot, stops).reduce((sum, piece) => sum + piece, 0);
  let [last, done] = [null, from];
  const step = (time) => {
    const passed = last === null ? 0 : Math.min(100, time - last);
    last = time;
    done = Math.min(1, done + (passed * state.speed) / duration);
    setPair(alongPath(robot, stops, done));
    each(done);
    refresh();
    if (done < 1) playing = window.requestAnimationFrame(step);
    else stop();
  };
  playing = calm.matches ? playCalmly(stops, from, each) : window.requestAnimationFrame(step);
}

/** With reduced motion: from stop to stop, without anything in between.
 * @type {(stops: Pair[], from: number, each: (done: number) => void) => number} */
function playCalmly(stops, from, each) {
  const pieces = pieceLengths(robot, stops);
  const whole = pieces.reduce((sum, piece) => sum + piece, 0);
  let reached = 0;
  const places = pieces
    .map((piece) => {
      reached += piece / whole;
      return reached;
    })
    .filter((s) => s > from + 1e-6);
  const step = () => {
    const next = Math.min(1, places.shift() ?? 1);
    setPair(alongPath(robot, stops, next));
    each(next);
    refresh();
    if (places.length > 0) play.timer = window.setTimeout(step, 1200 / state.speed);
    else stop();
  };
  step();
  return 0;
}

function stop() {
  window.cancelAnimationFrame(playing);
  window.clearTimeout(play.timer);
  playing = 0;
  byId("play").setAttribute("aria-pressed", "false");
  byId("play").textContent = "Play";
}

/** @type {() => boolean} */
function isPlaying() {
  return byId("play").getAttribute("aria-pressed") === "true";
}

function playWalk() {
  if (isPlaying()) {
    stop();
    return;
  }
  play(walkStops(), state.progress >= 1 ? 0 : state.progress, (done) => {
    state.progress = done;
    byId("progress").value = done;
  });
}

function showProgress() {
  stop();
  state.path = walkStops();
  setPair(alongPath(robot, state.path, state.progress));
  refresh();
}

/** A straight way in joint space to the mirrored pose. */
function playTask() {
  if (isPlaying()) {
    stop();
    return;
  }
  const now = inView(pairOf(state.q));
  play([now, state.mirror], 0, () => {});
}

function playFlip() {
  const other = otherPosture();
  if (other) play([inView(pairOf(state.q)), other], 0, () => {});
}

/* --- a link that restores the state ------------------------------------------------------------ */

/** @type {() => string} */
function hashOf() {
  const shown = Object.keys(state.show).filter((name) => state.show[name]);
  const values = {
    q: state.q.map((value) => Number(value.toFixed(5))).join(","),
    scale: Number(state.scale.toFixed(4)),
    walk: state.walk,
    at: Number(state.progress.toFixed(3)),
    show: shown.join(","),
  };
  return `#${Object.entries(values)
    .map(([key, value]) => `${key}=${value}`)
    .join("&")}`;
}

function remember() {
  byId("link").value = window.location.href.split("#")[0] + hashOf();
  byId("full-page").href = byId("link").value;
  window.clearTimeout(remember.timer);
  remember.timer = window.setTimeout(() => {
    if (window.location.hash !== hashOf()) window.history.replaceState(null, "", hashOf());
  }, 250);
}

/** Read a link; whatever is no number of this robot is left alone. */
function restore() {
  const read = new URLSearchParams(window.location.hash.slice(1));
  const q = (read.get("q") || "").split(",").map(Number);
  if (q.length === state.q.length && read.get("q") && q.every(Number.isFinite)) {
    state.q = withPair(robot, q.map(heldValue), inView(pairOf(q)));
  }
  const bounded = (name, high) => {
    const value = Number(read.get(name));
    return read.has(name) && value >= 0 && value <= high ? value : null;
  };
  state.scale = bounded("scale", robot.polygon && robot.polygon.binds ? 1.05 : 1) ?? state.scale;
  state.progress = bounded("at", 1) ?? 0;
  const walk = bounded("walk", robot.polygon ? robot.polygon.walks.length - 1 : 0);
  state.walk = Number.isInteger(walk) ? walk : 0;
  if (read.has("show")) {
    const names = read.get("show").split(",");
    for (const name of Object.keys(state.show)) state.show[name] = names.includes(name);
  }
}

/** A held joint's value, within its limits.
 * @type {(value: number, j: number) => number} */
function heldValue(value, j) {
  const { limits } = robot.joints[j];
  return limits ? Math.min(limits[1], Math.max(limits[0], value)) : value;
}

/* --- controls ---------------------------------------------------------------------------------- */

function element(name, properties = {}, ...children) {
  const made = Object.assign(document.createElement(name), properties);
  made.append(...children);
  return made;
}

function buildPose() {
  const rows = robot.joints.map((joint, j) => {
    const turn = joint.kind === "revolute";
    const [low, high] = rangeShown(joint, j).map((value) => (turn ? value / DEGREE : value));
    const step = turn ? 0.1 : (high - low) / 1000;
    const slide = element("input", { type: "range", id: `slide-${j}`, min: low, max: high, step });
    const value = element("input", {
      type: "number",
      id: `value-${j}`,
      min: low,
      max: high,
      step: "any",
    });
    const held = robot.free.includes(j) ? "" : " (held)";
    slide.setAttribute("aria-label", `${joint.name}${held}`);
    value.setAttribute(
      "aria-label",
      `${joint.name}${held}, ${turn ? "degrees" : robot.length_unit}`,
    );
    for (const input of [slide, value]) {
      input.addEventListener("input", () => {
        if (input.value === "" || !Number.isFinite(Number(input.value))) return;
        setJoint(j, Number(input.value) * (turn ? DEGREE : 1));
      });
    }
    value.addEventListener("blur", showPose);
    const unit = element("span", { className: "unit" }, value, turn ? "°" : robot.length_unit);
    return element(
      "div",
      { className: "slider" },
      element("span", {}, `${joint.name}${held}`),
      slide,
      unit,
    );
  });
  byId("pose").replaceChildren(...rows);
}

/** The range of a joint's slider: what is drawn, its limits, or one turn.
 * @type {(joint: Joint, j: number) => number[]} */
function rangeShown(joint, j) {
  const k = robot.free.indexOf(j);
  if (k >= 0) return [robot.views[k].low, robot.views[k].high];
  return joint.limits || [-Math.PI, Math.PI];
}

/** @type {(j: number, value: number) => void} */
function setJoint(j, value) {
  if (robot.free.includes(j)) {
    movePose(pairOf(state.q.map((old, i) => (i === j ? value : old))));
    return;
  }
  stop();
  state.q[j] = heldValue(value, j);
  state.path = null;
  state.mirror = null;
  rebuild();
}

function buildMargins() {
  const rows = margins(robot, state.q).map((one, i) => {
    const name = element("th", { scope: "row" }, one.name);
    const row = element(
      "tr",
      {},
      name,
      element("td", {}, betweenText(i) + (one.used ? "" : ", not used")),
      element("td", { className: "number" }),
    );
    row.classList.toggle("unused", !one.used);
    row.addEventListener("pointerenter", () => {
      state.hover = one.name;
      refresh();
    });
    row.addEventListener("pointerleave", () => {
      state.hover = null;
      refresh();
    });
    return row;
  });
  byId("margins").replaceChildren(...rows);
}

function buildScale() {
  byId("scaling").hidden = !robot.polygon;
  if (!robot.polygon) return;
  const { largest, walks, binds } = robot.polygon;
  const top = binds === null ? 1 : 1.05; // no larger scale was searched
  byId("scale").max = top;
  byId("largest").textContent =
    `Largest safe scale: ${number(largest, 4)}${binds === null ? " or more" : ""}`;
  byId("scale-mark").style.left = `${(100 * largest) / top}%`;
  byId("largest").addEventListener("click", () => setScale(largest));
  byId("scale").addEventListener("input", () => setScale(Number(byId("scale").value)));
  byId("walk").replaceChildren(
    ...walks.map((walk, i) => element("option", { value: i }, walk.map((k) => k + 1).join(" – "))),
  );
  byId("walk").value = state.walk;
  byId("progress").value = state.progress;
  byId("walk").addEventListener("change", () => {
    state.walk = Number(byId("walk").value);
    state.progress = 0;
    byId("progress").value = 0;
    showProgress();
  });
  byId("progress").addEventListener("input", () => {
    state.progress = Number(byId("progress").value);
    showProgress();
  });
  byId("speed").addEventListener("change", () => {
    state.speed = Number(byId("speed").value);
  });
  byId("play").addEventListener("click", playWalk);
}

/** @type {(scale: number) => void} */
function setScale(scale) {
  stop();
  state.scale = scale;
  state.show.polygon = true;
  if (state.path && state.path.length > 2) state.path = walkStops();
  buildShow();
  redraw();
}

function buildShow() {
  const words = {
    workspace: "Where the tool can go (geometric workspace)",
    polygon: "Polygon of the vertices",
    sample: `${robot.sample.length} random poses`,
    names: "Names of all points",
  };
  const boxes = Object.keys(words)
    .filter((name) => name !== "polygon" || robot.polygon)
    .map((name) => {
      const box = element("input", {
        type: "checkbox",
        id: `show-${name}`,
        checked: state.show[name],
      });
      box.addEventListener("change", () => {
        state.show[name] = box.checked;
        redraw();
      });
      return element("label", { className: "check" }, box, words[name]);
    });
  byId("show").replaceChildren(...boxes);
}

function goHome() {
  state.path = null;
  movePose(pairOf(robot.q));
}

/* --- hands and keys ---------------------------------------------------------------------------- */

/** Where a pointer is, in a picture's own pixels.
 * @type {(svg: SVGSVGElement, event: MouseEvent) => Point} */
function pixelOf(svg, event) {
  const box = svg.getBoundingClientRect();
  const view = svg.viewBox.baseVal;
  return [
    ((event.clientX - box.left) * view.width) / box.width,
    ((event.clientY - box.top) * view.height) / box.height,
  ];
}

/** Drag from a handle, or with a mouse from anywhere; a tap moves at once.
 * @type {(svg: SVGSVGElement, move: (pixel: Point) => void) => void} */
function draggable(svg, move) {
  let held = null;
  svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    const onHandle = event.target.classList.contains("reach-me");
    if (event.pointerType === "touch" && !onHandle) return;
    held = event.pointerId;
    svg.setPointerCapture(held);
    svg.focus({ preventScroll: true });
    event.preventDefault();
    if (!onHandle) move(pixelOf(svg, event));
  });
  svg.addEventListener("pointermove", (event) => {
    if (event.pointerId === held) move(pixelOf(svg, event));
  });
  for (const name of ["pointerup", "pointercancel"])
    svg.addEventListener(name, () => {
      held = null;
    });
  svg.addEventListener("click", (event) => {
    if (event.pointerType === "touch") move(pixelOf(svg, event));
  });
}

const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };

/** @type {(svg: SVGSVGElement, step: (direction: number[], large: boolean) => void) => void} */
function onKeys(svg, step) {
  svg.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.toLowerCase();
    if (ARROWS[event.key]) step(ARROWS[event.key], event.shiftKey);
    else if (key === "h") goHome();
    else if (key === "f") playFlip();
    else return;
    event.preventDefault();
  });
}

/** @type {(direction: number[], large: boolean) => void} */
function stepJoints(direction, large) {
  const size = (k) =>
    slice.map.kinds[k] === "revolute" ? DEGREE : (robot.views[k].high - robot.views[k].low) / 200;
  movePose(pairOf(state.q).map((value, k) => value + direction[k] * size(k) * (large ? 10 : 1)));
}

/** @type {(direction: number[], large: boolean) => void} */
function stepTool(direction, large) {
  const size = robot.reach * (large ? 0.05 : 0.01);
  const place = toolAt(slice.map, pairOf(state.q));
  moveTool(place.map((value, k) => value + direction[k] * size));
}

function listen() {
  draggable(byId("joints"), (pixel) => movePose(joints.from(pixel)));
  draggable(byId("plane"), (pixel) => moveTool(plane.from(pixel)));
  onKeys(byId("joints"), stepJoints);
  onKeys(byId("plane"), stepTool);
  byId("home").addEventListener("click", goHome);
  byId("flip").addEventListener("click", playFlip);
  byId("task-go").addEventListener("click", playTask);
  byId("task-again").addEventListener("click", () => {
    setMirror();
    refresh();
  });
  byId("copy").addEventListener("click", copyLink);
  window.addEventListener("hashchange", () => {
    restore();
    buildShow();
    rebuild();
  });
  new ResizeObserver(redraw).observe(byId("joints").parentElement);
}

function copyLink() {
  byId("link").select();
  if (navigator.clipboard) navigator.clipboard.writeText(byId("link").value).catch(() => {});
}

/* --- inside another page ----------------------------------------------------------------------- */

/** In a frame the page tells its height, and is told whether its surroundings are dark. */
function embed() {
  if (window.parent === window) return;
  document.documentElement.classList.add("embedded");
  const tell = () =>
    window.parent.postMessage({ explorerHeight: document.documentElement.offsetHeight }, "*");
  new ResizeObserver(tell).observe(document.body);
  window.addEventListener("message", ({ data }) => {
    if (data && ["light", "dark"].includes(data.theme))
      document.documentElement.style.colorScheme = data.theme;
  });
}

embed();
restore();
buildPose();
buildMargins();
buildScale();
buildShow();
rebuild();
listen();
