"use strict";
/* Whole bodies beside their points: outlines, what they share, how far apart they are. */
{
  const { framesOf, placeIn, project, viewAxes } = qboundEngine;

  /** The outlines of all bodies in the plane of motion.
   * @type {(robot: Robot, q: Pose) => Point[][]} */
  function outlines(robot, q) {
    const [frames, axes] = [framesOf(robot, q), viewAxes(robot, q)];
    return robot.bodies.map(({ frame, outline }) =>
      anticlockwise(outline.map((at) => project(axes, placeIn(frames[frame], at)))),
    );
  }

  /** @type {(corners: Point[]) => Point[]} */
  function anticlockwise(corners) {
    return area(corners) < 0 ? [...corners].reverse() : corners;
  }

  /** @type {(corners: Point[]) => number} */
  function area(corners) {
    return corners.reduce((total, [x, y], i) => {
      const [nextX, nextY] = corners[(i + 1) % corners.length];
      return total + (x * nextY - nextX * y) / 2;
    }, 0);
  }

  /** How far a point lies on the outer side of the line from a to b.
   * @type {(a: Point, b: Point, p: Point) => number} */
  function beyond(a, b, p) {
    const [x, y] = [b[0] - a[0], b[1] - a[1]];
    return ((p[0] - a[0]) * y - (p[1] - a[1]) * x) / Math.hypot(x, y);
  }

  /** What two convex outlines share (Sutherland and Hodgman); no corners where nothing.
   * @type {(one: Point[], other: Point[]) => Point[]} */
  function shared(one, other) {
    return other.reduce((corners, a, i) => {
      const b = other[(i + 1) % other.length];
      return corners.flatMap((p, j) => {
        const r = corners[(j + 1) % corners.length];
        const [from, to] = [beyond(a, b, p), beyond(a, b, r)];
        const share = from / (from - to);
        const cut = [p[0] + share * (r[0] - p[0]), p[1] + share * (r[1] - p[1])];
        return [...(from <= 0 ? [p] : []), ...(from <= 0 !== to <= 0 ? [cut] : [])];
      });
    }, one);
  }

  /** How far two convex outlines are apart; where they overlap, minus the shortest way out
      (separating axes, as qbound.measures.bodies.gap).
   * @type {(one: Point[], other: Point[]) => number} */
  function gap(one, other) {
    const depth = Math.max(pastEdges(one, other), pastEdges(other, one));
    if (depth <= 0) return depth;
    return Math.min(nearestCorner(one, other), nearestCorner(other, one));
  }

  /** @type {(one: Point[], other: Point[]) => number} */
  function pastEdges(one, other) {
    const sides = one.map((a, i) =>
      Math.min(...other.map((p) => beyond(a, one[(i + 1) % one.length], p))),
    );
    return Math.max(...sides);
  }

  /** @type {(one: Point[], other: Point[]) => number} */
  function nearestCorner(one, other) {
    return Math.min(
      ...one.flatMap(([ax, ay], i) => {
        const [bx, by] = one[(i + 1) % one.length];
        const [x, y] = [bx - ax, by - ay];
        return other.map(([px, py]) => {
          const t = ((px - ax) * x + (py - ay) * y) / (x * x + y * y);
          const share = Math.min(1, Math.max(0, t));
          return Math.hypot(ax + share * x - px, ay + share * y - py);
        });
      }),
    );
  }

  /** Every pair of bodies: its frames, its gap and what it shares.
   * @type {(robot: Robot, q: Pose) => BodyPair[]} */
  function bodyPairs(robot, q) {
    const placed = outlines(robot, q);
    return placed.flatMap((one, i) =>
      placed.slice(i + 1).map((other, k) => ({
        frames: [robot.bodies[i].frame, robot.bodies[i + 1 + k].frame],
        gap: gap(one, other),
        shared: shared(one, other),
      })),
    );
  }

  qboundFigures.bodies = Object.assign(() => {}, { outlines, area, gap, shared, bodyPairs });
}
