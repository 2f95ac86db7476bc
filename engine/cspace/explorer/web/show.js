/* Showing the state: both pictures, and every number and word beside them. */

/** What depends on the held joints alone. @type {Slice} */
let slice;
/** @type {JointPicture} */
let joints;
/** @type {PlanePicture} */
let plane;
const timers = { say: 0, remember: 0 };
let scaleShown = -1; // the scale whose clearance stands on the page

/** Everything anew: the window or a held joint has changed. */
function rebuild() {
  slice = findSlice();
  redraw();
}

/** Both pictures anew, from the slice there is. */
function redraw() {
  state.sample = state.show.sample ? judgeSample() : [];
  joints = drawJointSpace(svgOf("joints"), robot, state, slice);
  plane = drawPlane(svgOf("plane"), robot, state, slice, reachable);
  showLegends();
  byId("area").textContent = areaText();
  root.dispatchEvent(new CustomEvent("qbound-draw"));
  if (robot.polygon) inputOf("show-polygon").disabled = !slice.own;
  inputOf("show-workspace").disabled = !slice.regular; // the tool covers no area of the plane
  inputOf("show-workspace").checked = slice.regular && state.show.workspace;
  refresh();
}

function showLegends() {
  const { workspace, polygon, sample } = state.show;
  const curve = slice.arm.kind === "rr" ? "arm stretched or folded" : "singular curve";
  const cutOff = slice.cells.some((cell) => cell.piece !== slice.home);
  const walls = robot.boundaries.some((wall) => wall.kind === "half-space" && wall.used);
  byId("joints-legend").replaceChildren(
    ...legend("home", "allowed, with home", true),
    ...legend("away", "allowed, cut off", cutOff),
    ...legend("singular", `${curve}: det J = 0`, slice.lines.length > 0),
    ...legend(
      "polygon",
      `polygon of the vertices, at scale ${number(state.scale, 4)}`,
      polygon && slice.own,
    ),
    ...legend("dots", "random, allowed", sample),
    ...legend("dots away", "random, allowed, cut off", sample && cutOff),
    ...legend("crosses", "random, forbidden", sample),
    ...boundaryLegend(),
  );
  byId("plane-legend").replaceChildren(
    ...legend("workspace", "reached in one posture", workspace && slice.regular),
    ...legend("workspace twice", "reached in both", workspace && slice.lines.length > 0),
    ...legend("ground", "ground", plane.svg.querySelector(".ground") !== null),
    ...legend("beyond", "the forbidden side of a wall", walls && !robot.plane.oblique),
  );
}

/** The boundaries that have arcs or lines here, each in its colour, with what it is about.
 * @type {() => HTMLLIElement[]} */
function boundaryLegend() {
  const seen = [...joints.arcs, ...plane.walls].map((line) => line.dataset.boundary);
  return robot.boundaries.flatMap(({ name, kind }, i) =>
    i < 7 && seen.includes(name)
      ? legend("arc", kind === "bodies" ? name : `${name}: ${betweenText(i)}`, true).map((line) =>
          ownColour(robot, line, name),
        )
      : [],
  );
}

/** What moves with the pose. */
function refresh() {
  const found = margins(robot, state.q);
  const lit = litParts(found);
  const overlap = overlapText(robot, state.q);
  const [x, y] = joints.at(inView(pairOf(state.q)));
  joints.group.setAttribute("transform", `translate(${x} ${y})`);
  for (const line of [...joints.arcs, ...plane.walls])
    for (const [name, names] of Object.entries({ lit: lit.bold, violated: lit.violated }))
      line.classList.toggle(name, names.has(line.dataset.boundary ?? ""));
  for (const mark of [joints.mark, plane.mark])
    mark.classList.toggle("violated", !isSafe(found) || overlap !== "");
  placeArm(robot, plane, state, lit);
  plane.room.toggleAttribute("hidden", !slice.regular);
  showTask(isSafe(found));
  drawPaths();
  showStatus(found, overlap);
  showMargins(found, lit);
  showPose();
  showScale();
  remember();
  root.dispatchEvent(new CustomEvent("qbound-pose"));
}

/** The boundaries that stand out: violated ones, the one pointed at, and those that are near.
 * @type {(found: Margin[]) => Lit} */
function litParts(found) {
  const used = found.filter((one) => one.used);
  const violated = new Set(used.filter((one) => one.value < 0).map((one) => one.name));
  const bold = new Set([...violated, ...(state.hover ? [state.hover] : [])]);
  const near = used.filter((one) => one.unit === "length" && one.value < 0.04 * robot.reach);
  const closest = tightest(robot, found)?.name ?? null;
  const boundaries = new Set([...bold, ...near.map((one) => one.name)]);
  if (closest !== null) boundaries.add(closest);
  /** @type {(wanted: (name: string) => boolean) => Set<number>} */
  const pointsOf = (wanted) =>
    new Set(robot.boundaries.flatMap(({ name, points }) => (wanted(name) ? points : [])));
  return {
    violated,
    bold,
    closest,
    boundaries,
    points: pointsOf((name) => bold.has(name)),
    named: pointsOf((name) => bold.has(name) || name === closest),
  };
}

function drawPaths() {
  const stops = state.path ?? [];
  joints.path.setAttribute("d", pathText(stops.map(joints.at)));
  const count = stops.length > 1 && slice.map.planar ? 30 * (stops.length - 1) : 0;
  const steps = Array.from({ length: count }, (_, i) => alongPath(robot, stops, (i + 1) / count));
  const tool = count > 0 ? [stops[0], ...steps].map((pair) => toolAt(slice.map, pair)) : [];
  plane.path.setAttribute("d", pathText(tool.map(plane.at)));
  for (const ghost of [joints.ghost, plane.ghost])
    ghost.toggleAttribute("hidden", state.mirror === null);
  if (state.mirror === null) return;
  placeAt(joints.ghost, joints.at(inView(state.mirror)), "c");
  plane.ghost.setAttribute("d", skeleton(robot, plane, withPair(robot, state.q, state.mirror)));
}

/** @type {(found: Margin[], overlap: string) => void} */
function showStatus(found, overlap) {
  const [points, nearest] = statusText(found);
  // Points may keep clear of each other while the links that carry them do not.
  const isHidden = overlap !== "" && isSafe(found);
  const verdict = isHidden ? "Overlap:" : points;
  const reason = isHidden
    ? `${overlap.replace("Overlap: ", "")} The points allow this pose.`
    : nearest + (overlap ? " Links overlap." : "");
  byId("status").replaceChildren(element("strong", {}, verdict), ` ${reason}`);
  byId("status").classList.toggle("violated", !isSafe(found) || isHidden);
  if (shows("pose")) {
    byId("posture").textContent = postureText();
    partOf("flip", HTMLButtonElement).disabled = flipped() === null;
  }
  window.clearTimeout(timers.say);
  timers.say = window.setTimeout(() => say(verdict, reason), 600);
}

/** Tell a screen reader, once the arm rests.
 * @type {(verdict: string, reason: string) => void} */
function say(verdict, reason) {
  const pose = robot.free.map((j) => `${robot.joints[j].name} ${jointText(j, state.q[j])}`);
  byId("live").textContent = `${pose.join(", ")}. ${verdict} ${reason} ${postureText()}`;
}

/** @type {(found: Margin[], lit: Lit) => void} */
function showMargins(found, lit) {
  if (!shows("margins")) return;
  const { rows } = partOf("margins", HTMLTableSectionElement);
  for (const [i, group] of marginRows.entries()) {
    const { name, value, unit } = leastMargin(found, group);
    rows[i].cells[2].textContent = valueText(value, unit);
    rows[i].classList.toggle("lit", lit.violated.has(name));
  }
}

function showPose() {
  if (!shows("pose")) return;
  if (robot.row) byId("row").textContent = rowText(robot.row);
  for (const [j, { slide, set: show }] of poseRows.entries()) {
    show(state.q[j] / (robot.joints[j].kind === "revolute" ? DEGREE : 1));
    slide.setAttribute("aria-valuetext", jointText(j, state.q[j]));
  }
}

function showScale() {
  if (!robot.polygon || !shows("scaling")) return;
  byId("scaling").hidden = !slice.own;
  inputOf("scale").value = String(state.scale);
  byId("scale-value").textContent = number(state.scale, 4);
  if (scaleShown !== state.scale) showClearance(robot.polygon);
  scaleShown = state.scale;
}

/** @type {(polygon: VertexPolygon) => void} */
function showClearance({ vertices, centroid, largest }) {
  const least = smallestClearance(robot, robot.q, vertices, state.scale, centroid);
  const safe = state.scale <= largest;
  const good = goodWord();
  const verdict = safe ? `All of it is ${good}` : `Not all of it is ${good}`;
  byId("clearance").textContent =
    least.name === null
      ? "No boundary has a length."
      : `${verdict}. Smallest clearance ${lengthText(least.value)} (${least.name}).`;
  byId("clearance").classList.toggle("lit", !safe);
}
