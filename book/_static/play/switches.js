"use strict";
/* Figure 4: the bounds of Table 6 in the square of both joints, each of which can be switched off. */
{
  const TURN = 2 * Math.PI;
  const { alongSecond, apply, basis, framesOf, placeIn, restrict, rootsWithin } = qboundEngine;

  /** The components of a pair of points that depend on its joint: a cos q + b sin q = c where one
      vanishes (eq. 29).
   * @type {(robot: Robot, pair: PairWall) => Coefficients[]} */
  function components(robot, pair) {
    const [near, far] = pair.points
      .map((i) => robot.points[i])
      .sort((one, other) => one.frame - other.frame);
    /** @type {(q: number) => Place} */
    const vector = (q) => {
      const frames = framesOf(robot, robot.q.map((value, j) => (j === near.frame ? q : value)));
      const { turn, place } = frames[near.frame];
      const back = [0, 1, 2].map((k) => turn.map((row) => row[k]));
      const seen = placeIn(frames[far.frame], far.at).map((value, k) => value - place[k]);
      return apply(back, seen).map((value, k) => value - near.at[k]);
    };
    const [ahead, across, behind] = [0, TURN / 4, TURN / 2].map(vector);
    return ahead.flatMap((value, k) => {
      const c = -(value + behind[k]) / 2;
      const [a, b] = [value + c, across[k] + c];
      const moves = Math.hypot(a, b) > 1e-9;
      return moves ? [{ boundary: pair.name, component: k + 1, joint: near.frame, a, b, c }] : [];
    });
  }

  /** The printed inverse tangent of b / a, as it may be read.
   * @type {(a: number, b: number, reading: Reading) => number} */
  function direction(a, b, reading) {
    if (reading === "atan2") return Math.atan2(b, a);
    return Math.atan(b / a) + (reading === "plus" && a < 0 ? Math.PI : 0);
  }

  /** The sixteen bounds of the pairs of points: q <= value for k = 1, q >= value for k = 2.
   * @type {(robot: Robot, reading: Reading) => StraightBound[]} */
  function straightBounds(robot, reading) {
    const pairs = robot.boundaries.flatMap((wall) =>
      wall.kind === "pair" ? components(robot, wall) : [],
    );
    return pairs.flatMap(({ a, b, c, ...rest }) => {
      const upper = direction(a, b, reading) + Math.acos(c / Math.hypot(a, b));
      return [1, 2].map((k) => ({ ...rest, k, value: k === 1 ? upper : upper - TURN }));
    });
  }

  /** The walls: forms of both joints, whose roots along the second one are two bounds each.
   * @type {(robot: Robot) => CurvedWall[]} */
  function curvedWalls(robot) {
    return robot.boundaries.flatMap((wall) => {
      if (wall.kind === "pair") return [];
      const sizes = wall.normal.map(Math.abs);
      const component = sizes.indexOf(Math.max(...sizes)) + 1;
      return [{ boundary: wall.name, component, matrix: restrict(wall.form, robot, robot.q) }];
    });
  }

  /** The arc of the second joint on which a wall is respected: its middle, half its width, and
      whether it ends in roots.
   * @type {(matrix: Matrix, first: number) => WallArc} */
  function arcAt(matrix, first) {
    const [constant, a, b] = alongSecond(matrix, basis("revolute", first));
    const ratio = -constant / Math.hypot(a, b);
    const alpha = Math.acos(Math.min(1, Math.max(-1, ratio)));
    return { middle: Math.atan2(b, a), alpha, cuts: Math.abs(ratio) <= 1 };
  }

  /** The names of all bounds that a pose violates. A wall's bound forbids what lies between it and
      the direction opposite to the middle of its arc, modulo full turns.
   * @type {(straight: StraightBound[], walls: CurvedWall[], q: Pair) => string[]} */
  function violatedBounds(straight, walls, q) {
    const beyond = straight.filter(({ joint, k, value }) =>
      k === 1 ? q[joint] > value : q[joint] < value,
    );
    const curved = walls.flatMap(({ boundary, component, matrix }) => {
      const { middle, alpha } = arcAt(matrix, q[0]);
      const away = q[1] - middle - TURN * Math.round((q[1] - middle) / TURN);
      if (Math.abs(away) <= alpha) return [];
      return [nameOf({ boundary, component, k: away > 0 ? 1 : 2 })];
    });
    return [...beyond.map(nameOf), ...curved];
  }

  /** @type {(bound: { boundary: string, component: number, k: number }) => string} */
  function nameOf({ boundary, component, k }) {
    return `${boundary.slice(1)},${component},${k}`;
  }

  /** The box that straight bounds leave within a square, and the bound on each of its sides.
   * @type {(straight: StraightBound[], square: number[][]) => BoxSide[][]} */
  function box(straight, square) {
    return square.map((range, joint) =>
      range.map((end, side) => {
        /** @type {BoxSide} */
        let found = { value: end, by: null };
        for (const bound of straight) {
          if (bound.joint !== joint || (bound.k === 2) !== (side === 0)) continue;
          const tighter = side === 0 ? bound.value > found.value : bound.value < found.value;
          if (tighter) found = { value: bound.value, by: nameOf(bound) };
        }
        return found;
      }),
    );
  }

  /** Values of the first joint at which to draw a wall's curves: closer and closer to where they
      meet and end.
   * @type {(matrix: Matrix) => number[]} */
  function columns(matrix) {
    const view = { low: -Math.PI, high: Math.PI, wraps: true };
    const even = Array.from({ length: 361 }, (_, i) => ((i - 180) * Math.PI) / 180);
    const [, a, b] = alongSecond(matrix, basis("revolute", 0));
    const size = Math.hypot(a, b);
    const folds = [size, -size].flatMap((height) =>
      rootsWithin("revolute", [matrix[0][0] + height, matrix[1][0], matrix[2][0]], view),
    );
    const near = folds.flatMap((q) =>
      Array.from({ length: 41 }, (_, i) => q + ((i - 20) * Math.abs(i - 20) * Math.PI) / 72000),
    );
    return [...even, ...near].filter((q) => Math.abs(q) <= Math.PI).sort((p, q) => p - q);
  }

  /** A wall's bounds as curves, and what each forbids, without jumps by a turn.
   * @type {(matrix: Matrix) => CurveRow[]} */
  function curveRows(matrix) {
    let before = 0;
    return columns(matrix).map((first) => {
      const { middle, alpha, cuts } = arcAt(matrix, first);
      before = middle + TURN * Math.round((before - middle) / TURN);
      return { first, middle: before, alpha, cuts };
    });
  }

  qboundFigures.switches = Object.assign(() => {}, {
    straightBounds, curvedWalls, violatedBounds, box, curveRows
  });
}
