"use strict";
/* The explorer's arithmetic. It repeats the library's and knows no page: tests/test_explorer.py
   runs it beside Python. `robot` is the JSON of qbound/explorer.py; angles in radians. */

const TURN = 2 * Math.PI;
const LOWER = -1; // labels of an interval's end: a limit of the second joint, or
const UPPER = -2;
const SEAM = -3; // where a joint that turns all the way round is cut open for drawing
const RINGS = 12; // scales of a polygon, and
const STEPS = 48; // places on an edge, at which the clearance is computed

/* --- harmonic forms: sums over products of (1, cos q, sin q) or (1, q, q^2) ------------------- */

/** @type {(kind: Kind, q: number) => number[]} */
function basis(kind, q) {
  return kind === "revolute" ? [1, Math.cos(q), Math.sin(q)] : [1, q, q * q];
}

/** @type {(kind: Kind, q: number) => number[]} */
function basisSlope(kind, q) {
  return kind === "revolute" ? [0, -Math.sin(q), Math.cos(q)] : [0, 1, 2 * q];
}

/** Hold all joints but the two free ones: the 3 by 3 coefficients that are left.
    A form is a list of terms [coefficient, index of joint 1's factor, of joint 2's, ...].
 * @type {(form: Term[], robot: Robot, q: Pose) => Matrix} */
function restrict(form, robot, q) {
  const [first, second] = robot.free;
  const factors = robot.joints.map((joint, j) => basis(joint.kind, q[j]));
  const left = [
    [0, 0, 0],
    [0, 0, 0],
    [0, 0, 0],
  ];
  for (const [coefficient, ...index] of form) {
    let value = coefficient;
    index.forEach((k, j) => {
      if (j !== first && j !== second) value *= factors[j][k];
    });
    left[index[first]][index[second]] += value;
  }
  return left;
}

/** x' M y for two factors of three.
 * @type {(matrix: Matrix, x: number[], y: number[]) => number} */
function evaluate(matrix, x, y) {
  let sum = 0;
  for (let i = 0; i < 3; i += 1) {
    sum += x[i] * (matrix[i][0] * y[0] + matrix[i][1] * y[1] + matrix[i][2] * y[2]);
  }
  return sum;
}

/** The one-joint form (constant, a, b) along the second joint at a value of the first.
 * @type {(matrix: Matrix, x: number[]) => number[]} */
function alongSecond(matrix, x) {
  return [0, 1, 2].map((k) => x[0] * matrix[0][k] + x[1] * matrix[1][k] + x[2] * matrix[2][k]);
}

/** @type {(robot: Robot) => Kind[]} */
function freeKinds(robot) {
  return robot.free.map((j) => robot.joints[j].kind);
}

/* --- vectors, turns, frames: qbound.robot (Table 2) ------------------------------------------- */

const IDENTITY = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];

/** @type {(a: Place, b: Place) => number} */
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @type {(matrix: Matrix, v: Place) => Place} */
function apply(matrix, v) {
  return matrix.map((row) => dot(row, v));
}

/** @type {(a: Place, b: Place) => Place} */
function add(a, b) {
  return a.map((value, i) => value + b[i]);
}

/** @type {(a: Matrix, b: Matrix) => Matrix} */
function product(a, b) {
  return a.map((row) =>
    [0, 1, 2].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k]),
  );
}

/** Rodrigues' formula about a unit axis.
 * @type {(axis: Place, q: number) => Matrix} */
function axisTurn([x, y, z], q) {
  const [c, s, t] = [Math.cos(q), Math.sin(q), 1 - Math.cos(q)];
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
  ];
}

/** The base and the frame after each joint: turn and place, seen from the base.
 * @type {(robot: Robot, q: Pose) => Frame[]} */
function framesOf(robot, q) {
  const found = [{ turn: IDENTITY, place: [0, 0, 0] }];
  robot.joints.forEach((joint, j) => {
    const { turn, place } = found[j];
    const mounted = product(turn, joint.mount);
    const turns = joint.kind === "revolute";
    const slide = turns ? [0, 0, 0] : joint.axis.map((value) => value * q[j]);
    found.push({
      turn: turns ? product(mounted, axisTurn(joint.axis, q[j])) : mounted,
      place: add(add(place, apply(turn, joint.origin)), apply(mounted, slide)),
    });
  });
  return found;
}

/** A place fixed in one of the frames, seen from the base.
 * @type {(frame: Frame, at: Place) => Place} */
function placeIn(frame, at) {
  return add(frame.place, apply(frame.turn, at));
}

/** @type {(robot: Robot, q: Pose) => Place[]} */
function pointPlaces(robot, q) {
  const found = framesOf(robot, q);
  return robot.points.map((point) => placeIn(found[point.frame], point.at));
}

/* --- margins: qbound.region.violated (eqs. 10-12) --------------------------------------------- */

/** One margin a wall, negative where it is violated; a length, or for a limit a joint value.
 * @type {(robot: Robot, q: Pose) => Margin[]} */
function margins(robot, q) {
  const places = pointPlaces(robot, q);
  /** @type {(wall: Wall) => Margin} */
  const marginOf = (wall) => ({
    name: wall.name,
    value: wall.kind === "pair" ? pairMargin(wall, places) : halfSpaceMargin(wall, places),
    used: wall.used,
    unit: "length",
  });
  return [...robot.boundaries.map(marginOf), ...limitMargins(robot, q)];
}

/** @type {(wall: PairWall, places: Place[]) => number} */
function pairMargin(wall, places) {
  const [a, b] = wall.points.map((i) => places[i]);
  return Math.hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]) - wall.required;
}

/** @type {(wall: HalfSpaceWall, places: Place[]) => number} */
function halfSpaceMargin(wall, places) {
  return dot(wall.normal, places[wall.points[0]]) - wall.offset;
}

/** @type {(robot: Robot, q: Pose) => Margin[]} */
function limitMargins(robot, q) {
  return robot.limits.map((limit) => {
    const joint = robot.joints[limit.joint];
    return {
      name: limit.name,
      value: limit.side * (limit.value - around(joint, q[limit.joint], limit.middle)),
      used: true,
      unit: joint.kind === "revolute" ? "angle" : "length",
    };
  });
}

/** A joint that turns all the way round has no beginning: its value nearest to `middle`.
 * @type {(joint: Joint, q: number, middle: number) => number} */
function around(joint, q, middle) {
  return joint.wraps ? q - TURN * Math.round((q - middle) / TURN) : q;
}

/** The margin that is smallest for its size: lengths by the robot's reach, angles by a turn.
 * @type {(robot: Robot, found: Margin[]) => Margin | null} */
function tightest(robot, found) {
  const used = found.filter((one) => one.used);
  return leastBy(used, (one) => one.value / (one.unit === "angle" ? 1 : robot.reach));
}

/** @type {(found: Margin[]) => boolean} */
function isSafe(found) {
  return found.every((one) => !one.used || one.value >= 0);
}

/** The entry whose size is least, the first of equals; null where there is none.
 * @template T
 * @param {T[]} all
 * @param {(one: T) => number} size
 * @returns {T | null} */
function leastBy(all, size) {
  const sizes = all.map(size);
  return all[sizes.indexOf(Math.min(...sizes))] ?? null;
}

/* --- the plane of motion ---------------------------------------------------------------------- */

/** Two unit vectors of the plane that is drawn, turned with the frame that carries it.
 * @type {(robot: Robot, q: Pose) => Place[]} */
function viewAxes(robot, q) {
  const { turn } = framesOf(robot, q)[robot.plane.frame];
  return [apply(turn, robot.plane.u), apply(turn, robot.plane.v), apply(turn, robot.plane.n)];
}

/** @type {(axes: Place[], place: Place) => Point} */
function project(axes, place) {
  return [dot(axes[0], place), dot(axes[1], place)];
}

/** The tool's place in the plane as two forms of the free joints, and whether it stays there.
 * @type {(robot: Robot, q: Pose) => ToolMap} */
function toolMap(robot, q) {
  const seen = robot.tool_forms.map((form) => restrict(form, robot, q));
  /** @type {(axis: Place) => Matrix} */
  const along = (axis) =>
    [0, 1, 2].map((i) =>
      [0, 1, 2].map((k) => dot(axis, [seen[0][i][k], seen[1][i][k], seen[2][i][k]])),
    );
  const [x, y, out] = viewAxes(robot, q).map(along);
  const depth = out
    .flat()
    .slice(1)
    .reduce((most, value) => Math.max(most, Math.abs(value)), 0);
  return { x, y, kinds: freeKinds(robot), planar: depth <= 1e-9 * robot.reach };
}

/** @type {(map: ToolMap, pair: Pair) => Point} */
function toolAt(map, pair) {
  const [a, b] = [basis(map.kinds[0], pair[0]), basis(map.kinds[1], pair[1])];
  return [evaluate(map.x, a, b), evaluate(map.y, a, b)];
}

/** det J of the tool in the plane: its sign is the posture, 0 the singular curve.
 * @type {(map: ToolMap, pair: Pair) => number} */
function determinant(map, pair) {
  const [a, b] = [basis(map.kinds[0], pair[0]), basis(map.kinds[1], pair[1])];
  const [da, db] = [basisSlope(map.kinds[0], pair[0]), basisSlope(map.kinds[1], pair[1])];
  return (
    evaluate(map.x, da, b) * evaluate(map.y, a, db) -
    evaluate(map.x, a, db) * evaluate(map.y, da, b)
  );
}

/* --- complex numbers [re, im], for kinematics in the plane ------------------------------------ */

/** @type {(a: Point, b: Point) => Point} */
const minus = (a, b) => [a[0] - b[0], a[1] - b[1]];
/** @type {(a: Point, b: Point) => Point} */
const plus = (a, b) => [a[0] + b[0], a[1] + b[1]];
/** @type {(a: Point, b: Point) => Point} */
const times = (a, b) => [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
/** @type {(a: Point, b: Point) => number} */
const inner = (a, b) => a[0] * b[0] + a[1] * b[1];
/** @type {(a: Point, b: Point) => number} */
const cross = (a, b) => a[0] * b[1] - a[1] * b[0];
/** @type {(a: Point) => number} */
const angle = (a) => Math.atan2(a[1], a[0]);
/** @type {(q: number) => Point} */
const turnedBy = (q) => [Math.cos(q), Math.sin(q)];
/** @type {(a: Point) => Point} */
const mirrored = (a) => [-a[0], a[1]];

/** @type {(q: number) => number} */
function wrapped(q) {
  return q - TURN * Math.ceil((q - Math.PI) / TURN);
}

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

/* --- fibres and cells of a slice: Theorem 2 along the second joint ----------------------------- */

/** What bounds a slice: its walls' forms at the held values of q, and the ranges of both joints.
 * @type {(robot: Robot, q: Pose) => SliceProblem} */
function sliceProblem(robot, q) {
  const walls = robot.boundaries.filter((wall) => wall.used);
  return {
    kinds: freeKinds(robot),
    forms: walls.map((wall) => restrict(wall.form, robot, q)),
    names: walls.map((wall) => wall.name),
    ranges: robot.free.map((joint, k) => rangeOf(robot, joint, robot.views[k])),
  };
}

/** The limits of a joint with their names; without limits one turn, cut open where the view is.
 * @type {(robot: Robot, joint: number, view: View) => NamedView} */
function rangeOf(robot, joint, view) {
  const [low, high] = robot.limits.filter((limit) => limit.joint === joint);
  if (!low) return { ...view, names: ["", ""] };
  return { low: low.value, high: high.value, wraps: false, names: [low.name, high.name] };
}

/** Roots of constant + a cos q + b sin q (all turns within the view), or + a q + b q^2.
 * @type {(kind: Kind, coefficients: number[], view: View) => number[]} */
function rootsWithin(kind, [constant, a, b], { low, high }) {
  let found = [];
  if (kind === "revolute") {
    const size = Math.hypot(a, b);
    if (size === 0 || Math.abs(constant) > size) return [];
    const [theta, alpha] = [Math.atan2(b, a), Math.acos(-constant / size)];
    for (const root of [theta - alpha, theta + alpha]) {
      const first = root + TURN * Math.ceil((low - root) / TURN);
      for (let value = first; value < high; value += TURN) found.push(value);
    }
  } else if (b === 0) {
    found = a === 0 ? [] : [-constant / a];
  } else {
    const square = a * a - 4 * b * constant;
    const q = -(a + (a < 0 ? -1 : 1) * Math.sqrt(Math.max(0, square))) / 2;
    found = square < 0 ? [] : q === 0 ? [0] : [q / b, constant / q];
  }
  return found.filter((value) => value > low && value < high);
}

/** The values of the second joint that are safe at one value of the first, with their ends.
 * @type {(problem: SliceProblem, first: number) => Interval[]} */
function fibre(problem, first) {
  const [kind, view] = [problem.kinds[1], problem.ranges[1]];
  const x = basis(problem.kinds[0], first);
  const lines = problem.forms.map((form) => alongSecond(form, x));
  const cuts = [{ at: view.low, by: view.wraps ? SEAM : LOWER }];
  lines.forEach((line, by) => {
    for (const at of rootsWithin(kind, line, view)) cuts.push({ at, by });
  });
  cuts.sort((a, b) => a.at - b.at);
  cuts.push({ at: view.high, by: view.wraps ? SEAM : UPPER });
  return cuts
    .slice(1)
    .map((high, i) => ({ low: cuts[i], high }))
    .filter(({ low, high }) => {
      const y = basis(kind, (low.at + high.at) / 2);
      return high.at > low.at && lines.every((line) => dot(line, y) > 0);
    });
}

/** @type {(intervals: Interval[]) => string} */
function signature(intervals) {
  return intervals.map(({ low, high }) => `${low.by},${high.by}`).join(";");
}

/** Whether every interval of one fibre goes on into the like one of the next.
 * @type {(a: Fibre, b: Fibre) => boolean} */
function goesOn(a, b) {
  return (
    signature(a.intervals) === signature(b.intervals) &&
    a.intervals.every((interval, k) => overlap(interval, b.intervals[k]) > 0)
  );
}

/** Fibres over the first joint's range, closer and closer to where their intervals change.
 * @type {(problem: SliceProblem, count: number) => Fibre[]} */
function fibres(problem, count) {
  const { low, high } = problem.ranges[0];
  const inset = (high - low) * 1e-9; // the ends themselves may be walls
  /** @type {(t: number) => Fibre} */
  const at = (t) => ({ t, intervals: fibre(problem, t) });
  const found = [at(low + inset)];
  /** @type {(a: Fibre, b: Fibre, depth: number) => void} */
  const narrow = (a, b, depth) => {
    if (depth > 0 && !goesOn(a, b)) {
      const middle = at((a.t + b.t) / 2);
      narrow(a, middle, depth - 1);
      narrow(middle, b, depth - 1);
    } else {
      found.push(b);
    }
  };
  for (let i = 1; i <= count; i += 1) {
    const t = low + inset + ((high - low - 2 * inset) * i) / count;
    narrow(found[found.length - 1], at(t), 14);
  }
  return found;
}

/** @type {(a: Span, b: Span) => number} */
function overlap(a, b) {
  return Math.min(a.high.at, b.high.at) - Math.max(a.low.at, b.low.at);
}

/** Cells: runs of fibres whose intervals keep their ends' names; joined ones share a `piece`.
 * @type {(problem: SliceProblem, count: number) => Cell[]} */
function sliceCells(problem, count) {
  const columns = fibres(problem, count);
  /** @type {Cell[]} */
  const all = [];
  /** @type {Cell[][]} */
  const joined = [];
  /** @type {Cell[]} */
  let before = [];
  columns.forEach(({ t, intervals }, i) => {
    const same = i > 0 && goesOn(columns[i - 1], columns[i]);
    const now = same ? before : intervals.map(newCell);
    if (!same) {
      now.forEach((cell, k) => {
        all.push(cell);
        before.forEach((other, m) => {
          if (overlap(intervals[k], columns[i - 1].intervals[m]) > 0) joined.push([cell, other]);
        });
      });
      joined.push(...seamPairs(now));
    }
    for (const [k, { low, high }] of intervals.entries()) now[k].rows.push([t, low.at, high.at]);
    before = now;
  });
  if (problem.ranges[0].wraps) joined.push(...basePairs(all, columns));
  numberPieces(all, joined);
  noteNeighbours(all, columns, problem.ranges[0].wraps);
  return all;
}

/** @type {(ends: Interval) => Cell} */
function newCell({ low, high }) {
  return { low: low.by, high: high.by, rows: [], piece: 0, before: [], after: [] };
}

/** Cells on both sides of the cut of a second joint that turns all the way round.
 * @type {(cells: Cell[]) => Cell[][]} */
function seamPairs(cells) {
  const top = cells.find((cell) => cell.high === SEAM);
  const bottom = cells.find((cell) => cell.low === SEAM);
  return top && bottom ? [[top, bottom]] : [];
}

/** Cells over the first and the last fibre of a first joint that turns all the way round.
 * @type {(all: Cell[], columns: Fibre[]) => Cell[][]} */
function basePairs(all, columns) {
  const [start, end] = [columns[0].t, columns[columns.length - 1].t];
  /** @type {(t: number) => (Span & { cell: Cell })[]} */
  const over = (t) =>
    all.flatMap((cell) =>
      cell.rows
        .filter((row) => row[0] === t)
        .map((row) => ({ cell, low: { at: row[1] }, high: { at: row[2] } })),
    );
  return over(start).flatMap((a) =>
    over(end)
      .filter((b) => overlap(a, b) > 0)
      .map((b) => [a.cell, b.cell]),
  );
}

/** @type {(all: Cell[], joined: Cell[][]) => void} */
function numberPieces(all, joined) {
  all.forEach((cell, i) => {
    cell.piece = i;
  });
  for (let changed = true; changed; ) {
    changed = false;
    for (const [a, b] of joined) {
      if (a.piece !== b.piece) {
        a.piece = b.piece = Math.min(a.piece, b.piece);
        changed = true;
      }
    }
  }
}

/** Give each cell the safe intervals just before it and just after it.
 * @type {(all: Cell[], columns: Fibre[], wraps: boolean) => void} */
function noteNeighbours(all, columns, wraps) {
  const places = columns.map(({ t }) => t);
  /** @type {(t: number, step: number) => Interval[]} */
  const beside = (t, step) => {
    const i = places.indexOf(t) + step;
    return (wraps ? columns.at(i % columns.length) : columns[i])?.intervals ?? [];
  };
  for (const cell of all) {
    cell.before = beside(cell.rows[0][0], -1);
    cell.after = beside(cell.rows[cell.rows.length - 1][0], 1);
  }
}

/** The boundary of a slice's cells as polylines with the names of their walls.
 * @type {(problem: SliceProblem, cells: Cell[]) => Edge[]} */
function cellEdges(problem, cells) {
  return cells.flatMap((cell) => [
    ...curveEdges(problem, cell, cell.low, 1),
    ...curveEdges(problem, cell, cell.high, 2),
    ...wallEdges(problem, cell, cell.rows[0], cell.before, 0),
    ...wallEdges(problem, cell, cell.rows[cell.rows.length - 1], cell.after, 1),
  ]);
}

/** The curve below (k = 1) or above (k = 2) a cell; none where it is only cut open for drawing.
 * @type {(problem: SliceProblem, cell: Cell, by: number, k: 1 | 2) => Edge[]} */
function curveEdges(problem, cell, by, k) {
  if (by === SEAM) return [];
  const boundary = by >= 0 ? problem.names[by] : problem.ranges[1].names[by === LOWER ? 0 : 1];
  return [{ boundary, piece: cell.piece, points: cell.rows.map((row) => [row[0], row[k]]) }];
}

/** The parts of a cell's first or last row at which the cell ends.
 * @type {(problem: SliceProblem, cell: Cell, row: Row, beyond: Interval[], side: 0 | 1) => Edge[]} */
function wallEdges(problem, cell, row, beyond, side) {
  const t = row[0];
  return uncovered(row, beyond).map(([low, high]) => ({
    boundary: wallName(problem, t, (low + high) / 2, side),
    piece: cell.piece,
    points: [
      [t, low],
      [t, high],
    ],
  }));
}

/** The parts of a fibre's interval that no neighbouring interval goes on from.
 * @type {(row: Row, beyond: Interval[]) => number[][]} */
function uncovered([, low, high], beyond) {
  let from = low;
  const found = [];
  for (const other of beyond) {
    if (other.low.at > from) found.push([from, Math.min(high, other.low.at)]);
    from = Math.max(from, other.high.at);
  }
  if (high > from) found.push([from, high]);
  return found.filter(([a, b]) => b - a > 1e-3 * (high - low));
}

/** The wall that stands across the first joint: one of its limits, or the form that is least.
 * @type {(problem: SliceProblem, first: number, second: number, side: number) => string} */
function wallName(problem, first, second, side) {
  const range = problem.ranges[0];
  const limit = side === 0 ? range.low : range.high;
  if (!range.wraps && Math.abs(first - limit) < 1e-6 * (range.high - range.low))
    return range.names[side];
  const [x, y] = [basis(problem.kinds[0], first), basis(problem.kinds[1], second)];
  const values = problem.forms.map((form) => Math.abs(evaluate(form, x, y)));
  return problem.names[values.indexOf(Math.min(...values))];
}

/** The part of a cell between two values of the second joint, as runs of rows.
 * @type {(rows: Row[], low: number, high: number) => Row[][]} */
function cutRows(rows, low, high) {
  /** @type {Row[][]} */
  const runs = [[]];
  rows.forEach(([t, a, b], i) => {
    const row = [t, Math.max(a, low), Math.min(b, high)];
    if (row[1] < row[2]) {
      runs[runs.length - 1].push(row);
    } else if (runs[runs.length - 1].length > 0 || i === 0) {
      runs.push([]);
    }
  });
  return runs.filter((run) => run.length > 1);
}

/** The outline of a run of rows in the plane of the joints, anticlockwise.
 * @type {(rows: Row[], steps?: number) => Pair[]} */
function outline(rows, steps = 1) {
  /** @type {(t: number, from: number, to: number) => Pair[]} */
  const upright = (t, from, to) =>
    Array.from({ length: steps }, (_, k) => [t, from + ((to - from) * k) / steps]);
  const [[start, bottom, top], [end, low, high]] = [rows[0], rows[rows.length - 1]];
  return [
    ...rows.map((row) => [row[0], row[1]]),
    ...upright(end, low, high),
    ...rows.map((row) => [row[0], row[2]]).reverse(),
    ...upright(start, top, bottom),
  ];
}

/** Images of cells in the plane of motion, apart by the sign of det J: the two postures.
 * @type {(map: ToolMap, arm: Arm, cells: Cell[], range: View) => Images} */
function postureImages(map, arm, cells, range) {
  const lines = singularValues(arm).flatMap((value) => turnsWithin(map.kinds[1], value, range));
  const ends = [range.low, ...lines.sort((a, b) => a - b), range.high];
  /** @type {Images} */
  const images = { positive: [], negative: [] };
  ends.slice(1).forEach((high, i) => {
    const inside = [cells[0] ? cells[0].rows[0][0] : 0, (ends[i] + high) / 2];
    const side = determinant(map, inside) > 0 ? images.positive : images.negative;
    for (const cell of cells) {
      for (const run of cutRows(cell.rows, ends[i], high)) {
        side.push(outline(run, 24).map((pair) => toolAt(map, pair)));
      }
    }
  });
  return images;
}

/** A value, or every turn of an angle, that lies within a range.
 * @type {(kind: Kind, value: number, view: View) => number[]} */
function turnsWithin(kind, value, { low, high }) {
  if (kind !== "revolute") return value > low && value < high ? [value] : [];
  const found = [];
  const first = value + TURN * Math.ceil((low - value) / TURN);
  for (let turn = first; turn < high; turn += TURN) found.push(turn);
  return found;
}

/** The piece that holds a configuration, or null where it is not safe.
 * @type {(cells: Cell[], pair: Pair) => number | null} */
function pieceAt(cells, [first, second]) {
  const found = cells.find(({ rows }) => {
    const i = rows.findIndex((row) => row[0] >= first);
    if (i < 0 || rows[0][0] > first) return false;
    const [b, a] = [rows[i], rows[Math.max(0, i - 1)]];
    const share = b[0] === a[0] ? 1 : (first - a[0]) / (b[0] - a[0]);
    return second > a[1] + share * (b[1] - a[1]) && second < a[2] + share * (b[2] - a[2]);
  });
  return found ? found.piece : null;
}

/* --- scaling and traversals: qbound.polygon, qbound.traversal ---------------------------------- */

/** @type {(vertices: Pair[], factor: number, centre: Pair) => Pair[]} */
function scaledPolygon(vertices, factor, centre) {
  return vertices.map((p) => p.map((value, k) => centre[k] + factor * (value - centre[k])));
}

/** Smallest length margin over the scaled polygon: its edges at this and at smaller scales.
 * @type {(robot: Robot, q: Pose, vertices: Pair[], factor: number, centre: Pair) => Least} */
function smallestClearance(robot, q, vertices, factor, centre) {
  const [kindA, kindB] = freeKinds(robot);
  const walls = robot.boundaries
    .filter((wall) => wall.used)
    .map((wall) => ({ wall, form: restrict(wall.form, robot, q) }));
  /** @type {Least} */
  let best = { value: Infinity, name: null, q: centre };
  for (let ring = 0; ring <= RINGS; ring += 1) {
    const corners = scaledPolygon(vertices, (factor * ring) / RINGS, centre);
    corners.forEach((start, i) => {
      const end = corners[(i + 1) % corners.length];
      for (let k = 0; k < STEPS; k += 1) {
        const at = start.map((value, j) => value + (k / STEPS) * (end[j] - value));
        const [x, y] = [basis(kindA, at[0]), basis(kindB, at[1])];
        for (const { wall, form } of walls) {
          const value = lengthOf(wall, evaluate(form, x, y));
          if (value < best.value) best = { value, name: wall.name, q: at };
        }
      }
    });
  }
  return best;
}

/** A form's value as a length: |B| - d_min for a pair, whose form is |B|^2 - d_min^2.
 * @type {(wall: Wall, value: number) => number} */
function lengthOf(wall, value) {
  if (wall.kind !== "pair") return value;
  return Math.sqrt(Math.max(0, value + wall.required * wall.required)) - wall.required;
}

/** Length of each straight piece of a path: the largest change of a joint, in views' widths.
 * @type {(robot: Robot, stops: Pair[]) => number[]} */
function pieceLengths(robot, stops) {
  const size = robot.views.map((view) => view.high - view.low);
  return stops
    .slice(1)
    .map((b, i) => Math.max(...b.map((value, k) => Math.abs(value - stops[i][k]) / size[k])));
}

/** The place on a path of straight pieces after a fraction of its length.
 * @type {(robot: Robot, stops: Pair[], fraction: number) => Pair} */
function alongPath(robot, stops, fraction) {
  const lengths = pieceLengths(robot, stops);
  let rest = Math.min(1, Math.max(0, fraction)) * lengths.reduce((sum, value) => sum + value, 0);
  for (let i = 0; i < lengths.length; i += 1) {
    if (rest <= lengths[i] || i === lengths.length - 1) {
      const share = lengths[i] === 0 ? 1 : Math.min(1, rest / lengths[i]);
      return stops[i].map((value, k) => value + share * (stops[i + 1][k] - value));
    }
    rest -= lengths[i];
  }
  return stops[0];
}
