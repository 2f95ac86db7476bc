/* Kinematics of two joints in the plane of motion: cspace.workspace.planar. */

/** The arm's own numbers, read off the coefficients of its tool map.
    RR: c + e^{i s1 q1} (d + e^{i s2 q2} e).  RP: c + e^{i s1 q1} (d + q2 e).
    PR: c + q1 d + e^{i s2 q2} e.             PP: c + q1 d + q2 e.
 * @type {(map: ToolMap) => Arm} */
function armOf(map) {
  /** @type {(i: number, k: number) => Point} */
  const at = (i, k) => [map.x[i][k], map.y[i][k]];
  const [turns, otherTurns] = map.kinds.map((kind) => kind === "revolute");
  const e = turns ? at(1, 1) : at(0, 1);
  return {
    kind: `${turns ? "r" : "p"}${otherTurns ? "r" : "p"}`,
    c: at(0, 0),
    d: at(1, 0),
    e,
    s1: turns ? Math.sign(cross(e, at(2, 1))) : 1,
    s2: otherTurns ? Math.sign(cross(e, turns ? at(1, 2) : at(0, 2))) : 1,
  };
}

/** Whether the tool sweeps an area at all: not where det J = 0 everywhere.
 * @type {(arm: Arm, reach: number) => boolean} */
function sweepsAnArea({ kind, d, e }, reach) {
  const [one, other] = [Math.hypot(...d), Math.hypot(...e)];
  const least = 1e-9 * reach;
  if (kind === "rp") return other > 1e-9;
  if (kind === "pp") return Math.abs(cross(d, e)) > 1e-9;
  return one > (kind === "pr" ? 1e-9 : least) && other > least;
}

/** Values of the second joint at which det J = 0: straight lines in the plane of the joints.
 * @type {(arm: Arm) => number[]} */
function singularValues(arm) {
  const { kind, d, e, s2 } = arm;
  if (kind === "rr") return [0, Math.PI].map((phi) => wrapped(s2 * (phi - angle(e) + angle(d))));
  if (kind === "rp") return [-inner(d, e) / inner(e, e)];
  if (kind === "pr")
    return [1, -1].map((s) => wrapped(s2 * ((s * Math.PI) / 2 - angle(e) + angle(d))));
  return [];
}

/** All joint values that bring the tool to a place, or as near as the arm reaches.
 * @type {(arm: Arm, target: Point) => Pair[]} */
function postures(arm, target) {
  const w = minus(target, arm.c);
  return { rr: posturesRR, rp: posturesRP, pr: posturesPR, pp: posturesPP }[arm.kind](arm, w);
}

/** @type {(arm: Arm, w: Point) => Pair[]} */
function posturesRR({ d, e, s1, s2 }, w) {
  const [l1, l2] = [Math.hypot(...d), Math.hypot(...e)];
  const cosine = (inner(w, w) - l1 * l1 - l2 * l2) / (2 * l1 * l2);
  const phi = Math.acos(Math.min(1, Math.max(-1, cosine)));
  return [phi, -phi].map((bend) => {
    const second = s2 * (bend - angle(e) + angle(d));
    const reach = plus(d, times(turnedBy(s2 * second), e));
    return [wrapped(s1 * (angle(w) - angle(reach))), wrapped(second)];
  });
}

/** @type {(arm: Arm, w: Point) => Pair[]} */
function posturesRP({ d, e, s1 }, w) {
  const middle = -inner(d, e) / inner(e, e);
  const square = (inner(w, w) - inner(d, d)) / inner(e, e) + middle * middle;
  const half = Math.sqrt(Math.max(0, square));
  return [middle + half, middle - half].map((second) => {
    const reach = plus(d, [second * e[0], second * e[1]]);
    return [wrapped(s1 * (angle(w) - angle(reach))), second];
  });
}

/** @type {(arm: Arm, w: Point) => Pair[]} */
function posturesPR({ d, e, s2 }, w) {
  const middle = inner(d, w) / inner(d, d);
  const square = (inner(e, e) - inner(w, w)) / inner(d, d) + middle * middle;
  const half = Math.sqrt(Math.max(0, square));
  return [middle + half, middle - half].map((first) => {
    const rest = minus(w, [first * d[0], first * d[1]]);
    return [first, wrapped(s2 * (angle(rest) - angle(e)))];
  });
}

/** @type {(arm: Arm, w: Point) => Pair[]} */
function posturesPP({ d, e }, w) {
  const area = cross(d, e);
  return area === 0 ? [] : [[cross(w, e) / area, cross(d, w) / area]];
}

/** The postures that the joints' ranges allow, angles turned into them.
 * @type {(robot: Robot, arm: Arm, target: Point) => Pair[]} */
function possible(robot, arm, target) {
  const kinds = freeKinds(robot);
  const turned = postures(arm, target).map((pair) =>
    pair.map((value, k) => turnsWithin(kinds[k], value, robot.views[k])[0]),
  );
  return turned.filter((pair) => pair.every((value) => value !== undefined));
}

/** Whether det J has the same sign at two poses; 0 counts as positive.
 * @type {(map: ToolMap, one: Pair, other: Pair) => boolean} */
function isLikePosture(map, one, other) {
  return determinant(map, one) >= 0 === determinant(map, other) >= 0;
}

/** The other posture at the tool's place; null where a limit forbids it or there is none.
 * @type {(robot: Robot, map: ToolMap, arm: Arm, pair: Pair) => Pair | null} */
function otherPosture(robot, map, arm, pair) {
  const found = possible(robot, arm, toolAt(map, pair));
  return found.find((one) => !isLikePosture(map, one, pair)) ?? null;
}

/** The pose of an RR arm whose joints and tool are mirrored in the vertical through joint one.
 * @type {(arm: Arm, pair: Pair) => Pair} */
function mirroredPose(arm, pair) {
  const { d, e, s1, s2 } = arm;
  const upper = times(turnedBy(s1 * pair[0]), d);
  const fore = times(turnedBy(s1 * pair[0] + s2 * pair[1]), e);
  const first = s1 * (angle(mirrored(upper)) - angle(d));
  const second = s2 * (angle(mirrored(fore)) - angle(e) - s1 * first);
  return [wrapped(first), wrapped(second)];
}
