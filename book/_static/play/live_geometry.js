"use strict";
/* Configuration space, live: where a link that turns about a point meets an obstacle, in closed form.

   A link is a segment with a radius. An obstacle is a disc or a polygon, convex or not. The link from
   a point meets a convex body where that body, made thicker by the link's radius and cut off at the
   link's length, is seen from the point; so every edge and every disc forbids one interval of angles.
   Its ends are the roots of the contacts: the tip on a corner or an edge, the side on a corner. */
const qboundLiveGeometry = (() => {
  const TURN = 2 * Math.PI;

  /** A shape in the plane: its corners (a disc has one), a radius, and a disc around it all.
   * @type {(obstacle: LiveObstacle) => LiveShape} */
  function placed(obstacle) {
    const { x, y, angle } = obstacle;
    const [cos, sin] = [Math.cos(angle), Math.sin(angle)];
    const points = localCorners(obstacle).map(([a, b]) => [
      x + a * cos - b * sin,
      y + a * sin + b * cos,
    ]);
    const radius = obstacle.kind === "disc" ? obstacle.radius : 0;
    const size = Math.max(...points.map(([a, b]) => Math.hypot(a - x, b - y))) + radius;
    return { points, radius, x, y, size };
  }

  /** @type {(obstacle: LiveObstacle) => Point[]} */
  function localCorners(obstacle) {
    if (obstacle.kind === "disc") return [[0, 0]];
    if (obstacle.kind === "polygon") return obstacle.corners;
    const [a, b] = [obstacle.width / 2, obstacle.height / 2];
    return [
      [-a, -b],
      [a, -b],
      [a, b],
      [-a, b],
    ];
  }

  /** Whether a place lies inside a polygon.
   * @type {(points: Point[], x: number, y: number) => boolean} */
  function isInside(points, x, y) {
    let odd = false;
    for (let i = 0, j = points.length - 1; i < points.length; j = i, i += 1) {
      const [ax, ay] = points[j];
      const [bx, by] = points[i];
      if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) odd = !odd;
    }
    return odd;
  }

  /** Whether no two edges of a polygon meet but at their shared corner.
   * @type {(points: Point[]) => boolean} */
  function isSimple(points) {
    const n = points.length;
    const size = Math.max(...points.flat().map(Math.abs));
    for (let i = 0; i < n; i += 1) {
      const [a, b, c] = [points[i], points[(i + 1) % n], points[(i + 2) % n]];
      const flat = Math.abs(cross(a, b, c)) <= 1e-6 * size ** 2;
      if (flat && (b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]) <= 0) return false;
      for (let k = i + 2; k < n; k += 1) {
        if (i === 0 && k === n - 1) continue;
        if (segmentGap(a, b, points[k], points[(k + 1) % n]) <= 1e-6 * size) return false;
      }
    }
    return true;
  }

  /** @type {(a: Point, b: Point, c: Point) => number} */
  function cross([ax, ay], [bx, by], [cx, cy]) {
    return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
  }

  /** How far two segments are apart.
   * @type {(a: Point, b: Point, c: Point, d: Point) => number} */
  function segmentGap(a, b, c, d) {
    if (cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0) return 0;
    return Math.min(
      toSegment(a, c, d).gap,
      toSegment(b, c, d).gap,
      toSegment(c, a, b).gap,
      toSegment(d, a, b).gap,
    );
  }

  /** The place of a segment that is nearest to a point, and its share of the way.
   * @type {(p: Point, a: Point, b: Point) => { gap: number, share: number, at: Point }} */
  function toSegment([px, py], [ax, ay], [bx, by]) {
    const [ex, ey] = [bx - ax, by - ay];
    const square = ex * ex + ey * ey;
    const along = square > 0 ? ((px - ax) * ex + (py - ay) * ey) / square : 0;
    const share = Math.min(1, Math.max(0, along));
    const at = [ax + share * ex, ay + share * ey];
    return { gap: Math.hypot(px - at[0], py - at[1]), share, at };
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
    const foot = Math.min(to, Math.max(from, 0));
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
    return isInside(points, x, y);
  }

  /** Turn intervals by an angle into [-pi, pi], cut there, sorted, joined where they overlap.
   * @type {(found: number[], by: number) => number[]} */
  function wrapped(found, by) {
    /** @type {number[]} */
    const sorted = [];
    for (let i = 0; i < found.length; i += 2) {
      const size = found[i + 1] - found[i];
      if (size >= TURN) return [-Math.PI, Math.PI];
      const from = found[i] - by;
      const start = from - TURN * Math.floor((from + Math.PI) / TURN);
      insert(sorted, start, Math.min(Math.PI, start + size));
      if (start + size > Math.PI) insert(sorted, -Math.PI, start + size - TURN);
    }
    return joined(sorted);
  }

  /** @type {(sorted: number[], from: number, to: number) => void} */
  function insert(sorted, from, to) {
    let i = sorted.length;
    sorted.push(from, to);
    for (; i > 0 && sorted[i - 2] > from; i -= 2) {
      sorted[i] = sorted[i - 2];
      sorted[i + 1] = sorted[i - 1];
    }
    sorted[i] = from;
    sorted[i + 1] = to;
  }

  /** @type {(sorted: number[]) => number[]} */
  function joined(sorted) {
    let last = 0;
    for (let i = 2; i < sorted.length; i += 2) {
      if (sorted[i] <= sorted[last + 1])
        sorted[last + 1] = Math.max(sorted[last + 1], sorted[i + 1]);
      else {
        last += 2;
        sorted[last] = sorted[i];
        sorted[last + 1] = sorted[i + 1];
      }
    }
    if (last + 2 < sorted.length) sorted.length = last + 2;
    return sorted;
  }

  /** Angles of the first link at which its end is just so far from a shape: there its fibres change.
   * @type {(length: number, distance: number, shape: LiveShape) => number[]} */
  function anglesAtDistance(length, distance, shape) {
    /** @type {number[]} */
    const all = [];
    const { points } = shape;
    const from = distance + shape.radius;
    for (const [i, [x, y]] of points.entries()) {
      const far = Math.hypot(x, y);
      const cosine = (length * length + far * far - from * from) / (2 * length * far);
      if (Math.abs(cosine) <= 1)
        for (const side of [-1, 1]) all.push(Math.atan2(y, x) + side * Math.acos(cosine));
      if (points.length === 1) break;
      const [ex, ey] = [
        points[(i + 1) % points.length][0] - x,
        points[(i + 1) % points.length][1] - y,
      ];
      const size = Math.hypot(ex, ey);
      for (const side of [-1, 1]) {
        const level = (x * -ey + y * ex) / size + side * from;
        if (Math.abs(level) > length) continue;
        const normal = Math.atan2(ex, -ey);
        for (const way of [-1, 1]) all.push(normal + way * Math.acos(level / length));
      }
    }
    return all.filter((angle) => {
      const end = [length * Math.cos(angle), length * Math.sin(angle)];
      return Math.abs(outlineGap(shape, end) - distance) < 1e-7;
    });
  }

  /** How far a place is from a shape's outline.
   * @type {(shape: LiveShape, place: Point) => number} */
  function outlineGap({ points, radius }, place) {
    const gaps = points.map((a, i) => toSegment(place, a, points[(i + 1) % points.length]).gap);
    return Math.min(...gaps) - radius;
  }

  /* --- how near a link is ----------------------------------------------------------------------- */

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
    for (const [i, corner] of points.entries()) {
      const near = toSegment(corner, a, b);
      const end = near.share === 0 ? 0 : near.share === 1 ? 1 : null;
      offer(near.gap, [near.at, corner], end, points.length > 1 ? "corner" : null, i);
      if (points.length === 1) break;
      const next = points[(i + 1) % points.length];
      for (const [k, tip] of [a, b].entries()) {
        const { gap, share, at } = toSegment(tip, corner, next);
        if (share > 0 && share < 1) offer(gap, [tip, at], k, "edge", i);
      }
      if (segmentGap(a, b, corner, next) === 0) best = { ...best, gap: 0 };
    }
    if (points.length > 1 && isInside(points, a[0], a[1])) best = { ...best, gap: 0 };
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

  return {
    TURN,
    placed,
    isSimple,
    meetingAngles,
    wrapped,
    joined,
    insert,
    anglesAtDistance,
    contact,
    jointPlaces,
    encounters,
  };
})();
