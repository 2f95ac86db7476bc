"use strict";
/* Theorem 2: where a cos q + b sin q reaches c on the circle, and what eq. (31) says of it. */
{
  const TURN = 2 * Math.PI;
  const TANGENT = 4 * 2 ** -52; // qbound.tolerances, as the next one
  const NO_AMPLITUDE = 2 ** -40;

  /** The arc where a cos q + b sin q >= c, as qbound.circle_arc and qbound.circle_roots find it.
   * @type {(a: number, b: number, c: number) => TheoremTwo} */
  function theorem(a, b, c) {
    const d = Math.hypot(a, b);
    const ratio = d > NO_AMPLITUDE * Math.abs(c) ? c / d : Math.sign(c) / NO_AMPLITUDE;
    const touches = Math.abs(Math.abs(ratio) - 1) <= TANGENT;
    const everywhere = a === 0 && b === 0 && c === 0;
    const count = touches ? 1 : Math.abs(ratio) < 1 ? 2 : 0;
    const alpha = everywhere
      ? Math.PI
      : Math.acos(Math.min(1, Math.max(-1, touches ? Math.sign(ratio) : ratio)));
    const empty = count === 0 && c > 0 && !everywhere;
    return { d, theta: Math.atan2(b, a), alpha, count: everywhere ? -1 : count, empty };
  }

  /** The interval of eq. (31), k = 0; `quadrant` reads its arctangent as atan2, `struck` leaves out
      the -2 pi of its second line. None where the formula has no value.
   * @type {(a: number, b: number, c: number, quadrant: boolean, struck: boolean) => number[] | null} */
  function printed(a, b, c, quadrant, struck) {
    const { d, alpha, count } = theorem(a, b, c);
    if (d === 0 || count < 1 || (a === 0 && !quadrant)) return null;
    const theta = quadrant ? Math.atan2(b, a) : Math.atan(b / a);
    return [theta - alpha - (struck ? 0 : TURN), theta + alpha];
  }

  const OPENS = [-1.5, 12.41, -7.5];
  qboundFigures.circle = Object.assign(() => {}, { theorem, printed, OPENS });
}
