"""Equations (30) to (39): Theorem 2, its proof, and the theorem restated."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import robot
from lizarraga2025.evidence.proofs import theorem_2
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.verdicts import Outcome, Verdict, formula, judge, of_readings, reading
from qbound import joint_windows, pair_vector
from qbound.circle import ALL, circle_arc, circle_roots
from qbound.symbols import joint_symbols

ATAN2: Final = "θ = atan2(b, a)"
A, B, C, D, K, PM, Q, THETA, ALPHA = sp.symbols("a b c d k pm q theta alpha", real=True)
SMALLEST: Final = {THETA: sp.atan2(0, 1), ALPHA: sp.acos(0)}
"""θ and α = arccos(c / d) of cos q = 0: a = 1, b = c = 0."""


def printed(name: str, arctan: paper.Reading = "arctan") -> sp.Expr:
    """Return a printed side of Theorem 2 or its proof."""
    return paper.expression(paper.THEOREM_2[name], arctan=arctan)


@dataclass(frozen=True)
class Interval:
    """An interval printed for the roots, in terms of θ and α = arccos(c / d)."""

    lower: sp.Expr
    upper: sp.Expr

    @property
    def length(self) -> sp.Expr:
        """Upper minus lower end."""
        return sp.expand(self.upper - self.lower)

    @property
    def excludes(self) -> bool:
        """Whether some α in [0, π] leaves an angle out: a length below a full turn."""
        shorter = sp.solveset(self.length < 2 * sp.pi, ALPHA, sp.Interval(0, sp.pi))
        return bool(shorter != sp.EmptySet)

    def reaches(self, root: sp.Expr) -> bool:
        """Tell whether a root, or a copy of it some full turns away, lies between the ends.

        Tried for α from 0 to π in steps of π/8, exactly; an interval of a full turn needs no trial.
        """
        steps = ({ALPHA: sp.pi * sp.Rational(i, 8)} for i in range(9))
        return not self.excludes or all(self.copies(root, at) for at in steps)

    def copies(self, root: sp.Expr, at: dict[sp.Symbol, sp.Expr], *, inside: bool = False) -> int:
        """Count the copies of a root, full turns away, between the ends or strictly inside."""
        low, high = ((x - root).subs(at) for x in (self.lower, self.upper))
        turns = (2 * sp.pi * turn for turn in range(-3, 4))
        return sum(bool(low < x < high if inside else low <= x <= high) for x in turns)

    def copies_between(self) -> int:
        """Count the copies of the roots at the ends that lie strictly between, for cos q = 0."""
        low, high = (self.copies(end, SMALLEST, inside=True) for end in (self.lower, self.upper))
        is_one_root = self.copies(self.upper, SMALLEST) - high == 2
        return high if is_one_root else low + high

    def holds_solutions(self) -> Verdict:
        """Judge that every solution has a copy between the ends, whatever the arctangent."""
        with_atan2, turned = (
            all(self.reaches(THETA + turn + sign * ALPHA) for sign in (1, -1))
            for turn in (0, sp.pi)
        )
        return judge(holds=with_atan2 and turned, constrains=self.excludes, under=with_atan2)

    def holds_a_motion(self) -> Verdict:
        """Judge that a joint stays between the ends, for a fixed k, while it keeps off their roots.

        The ends have to be roots, and no other copy of them lies between.
        """
        with_atan2, turned = (
            all(
                sp.expand_trig(sp.cos(end.subs(THETA, turn)) - sp.cos(ALPHA)) == 0
                for end in (self.lower, self.upper)
            )
            for turn in (0, sp.pi)
        )
        alone = self.copies_between() == 0
        return judge(holds=alone and with_atan2 and turned, under=alone and with_atan2)


RESTATED: Final = Interval(THETA - ALPHA, THETA + ALPHA)


def interval(equation: int) -> Interval:
    """Return the interval of eq. (31) or (39), k = 0, with θ for the printed inverse tangent."""
    lower, upper = (_in_angles(f"{equation} {end}") for end in ("lower", "upper"))
    return Interval(lower, upper)


def _in_angles(name: str) -> sp.Expr:
    """Return a printed side with θ and α for its inverse functions, k = 0."""
    side = printed(name).replace(sp.atan, lambda _: THETA).replace(sp.acos, lambda _: ALPHA)
    return side.subs(K, 0)


def plain(expression: sp.Expr) -> str:
    """Write an expression in θ, α and π without signs of multiplication."""
    text = str(sp.sstr(expression)).replace("*", "")
    return text.replace("alpha", "α").replace("theta", "θ").replace("pi", "π")


@computes("E-30", "E-32")
def form_of_the_components() -> Outcome:
    """Judge that each component is that of eq. (30) in its joints, with c the rest, less its sign.

    The factors a, b and the rest have to be free of the joint.
    """
    forms = [sp.expand(paper.expression(text)) for text in paper.EQUATION_29.values()]
    fit = []
    for form in forms:
        parts = []
        for q in (q for q in joint_symbols(robot()) if form.has(q)):
            factors = {A: form.coeff(sp.cos(q)), B: form.coeff(sp.sin(q))}
            rest = sp.expand(form - printed("30").subs(Q, q).subs(factors))
            parts += [part.has(q) for part in (*factors.values(), rest)]
        fit.append(not any(parts))
    return Outcome(
        judge(holds=all(fit)),
        f"{sum(fit)} of {len(forms)} components of eq. (29) are of this form in every joint they"
        " depend on, identically in the offsets, the other joint held.",
    )


@computes("E-31")
def bounds_as_printed() -> Outcome:
    one = interval(31)
    low, high = (plain(end.subs(SMALLEST)) for end in (one.lower, one.upper))
    return Outcome(
        one.holds_solutions(),
        f"It is {plain(one.length)} long, a full turn or more: with arctan or atan2, every solution"
        " has a copy in it, full turns away, for some k, and so has every other angle. With atan2"
        f" both ends are roots, and {one.copies_between()} more copies of these two roots lie"
        " strictly between, so for a fixed k it bounds nothing that they do not bound closer"
        f" (E-39). Smallest case: cos q = 0 has the interval from {low} to {high}. Without the -2π"
        f" of the second line, and with {ATAN2}, it is {plain(RESTATED.length)} long and exactly"
        f" the set where a cos q + b sin q ≥ c{_proved()}. {_one_sign_off()}",
    )


def _one_sign_off() -> str:
    """Tell that eqs. (31) and (39) differ by one sign."""
    stated, derived = interval(31), interval(39)
    same = derived.upper == stated.upper and derived.lower == stated.lower.subs(ALPHA, -ALPHA)
    if not same:
        return "It is not what the proof derives."
    return (
        "Eq. (39), with which the proof ends, has + before cos⁻¹ in both lines: one sign differs."
    )


def _proved() -> str:
    """Tell whether the steps of the restated theorem are identities."""
    return ", as Theorem 2 restated proves" if all(theorem_2().values()) else ""


@computes("S-21.2")
def range_of_values() -> Outcome:
    return of_readings(
        f"The solutions of the inequality are an arc of {plain(RESTATED.length)}{_proved()}; eq."
        f" (31) is {plain(interval(31).length)} long.",
        reading("by eq. (31) as printed", holds=interval(31) == RESTATED),
        reading("by Theorem 2 restated (TH-2)", holds=False, under=all(theorem_2().values())),
    )


@computes("S-7.1")
def theorems_that_bound_q() -> Outcome:
    steps, excludes = theorem_2(), interval(31).excludes
    return of_readings(
        "As printed the interval of Theorem 2 leaves no angle out; restated, it has the two roots"
        f" as its ends, and {sum(steps.values())} of the {len(steps)} steps of its proof are"
        " identities.",
        reading("Theorem 2 restated", holds=excludes, under=bool(steps) and all(steps.values())),
        reading("Theorem 2 as printed", holds=True, constrains=excludes),
    )


@computes("E-33")
def one_cosine() -> Outcome:
    meant = {D: sp.sqrt(A**2 + B**2), THETA: sp.atan2(B, A)}
    left = sp.expand_trig(printed("33").subs(meant)) - A * sp.cos(Q) - B * sp.sin(Q)
    return Outcome(
        judge(holds=sp.simplify(left) == 0),
        "There is such a d and θ for all real a and b, not both zero: with d the root of a² + b²"
        " and θ the direction of (a, b) it is an identity. Which θ is meant, eq. (34) says.",
    )


@computes("E-34")
def amplitude_and_phase() -> Outcome:
    def is_identity(a: sp.Symbol, arctan: paper.Reading) -> bool:
        d, theta = (printed(f"34 {name}", arctan).subs(A, a) for name in ("d", "theta"))
        return bool(sp.simplify(d * sp.cos(Q - theta) - a * sp.cos(Q) - B * sp.sin(Q)) == 0)

    signs = sp.Symbol("a", positive=True), sp.Symbol("a", negative=True)
    right, left = (is_identity(a, "arctan") for a in signs)
    behind = []
    for window in joint_windows(robot()):
        vector = pair_vector(robot(), robot().boundary(window.boundary))
        if vector[window.component - 1].along(window.joint, robot().home).a < 0:
            behind.append(f"β_{{{window.boundary[1:]},{window.component}}}")
    at = sp.cos(0 - sp.atan(sp.Integer(0) / -1))  # a = -1, b = 0 at q = 0, where a cos q is -1
    return formula(
        holds=right and left,
        amended=right and all(is_identity(a, "atan2") for a in signs),
        computed="d cos(q - θ) equals a cos q + b sin q identically for a > 0. For a < 0 an"
        f" arctangent of the quotient alone turns it round: a = -1, b = 0 at q = 0 gives {at} for"
        " -1. For a = 0 the quotient does not exist. With atan2(b, a), which is often meant, it is"
        f" an identity in all quadrants. Of the robot's point components, {' and '.join(behind)}"
        " have a < 0.",
    )


@computes("E-35")
def divided() -> Outcome:
    d, x = sp.Symbol("d", positive=True), sp.Symbol("x", real=True)
    same = sp.solveset(d * x - C, x) == sp.FiniteSet(printed("35").subs(D, d))
    return Outcome(
        judge(holds=same),
        "Equivalent for d > 0, which all components of the robot have. For a = b = c = 0 every q"
        " is a solution, and c / d does not exist.",
    )


@computes("E-36")
def condition_for_roots() -> Outcome:
    values = sp.Interval(printed("36 lower"), printed("36 upper"))
    exact = sp.calculus.util.function_range(sp.cos(Q), Q, sp.Interval(0, 2 * sp.pi)) == values
    counts = [int(circle_roots(3.0, 4.0, c).count) for c in (6.0, 5.0, 2.0)]
    everywhere = int(circle_roots(0.0, 0.0, 0.0).count) == ALL
    return Outcome(
        judge(holds=exact and counts == [0, 1, 2]),
        "The values of a cosine are those from -1 to 1, so for d > 0 the condition is needed, and"
        f" it suffices. Roots for a = 3, b = 4: {counts[0]} for |c| > d, {counts[1]} for |c| = d,"
        f" {counts[2]} for |c| < d. At d = 0 there is no c / d; for c = 0 too"
        f" {'every q solves' if everywhere else 'no q solves'} the equation.",
    )


@computes("E-37")
def inverse_cosine() -> Outcome:
    families = {_in_angles("37").subs(PM, sign) for sign in (1, -1)}
    solve = all(sp.cos(x) == sp.cos(ALPHA) for x in families)
    one = _in_angles("37").subs(PM, 1)
    q = -sp.pi / 2  # cos q = 0: a = 1, b = c = 0
    both = {ALPHA, -ALPHA}
    return of_readings(
        "These are the solutions at which a cos q + b sin q falls. Those at which it rises have the"
        f" other sign, for the cosine is even: cos q = 0 has q = {plain(q)} too, which would need"
        f" k = {(q - sp.acos(0)) / (2 * sp.pi)}. All hangs on one sign of a converted text. Eq."
        " (38) and Table 6 have the same +. We therefore read it as a deliberate choice of one"
        " root.",
        reading(
            "every solution, with ± for +", holds=families == both, corrected={one, -one} == both
        ),
        reading(
            "the solutions at which it falls, with +", holds=solve and families == both, under=solve
        ),
    )


@computes("E-38")
def one_root() -> Outcome:
    turn = np.linspace(-np.pi, np.pi, 73)[:-1] + 0.01  # no a is zero
    a, b, c = np.cos(turn), np.sin(turn), np.linspace(-0.99, 0.99, 45)[:, None]
    solved, falls = {}, {}
    for arctan in ("arctan", "atan2"):
        q = sp.lambdify((A, B, C, D, K), printed("38", arctan), "numpy")(a, b, c, 1, 0)
        solved[arctan] = np.abs(a * np.cos(q) + b * np.sin(q) - c) < SMALL
        falls[arctan] = bool((b * np.cos(q) - a * np.sin(q) < 0).all())
    missed = ~solved["arctan"]
    behind = bool((missed == ((a < 0) & (c**2 > SMALL))).all())
    return formula(
        holds=not missed.any(),
        amended=bool(solved["atan2"].all()) and falls["atan2"],
        computed=f"Of {missed.size} equations with d = 1 all round the circle an arctangent of the"
        f" quotient alone does not solve {'those with a < 0 and c not 0' if behind else 'some'};"
        f" with {ATAN2} all are solved, at the root where a cos q + b sin q falls.",
    )


@computes("E-39")
def interval_between_roots() -> Outcome:
    one = interval(39)
    rising = one.copies(THETA - ALPHA, SMALLEST, inside=True)
    return of_readings(
        f"It is {plain(one.length)} long. With {ATAN2} its ends are two copies of the falling root,"
        f" and {one.copies_between() or 'no other'} copy of it lies between, so a joint that never"
        f" reaches that root stays inside. {rising} copy of the rising root lies between, where the"
        " sign of a cos q + b sin q - c changes. With k free, every angle has a copy in it.",
        ("for every solution some k", one.holds_solutions()),
        (
            "k fixed: a joint that moves continuously and never reaches the roots at the ends",
            one.holds_a_motion(),
        ),
    )


@computes("E-39.2")
def proof_completed() -> Outcome:
    stated, derived = interval(31), interval(39)
    signs = {_in_angles("37").coeff(ALPHA).subs(PM, sign) for sign in (1, -1)}
    gaps = [derived.lower - stated.lower, stated.upper - derived.upper]
    inside = all(gap.subs(ALPHA, end) >= 0 for gap in gaps for end in (0, sp.pi))  # affine in α
    follows = inside and all(derived.reaches(THETA + sign * ALPHA) for sign in signs)
    either = all(stated.reaches(THETA + sign * ALPHA) for sign in (1, -1))
    return of_readings(
        "The interval of eq. (39) lies in that of eq. (31) for every θ and every cos⁻¹ from 0 to π."
        " Eq. (39) is derived for the solutions with + in eq. (37) alone; those with - have a copy"
        f" in both intervals too, with {ATAN2} (E-34).",
        reading(
            "eq. (31) for every solution",
            holds=follows and signs == {1, -1},
            under=follows and either,
        ),
        reading(
            "eq. (39) for the solutions of eq. (38)", holds=follows, constrains=derived.excludes
        ),
    )


@computes("TH-2")
def theorem_as_printed() -> Outcome:
    length = {
        name: int(np.rint(np.degrees(float(one.length.subs(SMALLEST)))))
        for name, one in (("31", interval(31)), ("39", interval(39)), ("restated", RESTATED))
    }
    positive = round(2 * np.degrees(float(circle_arc(1.0, 0.0, 0.0).half_width)))
    return Outcome(
        interval(31).holds_solutions(),
        "True of every solution, and of every angle. For cos q ≥ 0, which holds on"
        f" {positive}°, eq. (31) is {length['31']}° long, eq. (39) {length['39']}°, the restated"
        f" theorem {length['restated']}°. Its proof has {len(theorem_2())} steps,"
        f" {sum(theorem_2().values())} of them identities checked by computer algebra."
        f" {_one_sign_off()}",
    )
