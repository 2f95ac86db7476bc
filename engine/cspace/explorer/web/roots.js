/* Forms of one joint, constant + a cos q + b sin q or constant + a q + b q^2, and where they are 0:
   cspace.forms.circle (Theorem 2). */

const TANGENT = 4 * 2 ** -52; // cspace.tolerances, as the next one
const NO_AMPLITUDE = 2 ** -40;

/** @type {(kind: Kind, q: number) => number[]} */
function basis(kind, q) {
  return kind === "revolute" ? [1, Math.cos(q), Math.sin(q)] : [1, q, q * q];
}

/** @type {(kind: Kind, q: number) => number[]} */
function basisSlope(kind, q) {
  return kind === "revolute" ? [0, -Math.sin(q), Math.cos(q)] : [0, 1, 2 * q];
}

/** The form that takes three values: at 0 and a third of a turn either way, or at 0 and +-h.
 * @type {(kind: Kind, at: number[], values: number[]) => number[]} */
function throughThree(kind, [, h], [middle, ahead, back]) {
  if (kind === "revolute") {
    const constant = (middle + ahead + back) / 3;
    return [constant, (2 * middle - ahead - back) / 3, (ahead - back) / Math.sqrt(3)];
  }
  return [middle, (ahead - back) / (2 * h), (ahead + back - 2 * middle) / (2 * h * h)];
}

/** The arc where a cos q + b sin q >= c: its middle and half its width.
 * @type {(a: number, b: number, c: number) => CircleArc} */
function circleArc(a, b, c) {
  const d = Math.hypot(a, b);
  const ratio = d > NO_AMPLITUDE * Math.abs(c) ? c / d : Math.sign(c) / NO_AMPLITUDE;
  const touches = Math.abs(Math.abs(ratio) - 1) <= TANGENT;
  const cosine = touches ? Math.sign(ratio) : between(ratio, -1, 1);
  const everywhere = a === 0 && b === 0 && c === 0;
  const count = everywhere ? -1 : touches ? 1 : Math.abs(ratio) < 1 ? 2 : 0;
  const alpha = everywhere ? Math.PI : Math.acos(cosine);
  return { d, theta: Math.atan2(b, a), alpha, count, empty: count === 0 && c > 0 };
}

/** Both ends of that arc, where a cos q + b sin q = c; none where no angle is a root, or every one.
 * @type {(a: number, b: number, c: number) => number[]} */
function circleRoots(a, b, c) {
  if (Math.abs(c) > (1 + 2 * TANGENT) * Math.hypot(a, b)) return []; // sooner than an arc cosine
  const { theta, alpha, count } = circleArc(a, b, c);
  return count > 0 ? [theta - alpha, theta + alpha] : [];
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

/** Roots of a form within a range, an angle's in all turns.
 * @type {(kind: Kind, coefficients: number[], view: View) => number[]} */
function rootsWithin(kind, [constant, a, b], view) {
  const found = kind === "revolute" ? circleRoots(a, b, -constant) : realRoots(constant, a, b);
  if (found.length === 0) return found;
  return found.flatMap((root) => turnsWithin(kind, root, view)).filter((root) => root > view.low);
}

/** Roots of constant + a q + b q^2, without cancellation.
 * @type {(constant: number, a: number, b: number) => number[]} */
function realRoots(constant, a, b) {
  if (b === 0) return a === 0 ? [] : [-constant / a];
  const square = a * a - 4 * b * constant;
  const q = -(a + (a < 0 ? -1 : 1) * Math.sqrt(Math.max(0, square))) / 2;
  return square < 0 ? [] : q === 0 ? [0] : [q / b, constant / q];
}
