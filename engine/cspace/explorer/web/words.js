/* What the explorer says: numbers with units, the verdict on a pose, its posture. */

/** @type {(value: number) => string} */
function lengthText(value) {
  return `${number(value, robot.reach < 10 ? 4 : 2)} ${robot.length_unit}`;
}

/** @type {(value: number) => string} */
function angleText(value) {
  return `${number(value / DEGREE, 1)}°`;
}

/** @type {(value: number, unit: "length" | "angle") => string} */
function valueText(value, unit) {
  return unit === "angle" ? angleText(value) : lengthText(value);
}

/** @type {(j: number, value: number) => string} */
function jointText(j, value) {
  return valueText(value, robot.joints[j].kind === "revolute" ? "angle" : "length");
}

/** @type {(row: number) => string} */
function betweenText(row) {
  const limit = robot.limits[row - robot.boundaries.length]; // they follow the boundaries
  const own = limit && robot.boundaries.some(({ name }) => name === limit.name);
  if (limit) return `${own ? "window" : "limit"} of ${robot.joints[limit.joint].name}`;
  const wall = robot.boundaries[row];
  const names = partners(wall);
  const words = wall.kind === "half-space" ? `${names[0]} and a wall` : names.join(" and ");
  return wall.used ? words : `${words}, not used`;
}

/** The boundaries and limits of each row of the margins, by index: of more than a dozen boundaries,
    those of balls, which are called LINK/1, LINK/2, share the row of their links.
 * @type {() => number[][]} */
function marginGroups() {
  /** @type {Map<string, number[]>} */
  const groups = new Map();
  for (const i of [...robot.boundaries, ...robot.limits].keys()) {
    const links = robot.boundaries.length > 12 ? linksOf(i) : null;
    const key = links === null ? `${i}` : JSON.stringify([robot.boundaries[i].used, ...links]);
    groups.set(key, [...(groups.get(key) ?? []), i]);
  }
  return [...groups.values()];
}

/** The two links that a boundary keeps apart by a ball of each; null where it is about others.
 * @type {(row: number) => string[] | null} */
function linksOf(row) {
  const wall = robot.boundaries[row];
  if (wall?.kind !== "pair") return null;
  const balls = wall.points.map((i) => robot.points[i]);
  const links = balls.map(({ name }) => name.slice(0, Math.max(name.lastIndexOf("/"), 0)));
  return balls.every(({ radius }) => radius > 0) && links.every(Boolean) ? links : null;
}

/** What a boundary keeps apart, or on its side.
 * @type {(wall: Wall) => string[]} */
function partners(wall) {
  if (wall.kind === "bodies") return wall.bodies.map((i) => robot.bodies[i].name);
  if (wall.kind === "half-space" && wall.body !== null) return [robot.bodies[wall.body].name];
  const names = wall.points.map((i) => robot.points[i].name);
  if (wall.kind === "pair") return [`points ${names[0]}`, names[1]];
  return [`point ${names[0]}${wall.points[0] === robot.tool ? " (the tool)" : ""}`];
}

/** What keeps a margin, and how far it is from its boundary, or beyond it.
 * @type {(margin: Margin, row: number) => string} */
function marginText({ name, value, unit }, row) {
  const size = valueText(Math.abs(value), unit);
  const limit = robot.limits[row - robot.boundaries.length];
  if (limit) {
    const joint = robot.joints[limit.joint].name;
    return `${joint} is ${size} ${value < 0 ? "beyond" : "from"} ${name}`;
  }
  const wall = robot.boundaries[row];
  const [first, second] = partners(wall);
  if (wall.kind === "half-space")
    return `${first} is ${size} ${value < 0 ? "beyond" : "from"} ${name}`;
  const [both, least] =
    wall.kind === "bodies"
      ? [`${first} and ${second}`, wall.clearance]
      : [`${first} and ${second} (${name})`, wall.required];
  if (value < 0 && wall.kind === "bodies" && least === 0) return `${both} overlap by ${size}`;
  if (value < 0) return `${both} are ${size} too close`;
  return `${both} are ${size} ${least > 0 ? "farther apart than they must be" : "apart"}`;
}

/** What a pose is called that keeps every boundary: safe only where whole links keep clear.
 * @type {() => string} */
function goodWord() {
  return robot.safe ? "safe" : `feasible by ${robot.feasible_by}`;
}

/** Whether the pose is feasible, and whether the home pose can be reached from it.
 * @type {(found: Margin[]) => string[]} */
function statusText(found) {
  /** @type {(one: Margin) => string} */
  const words = (one) => marginText(one, found.indexOf(one));
  const verdict = goodWord();
  const bad = found.filter((one) => one.used && one.value < 0);
  if (bad.length > 0) {
    const first = bad.slice(0, 2).map(words).join("; ");
    const more = bad.length > 2 ? `; and ${bad.length - 2} more` : "";
    return [`Not ${verdict}:`, `${first}${more}.`];
  }
  const close = tightest(robot, found);
  const nearby = close ? `Closest: ${words(close)}.` : "Nothing bounds this arm.";
  const away =
    slice.home !== null && pieceAt(slice.columns, slice.of, inView(pairOf(state.q))) !== slice.home;
  const good = verdict[0].toUpperCase() + verdict.slice(1);
  return [away ? `${good}, but cut off from home.` : `${good}.`, nearby];
}

/** @type {() => string} */
function postureText() {
  if (!slice.regular) return `${irregularText()}: move the arm in joint space.`;
  const det = determinant(slice.map, pairOf(state.q));
  if (slice.lines.length === 0) return "One posture only: det J is never 0.";
  if (Math.abs(det) <= NEAR_SINGULAR * slice.largest)
    return "Singular: det J = 0. Here one posture turns into the other.";
  const posture = det > 0 ? "A (det J > 0)" : "B (det J < 0)";
  return `Posture ${posture}. The other one at this place is ${otherPostureText()}.`;
}

/** Why the tool covers no area of the plane.
 * @type {() => string} */
function irregularText() {
  const still = slice.map.still.map((k) => robot.joints[robot.free[k]].name);
  if (still.length > 0) return `The tool is not moved by ${still.join(" and ")}`;
  return slice.map.planar ? "The tool keeps to a curve" : "The tool leaves the plane";
}

/** @type {() => string} */
function otherPostureText() {
  const other = flipped();
  if (other === null) return "beyond a limit";
  const verdict = goodWord();
  return isSafe(margins(robot, withPair(robot, state.q, other))) ? verdict : `not ${verdict}`;
}

/** Which slice of a row this is, how large it is, and that nothing is known between two of them.
 * @type {(row: SliceRow) => string} */
function rowText({ joint, slices, unit }) {
  const { name } = robot.joints[joint];
  const k = slices.findIndex(({ value }) => value === state.q[joint]);
  const words = `${name} goes through ${slices.length} slices, each exact; between two of them nothing is computed.`;
  if (!slice.exact || k < 0)
    return `${words} Another held joint has moved: this outline is drawn from fibres.`;
  const area = sum(slices[k].components.map((one) => one.area));
  return `Slice ${k + 1} of ${slices.length}: feasible area ${Number(area.toPrecision(5))} ${unit}. ${words}`;
}

/** The exact areas of the workspace, as the library found them for the slice it was given.
 * @type {() => string} */
function areaText() {
  if (!robot.workspace || !slice.own || !state.show.workspace) return "";
  const [whole, twice] = [robot.workspace.area, robot.workspace.covered_twice].map(
    (value) => `${Number(value.toPrecision(6))} ${robot.length_unit}²`,
  );
  const again = robot.workspace.covered_twice > 0 ? `, of it ${twice} in both postures` : "";
  return `Reached from home: ${whole}${again}.`;
}
