"""Equations (1) to (39)."""

from __future__ import annotations

from qbound.claims.ledger import Finding, entry, judge


@entry(
    "E-34",
    "equation",
    "eq. (34), proof of Theorem 2",
    "d is the root of a² + b², and θ the inverse tangent of b / a.",
    test="test_circle.py::test_printed_arctan_solves_another_equation_when_a_is_negative",
    chapter="06_theorem_2#equation-eq-34",
    mended="θ = atan2(b, a), with d > 0.",
)
def amplitude_and_phase() -> Finding:
    import sympy as sp

    b, q = sp.symbols("b q", real=True)

    def missing(a: sp.Symbol, theta: sp.Expr) -> sp.Expr:
        cosine = sp.sqrt(a**2 + b**2) * sp.cos(q - theta)
        return sp.simplify(cosine - a * sp.cos(q) - b * sp.sin(q))

    positive, negative = sp.Symbol("a", positive=True), sp.Symbol("a", negative=True)
    right = missing(positive, sp.atan(b / positive)) == 0
    left = missing(negative, sp.atan(b / negative)) == 0
    mended = all(missing(a, sp.atan2(b, a)) == 0 for a in (positive, negative))
    at = sp.sqrt(2) * sp.cos(0 - sp.atan(sp.Integer(1) / -1))  # a = -1, b = 1, q = 0
    return Finding(
        judge(holds=right and left, under=right and mended),
        "d cos(q - θ) equals a cos q + b sin q identically for a > 0; for a = -1, b = 1, q = 0 it"
        f" is {at} where -1 is wanted, and for a = 0 the quotient does not exist. With"
        " atan2(b, a) it is an identity in all quadrants.",
    )
