"use strict";
/* The explorer's arithmetic, from here to polygons.js: it repeats the library's and knows no page,
   and engine/tests/test_engine.py runs it beside Python. This file: numbers, vectors, polygons. */

const TURN = 2 * Math.PI;

/** @type {(value: number, low: number, high: number) => number} */
function between(value, low, high) {
  return Math.min(high, Math.max(low, value));
}

/** An angle, turned whole turns to within half a turn of a middle; one that lies there stays.
 * @type {(q: number, middle?: number) => number} */
function wrapped(q, middle = 0) {
  const away = q - middle;
  return Math.abs(away) <= Math.PI ? q : q - TURN * Math.round(away / TURN);
}

/** @type {(values: number[]) => number} */
function sum(values) {
  return values.reduce((total, value) => total + value, 0);
}

/** The entry whose size is least, the first of equals; null where there is none.
 * @template T
 * @param {T[]} all
 * @param {(one: T) => number} size
 * @returns {T | null} */
function leastBy(all, size) {
  const sizes = all.map(size);
  return all[sizes.indexOf(Math.min(...sizes))] ?? null;
}

/** A number as pages write it, with a minus sign and without a minus zero.
 * @type {(value: number, digits: number) => string} */
function number(value, digits) {
  const text = value.toFixed(digits).replace(/^-(0(\.0+)?)$/, "$1");
  return text.replace("-", "−");
}

/* --- in space --------------------------------------------------------------------------------- */

const IDENTITY = [
  [1, 0, 0],
  [0, 1, 0],
  [0, 0, 1],
];

/** @type {(a: Place, b: Place) => number} */
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/** @type {(matrix: Matrix, v: Place) => Place} */
function apply(matrix, v) {
  return matrix.map((row) => dot(row, v));
}

/** @type {(a: Place, b: Place) => Place} */
function add(a, b) {
  return a.map((value, i) => value + b[i]);
}

/** @type {(a: Matrix, b: Matrix) => Matrix} */
function product(a, b) {
  return a.map((row) =>
    [0, 1, 2].map((k) => row[0] * b[0][k] + row[1] * b[1][k] + row[2] * b[2][k]),
  );
}

/** Rodrigues' formula about a unit axis.
 * @type {(axis: Place, q: number) => Matrix} */
function axisTurn([x, y, z], q) {
  const [c, s, t] = [Math.cos(q), Math.sin(q), 1 - Math.cos(q)];
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
  ];
}

/* --- in the plane: a point is also a complex number [re, im] ----------------------------------- */

/** @type {(a: Point, b: Point) => Point} */
const minus = (a, b) => [a[0] - b[0], a[1] - b[1]];
/** @type {(a: Point, b: Point) => Point} */
const plus = (a, b) => [a[0] + b[0], a[1] + b[1]];
/** @type {(a: Point, b: Point) => Point} */
const times = (a, b) => [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]];
/** @type {(a: Point, b: Point) => number} */
const inner = (a, b) => a[0] * b[0] + a[1] * b[1];
/** @type {(a: Point, b: Point) => number} */
const cross = (a, b) => a[0] * b[1] - a[1] * b[0];
/** @type {(a: Point) => number} */
const angle = (a) => Math.atan2(a[1], a[0]);
/** @type {(q: number) => Point} */
const turnedBy = (q) => [Math.cos(q), Math.sin(q)];
/** @type {(a: Point) => Point} */
const mirrored = (a) => [-a[0], a[1]];
/** @type {(a: Point, b: Point, share: number) => Point} */
const partWay = (a, b, share) => [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])];

/** The sides of a polygon; a segment has one, a point one without length.
 * @type {(corners: Point[]) => Point[][]} */
function sides(corners) {
  const count = corners.length < 3 ? 1 : corners.length;
  return corners.slice(0, count).map((a, i) => [a, corners[(i + 1) % corners.length]]);
}

/** Area of a polygon, positive where it goes anticlockwise.
 * @type {(corners: Point[]) => number} */
function area(corners) {
  let doubled = 0;
  for (let i = 0, j = corners.length - 1; i < corners.length; j = i, i += 1)
    doubled += cross(corners[j], corners[i]);
  return doubled / 2;
}

/** Whether a place lies inside a polygon: a ray from it crosses an odd number of sides.
 * @type {(corners: Point[], place: Point) => boolean} */
function isInside(corners, [x, y]) {
  let odd = false;
  for (let i = 0, j = corners.length - 1; i < corners.length; j = i, i += 1) {
    const [ax, ay] = corners[j];
    const [bx, by] = corners[i];
    if (ay > y !== by > y && x < ax + ((y - ay) / (by - ay)) * (bx - ax)) odd = !odd;
  }
  return odd;
}

/** The place of a segment that is nearest to a point, and its share of the way.
 * @type {(p: Point, a: Point, b: Point) => { gap: number, share: number, at: Point }} */
function toSegment(p, a, b) {
  const [x, y] = [b[0] - a[0], b[1] - a[1]];
  const square = x * x + y * y;
  const along = (p[0] - a[0]) * x + (p[1] - a[1]) * y;
  const share = square > 0 ? between(along / square, 0, 1) : 0;
  const at = [a[0] + share * x, a[1] + share * y];
  return { gap: Math.hypot(p[0] - at[0], p[1] - at[1]), share, at };
}

/** Where the step from a to b changes the side of a line, if it does.
 * @type {(a: Point, b: Point, side: Side) => Point[]} */
function crossing(a, b, side) {
  const [from, to] = [side(a), side(b)];
  return from <= 0 === to <= 0 ? [] : [partWay(a, b, from / (from - to))];
}
