"use strict";
/* Configuration space, live: the free poses of two links, column by column.

   A column is a value of q1 with the exact free intervals of q2. There is one at every pixel, one on
   each side of every value of q1 at which the intervals of one obstacle change in number, and between
   neighbours that do not match more by halving, until they do or are a millionth of a radian apart. Intervals of neighbouring
   columns that overlap belong to one component. */
const qboundLiveFibres = (() => {
  const { TURN, anglesAtDistance, insert, joined, meetingAngles, wrapped } = qboundLiveGeometry;
  const ALL = [-Math.PI, Math.PI];
  /** @type {number[]} */
  const NONE = [];
  /** @type {number[]} */
  const met = []; // used again and again
  const BESIDE = 1e-9; // rad, of a critical value: a column on each side
  const CLOSEST = 1e-6; // rad, between columns that halving puts in
  const MOST = 4000; // columns put in so
  const SMALLEST = 1e-6; // rad^2: a component below it is rounding, not counted

  /** What an obstacle forbids on every column of the grid.
   * @type {(arm: LiveArm, shape: LiveShape, count: number) => LiveForbidden} */
  function forbiddenBy(arm, shape, count) {
    const [length, second] = arm.lengths;
    /** @type {number[]} */
    const found = [];
    const blocked = meetingAngles(0, 0, length, arm.radii[0], shape, found);
    const windows = blocked ? ALL : wrapped(found, 0);
    const columns = Array.from({ length: count + 1 }, (_, k) =>
      forearm(arm, shape, -Math.PI + (TURN * k) / count),
    );
    const reach = arm.radii[1];
    const critical = [reach, second + reach].flatMap((distance) =>
      anglesAtDistance(length, distance, shape),
    );
    return { windows, columns, critical: wrapAngles([...critical, ...windows]) };
  }

  /** @type {(angles: number[]) => number[]} */
  function wrapAngles(angles) {
    return angles.map((angle) => angle - TURN * Math.floor((angle + Math.PI) / TURN));
  }

  /** The angles of the second joint at which the second link meets a shape.
   * @type {(arm: LiveArm, shape: LiveShape, first: number) => number[]} */
  function forearm(arm, shape, first) {
    const [length, second] = arm.lengths;
    const x = length * Math.cos(first);
    const y = length * Math.sin(first);
    met.length = 0;
    if (meetingAngles(x, y, second, arm.radii[1], shape, met)) return ALL;
    return met.length > 0 ? wrapped(met, first) : NONE;
  }

  /** Whether a value lies inside of an interval; at a half turn, where intervals are cut, they go on.
   * @type {(intervals: number[], value: number) => boolean} */
  function holds(intervals, value) {
    for (let i = 0; i < intervals.length; i += 2) {
      const isPast = value > intervals[i] || intervals[i] === -Math.PI;
      if (isPast && (value < intervals[i + 1] || intervals[i + 1] === Math.PI)) return true;
    }
    return false;
  }

  /** What no list of forbidden intervals holds.
   * @type {(lists: number[][]) => number[]} */
  function free(lists) {
    /** @type {number[]} */
    const sorted = [];
    for (const list of lists) {
      if (list === ALL) return [];
      for (let i = 0; i < list.length; i += 2) insert(sorted, list[i], list[i + 1]);
    }
    joined(sorted);
    const found = [];
    let from = -Math.PI;
    for (let i = 0; i < sorted.length; i += 2) {
      if (sorted[i] > from) found.push(from, sorted[i]);
      from = sorted[i + 1];
    }
    if (from < Math.PI) found.push(from, Math.PI);
    return found;
  }

  /** Whether the intervals of two columns overlap one to one, and no other way.
   * @type {(a: number[], b: number[]) => boolean} */
  function isMatched(a, b) {
    if (a.length !== b.length) return false;
    for (let i = 0; i < a.length; i += 2) {
      if (a[i] >= b[i + 1] || b[i] >= a[i + 1]) return false;
      if (i > 0 && (a[i] < b[i - 1] || b[i] < a[i - 1])) return false;
    }
    return true;
  }

  /** The free poses of an arm among shapes, cached: what one shape forbids is found anew only when it
      or the arm is another one.
   * @type {(count: number) => LiveSpace} */
  function freeSpace(count) {
    /** @type {WeakMap<LiveShape, LiveForbidden>} */
    let known = new WeakMap();
    /** @type {LiveArm | null} */
    let knownArm = null;

    /** @type {(arm: LiveArm, shapes: LiveShape[]) => LiveColumn[]} */
    function columnsOf(arm, shapes) {
      if (arm !== knownArm) known = new WeakMap();
      knownArm = arm;
      const all = shapes.map((shape) => {
        const found = known.get(shape) ?? forbiddenBy(arm, shape, count);
        known.set(shape, found);
        return found;
      });
      const windows = all.map((one) => one.windows);
      /** @type {(q: number, lists: () => number[][]) => LiveColumn} */
      const column = (q, lists) => ({
        q,
        free: windows.some((list) => holds(list, q)) ? [] : free(lists()),
      });
      /** @type {(q: number) => LiveColumn} */
      const fresh = (q) => column(q, () => shapes.map((shape) => forearm(arm, shape, q)));
      const grid = Array.from({ length: count + 1 }, (_, k) =>
        column(-Math.PI + (TURN * k) / count, () => all.map((one) => one.columns[k])),
      );
      const critical = all
        .flatMap((one) => one.critical)
        .flatMap((q) => [q - BESIDE, q + BESIDE])
        .filter((q) => q > -Math.PI && q < Math.PI)
        .sort((a, b) => a - b);
      return refined(merged(grid, critical.map(fresh)), fresh);
    }

    return { columnsOf };
  }

  /** @type {(a: LiveColumn[], b: LiveColumn[]) => LiveColumn[]} */
  function merged(a, b) {
    const found = [];
    let k = 0;
    for (const column of a) {
      while (k < b.length && b[k].q < column.q) {
        found.push(b[k]);
        k += 1;
      }
      found.push(column);
    }
    return found;
  }

  /** Put columns between neighbours that do not match.
   * @type {(columns: LiveColumn[], fresh: (q: number) => LiveColumn) => LiveColumn[]} */
  function refined(columns, fresh) {
    const found = [columns[0]];
    let left = MOST;
    /** @type {(a: LiveColumn, b: LiveColumn) => void} */
    const between = (a, b) => {
      if (b.q - a.q > CLOSEST && left > 0 && !isMatched(a.free, b.free)) {
        const middle = fresh((a.q + b.q) / 2);
        left -= 1;
        between(a, middle);
        found.push(middle);
        between(middle, b);
      }
    };
    for (let i = 1; i < columns.length; i += 1) {
      between(columns[i - 1], columns[i]);
      found.push(columns[i]);
    }
    return found;
  }

  /* --- components ------------------------------------------------------------------------------- */

  /** Join intervals of neighbouring columns into components, with areas: home's first, then the
      largest. Both angles go round: the last column is the first one.
   * @type {(columns: LiveColumn[], home: Pair) => LiveRegions} */
  function components(columns, home) {
    const starts = [0];
    for (const { free: pieces } of columns)
      starts.push(starts[starts.length - 1] + pieces.length / 2);
    const count = starts[columns.length];
    const parent = Int32Array.from({ length: count }, (_, i) => i);
    /** @type {(i: number) => number} */
    const root = (i) => {
      let at = i;
      while (parent[at] !== at) {
        parent[at] = parent[parent[at]];
        at = parent[at];
      }
      return at;
    };
    const areas = new Float64Array(count);
    /** @type {(k: number, l: number) => void} */
    const join = (k, l) => {
      const [a, b] = [columns[k].free, columns[l].free];
      for (let i = 0, j = 0; i < a.length && j < b.length; ) {
        if (a[i] < b[j + 1] && b[j] < a[i + 1])
          parent[root(starts[l] + j / 2)] = root(starts[k] + i / 2);
        if (a[i + 1] < b[j + 1]) i += 2;
        else j += 2;
      }
    };
    for (const [k, { q, free: pieces }] of columns.entries()) {
      if (pieces.length > 2 && pieces[0] === -Math.PI && pieces[pieces.length - 1] === Math.PI)
        parent[root(starts[k + 1] - 1)] = root(starts[k]);
      if (k + 1 < columns.length) join(k, k + 1);
      const width = (columns[k + 1]?.q ?? q) - (columns[k - 1]?.q ?? q);
      for (let i = 0; i < pieces.length; i += 2)
        areas[starts[k] + i / 2] = ((pieces[i + 1] - pieces[i]) * width) / 2;
    }
    join(columns.length - 1, 0);
    /** @type {Map<number, number>} */
    const sums = new Map();
    for (let i = 0; i < count; i += 1) sums.set(root(i), (sums.get(root(i)) ?? 0) + areas[i]);
    const at = pieceAt(columns, home);
    const first = at === null ? -1 : root(starts[at[0]] + at[1] / 2);
    const kept = [...sums].filter(([one, area]) => area > SMALLEST || one === first);
    kept.sort((a, b) => Number(b[0] === first) - Number(a[0] === first) || b[1] - a[1]);
    const numbers = new Map(kept.map(([one], i) => [one, i]));
    return {
      columns,
      home: first >= 0,
      areas: kept.map(([, area]) => area),
      of: columns.map(({ free: pieces }, k) =>
        Array.from({ length: pieces.length / 2 }, (_, i) => numbers.get(root(starts[k] + i)) ?? -1),
      ),
    };
  }

  /** The column and the interval nearest to a pose whose interval holds it; null where none does.
   * @type {(columns: LiveColumn[], pair: Pair) => number[] | null} */
  function pieceAt(columns, [first, second]) {
    let [from, to] = [0, columns.length - 1];
    while (to - from > 1) {
      const middle = (from + to) >> 1;
      if (columns[middle].q <= first) from = middle;
      else to = middle;
    }
    for (const k of [from, to]) {
      const pieces = columns[k].free;
      for (let i = 0; i < pieces.length; i += 2)
        if (second >= pieces[i] && second <= pieces[i + 1]) return [k, i];
    }
    return null;
  }

  /** The component of a pose, by its number; -1 where it has none.
   * @type {(regions: LiveRegions, pair: Pair) => number} */
  function componentOf(regions, pair) {
    const at = pieceAt(regions.columns, pair);
    return at === null ? -1 : regions.of[at[0]][at[1] / 2];
  }

  /* --- outlines --------------------------------------------------------------------------------- */

  const CRISP = 0.05; // pixels: a point is left out where the line misses it by less
  const UPRIGHT = 0.01; // rad: a shorter upright edge is what halving has left

  /** A line from left to right that leaves out points which it would hardly miss.
   * @type {() => LiveLine} */
  function line() {
    /** @type {number[]} */
    const kept = [];
    let [x, y] = [0, 0]; // the last point, which may be left out
    let [least, most] = [0, 0]; // slopes from the last kept point that miss none since
    let pending = false;
    /** @type {(nextX: number, nextY: number) => void} */
    const add = (nextX, nextY) => {
      const n = kept.length;
      if (n === 0) {
        kept.push(nextX, nextY);
        return;
      }
      const across = nextX - kept[n - 2];
      const slope = (nextY - kept[n - 1]) / across;
      if (pending && !(slope >= least && slope <= most)) {
        end();
        add(nextX, nextY);
        return;
      }
      const room = CRISP / across;
      least = pending ? Math.max(least, slope - room) : slope - room;
      most = pending ? Math.min(most, slope + room) : slope + room;
      x = nextX;
      y = nextY;
      pending = true;
    };
    const end = () => {
      if (pending) kept.push(x, y);
      pending = false;
    };
    return { kept, add, end };
  }

  /** @type {(points: number[], backwards?: boolean) => string} */
  function lineText(points, backwards = false) {
    const words = [];
    for (let i = 0; i < points.length; i += 2) {
      const k = backwards ? points.length - 2 - i : i;
      words.push(`${Math.round(points[k] * 20) / 20} ${Math.round(points[k + 1] * 20) / 20}`);
    }
    return words.join("L");
  }

  /** Which interval of `a` each interval of `b` goes on, where the two overlap no other; else -1.
   * @type {(a: number[], b: number[]) => number[]} */
  function goesOn(a, b) {
    const [of, back] = [b, a].map((list) => new Array(list.length / 2).fill(-1));
    for (let i = 0, j = 0; i < a.length && j < b.length; ) {
      if (a[i] < b[j + 1] && b[j] < a[i + 1]) {
        of[j / 2] = of[j / 2] === -1 ? i / 2 : -2;
        back[i / 2] = back[i / 2] === -1 ? j / 2 : -2;
      }
      if (a[i + 1] < b[j + 1]) i += 2;
      else j += 2;
    }
    return of.map((i, j) => (i >= 0 && back[i] === j ? i : -1));
  }

  /** The outlines of what the columns hold, as paths: for each number in `of` what is to be filled, and
      the edges, which leave out where the square is cut. `scale` leads from angles to pixels.
   * @type {(columns: LiveColumn[], of: number[][], count: number, scale: LiveScale) => LiveOutline[]} */
  function outlines(columns, of, count, { x0, dx, y0, dy }) {
    /** @type {string[][]} */
    const fills = Array.from({ length: count }, () => []);
    /** @type {string[][]} */
    const edges = Array.from({ length: count }, () => []);
    /** @type {(strip: LiveStrip) => void} */
    const close = ({ number, lower, upper, cutLow, cutHigh }) => {
      lower.end();
      upper.end();
      if (number < 0) return;
      const [first, second] = [lineText(lower.kept), lineText(upper.kept, true)];
      fills[number].push(`M${first}L${second}Z`);
      if (!cutLow) edges[number].push(`M${first}`);
      if (!cutHigh) edges[number].push(`M${second}`);
    };
    /** Edges that stand upright: of what `pieces` have beyond `others`.
     * @type {(x: number, pieces: number[], numbers: number[], others: number[]) => void} */
    const upright = (x, pieces, numbers, others) => {
      for (let i = 0; i < pieces.length; i += 2) {
        let from = pieces[i];
        for (let j = 0; j <= others.length && from < pieces[i + 1]; j += 2) {
          const to = Math.min(pieces[i + 1], j < others.length ? others[j] : Infinity);
          if (to - from > UPRIGHT && numbers[i / 2] >= 0)
            edges[numbers[i / 2]].push(`M${lineText([x, y0 + dy * from, x, y0 + dy * to])}`);
          if (j < others.length) from = Math.max(from, others[j + 1]);
        }
      }
    };
    /** @type {LiveStrip[]} */
    let open = [];
    let lastX = x0 + dx * columns[0].q;
    /** @type {number[]} */
    let last = [];
    for (const [k, { q, free: pieces }] of columns.entries()) {
      const x = x0 + dx * q;
      /** @type {LiveStrip[]} */
      const next = [];
      for (const [j, i] of goesOn(last, pieces).entries()) {
        const [low, high] = [pieces[2 * j], pieces[2 * j + 1]];
        const old = i < 0 ? null : open[i];
        let strip = old;
        // A line that reaches the square's edge, or leaves it, is cut there.
        if (!strip || strip.cutLow !== low <= -Math.PI || strip.cutHigh !== high >= Math.PI) {
          strip = newStrip(of[k][j], low, high);
          strip.lower.add(lastX, y0 + dy * (old ? last[2 * i] : low));
          strip.upper.add(lastX, y0 + dy * (old ? last[2 * i + 1] : high));
        }
        strip.lower.add(x, y0 + dy * low);
        strip.upper.add(x, y0 + dy * high);
        next.push(strip);
      }
      for (const strip of open) if (!next.includes(strip)) close(strip);
      if (k > 0 && q - columns[k - 1].q < 2 * CLOSEST) {
        upright(x, last, of[k - 1], pieces);
        upright(x, pieces, of[k], last);
      }
      [open, lastX, last] = [next, x, pieces];
    }
    for (const strip of open) close(strip);
    return fills.map((fill, i) => ({ fill: fill.join(""), edge: edges[i].join("") }));
  }

  /** @type {(number: number, low: number, high: number) => LiveStrip} */
  function newStrip(number, low, high) {
    return {
      number,
      lower: line(),
      upper: line(),
      cutLow: low <= -Math.PI,
      cutHigh: high >= Math.PI,
    };
  }

  return {
    outlines,
    ALL,
    BESIDE,
    forearm,
    forbiddenBy,
    holds,
    free,
    isMatched,
    freeSpace,
    components,
    componentOf,
  };
})();
