/* The feasible poses of a slice, column by column. A column is a value of the first joint with the free
   intervals of the second in order, and a label for each of their ends: what is met there. */

const LOWER = -1; // labels: a limit of the second joint, or
const UPPER = -2;
const SEAM = -3; // where a joint that turns all the way round is cut open for drawing

/* --- columns of any kind ---------------------------------------------------------------------- */

const CLOSEST = 1e-6; // of a turn or a range: no columns nearer to each other are put in between
const MOST = 4000; // columns that are put in
const UPRIGHT = 0.01; // a shorter upright edge is what halving has left

/** Whether two columns have the same intervals: with the same labels, each over its like alone.
 * @type {(a: Column, b: Column) => boolean} */
function isMatched(a, b) {
  if (a.free.length !== b.free.length) return false;
  for (let i = 0; i < a.free.length; i += 2) {
    if (a.by[i] !== b.by[i] || a.by[i + 1] !== b.by[i + 1]) return false;
    if (a.free[i] >= b.free[i + 1] || b.free[i] >= a.free[i + 1]) return false;
    if (i > 0 && (a.free[i] < b.free[i - 1] || b.free[i] < a.free[i - 1])) return false;
  }
  return true;
}

/** Put columns between neighbours that do not match, by halving, until they do or are this close.
 * @type {(columns: Column[], fresh: (q: number) => Column, closest: number) => Column[]} */
function refined(columns, fresh, closest) {
  const found = [columns[0]];
  let left = MOST;
  /** @type {(a: Column, b: Column) => void} */
  const fill = (a, b) => {
    if (b.q - a.q > closest && left > 0 && !isMatched(a, b)) {
      const middle = fresh((a.q + b.q) / 2);
      left -= 1;
      fill(a, middle);
      found.push(middle);
      fill(middle, b);
    }
  };
  for (let i = 1; i < columns.length; i += 1) {
    fill(columns[i - 1], columns[i]);
    found.push(columns[i]);
  }
  return found;
}

/** The component of every interval of every column, numbered from 0, and how many there are. Those
    of neighbouring columns that overlap belong together; a joint that wraps goes on at its seam.
 * @type {(columns: Column[], wraps: boolean) => { of: number[][], count: number }} */
function components(columns, wraps) {
  const starts = [0];
  for (const { free } of columns) starts.push(starts[starts.length - 1] + free.length / 2);
  const parent = Int32Array.from({ length: starts[columns.length] }, (_, i) => i);
  /** @type {(i: number) => number} */
  const root = (i) => {
    let at = i;
    while (parent[at] !== at) {
      parent[at] = parent[parent[at]];
      at = parent[at];
    }
    return at;
  };
  /** @type {(k: number, l: number) => void} */
  const join = (k, l) =>
    overlaps(columns[k].free, columns[l].free, (i, j) => {
      parent[root(starts[l] + j)] = root(starts[k] + i);
    });
  for (const [k, { by }] of columns.entries()) {
    if (by[0] === SEAM && by[by.length - 1] === SEAM)
      parent[root(starts[k + 1] - 1)] = root(starts[k]);
    if (k > 0) join(k - 1, k);
  }
  if (wraps) join(columns.length - 1, 0);
  /** @type {Map<number, number>} */
  const numbers = new Map();
  const of = columns.map(({ free }, k) =>
    Array.from({ length: free.length / 2 }, (_, i) => {
      const one = root(starts[k] + i);
      const known = numbers.get(one) ?? numbers.size;
      numbers.set(one, known);
      return known;
    }),
  );
  return { of, count: numbers.size };
}

/** The component that holds a pose, by its number in `of`; null where none does.
 * @type {(columns: Column[], of: number[][], pair: Pair) => number | null} */
function pieceAt(columns, of, [first, second]) {
  let [from, to] = [0, columns.length - 1];
  while (to - from > 1) {
    const middle = (from + to) >> 1;
    if (columns[middle].q <= first) from = middle;
    else to = middle;
  }
  const [a, b] = [columns[from], columns[to]];
  const share = between((first - a.q) / (b.q - a.q), 0, 1);
  const matched = isMatched(a, b);
  const near = matched || share < 0.5 ? from : to;
  const ends = matched
    ? a.free.map((value, i) => value + share * (b.free[i] - value))
    : columns[near].free;
  for (let i = 0; i < ends.length; i += 2)
    if (second >= ends[i] && second <= ends[i + 1]) return of[near][i / 2];
  return null;
}

/** Cells: runs of intervals that go on from column to column, one to one, and keep their labels.
 * @type {(columns: Column[], of: number[][]) => Cell[]} */
function cells(columns, of) {
  /** @type {Cell[]} */
  const all = [];
  /** @type {Cell[]} */
  let open = [];
  for (const [k, { q, free, by }] of columns.entries()) {
    const before = k > 0 ? goesOn(columns[k - 1].free, free) : [];
    open = of[k].map((piece, j) => {
      const [low, high] = [by[2 * j], by[2 * j + 1]];
      const old = open[before[j] ?? -1];
      let cell = old;
      if (!cell || cell.low !== low || cell.high !== high) {
        // Where only a label changes, the new cell begins where the old one ends.
        cell = { low, high, piece, rows: old ? [old.rows[old.rows.length - 1]] : [] };
        all.push(cell);
      }
      cell.rows.push([q, free[2 * j], free[2 * j + 1]]);
      return cell;
    });
  }
  return all;
}

/** Upright edges: what a column has free, and one just beside it has not. A first joint that does
    not wrap ends at such edges, too.
 * @type {(columns: Column[], of: number[][], sizes: ColumnSizes) => UprightEdge[]} */
function uprights(columns, of, { closest, least, wraps }) {
  /** @type {UprightEdge[]} */
  const found = [];
  /** @type {(k: number, other: number[], side: 0 | 1) => void} */
  const add = (k, other, side) => {
    const { q, free } = columns[k];
    for (const [i, piece] of of[k].entries()) {
      const ends = without(free[2 * i], free[2 * i + 1], other);
      for (let j = 0; j < ends.length; j += 2)
        if (ends[j + 1] - ends[j] > least)
          found.push({ q, low: ends[j], high: ends[j + 1], piece, side });
    }
  };
  for (let k = 1; k < columns.length; k += 1) {
    if (columns[k].q - columns[k - 1].q > 2 * closest) continue;
    add(k - 1, columns[k].free, 1);
    add(k, columns[k - 1].free, 0);
  }
  if (!wraps) add(0, [], 0);
  if (!wraps) add(columns.length - 1, [], 1);
  return found;
}

/* --- fibres of a robot: Theorem 2 along the second joint ---------------------------------------- */

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

/** The limits of a joint with their names; without limits one turn, cut open where the view is.
 * @type {(robot: Robot, joint: number, view: View) => NamedView} */
function rangeOf(robot, joint, view) {
  const [low, high] = robot.limits.filter((limit) => limit.joint === joint);
  if (!low) return { ...view, names: ["", ""] };
  return { low: low.value, high: high.value, wraps: false, names: [low.name, high.name] };
}

/** The column at one value of the first joint: the safe values of the second.
 * @type {(problem: SliceProblem, first: number) => Column} */
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
  /** @type {Column} */
  const column = { q: first, free: [], by: [] };
  for (const [i, high] of cuts.entries()) {
    const low = cuts[i - 1];
    if (!low || high.at <= low.at) continue;
    const middle = (low.at + high.at) / 2;
    const y = basis(kind, middle);
    if (!lines.every((line) => dot(line, y) > 0)) continue;
    if (!areBodiesApart(problem, first, middle)) continue;
    column.free.push(low.at, high.at);
    column.by.push(low.by, high.by);
  }
  return column;
}

/** @type {(problem: SliceProblem, first: number, second: number) => boolean} */
function areBodiesApart(problem, first, second) {
  const { robot, bodies } = problem;
  if (bodies.length === 0) return true;
  const { found, placed } = partsAt(problem, first, second);
  const least = 1e-12 * robot.reach;
  return bodies.every((wall) => bodiesMargin(robot, wall, found, placed) > least);
}

/** The columns of a slice, so many and those between, with their components and cells.
 * @type {(problem: SliceProblem, count: number) => Decomposition} */
function decompose(problem, count) {
  const [{ low, high, wraps }] = problem.ranges;
  const inset = (high - low) * 1e-9; // the ends themselves may be walls
  const even = Array.from({ length: count + 1 }, (_, i) =>
    fibre(problem, low + inset + ((high - low - 2 * inset) * i) / count),
  );
  const closest = (CLOSEST * (high - low)) / TURN;
  const columns = refined(even, (q) => fibre(problem, q), closest);
  const { of } = components(columns, wraps);
  return { columns, of, cells: cells(columns, of) };
}

/** The boundary of a slice's cells as polylines with the names of their walls.
 * @type {(problem: SliceProblem, found: Decomposition) => Edge[]} */
function cellEdges(problem, { columns, of, cells: all }) {
  const [first, second] = problem.ranges;
  const sizes = {
    closest: (CLOSEST * (first.high - first.low)) / TURN,
    least: (UPRIGHT * (second.high - second.low)) / TURN,
    wraps: first.wraps,
  };
  return [
    ...all.flatMap((cell) => [
      ...curveEdges(problem, cell, cell.low, 1),
      ...curveEdges(problem, cell, cell.high, 2),
    ]),
    ...uprights(columns, of, sizes).map(({ q, low, high, piece, side }) => ({
      boundary: wallName(problem, q, (low + high) / 2, side),
      piece,
      points: [
        [q, low],
        [q, high],
      ],
    })),
  ];
}

/** The curve below (k = 1) or above (k = 2) a cell; none where it is only cut open for drawing.
 * @type {(problem: SliceProblem, cell: Cell, by: number, k: 1 | 2) => Edge[]} */
function curveEdges(problem, cell, by, k) {
  if (by === SEAM) return [];
  const boundary = by >= 0 ? problem.names[by] : problem.ranges[1].names[by === LOWER ? 0 : 1];
  return [{ boundary, piece: cell.piece, points: cell.rows.map((row) => [row[0], row[k]]) }];
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
    ...problem.bodies.map((wall) => Math.abs(bodiesMargin(problem.robot, wall, found))),
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
 * @type {(map: ToolMap, arm: Arm, found: Cell[], range: View) => Images} */
function postureImages(map, arm, found, range) {
  const lines = singularValues(arm).flatMap((value) => turnsWithin(map.kinds[1], value, range));
  const ends = [range.low, ...lines.sort((a, b) => a - b), range.high];
  /** @type {Images} */
  const images = { positive: [], negative: [] };
  ends.slice(1).forEach((high, i) => {
    const inside = [found[0]?.rows[0][0] ?? 0, (ends[i] + high) / 2];
    const side = determinant(map, inside) > 0 ? images.positive : images.negative;
    for (const { rows } of found) {
      for (const run of cutRows(rows, ends[i], high)) {
        side.push(outline(run, 24).map((pair) => toolAt(map, pair)));
      }
    }
  });
  return images;
}
