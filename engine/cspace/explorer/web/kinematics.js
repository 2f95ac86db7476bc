/* Harmonic forms, frames, margins and the plane of motion of a robot. */

/* --- harmonic forms: sums over products of (1, cos q, sin q) or (1, q, q^2) ------------------- */

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

/* --- frames: cspace.robot (Table 2) ------------------------------------------------------------ */

/** The base and the frame after each step: turn and place, seen from the base.
 * @type {(robot: Robot, q: Pose) => Frame[]} */
function framesOf(robot, q) {
  const found = [{ turn: IDENTITY, place: [0, 0, 0] }];
  robot.steps.forEach((step, k) => {
    const { turn, place } = found[k];
    const mounted = product(turn, step.mount);
    const turns = robot.joints[step.joint].kind === "revolute";
    const by = step.sense * q[step.joint];
    const slide = turns ? [0, 0, 0] : step.axis.map((value) => value * by);
    found.push({
      turn: turns ? product(mounted, axisTurn(step.axis, by)) : mounted,
      place: add(add(place, apply(turn, step.origin)), apply(mounted, slide)),
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

/* --- margins: cspace.region.violated (eqs. 10-12) --------------------------------------------- */

/** One margin a wall, negative where it is violated; a length, or for a limit a joint value.
 * @type {(robot: Robot, q: Pose) => Margin[]} */
function margins(robot, q) {
  const found = framesOf(robot, q);
  const places = robot.points.map((point) => placeIn(found[point.frame], point.at));
  const placed = placedParts(robot, found);
  /** @type {(wall: Wall) => number} */
  const marginTo = (wall) => {
    if (isAboutBodies(wall)) return bodiesMargin(robot, wall, found, placed);
    return wall.kind === "pair" ? pairMargin(wall, places) : halfSpaceMargin(wall, places);
  };
  /** @type {(wall: Wall) => Margin} */
  const marginOf = (wall) => ({
    name: wall.name,
    value: marginTo(wall),
    used: wall.used,
    unit: "length",
  });
  return [...robot.boundaries.map(marginOf), ...limitMargins(robot, q)];
}

/** Whether a boundary is about bodies, not about points: then it has no form of its own.
 * @type {(wall: Wall) => wall is BodiesWall | HalfSpaceWall} */
function isAboutBodies(wall) {
  return wall.kind === "bodies" || (wall.kind === "half-space" && wall.body !== null);
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
    // A joint that turns all the way round has no beginning: its value nearest to the middle.
    const at = joint.wraps ? wrapped(q[limit.joint], limit.middle) : q[limit.joint];
    return {
      name: limit.name,
      value: limit.side * (limit.value - at),
      used: true,
      unit: joint.kind === "revolute" ? "angle" : "length",
    };
  });
}

/** @type {(robot: Robot, q: Pose, pair: Pair) => Pose} */
function withPair(robot, q, pair) {
  const pose = [...q];
  robot.free.forEach((j, k) => {
    pose[j] = pair[k];
  });
  return pose;
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
  const least = 1e-9 * robot.reach;
  /** @type {(joint: number) => boolean} */
  const moves = (joint) =>
    seen.some((form) =>
      form.some((row, i) => row.some((x, k) => [i, k][joint] > 0 && Math.abs(x) > least)),
    );
  const still = [0, 1].filter((joint) => !moves(joint));
  return { x, y, kinds: freeKinds(robot), planar: depth <= least, still };
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
