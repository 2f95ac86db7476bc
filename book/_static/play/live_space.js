"use strict";
/* Configuration space, live: where a link that turns about a point meets an obstacle, in closed form,
   and the free poses of two links, column by column.

   A link is a segment with a radius. An obstacle is a disc or a polygon, convex or not. The link from
   a point meets a convex body where that body, made thicker by the link's radius and cut off at the
   link's length, is seen from the point; so every edge and every disc forbids one interval of angles.
   Its ends are the roots of the contacts: the tip on a corner or an edge, the side on a corner.

   A column is a value of q1 with the exact free intervals of q2. There is one at every pixel, one on
   each side of every value of q1 at which the intervals of one obstacle change in number, and between
   neighbours that do not match more by halving. */
const qboundLiveSpace = (() => {
  const { CIRCLE, CLOSEST, SEAM, TURN, UPRIGHT, between, circleRoots, cross, encounter } =
    qboundEngine;
  const { holds, insert, isInside, joined, minus, onCircle, sides, toSegment } = qboundEngine;
  const { turnedBy, without, wrapped } = qboundEngine;
  const BESIDE = 1e-9; // rad, of a critical value: a column on each side
  const SMALLEST = 1e-6; // rad^2: a component below it is rounding, not counted
  const SIZES = { closest: CLOSEST, least: UPRIGHT, wraps: true };
  /** @type {number[]} */
  const NONE = [];
  /** @type {number[]} */
  const met = []; // used again and again

  /** A shape in the plane: its corners (a disc has one), a radius, and a disc around it all.
   * @type {(obstacle: LiveObstacle) => LiveShape} */
  function placed(obstacle) {
    const { kind, x, y, angle, sizes } = obstacle;
    const [cos, sin] = turnedBy(angle);
    const points = localCorners(obstacle).map(([a, b]) => [
      x + a * cos - b * sin,
      y + a * sin + b * cos,
    ]);
    const radius = kind === "disc" ? sizes[0] : 0;
    const size = Math.max(...points.map(([a, b]) => Math.hypot(a - x, b - y))) + radius;
    return { points, radius, x, y, size };
  }

  /** @type {(obstacle: LiveObstacle) => Point[]} */
  function localCorners({ kind, sizes, corners }) {
    if (kind === "disc") return [[0, 0]];
    if (kind === "polygon") return corners;
    const [a, b] = sizes.map((value) => value / 2);
    return [
      [-a, -b],
      [a, -b],
      [a, b],
      [-a, b],
    ];
  }

  /** Whether no two edges of a polygon meet but at their shared corner.
   * @type {(points: Point[]) => boolean} */
  function isSimple(points) {
    const size = Math.max(...points.flat().map(Math.abs));
    const edges = sides(points);
    return edges.every((one, i) => {
      const [, c] = edges[(i + 1) % edges.length];
      const [way, next] = [minus(one[1], one[0]), minus(c, one[1])];
      const isFlat = Math.abs(cross(way, next)) <= 1e-6 * size ** 2;
      if (isFlat && way[0] * next[0] + way[1] * next[1] <= 0) return false;
      const others = edges.slice(i + 2, i === 0 ? -1 : undefined);
      return others.every((other) => encounter(one, other).distance > 1e-6 * size);
    });
  }

  /* --- angles that an obstacle forbids ---------------------------------------------------------- */

  let [low, high] = [0, 0]; // of the interval that is being found, from a reference

  /** @type {(angle: number) => void} */
  function widen(angle) {
    if (angle < low) low = angle;
    if (angle > high) high = angle;
  }

  /** Angles at which a link meets a disc: its side's tangents, or its tip on the rim.
   * @type {(distance: number, length: number, reach: number) => number} */
  function halfAngle(distance, length, reach) {
    const square = distance * distance;
    if (square <= length * length + reach * reach) return Math.asin(reach / distance);
    const cosine = (square + length * length - reach * reach) / (2 * distance * length);
    return Math.acos(Math.min(1, cosine));
  }

  /** The interval of angles at which a link from the origin comes nearer to an edge than its radius,
      put into `found`; true where that is every angle.
   * @type {(ax: number, ay: number, bx: number, by: number, length: number, reach: number, found: number[]) => boolean} */
  function edgeAngles(ax, ay, bx, by, length, reach, found) {
    const [ex, ey] = [bx - ax, by - ay];
    const size = Math.sqrt(ex * ex + ey * ey);
    const [ux, uy] = [ex / size, ey / size];
    const [from, to] = [ax * ux + ay * uy, bx * ux + by * uy]; // along the edge's line
    const height = ay * ux - ax * uy; // of the line, over its left normal
    const foot = between(0, from, to);
    const nearest = Math.sqrt(foot * foot + height * height);
    if (nearest <= reach) return true;
    if (nearest >= length + reach) return false;
    // Angles are counted from the direction of the nearest place: all lie within a right angle.
    const reference = Math.atan2(foot * uy + height * ux, foot * ux - height * uy);
    const [nx, ny] = [foot, height]; // of it, in the edge's own axes
    low = Infinity;
    high = -Infinity;
    for (let end = 0; end < 2; end += 1) {
      const along = end === 0 ? from : to;
      const distance = Math.sqrt(along * along + height * height);
      if (distance >= length + reach) continue;
      const angle = Math.atan2(nx * height - ny * along, nx * along + ny * height);
      const half = halfAngle(distance, length, reach);
      widen(angle - half);
      widen(angle + half);
    }
    for (let side = -1; side <= 1; side += 2) {
      const level = height + side * reach; // the tip on the edge, from either side
      if (Math.abs(level) >= length) continue;
      const far = Math.sqrt(length * length - level * level);
      for (let way = -far; way <= far; way += 2 * far) {
        if (way >= from && way <= to)
          widen(Math.atan2(nx * level - ny * way, nx * way + ny * level));
        if (far === 0) break;
      }
    }
    if (high >= low) found.push(reference + low, reference + high);
    return false;
  }

  /** The angles at which a link that begins at a place meets a shape: pairs of ends in `found`, in no
      order, none wrapped; true where that is every angle.
   * @type {(x: number, y: number, length: number, radius: number, shape: LiveShape, found: number[]) => boolean} */
  function meetingAngles(x, y, length, radius, shape, found) {
    const [dx, dy] = [shape.x - x, shape.y - y];
    const far = length + radius + shape.size;
    if (dx * dx + dy * dy >= far * far) return false;
    const { points } = shape;
    const reach = radius + shape.radius;
    if (points.length === 1) {
      const distance = Math.sqrt(dx * dx + dy * dy);
      if (distance <= reach) return true;
      const [angle, half] = [Math.atan2(dy, dx), halfAngle(distance, length, reach)];
      found.push(angle - half, angle + half);
      return false;
    }
    let [ax, ay] = points[points.length - 1];
    ax -= x;
    ay -= y;
    for (let i = 0; i < points.length; i += 1) {
      const bx = points[i][0] - x;
      const by = points[i][1] - y;
      if (edgeAngles(ax, ay, bx, by, length, reach, found)) return true;
      ax = bx;
      ay = by;
    }
    return isInside(points, [x, y]);
  }

  /** Angles of the first link at which its end is just so far from a shape: there its fibres change.
   * @type {(length: number, distance: number, shape: LiveShape) => number[]} */
  function anglesAtDistance(length, distance, shape) {
    const { points, radius } = shape;
    const from = distance + radius;
    const atCorners = points.flatMap(([x, y]) =>
      circleRoots(x, y, (length * length + x * x + y * y - from * from) / (2 * length)),
    );
    const atEdges =
      points.length === 1
        ? []
        : sides(points).flatMap(([a, b]) => {
            const way = minus(b, a);
            const height = cross(way, a) / Math.hypot(...way);
            const [x, y] = [-way[1] / Math.hypot(...way), way[0] / Math.hypot(...way)];
            return [-1, 1].flatMap((side) => circleRoots(x, y, (height + side * from) / length));
          });
    return [...atCorners, ...atEdges].filter((angle) => {
      const end = turnedBy(angle).map((value) => length * value);
      const gaps = sides(points).map(([a, b]) => toSegment(end, a, b).gap);
      return Math.abs(Math.min(...gaps) - from) < 1e-7;
    });
  }

  /** The angles of the first joint at which the first link meets a shape.
   * @type {(arm: LiveArm, shape: LiveShape) => number[]} */
  function upperArm(arm, shape) {
    /** @type {number[]} */
    const found = [];
    const isEvery = meetingAngles(0, 0, arm.lengths[0], arm.radii[0], shape, found);
    return isEvery ? CIRCLE : onCircle(found, 0);
  }

  /** The angles of the second joint at which the second link meets a shape.
   * @type {(arm: LiveArm, shape: LiveShape, first: number) => number[]} */
  function forearm(arm, shape, first) {
    const [length, second] = arm.lengths;
    const x = length * Math.cos(first);
    const y = length * Math.sin(first);
    met.length = 0;
    if (meetingAngles(x, y, second, arm.radii[1], shape, met)) return CIRCLE;
    return met.length > 0 ? onCircle(met, first) : NONE;
  }

  /* --- how near a link is ----------------------------------------------------------------------- */

  /** Whether two segments cross.
   * @type {(a: Point, b: Point, c: Point, d: Point) => boolean} */
  function areCrossing(a, b, c, d) {
    const [one, other] = [minus(b, a), minus(d, c)];
    return (
      cross(one, minus(c, a)) * cross(one, minus(d, a)) < 0 &&
      cross(other, minus(a, c)) * cross(other, minus(b, c)) < 0
    );
  }

  /** The gap between a thick segment and a shape, the two nearest places of their cores, and the
      features there: end 0 or 1 of the link or its side; a corner, an edge. Not positive: they overlap
      (then no depth is told).
   * @type {(a: Point, b: Point, radius: number, shape: LiveShape) => LiveContact} */
  function contact(a, b, radius, shape) {
    const { points } = shape;
    /** @type {LiveContact} */
    let best = { gap: Infinity, places: [a, a], end: null, part: null, number: 0 };
    /** @type {(gap: number, places: Point[], end: number | null, part: "corner" | "edge" | null, number: number) => void} */
    const offer = (gap, places, end, part, number) => {
      if (gap < best.gap) best = { gap, places, end, part, number };
    };
    for (const [i, [corner, next]] of sides(points).entries()) {
      const near = toSegment(corner, a, b);
      const end = near.share === 0 ? 0 : near.share === 1 ? 1 : null;
      offer(near.gap, [near.at, corner], end, points.length > 1 ? "corner" : null, i);
      if (points.length === 1) break;
      for (const [k, tip] of [a, b].entries()) {
        const { gap, share, at } = toSegment(tip, corner, next);
        if (share > 0 && share < 1) offer(gap, [tip, at], k, "edge", i);
      }
      if (areCrossing(a, b, corner, next)) best = { ...best, gap: 0 };
    }
    if (points.length > 1 && isInside(points, a)) best = { ...best, gap: 0 };
    return { ...best, gap: best.gap - radius - shape.radius };
  }

  /** The base, the elbow and the tip of the arm.
   * @type {(arm: LiveArm, q: Pair) => Point[]} */
  function jointPlaces(arm, [first, second]) {
    const [a, b] = arm.lengths;
    const elbow = [a * Math.cos(first), a * Math.sin(first)];
    const both = first + second;
    return [[0, 0], elbow, [elbow[0] + b * Math.cos(both), elbow[1] + b * Math.sin(both)]];
  }

  /** The pose whose tool is at a place, or as near as the arm reaches, bent as it is.
   * @type {(arm: LiveArm, pair: Pair, place: Point) => Pair} */
  function poseAt({ lengths: [a, b] }, [first, second], place) {
    const arm = {
      kind: /** @type {const} */ ("rr"),
      c: [0, 0],
      d: [a, 0],
      e: [b, 0],
      s1: 1,
      s2: 1,
    };
    const [left, right] = qboundEngine.postures(arm, place);
    const bent = Math.sin(second) < 0 ? right : left;
    return Math.hypot(...place) < 1e-9 ? [first, bent[1]] : bent;
  }

  /** Both links against every shape.
   * @type {(arm: LiveArm, shapes: LiveShape[], q: Pair) => LiveEncounter[]} */
  function encounters(arm, shapes, q) {
    const places = jointPlaces(arm, q);
    return [0, 1].flatMap((link) =>
      shapes.map((shape, obstacle) => ({
        link,
        obstacle,
        ...contact(places[link], places[link + 1], arm.radii[link], shape),
      })),
    );
  }

  /* --- free poses ------------------------------------------------------------------------------- */

  /** What an obstacle forbids on every column of the grid.
   * @type {(arm: LiveArm, shape: LiveShape, count: number) => LiveForbidden} */
  function forbiddenBy(arm, shape, count) {
    const [length, second] = arm.lengths;
    const windows = upperArm(arm, shape);
    const columns = Array.from({ length: count + 1 }, (_, k) =>
      forearm(arm, shape, -Math.PI + (TURN * k) / count),
    );
    const reach = arm.radii[1];
    const critical = [reach, second + reach].flatMap((distance) =>
      anglesAtDistance(length, distance, shape),
    );
    return { windows, columns, critical: [...critical, ...windows].map((q) => wrapped(q)) };
  }

  /** A column of what no list of forbidden intervals holds.
   * @type {(q: number, lists: number[][]) => Column} */
  function freeColumn(q, lists) {
    if (lists.includes(CIRCLE)) return { q, free: [], by: [] };
    /** @type {number[]} */
    const sorted = [];
    for (const list of lists)
      for (let i = 0; i < list.length; i += 2) insert(sorted, list[i], list[i + 1]);
    const free = without(-Math.PI, Math.PI, joined(sorted));
    return { q, free, by: free.map((end) => (Math.abs(end) === Math.PI ? SEAM : 0)) };
  }

  /** The free poses of an arm among shapes, cached: what one shape forbids is found anew only when it
      or the arm is another one.
   * @type {(count: number) => LiveSpace} */
  function freeSpace(count) {
    /** @type {WeakMap<LiveShape, LiveForbidden>} */
    let known = new WeakMap();
    /** @type {LiveArm | null} */
    let knownArm = null;

    /** @type {(arm: LiveArm, shapes: LiveShape[]) => Column[]} */
    function columnsOf(arm, shapes) {
      if (arm !== knownArm) known = new WeakMap();
      knownArm = arm;
      const forbidden = shapes.map((shape) => {
        const found = known.get(shape) ?? forbiddenBy(arm, shape, count);
        known.set(shape, found);
        return found;
      });
      /** @type {(q: number, lists: () => number[][]) => Column} */
      const column = (q, lists) =>
        freeColumn(q, forbidden.some(({ windows }) => holds(windows, q)) ? [CIRCLE] : lists());
      /** @type {(q: number) => Column} */
      const fresh = (q) => column(q, () => shapes.map((shape) => forearm(arm, shape, q)));
      const grid = Array.from({ length: count + 1 }, (_, k) =>
        column(-Math.PI + (TURN * k) / count, () => forbidden.map((one) => one.columns[k])),
      );
      const critical = forbidden
        .flatMap((one) => one.critical)
        .flatMap((q) => [q - BESIDE, q + BESIDE])
        .filter((q) => q > -Math.PI && q < Math.PI);
      const all = [...grid, ...critical.map(fresh)].sort((a, b) => a.q - b.q);
      const apart = all.filter(({ q }, i) => i === 0 || q > all[i - 1].q);
      return qboundEngine.refined(apart, fresh, CLOSEST);
    }

    return { columnsOf };
  }

  /** The components of the columns' intervals, with areas: home's first, then the largest.
   * @type {(columns: Column[], home: Pair) => LiveRegions} */
  function regions(columns, home) {
    const { of, count } = qboundEngine.components(columns, true);
    const areas = new Float64Array(count);
    for (const [k, { q, free }] of columns.entries()) {
      const width = (columns[k + 1]?.q ?? q) - (columns[k - 1]?.q ?? q);
      for (const [i, piece] of of[k].entries())
        areas[piece] += ((free[2 * i + 1] - free[2 * i]) * width) / 2;
    }
    const first = qboundEngine.pieceAt(columns, of, home);
    const kept = [...areas.keys()].filter((i) => areas[i] > SMALLEST || i === first);
    kept.sort((a, b) => Number(b === first) - Number(a === first) || areas[b] - areas[a]);
    const numbers = new Map(kept.map((old, i) => [old, i]));
    return {
      columns,
      home: first !== null,
      areas: kept.map((i) => areas[i]),
      of: of.map((pieces) => pieces.map((old) => numbers.get(old) ?? -1)),
    };
  }

  /** The component of a pose, by its number; -1 where it has none.
   * @type {(found: LiveRegions, pair: Pair) => number} */
  function regionOf({ columns, of }, pair) {
    return qboundEngine.pieceAt(columns, of, pair) ?? -1;
  }

  /* --- outlines --------------------------------------------------------------------------------- */

  const CRISP = 0.05; // pixels: a point is left out where the line misses it by less

  /** A line from left to right without the points which it would hardly miss.
   * @type {(points: Point[]) => Point[]} */
  function crisp(points) {
    const kept = [points[0]];
    let [least, most] = [-Infinity, Infinity]; // slopes from the last kept point that miss none since
    for (let i = 1; i < points.length; i += 1) {
      const [x, y] = kept[kept.length - 1];
      const across = points[i][0] - x;
      const slope = (points[i][1] - y) / across;
      if (slope >= least && slope <= most) {
        least = Math.max(least, slope - CRISP / across);
        most = Math.min(most, slope + CRISP / across);
      } else {
        kept.push(points[i - 1]);
        [least, most] = [-Infinity, Infinity];
        i -= 1;
      }
    }
    if (points.length > 1) kept.push(points[points.length - 1]);
    return kept;
  }

  /** @type {(points: Point[]) => string} */
  function lineText(points) {
    const near = (/** @type {number} */ value) => Math.round(value * 20) / 20;
    return points.map(([x, y]) => `${near(x)} ${near(y)}`).join("L");
  }

  /** The outlines of what the columns hold, as paths: for each number in `of` what is to be filled, and
      the edges, which leave out where the square is cut. `scale` leads from angles to pixels.
   * @type {(columns: Column[], of: number[][], count: number, scale: LiveScale) => LiveOutline[]} */
  function outlines(columns, of, count, { x0, dx, y0, dy }) {
    const found = Array.from({ length: count }, () => ({ fill: "", edge: "" }));
    for (const { piece, low, high, rows } of qboundEngine.cells(columns, of)) {
      if (piece < 0) continue;
      const [lower, upper] = [1, 2].map((k) =>
        crisp(rows.map((row) => [x0 + dx * row[0], y0 + dy * row[k]])),
      );
      const [there, back] = [lineText(lower), lineText(upper.reverse())];
      found[piece].fill += `M${there}L${back}Z`;
      if (low !== SEAM) found[piece].edge += `M${there}`;
      if (high !== SEAM) found[piece].edge += `M${back}`;
    }
    for (const { q, low: from, high: to, piece } of qboundEngine.uprights(columns, of, SIZES)) {
      const ends = [from, to].map((value) => [x0 + dx * q, y0 + dy * value]);
      if (piece >= 0) found[piece].edge += `M${lineText(ends)}`;
    }
    return found;
  }

  return {
    placed,
    isSimple,
    upperArm,
    forearm,
    contact,
    jointPlaces,
    poseAt,
    encounters,
    freeSpace,
    regions,
    regionOf,
    outlines,
  };
})();
