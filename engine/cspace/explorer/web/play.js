/* Paths that play, and the task that asks for one: why the arm must stretch. */

/* --- the task ---------------------------------------------------------------------------------- */

function hasTask() {
  return shows("task") && slice.regular && slice.arm.kind === "rr";
}

/** Ask for the mirror image of the present pose.
 * @type {() => Pair} */
function setMirror() {
  const now = pairOf(state.q);
  state.mirror = inView(mirroredPose(slice.arm, now));
  state.side = Math.sign(determinant(slice.map, now));
  return state.mirror;
}

/** @type {(safe: boolean) => void} */
function showTask(safe) {
  byId("task").hidden = !hasTask();
  if (!hasTask()) return;
  const mirror = state.mirror ?? setMirror();
  const now = pairOf(state.q);
  const det = determinant(slice.map, now);
  const singular = Math.abs(det) <= NEAR_SINGULAR * slice.largest;
  const across = Math.sign(det) !== state.side;
  for (const [i, line] of joints.singular.entries()) {
    const [, off] = wayTo(robot, [now[0], slice.lines[i]], now);
    const near = Math.abs(off) <= 45 * DEGREE;
    line.classList.toggle("lit", singular && near);
  }
  const gap = Math.max(...wayTo(robot, now, mirror).map(Math.abs));
  const text = taskText(safe, singular, across, across && gap < 6 * DEGREE);
  if (byId("task-text").textContent !== text) byId("task-text").textContent = text;
}

/** What to do next: `across` is the side of the singular curve on which the mirror image lies.
 * @type {(safe: boolean, singular: boolean, across: boolean, there: boolean) => string} */
function taskText(safe, singular, across, there) {
  if (!safe) {
    const where = there ? "This is the mirror image, but it" : "This pose";
    return `${where} is not ${goodWord()}. The way has to stay in the blue region.`;
  }
  if (there) {
    return (
      "There. On the way you crossed the dashed line, where the arm is stretched or folded. The " +
      "mirror image bends the other way: it is the other posture, and every way to it crosses " +
      "that line."
    );
  }
  if (singular)
    return "Now both links lie in one line: det J = 0. The arm can go on and bend to either side.";
  if (across)
    return "You are on the other side of the dashed line: the arm bends the other way. Go on to the dotted pose.";
  return "Bring the arm to its mirror image, the dotted arm. Can you get there without crossing the dashed line?";
}

/* --- paths ------------------------------------------------------------------------------------- */

/** The corners of the scaled polygon in the order of the chosen walk.
 * @type {() => Pair[]} */
function walkStops() {
  if (!robot.polygon) return [];
  const { vertices, centroid, walks } = robot.polygon;
  const corners = scaledPolygon(vertices, state.scale, centroid);
  return walks[state.walk].map((i) => corners[i]);
}

/** @type {(done: number) => void} */
let tellDone = () => {};

const walker = player(
  (done) => {
    setPair(alongPath(robot, state.path ?? [], done));
    tellDone(done);
    refresh();
  },
  (runs) => {
    byId("play").setAttribute("aria-pressed", String(runs));
    byId("play").textContent = runs ? "Pause" : "Play";
  },
  () => state.speed,
);

/** Move along straight pieces from a fraction of their length on; `each` hears how far it is.
 * @type {(stops: Pair[], from: number, each: (done: number) => void) => void} */
function play(stops, from, each) {
  const behavior = walker.calm() ? "auto" : "smooth";
  svgOf("plane").scrollIntoView({ block: "nearest", behavior });
  state.path = stops;
  tellDone = each;
  const seconds = PACE * sum(pieceLengths(robot, stops));
  walker.play({ seconds, places: stopsAt(robot, stops), from });
}

function stopPlaying() {
  walker.stop();
}

function playWalk() {
  if (walker.runs()) {
    stopPlaying();
    return;
  }
  play(walkStops(), state.progress, (done) => {
    state.progress = done;
    inputOf("progress").value = String(done);
  });
}

function showProgress() {
  stopPlaying();
  state.path = walkStops();
  inputOf("progress").value = String(state.progress);
  setPair(alongPath(robot, state.path, state.progress));
  refresh();
}

/** A safe way in joint space to the mirrored pose, if it is a simple one. */
function playTask() {
  if (walker.runs()) {
    stopPlaying();
    return;
  }
  const way = wayToMirror();
  if (way) play(way, 0, () => {});
  else byId("task-text").textContent = `No simple way there is ${goodWord()}. Can you find one?`;
}

/** Straight to the mirrored pose, or by way of the centroid of the home component.
 * @type {() => Pair[] | null} */
function wayToMirror() {
  const { mirror } = state;
  if (!mirror) return null;
  const now = inView(pairOf(state.q));
  const centroid = robot.components.find(({ home }) => home)?.centroid;
  const ways = [[now, mirror], ...(centroid ? [[now, centroid, mirror]] : [])];
  return ways.find(isSafeWay) ?? null;
}

/** Whether two hundred poses along a path are safe.
 * @type {(stops: Pair[]) => boolean} */
function isSafeWay(stops) {
  const steps = Array.from({ length: 201 }, (_, i) => alongPath(robot, stops, i / 200));
  return steps.every((pair) => isSafe(margins(robot, withPair(robot, state.q, pair))));
}

function playFlip() {
  const other = flipped();
  if (other) play([inView(pairOf(state.q)), other], 0, () => {});
}
