/* Distances of convex parts in the plane of motion, cspace.geometry.distance, and where along the
   second joint two bodies touch. A part is a convex core (a point, a segment, a polygon) with a
   radius. */

const TOUCH = 1e-9; // of the reach: so near to contact a root of a feature is one

/** The parts of bodies at a pose, of all or of some, in two coordinates of the plane of motion.
 * @type {(robot: Robot, found: Frame[], wanted?: number[]) => PlacedPart[][]} */
function placedParts(robot, found, wanted) {
  const [u, v] = robot.flat ?? IDENTITY;
  return robot.bodies.map(({ frame, parts }, i) => {
    if (wanted && !wanted.includes(i)) return [];
    return parts.map(({ corners, radius }) => ({
      radius,
      corners: corners.map((corner) => {
        const place = placeIn(found[frame], corner);
        return [dot(u, place), dot(v, place)];
      }),
    }));
  });
}

/** Edges of a core, each as its start, unit step, length and unit normal: outward of a polygon.
 * @type {(corners: Point[]) => CoreEdge[]} */
function coreEdges(corners) {
  if (corners.length === 1) return [];
  const sense = corners.length < 3 || area(corners) > 0 ? 1 : -1;
  return sides(corners).map(([start, end]) => {
    const [x, y] = minus(end, start);
    const length = Math.hypot(x, y);
    const normal = [(sense * y) / length, (-sense * x) / length];
    return { start, step: [x / length, y / length], length, normal };
  });
}

/** How far two cores are apart, negative by how deep they overlap, and the two places that show it.
 * @type {(one: Point[], other: Point[]) => Encounter} */
function encounter(one, other) {
  const beyond = [edgeGaps(one, other), edgeGaps(other, one).map(swapped)].flat();
  const most = leastBy(beyond, ({ distance }) => -distance);
  if (most && most.distance < 0 && !areBeside(one, other)) return most;
  const [near, back] = [nearestCorner(one, other), nearestCorner(other, one)];
  return near.distance <= back.distance ? near : swapped(back);
}

/** @type {(gap: Encounter) => Encounter} */
function swapped({ distance, places }) {
  return { distance, places: [places[1], places[0]] };
}

/** What the normal of each edge shows, the better one of a segment's two.
 * @type {(core: Point[], far: Point[]) => Encounter[]} */
function edgeGaps(core, far) {
  const senses = core.length < 3 ? [1, -1] : [1];
  return coreEdges(core).map(({ start, step, normal }) => {
    const found = senses.map((sense) => {
      const heights = far.map((corner) => sense * beside(corner, start, normal));
      const distance = Math.min(...heights);
      const corner = far[heights.indexOf(distance)];
      const along = beside(corner, start, step);
      return {
        distance,
        places: [[start[0] + along * step[0], start[1] + along * step[1]], corner],
      };
    });
    return found.reduce((best, gap) => (gap.distance > best.distance ? gap : best));
  });
}

/** How far a place lies from another one along a direction.
 * @type {(place: Point, start: Point, direction: Point) => number} */
function beside(place, start, direction) {
  return (place[0] - start[0]) * direction[0] + (place[1] - start[1]) * direction[1];
}

/** Whether two segments on one line are apart along it.
 * @type {(one: Point[], other: Point[]) => boolean} */
function areBeside(one, other) {
  if (one.length > 2 || other.length > 2) return false;
  return [
    [one, other],
    [other, one],
  ].some(([core, far]) =>
    coreEdges(core).some(({ start, step, length }) => {
      const along = far.map((corner) => beside(corner, start, step));
      return Math.min(...along) > length || Math.max(...along) < 0;
    }),
  );
}

/** The place of a core's edges and the corner of another core that are nearest to each other.
 * @type {(core: Point[], far: Point[]) => Encounter} */
function nearestCorner(core, far) {
  /** @type {Encounter} */
  let best = { distance: Infinity, places: [] };
  for (const [a, b] of sides(core)) {
    for (const corner of far) {
      const { gap, at } = toSegment(corner, a, b);
      if (gap < best.distance) best = { distance: gap, places: [at, corner] };
    }
  }
  return best;
}

/** The margin of two bodies, and the nearest places of the two parts that decide it.
 * @type {(wall: Pick<BodiesWall, "bodies" | "clearance">, placed: PlacedPart[][]) => Encounter} */
function bodiesEncounter(wall, placed) {
  const [ones, others] = wall.bodies.map((i) => placed[i]);
  /** @type {Encounter} */
  let least = { distance: Infinity, places: [] };
  for (const one of ones) {
    for (const other of others) {
      const { distance, places } = encounter(one.corners, other.corners);
      const value = distance - one.radius - other.radius - wall.clearance;
      if (value < least.distance)
        least = { distance: value, places: onSurfaces(places, one.radius, other.radius) };
    }
  }
  return least;
}

/** How far the bodies of each pair in `apart` are from each other: negative where they overlap.
 * @type {(robot: Robot, placed: PlacedPart[][]) => BodyGap[]} */
function bodyGaps(robot, placed) {
  return robot.apart.map((bodies) => {
    const gap = bodiesEncounter({ bodies, clearance: 0 }, placed).distance;
    return { bodies, gap, overlap: gap < -TOUCH * robot.reach };
  });
}

/** Two places of cores moved towards each other by the radii: where the surfaces are nearest.
 * @type {(places: Point[], one: number, other: number) => Point[]} */
function onSurfaces([a, b], one, other) {
  const size = Math.hypot(b[0] - a[0], b[1] - a[1]);
  if (size === 0) return [a, b];
  const [x, y] = [(b[0] - a[0]) / size, (b[1] - a[1]) / size];
  return [
    [a[0] + one * x, a[1] + one * y],
    [b[0] - other * x, b[1] - other * y],
  ];
}

/** The margin of a boundary about bodies; their parts are placed, unless that has been done.
 * @type {(robot: Robot, wall: BodiesWall | HalfSpaceWall, found: Frame[], placed?: PlacedPart[][]) => number} */
function bodiesMargin(robot, wall, found, placed) {
  if (wall.kind === "half-space") return lowestCorner(robot, wall, found).value;
  return bodiesEncounter(wall, placed ?? placedParts(robot, found, wall.bodies)).distance;
}

/** The corner of a body that is lowest over a wall, and how much; seen from the base.
 * @type {(robot: Robot, wall: HalfSpaceWall, found: Frame[]) => { value: number, place: Place }} */
function lowestCorner(robot, wall, found) {
  const heights = cornerHeights(robot, wall, found);
  return heights.reduce((least, one) => (one.value < least.value ? one : least));
}

/** How high each corner of a body is over a wall, less the radius, and the place of it there.
 * @type {(robot: Robot, wall: HalfSpaceWall, found: Frame[]) => { value: number, place: Place }[]} */
function cornerHeights(robot, wall, found) {
  const { frame, parts } = robot.bodies[wall.body ?? 0];
  return parts.flatMap(({ corners, radius }) =>
    corners.map((corner) => {
      const core = placeIn(found[frame], corner);
      const place = core.map((value, k) => value - radius * wall.normal[k]);
      return { value: dot(wall.normal, place) - wall.offset, place };
    }),
  );
}

/* --- contacts along the second joint ------------------------------------------------------------ */

/** Values of the second joint at which bodies touch, at one value of the first.
    Seen over the second joint each feature of two parts is a form of it: three values settle it.
 * @type {(problem: SliceProblem, first: number) => { at: number, by: number }[]} */
function bodyCuts(problem, first) {
  const { robot, bodies, kinds, ranges } = problem;
  if (bodies.length === 0) return [];
  const [kind, view] = [kinds[1], ranges[1]];
  const far = Math.max(Math.abs(view.low), Math.abs(view.high));
  const values = kind === "revolute" ? [0, TURN / 3, -TURN / 3] : [0, far, -far];
  const seen = values.map((second) => partsAt(problem, first, second));
  return bodies.flatMap((wall, i) => {
    const by = problem.forms.length + i;
    const touching = contactValues(wall, seen, kind, values, view).filter((at) => {
      const least = bodiesMargin(robot, wall, framesAt(problem, first, at));
      return Math.abs(least) <= TOUCH * robot.reach;
    });
    touching.sort((a, b) => a - b);
    return touching
      .filter((at, k) => k === 0 || at - touching[k - 1] > TOUCH)
      .map((at) => ({ at, by }));
  });
}

/** @type {(problem: SliceProblem, first: number, second: number) => Frame[]} */
function framesAt({ robot, q }, first, second) {
  return framesOf(robot, withPair(robot, q, [first, second]));
}

/** @type {(problem: SliceProblem, first: number, second: number) => Seen} */
function partsAt(problem, first, second) {
  const found = framesAt(problem, first, second);
  return { robot: problem.robot, found, placed: placedParts(problem.robot, found) };
}

/** Roots of the features of a boundary along the second joint, seen at three of its values.
 * @type {(wall: BodiesWall | HalfSpaceWall, seen: Seen[], kind: Kind, values: number[], view: View) => number[]} */
function contactValues(wall, seen, kind, values, view) {
  const rows = seen.map((one) => featureRows(wall, one));
  return rows[0].flatMap((_, i) => {
    const [form, ...sides] = rows[0][i].map((_, k) =>
      throughThree(
        kind,
        values,
        rows.map((row) => row[i][k]),
      ),
    );
    return rootsWithin(kind, form, view).filter((at) => {
      const factors = basis(kind, at);
      return sides.every((side) => dot(side, factors) >= -1e-6);
    });
  });
}

/** Each feature's value, 0 in contact, and the values that are not negative where it is one.
 * @type {(wall: BodiesWall | HalfSpaceWall, seen: Seen) => number[][]} */
function featureRows(wall, { robot, placed, found }) {
  if (wall.kind === "half-space")
    return cornerHeights(robot, wall, found).map((one) => [one.value]);
  const [ones, others] = wall.bodies.map((i) => placed[i]);
  return ones.flatMap((one) =>
    others.flatMap((other) => {
      const keep = one.radius + other.radius + wall.clearance;
      const rows = [
        ...edgeRows(one.corners, other.corners, keep),
        ...edgeRows(other.corners, one.corners, keep),
      ];
      return keep > 0 ? [...rows, ...cornerRows(one.corners, other.corners, keep)] : rows;
    }),
  );
}

/** @type {(core: Point[], far: Point[], keep: number) => number[][]} */
function edgeRows(core, far, keep) {
  const senses = core.length < 3 ? [1, -1] : [1];
  return (core.length > 1 ? coreEdges(core) : []).flatMap(({ start, step, length, normal }) =>
    far.flatMap((corner) => {
      const [height, along] = [beside(corner, start, normal), beside(corner, start, step)];
      return senses.map((sense) => [sense * height - keep, along, length - along]);
    }),
  );
}

/** @type {(core: Point[], far: Point[], keep: number) => number[][]} */
function cornerRows(core, far, keep) {
  const [steps, others] = [core, far].map((corners) =>
    corners.map((_, i) => stepsFrom(corners, i)),
  );
  return core.flatMap((p, i) =>
    far.map((r, k) => [
      (r[0] - p[0]) ** 2 + (r[1] - p[1]) ** 2 - keep * keep,
      ...steps[i].map((step) => -beside(r, p, step)),
      ...others[k].map((step) => beside(r, p, step)),
    ]),
  );
}

/** Unit steps from a corner to its neighbours.
 * @type {(corners: Point[], i: number) => Point[]} */
function stepsFrom(corners, i) {
  const n = corners.length;
  const near = n < 3 ? [1 - i].filter((k) => k >= 0 && k < n) : [(i + 1) % n, (i + n - 1) % n];
  return near.map((k) => {
    const way = minus(corners[k], corners[i]);
    return way.map((value) => value / Math.hypot(...way));
  });
}
