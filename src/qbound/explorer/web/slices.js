/* The safe poses of a slice, as cells between the curves along which a wall is met. */

const LOWER = -1; // labels of an interval's end: a limit of the second joint, or
const UPPER = -2;
const SEAM = -3; // where a joint that turns all the way round is cut open for drawing

/* --- fibres: Theorem 2 along the second joint ------------------------------------------------- */

/** What bounds a slice: its walls' forms at the held values of q, and the ranges of both joints.
    `known` are the walls that can bound it, where the library has told.
 * @type {(robot: Robot, q: Pose, known?: number[] | null) => SliceProblem} */
function sliceProblem(robot, q, known = null) {
  const chosen = known?.map((i) => robot.boundaries[i]) ?? robot.boundaries;
  const walls = chosen.filter((wall) => wall.used);
  const bodies = walls.filter(isAboutBodies);
  const formed = walls.filter((wall) => !isAboutBodies(wall));
  return {
    robot,
    q,
    kinds: freeKinds(robot),
    forms: formed.map((wall) => restrict(wall.form, robot, q)),
    bodies,
    names: [...formed, ...bodies].map((wall) => wall.name),
    ranges: robot.free.map((joint, k) => rangeOf(robot, joint, robot.views[k])),
  };
}

/** @type {(wall: Wall) => wall is BodiesWall | HalfSpaceWall} */
function isAboutBodies(wall) {
  return wall.kind === "bodies" || (wall.kind === "half-space" && isOfBody(wall));
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
  cuts.push(...bodyCuts(problem, first));
  cuts.sort((a, b) => a.at - b.at);
  cuts.push({ at: view.high, by: view.wraps ? SEAM : UPPER });
  return cuts
    .slice(1)
    .map((high, i) => ({ low: cuts[i], high }))
    .filter(({ low, high }) => {
      const y = basis(kind, (low.at + high.at) / 2);
      if (high.at <= low.at || !lines.every((line) => dot(line, y) > 0)) return false;
      return areBodiesApart(problem, first, (low.at + high.at) / 2);
    });
}

/** @type {(problem: SliceProblem, first: number, second: number) => boolean} */
function areBodiesApart(problem, first, second) {
  const { robot, bodies } = problem;
  if (bodies.length === 0) return true;
  const { found, placed } = partsAt(problem, first, second);
  return bodies.every((wall) => {
    const { kind } = wall;
    const value =
      kind === "bodies"
        ? bodiesEncounter(wall, placed).distance
        : lowestCorner(robot, wall, found).value;
    return value > 1e-12 * robot.reach;
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
  const found = problem.bodies.length > 0 ? framesAt(problem, first, second) : [];
  const values = [
    ...problem.forms.map((form) => Math.abs(evaluate(form, x, y))),
    ...problem.bodies.map((wall) => Math.abs(wallMargin(problem.robot, wall, found))),
  ];
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
