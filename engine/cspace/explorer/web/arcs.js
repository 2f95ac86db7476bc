/* Unions of intervals: flat lists of their ends, [low, high, low, high, ...], in order and apart.
   Those of angles lie in [-pi, pi], where the circle is cut open: an arc across the cut is two. */

const CIRCLE = [-Math.PI, Math.PI];

/** Put an interval among others that are sorted by their lower ends.
 * @type {(sorted: number[], from: number, to: number) => void} */
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

/** Join sorted intervals where they overlap; the list itself is changed.
 * @type {(sorted: number[]) => number[]} */
function joined(sorted) {
  let last = 0;
  for (let i = 2; i < sorted.length; i += 2) {
    if (sorted[i] <= sorted[last + 1]) sorted[last + 1] = Math.max(sorted[last + 1], sorted[i + 1]);
    else {
      last += 2;
      sorted[last] = sorted[i];
      sorted[last + 1] = sorted[i + 1];
    }
  }
  if (last + 2 < sorted.length) sorted.length = last + 2;
  return sorted;
}

/** The union of arcs in no order, seen from a direction: angles are counted from it.
 * @type {(found: number[], direction: number) => number[]} */
function onCircle(found, direction) {
  /** @type {number[]} */
  const sorted = [];
  for (let i = 0; i < found.length; i += 2) {
    const size = found[i + 1] - found[i];
    if (size >= TURN) return CIRCLE;
    const from = found[i] - direction;
    const start = from - TURN * Math.floor((from + Math.PI) / TURN);
    insert(sorted, start, Math.min(Math.PI, start + size));
    if (start + size > Math.PI) insert(sorted, -Math.PI, start + size - TURN);
  }
  return joined(sorted);
}

/** Whether an angle lies inside of an arc; at a half turn, where arcs are cut, they go on.
 * @type {(arcs: number[], angle: number) => boolean} */
function holds(arcs, angle) {
  for (let i = 0; i < arcs.length; i += 2) {
    const isPast = angle > arcs[i] || arcs[i] === -Math.PI;
    if (isPast && (angle < arcs[i + 1] || arcs[i + 1] === Math.PI)) return true;
  }
  return false;
}

/** What others leave of an interval.
 * @type {(low: number, high: number, others: number[]) => number[]} */
function without(low, high, others) {
  const found = [];
  let from = low;
  for (let i = 0; i < others.length && others[i] < high; i += 2) {
    if (others[i] > from) found.push(from, others[i]);
    from = Math.max(from, others[i + 1]);
  }
  if (from < high) found.push(from, high);
  return found;
}

/** Tell of every interval of one union and every one of another that overlap, by their numbers.
 * @type {(a: number[], b: number[], meet: (i: number, j: number) => void) => void} */
function overlaps(a, b, meet) {
  for (let i = 0, j = 0; i < a.length && j < b.length; ) {
    if (a[i] < b[j + 1] && b[j] < a[i + 1]) meet(i / 2, j / 2);
    if (a[i + 1] < b[j + 1]) i += 2;
    else j += 2;
  }
}

/** Which interval of `a` each interval of `b` goes on, where the two overlap no other; else -1.
 * @type {(a: number[], b: number[]) => number[]} */
function goesOn(a, b) {
  const [of, back] = [b, a].map((list) => new Array(list.length / 2).fill(-1));
  overlaps(a, b, (i, j) => {
    of[j] = of[j] === -1 ? i : -2;
    back[i] = back[i] === -1 ? j : -2;
  });
  return of.map((i, j) => (i >= 0 && back[i] === j ? i : -1));
}
