"use strict";
/* Figure 6: the polygon scaled about its centroid, and how far the tool goes below its limit. */
{
  const { basis, basisSlope, evaluate, restrict, scaledPolygon } = qboundEngine;
  const PIECES = 24; // of an edge: on none of them does a floor's slope change its sign twice

  /** Least value of a form on a straight edge and where: at an end, or where the slope along the
      edge passes zero upward, found by bisection.
   * @type {(matrix: Matrix, start: Pair, end: Pair) => { value: number, q: Pair }} */
  function leastOnEdge(matrix, start, end) {
    const along = start.map((value, k) => end[k] - value);
    /** @type {(t: number) => Pair} */
    const at = (t) => start.map((value, k) => value + t * along[k]);
    /** @type {(q: Pair) => number} */
    const height = ([p, q]) => evaluate(matrix, basis("revolute", p), basis("revolute", q));
    /** @type {(t: number) => number} */
    const slope = (t) => {
      const [p, q] = at(t);
      return (
        along[0] * evaluate(matrix, basisSlope("revolute", p), basis("revolute", q)) +
        along[1] * evaluate(matrix, basis("revolute", p), basisSlope("revolute", q))
      );
    };
    const places = [start, end];
    for (let i = 0; i < PIECES; i += 1) {
      let [low, high] = [i / PIECES, (i + 1) / PIECES];
      if (slope(low) > 0 || slope(high) <= 0) continue;
      for (let step = 0; step < 50; step += 1) {
        const middle = (low + high) / 2;
        if (slope(middle) > 0) high = middle;
        else low = middle;
      }
      places.push(at(low));
    }
    const heights = places.map(height);
    const value = Math.min(...heights);
    return { value, q: places[heights.indexOf(value)] };
  }

  /** Every edge of the polygon at a scale: the least height of the tool above its limit, and where.
   * @type {(matrix: Matrix, polygon: VertexPolygon, factor: number) => { value: number, q: Pair }[]} */
  function edges(matrix, { vertices, centroid }, factor) {
    const corners = scaledPolygon(vertices, factor, centroid);
    return corners.map((corner, i) => leastOnEdge(matrix, corner, corners[(i + 1) % corners.length]));
  }

  function floorOf(robot) {
    return restrict(robot.boundaries.find((w) => w.kind !== 'pair' && w.used).form, robot, robot.q);
  }
  qboundFigures.scale = Object.assign(() => {}, { edges, floorOf });
}
