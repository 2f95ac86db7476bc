/* Scaled polygons and paths of straight pieces: cspace.measures.scaling, cspace.paths.traversal. */

const RINGS = 12; // scales of a polygon, and
const STEPS = 48; // places on an edge, at which the clearance is computed

/** @type {(vertices: Pair[], factor: number, centre: Pair) => Pair[]} */
function scaledPolygon(vertices, factor, centre) {
  return vertices.map((p) => p.map((value, k) => centre[k] + factor * (value - centre[k])));
}

/** Smallest length margin over the scaled polygon: its edges at this and at smaller scales.
 * @type {(robot: Robot, q: Pose, vertices: Pair[], factor: number, centre: Pair) => Least} */
function smallestClearance(robot, q, vertices, factor, centre) {
  const [kindA, kindB] = freeKinds(robot);
  const used = robot.boundaries.filter((wall) => wall.used);
  const bodies = used.filter(isAboutBodies);
  const walls = used
    .filter((wall) => !isAboutBodies(wall))
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
        const found = bodies.length > 0 ? framesOf(robot, withPair(robot, q, at)) : [];
        for (const wall of bodies) {
          const value = bodiesMargin(robot, wall, found);
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

/** Random values of the free joints within what is drawn, the same every time (a congruential
    generator: next = 1664525 last + 1013904223, modulo 2^32).
 * @type {(robot: Robot) => Pair[]} */
function randomPairs(robot) {
  let last = 11;
  const next = () => {
    last = (Math.imul(last, 1664525) + 1013904223) >>> 0;
    return last / 2 ** 32;
  };
  return Array.from({ length: 1500 }, () =>
    robot.views.map(({ low, high }) => low + next() * (high - low)),
  );
}

/** The shortest way from one pair of joint values to another: a joint that wraps takes it.
 * @type {(robot: Robot, from: Pair, to: Pair) => Pair} */
function wayTo(robot, from, to) {
  return to.map((value, k) => (robot.views[k].wraps ? wrapped(value - from[k]) : value - from[k]));
}

/** Length of each straight piece of a path: the largest change of a joint, in views' widths.
 * @type {(robot: Robot, stops: Pair[]) => number[]} */
function pieceLengths(robot, stops) {
  const size = robot.views.map((view) => view.high - view.low);
  return stops
    .slice(1)
    .map((b, i) => Math.max(...b.map((value, k) => Math.abs(value - stops[i][k]) / size[k])));
}

/** The fractions of its length at which a path comes to its stops.
 * @type {(robot: Robot, stops: Pair[]) => number[]} */
function stopsAt(robot, stops) {
  const lengths = pieceLengths(robot, stops);
  return stops.map((_, i) => sum(lengths.slice(0, i)) / sum(lengths));
}

/** On which of so long pieces a fraction of their whole length lies, and the share of that piece.
 * @type {(lengths: number[], fraction: number) => { leg: number, share: number }} */
function legAt(lengths, fraction) {
  let rest = between(fraction, 0, 1) * sum(lengths);
  let leg = 0;
  while (leg < lengths.length - 1 && rest > lengths[leg]) {
    rest -= lengths[leg];
    leg += 1;
  }
  return { leg, share: lengths[leg] > 0 ? Math.min(1, rest / lengths[leg]) : 1 };
}

/** The place on a path of straight pieces after a fraction of its length.
 * @type {(robot: Robot, stops: Pair[], fraction: number) => Pair} */
function alongPath(robot, stops, fraction) {
  const { leg, share } = legAt(pieceLengths(robot, stops), fraction);
  return stops.length > 1 ? partWay(stops[leg], stops[leg + 1], share) : stops[0];
}
