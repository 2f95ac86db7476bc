/* The explorer's state, and what it means: the slice that the held joints leave, the poses in it.
   One way round: an action changes the state, `refresh` shows it. */

const prefix = options.page ? "" : newPrefix();
const parts = addParts(root, prefix, shows);

/** Whether a section of the controls stands in the page.
 * @type {(control: string) => boolean} */
function shows(control) {
  return options.page || (options.controls ?? ["legend"]).includes(control);
}

/** A part of this explorer, of the kind that the caller needs.
 * @template {Element} T
 * @param {string} id
 * @param {new () => T} kind
 * @returns {T} */
function partOf(id, kind) {
  const found = parts.get(id);
  if (!(found instanceof kind)) throw new Error(`The explorer has no ${kind.name} "${id}".`);
  return found;
}

/** Name an element, so that `partOf` finds it.
 * @template {Element} T
 * @param {string} id
 * @param {T} made
 * @returns {T} */
function newPart(id, made) {
  made.id = prefix + id;
  parts.set(id, made);
  return made;
}

/** @type {(id: string) => HTMLElement} */
const byId = (id) => partOf(id, HTMLElement);
/** @type {(id: string) => HTMLInputElement} */
const inputOf = (id) => partOf(id, HTMLInputElement);
/** @type {(id: string) => SVGSVGElement} */
const svgOf = (id) => partOf(id, SVGSVGElement);

const DEGREE = Math.PI / 180;
const COLUMNS = 240; // fibres of a slice: one every pixel and a half
const NEAR_SINGULAR = 0.02; // of the largest |det J|: here the arm looks stretched
const reachable = planeBox(robot);

/** @type {State} */
const state = {
  q: [...(options.q ?? robot.q)],
  scale: options.scale ?? (robot.polygon ? robot.polygon.largest : 0),
  walk: 0,
  progress: 0,
  speed: 1,
  show: {
    workspace: true,
    polygon: Boolean(robot.polygon),
    sample: false,
    names: false,
    ...options.show,
  },
  sample: [],
  path: null,
  mirror: null,
  side: 0,
  hover: options.lit ?? null,
};

/* --- what depends on the held joints ----------------------------------------------------------- */

/** The slice's cells, arcs, images and singular lines; the library's exact arcs where it has them.
 * @type {() => Slice} */
function findSlice() {
  const known = knownSlice();
  const problem = sliceProblem(robot, state.q, known?.walls);
  const found = decompose(problem, COLUMNS);
  const home = pieceAt(found.columns, found.of, inView(pairOf(robot.q)));
  const map = toolMap(robot, state.q);
  const arm = armOf(map);
  const regular = map.planar && sweepsAnArea(arm, robot.reach);
  const inside = found.cells.filter((cell) => cell.piece === home);
  const [, view] = robot.views;
  const lines = singularValues(arm).flatMap((value) => turnsWithin(map.kinds[1], value, view));
  return {
    ...found,
    home,
    exact: known !== null,
    own: robot.joints.every((_, j) => isAsOpened(j)),
    map,
    arm,
    regular,
    arcs: known ? exactArcs(known) : slicedArcs(problem, found, home),
    images: postureImages(map, arm, regular ? inside : [], problem.ranges[1]),
    lines: regular ? lines : [],
    largest: largestDeterminant(map),
  };
}

/** Whether a joint is free, or held where the page opened.
 * @type {(j: number) => boolean} */
function isAsOpened(j) {
  return robot.free.includes(j) || state.q[j] === robot.q[j];
}

/** What the library found for the held joints: the slice that the page opened with, or one of the
    row along a third joint.
 * @type {() => KnownSlice | null} */
function knownSlice() {
  const moved = robot.joints.flatMap((_, j) => (isAsOpened(j) ? [] : [j]));
  if (moved.length === 0) return robot;
  const row = moved.length === 1 && robot.row?.joint === moved[0] ? robot.row : null;
  return row?.slices.find(({ value }) => value === state.q[row.joint]) ?? null;
}

/** @type {(known: KnownSlice) => DrawnArc[]} */
function exactArcs({ components }) {
  return components.flatMap(({ home, loops }) => loops.flat().map((arc) => ({ ...arc, home })));
}

/** @type {(problem: SliceProblem, found: Decomposition, home: number | null) => DrawnArc[]} */
function slicedArcs(problem, found, home) {
  const edges = cellEdges(problem, found);
  return edges.map((edge) => ({ ...edge, branch: null, home: edge.piece === home }));
}

/** @type {(map: ToolMap) => number} */
function largestDeterminant(map) {
  const steps = Array.from({ length: 37 }, (_, i) => i / 36);
  const [firsts, seconds] = robot.views.map(({ low, high }) =>
    steps.map((s) => low + s * (high - low)),
  );
  const sizes = firsts.flatMap((a) => seconds.map((b) => Math.abs(determinant(map, [a, b]))));
  return Math.max(...sizes);
}

/** @type {() => SamplePose[]} */
function judgeSample() {
  return randomPairs(robot).map((pair) => {
    const q = withPair(robot, state.q, pair);
    const home = slice.home === null || pieceAt(slice.columns, slice.of, pair) === slice.home;
    return { pair, safe: isSafe(margins(robot, q)), home, tool: toolAt(slice.map, pair) };
  });
}

/* --- poses ------------------------------------------------------------------------------------- */

/** Bring both free joints into what is drawn: turn whole turns, stop at limits.
 * @type {(pair: Pair) => Pair} */
function inView(pair) {
  return pair.map((value, k) => {
    const { low, high, wraps } = robot.views[k];
    return wraps ? value - TURN * Math.floor((value - low) / TURN) : between(value, low, high);
  });
}

/** @type {(q: Pose) => Pair} */
function pairOf(q) {
  return robot.free.map((j) => q[j]);
}

/** The values of a joint along which the library found a row of slices.
 * @type {(j: number) => number[] | null} */
function rowValues(j) {
  return robot.row?.joint === j ? robot.row.slices.map((one) => one.value) : null;
}

/** A held joint's value, within its limits; along a row of slices that of the nearest one.
 * @type {(value: number, j: number) => number} */
function heldValue(value, j) {
  const row = rowValues(j);
  if (row) return leastBy(row, (one) => Math.abs(one - value)) ?? value;
  const { limits } = robot.joints[j];
  return limits ? between(value, limits[0], limits[1]) : value;
}

/** @type {(pair: Pair) => void} */
function setPair(pair) {
  state.q = withPair(robot, state.q, inView(pair));
}

/** The reader moved the arm: a running path stops.
 * @type {(pair: Pair) => void} */
function movePose(pair) {
  stopPlaying();
  setPair(pair);
  refresh();
}

/** Bring the tool to a place of the plane, in the posture that it has.
 * @type {(target: Point) => void} */
function moveTool(target) {
  if (!slice.regular) return;
  const now = pairOf(state.q);
  const found = possible(robot, slice.arm, target);
  const same = found.filter((pair) => isLikePosture(slice.map, pair, now));
  const best = nearest(same.length > 0 ? same : found, now);
  if (best) movePose(best);
}

/** @type {(pairs: Pair[], now: Pair) => Pair | null} */
function nearest(pairs, now) {
  return leastBy(pairs, (pair) => sum(wayTo(robot, now, pair).map(Math.abs)));
}

/** The same place of the tool in the other posture, if the joints' limits allow it.
 * @type {() => Pair | null} */
function flipped() {
  return slice.regular ? otherPosture(robot, slice.map, slice.arm, pairOf(state.q)) : null;
}
