/* What a reader holds: sliders, fields, buttons, handles, keys, a link. Then the page begins. */

const MAX_SCALE = 1.05;

/* --- a link that restores the state ------------------------------------------------------------ */

/** @type {() => string} */
function hashOf() {
  const shown = Object.entries(state.show).flatMap(([name, shows]) => (shows ? [name] : []));
  const values = {
    q: state.q.map((value) => Number(value.toFixed(5))).join(","),
    scale: Number(state.scale.toFixed(4)),
    walk: state.walk,
    at: Number(state.progress.toFixed(3)),
    show: shown.join(","),
  };
  const pairs = Object.entries(values).map(([key, value]) => `${key}=${value}`);
  return `#${pairs.join("&")}`;
}

/** Write the view into the address and the links, once the arm rests. */
function remember() {
  if (!options.page) return;
  window.clearTimeout(timers.remember);
  timers.remember = window.setTimeout(() => {
    const link = window.location.href.split("#")[0] + hashOf();
    inputOf("link").value = link;
    partOf("full-page", HTMLAnchorElement).href = link;
    if (window.location.href !== link) window.history.replaceState(null, "", link);
  }, 250);
}

/** Read a link; whatever is no number of this robot is left alone. */
function restore() {
  const read = new URLSearchParams(window.location.hash.slice(1));
  const q = (read.get("q") || "none").split(",").map(Number);
  if (q.length === state.q.length && q.every(Number.isFinite))
    state.q = withPair(robot, q.map(heldValue), inView(pairOf(q)));
  /** @type {(name: string, high: number) => number | null} */
  const bounded = (name, high) => {
    const value = Number(read.get(name) ?? "none");
    return value >= 0 && value <= high ? value : null;
  };
  state.scale = bounded("scale", largestScale()) ?? state.scale;
  state.progress = bounded("at", 1) ?? 0;
  const walk = bounded("walk", robot.polygon ? robot.polygon.walks.length - 1 : 0) ?? 0;
  state.walk = Number.isInteger(walk) ? walk : 0;
  const names = read.get("show")?.split(",");
  for (const name of shownNames()) state.show[name] = names?.includes(name) ?? state.show[name];
}

/** @type {() => (keyof State["show"])[]} */
function shownNames() {
  return ["workspace", "polygon", "sample", "names"];
}

/** Where no boundary binds, no scale beyond 1 was searched.
 * @type {() => number} */
function largestScale() {
  return robot.polygon?.binds ? MAX_SCALE : 1;
}

/* --- controls ---------------------------------------------------------------------------------- */

function buildPose() {
  const note = newPart("row", element("p", { className: "readout", hidden: !robot.row }));
  byId("pose").replaceChildren(...robot.joints.map(poseRow), note);
}

/** @type {SetRow[]} */
const poseRows = [];

/** A slider and a field for one joint.
 * @type {(joint: Joint, j: number) => HTMLElement} */
function poseRow(joint, j) {
  const turn = joint.kind === "revolute";
  const factor = turn ? DEGREE : 1;
  const [low, high] = rangeShown(joint, j).map((value) => value / factor);
  const name = joint.name + (robot.free.includes(j) ? "" : " (held)");
  const unit = turn ? "°" : robot.length_unit;
  const [step, digits] = turn ? [0.1, 1] : [(high - low) / 1000, 4];
  const places = rowValues(j)?.map((value) => value / factor);
  const row = valueRow({ name, spoken: name, low, high, step, digits, unit, places }, (value) =>
    setJoint(j, value * factor),
  );
  newPart(`slide-${j}`, row.slide);
  newPart(`value-${j}`, row.field).ariaLabel = `${name}, ${turn ? "degrees" : unit}`;
  poseRows[j] = row;
  return row.row;
}

/** The range of a joint's slider: what is drawn, its limits, or one turn.
 * @type {(joint: Joint, j: number) => number[]} */
function rangeShown(joint, j) {
  const k = robot.free.indexOf(j);
  if (k >= 0) return [robot.views[k].low, robot.views[k].high];
  return joint.limits ?? [-Math.PI, Math.PI];
}

/** @type {(j: number, value: number) => void} */
function setJoint(j, value) {
  if (robot.free.includes(j)) {
    movePose(pairOf(state.q.map((old, i) => (i === j ? value : old))));
    return;
  }
  stopPlaying();
  state.q[j] = heldValue(value, j);
  state.path = null;
  state.mirror = null;
  rebuild();
}

function buildMargins() {
  const found = margins(robot, state.q);
  marginRows.splice(0, Infinity, ...marginGroups());
  byId("margins").replaceChildren(...marginRows.map((rows) => marginRow(found, rows)));
}

/** The boundaries and limits of each row. @type {number[][]} */
const marginRows = [];

/** The least of some margins.
 * @type {(found: Margin[], rows: number[]) => Margin} */
function leastMargin(found, rows) {
  return rows.map((i) => found[i]).reduce((one, other) => (other.value < one.value ? other : one));
}

/** @type {(found: Margin[], rows: number[]) => HTMLTableRowElement} */
function marginRow(found, rows) {
  const { name, used } = found[rows[0]];
  const links = rows.length > 1 ? linksOf(rows[0]) : null;
  const row = element("tr", { className: used ? "" : "unused" });
  row.append(
    links
      ? element("th", { scope: "row" }, `${rows.length} pairs of balls`)
      : ownColour(robot, element("th", { scope: "row" }, name), name),
    element("td", {}, links ? links.join(" and ") : betweenText(rows[0])),
    element("td", { className: "number" }),
  );
  /** @type {(hover: string | null) => void} */
  const point = (hover) => {
    state.hover = hover;
    refresh();
  };
  row.addEventListener("pointerenter", () =>
    point(leastMargin(margins(robot, state.q), rows).name),
  );
  row.addEventListener("pointerleave", () => point(null));
  return row;
}

function buildScale() {
  byId("scaling").hidden = !robot.polygon;
  if (!robot.polygon) return;
  const { largest, walks, binds } = robot.polygon;
  inputOf("scale").max = String(largestScale());
  const more = binds === null ? " or more" : "";
  const shown = number(Math.floor(largest * 1e4) / 1e4, 4); // rounded up it would not be safe
  byId("largest").textContent = `Largest ${goodWord()} scale: ${shown}${more}`;
  byId("scale-mark").style.left = `${(100 * largest) / largestScale()}%`;
  byId("largest").addEventListener("click", () => setScale(largest));
  inputOf("scale").addEventListener("input", () => setScale(Number(inputOf("scale").value)));
  buildWalk(partOf("walk", HTMLSelectElement), walks);
}

/** @type {(choice: HTMLSelectElement, walks: number[][]) => void} */
function buildWalk(choice, walks) {
  const orders = walks.map((walk) => walk.map((k) => k + 1).join(" – "));
  choice.replaceChildren(
    ...orders.map((order, i) => element("option", { value: String(i) }, order)),
  );
  choice.value = String(state.walk);
  inputOf("progress").value = String(state.progress);
  choice.addEventListener("change", () => {
    state.walk = Number(choice.value);
    state.progress = 0;
    showProgress();
  });
  inputOf("progress").addEventListener("input", () => {
    state.progress = Number(inputOf("progress").value);
    showProgress();
  });
  const speed = partOf("speed", HTMLSelectElement);
  speed.addEventListener("change", () => {
    state.speed = Number(speed.value);
  });
  byId("play").addEventListener("click", playWalk);
}

/** @type {(scale: number) => void} */
function setScale(scale) {
  stopPlaying();
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
    sample: "1500 random poses",
    names: "Names of all points",
  };
  const names = shownNames().filter((name) => name !== "polygon" || robot.polygon);
  const boxes = names.map((name) => {
    const checked = state.show[name];
    const box = newPart(`show-${name}`, element("input", { type: "checkbox", checked }));
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

/** @type {(direction: number[], large: boolean) => void} */
function stepJoints(direction, large) {
  const sizes = robot.views.map(({ low, high }, k) =>
    slice.map.kinds[k] === "revolute" ? DEGREE : (high - low) / 200,
  );
  const factor = large ? 10 : 1;
  movePose(pairOf(state.q).map((value, k) => value + direction[k] * sizes[k] * factor));
}

/** @type {(direction: number[], large: boolean) => void} */
function stepTool(direction, large) {
  const size = robot.reach * (large ? 0.05 : 0.01);
  const place = toolAt(slice.map, pairOf(state.q));
  moveTool(place.map((value, k) => value + direction[k] * size));
}

function listen() {
  if (robot.plane.oblique) byId("plane-title").textContent = "Arm, seen obliquely from above";
  const [jointSvg, planeSvg] = [svgOf("joints"), svgOf("plane")];
  const keys = { h: goHome, f: playFlip };
  draggable(jointSvg, (pixel) => movePose(joints.from(pixel)));
  draggable(planeSvg, (pixel) => moveTool(plane.from(pixel)));
  onKeys(jointSvg, stepJoints, keys);
  onKeys(planeSvg, stepTool, keys);
  root.addEventListener("qbound-light", (event) => {
    state.hover = event instanceof CustomEvent ? event.detail : null;
    refresh();
  });
  byId("home").addEventListener("click", goHome);
  byId("flip").addEventListener("click", playFlip);
  byId("task-go").addEventListener("click", playTask);
  byId("task-again").addEventListener("click", () => {
    setMirror();
    refresh();
  });
  byId("copy").addEventListener("click", copyLink);
  const stage = parts.get("stage") ?? root;
  let width = stage.clientWidth;
  const resized = () => {
    if (stage.clientWidth === width) return;
    width = stage.clientWidth;
    redraw();
  };
  new ResizeObserver(resized).observe(stage);
}

function copyLink() {
  inputOf("link").select();
  navigator.clipboard?.writeText(inputOf("link").value).catch(() => {});
}

/* --- a page of its own ------------------------------------------------------------------------- */

/** The address holds the view. A page that stands in its frame's `srcdoc` (a notebook's output) has
    no address, and no room elsewhere. */
function ownPage() {
  window.addEventListener("hashchange", () => {
    restore();
    buildShow();
    rebuild();
  });
  const hasAddress = window.location.protocol !== "about:";
  byId("share").hidden = !hasAddress;
  if (hasAddress) answerFrame();
}

if (options.page) {
  ownPage();
  restore();
}
buildPose();
buildMargins();
buildScale();
buildShow();
rebuild();
listen();

/** What others may do with this explorer. @type {Explorer} */
const explorer = {
  root,
  robot,
  state,
  get slice() {
    return slice;
  },
  get joints() {
    return joints;
  },
  get plane() {
    return plane;
  },
  part: byId,
  pair: () => pairOf(state.q),
  move: movePose,
  moveTool,
  play,
  stop: stopPlaying,
  isPlaying: walker.runs,
  walkStops,
  setScale,
  refresh,
  redraw,
};
