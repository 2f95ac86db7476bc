"""Equations (30) to (39): Theorem 2, its proof, and the theorem restated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import pairs, robot, symbolic_robot
from lizarraga2025.evidence.proofs import theorem_2
from lizarraga2025.verdicts import Outcome, judge, require
from qbound import circle_arc, circle_roots, components, pair_vector
from qbound.forms.circle import ALL
from qbound.region import paper_rule
from qbound.symbols import joint_symbols

if TYPE_CHECKING:
    import sympy


@dataclass(frozen=True)
class Interval:
    """An interval printed for the roots, in terms of θ and α = arccos(c / d)."""

    lower: sympy.Expr
    upper: sympy.Expr

    @property
    def length(self) -> sympy.Expr:
        """Upper minus lower end."""
        import sympy as sp

        return sp.expand(self.upper - self.lower)

    @property
    def excludes(self) -> bool:
        """Whether some α in [0, π] leaves an angle out: a length below a full turn."""
        import sympy as sp

        _, alpha = symbols()
        shorter = sp.solveset(self.length < 2 * sp.pi, alpha, sp.Interval(0, sp.pi))
        return bool(shorter != sp.EmptySet)

    def inside(self, root: sympy.Expr, at: dict[sympy.Symbol, sympy.Expr]) -> int:
        """Count the copies of a root, modulo full turns, strictly between the ends."""
        import sympy as sp

        copies = (root + 2 * sp.pi * turn for turn in range(-3, 4))
        places = [x.subs(at) for x in copies]
        return sum(bool(self.lower.subs(at) < x) and bool(x < self.upper.subs(at)) for x in places)


def symbols() -> tuple[sympy.Symbol, sympy.Symbol]:
    """Return θ and α."""
    import sympy as sp

    theta, alpha = sp.symbols("theta alpha", real=True)
    return theta, alpha


def printed_interval() -> Interval:
    """Return the interval of eq. (31), k = 0."""
    import sympy as sp

    theta, alpha = symbols()
    return Interval(theta - alpha - 2 * sp.pi, theta + alpha)


def interval_of_the_proof() -> Interval:
    """Return the interval of eq. (39), k = 0."""
    import sympy as sp

    theta, alpha = symbols()
    return Interval(theta + alpha - 2 * sp.pi, theta + alpha)


def plain(expression: sympy.Expr) -> str:
    """Write an expression in θ, α and π without signs of multiplication."""
    import sympy as sp

    text = str(sp.sstr(expression)).replace("*", "")
    return text.replace("alpha", "α").replace("theta", "θ").replace("pi", "π")


def smallest() -> dict[sympy.Symbol, sympy.Expr]:
    """Return θ and α of cos q = 0: a = 1, b = c = 0."""
    import sympy as sp

    theta, alpha = symbols()
    return {theta: sp.atan2(0, 1), alpha: sp.acos(0)}


def _forms_of_the_robot() -> tuple[int, int]:
    """Count the components of eq. (29), and those that are of the form in each of their joints."""
    import sympy as sp

    symbolic, _ = symbolic_robot()
    q = joint_symbols(robot())
    total = of_the_form = 0
    for boundary in symbolic.boundaries:
        for form in components(symbolic, boundary).symbolic(q):
            used = sorted(sp.sympify(form).free_symbols & set(q), key=str)
            total += bool(used)
            of_the_form += bool(used) and all(_is_of_the_form(sp.expand(form), x) for x in used)
    return total, of_the_form


def _is_of_the_form(form: sympy.Expr, q: sympy.Symbol) -> bool:
    import sympy as sp

    a, b = form.coeff(sp.cos(q)), form.coeff(sp.sin(q))
    rest = sp.expand(form - a * sp.cos(q) - b * sp.sin(q))
    return not any(q in part.free_symbols for part in (a, b, rest))


@computes("E-30")
@computes("E-32")
def form_of_the_components() -> Outcome:
    total, of_the_form = _forms_of_the_robot()
    return Outcome(
        judge(holds=total == of_the_form > 0),
        f"{of_the_form} of {total} components of eq. (29) are of this form in every joint they"
        " depend on, identically in the offsets, the other joint held.",
    )


@computes("E-31")
def bounds_as_printed() -> Outcome:
    theta, alpha = symbols()
    interval, at = printed_interval(), smallest()
    passed = interval.inside(theta + alpha, at)
    _require_theorem()
    ends = tuple(x.subs(at) for x in (interval.lower, interval.upper))
    return Outcome(
        judge(holds=interval.excludes, under=passed == 0),
        f"Its length is {plain(interval.length)}, at least a full turn, so it excludes no angle."
        f" Smallest case: cos q = 0 gives [{plain(ends[0])}, {plain(ends[1])}], which holds every"
        f" angle, and {passed} copy of the root that the proof keeps lies inside. Without the -2π"
        " of the second line it is the set where a cos q + b sin q ≥ c, proved for every a, b, c.",
    )


@computes("E-33")
def one_cosine() -> Outcome:
    steps = theorem_2()
    (identity,) = (name for name in steps if "θ = atan2" in name)
    return Outcome(
        judge(holds=steps[identity]),
        f"There is such a d and θ for all real a, b: {identity} leaves nothing after"
        " simplification. Which θ that is, eq. (34) says.",
    )


@computes("E-34")
def amplitude_and_phase() -> Outcome:
    import sympy as sp

    b, q = sp.symbols("b q", real=True)

    def missing(a: sp.Symbol, theta: sp.Expr) -> sp.Expr:
        cosine = sp.sqrt(a**2 + b**2) * sp.cos(q - theta)
        return sp.simplify(cosine - a * sp.cos(q) - b * sp.sin(q))

    positive, negative = sp.Symbol("a", positive=True), sp.Symbol("a", negative=True)
    right = missing(positive, sp.atan(b / positive)) == 0
    left = missing(negative, sp.atan(b / negative)) == 0
    corrected = all(missing(a, sp.atan2(b, a)) == 0 for a in (positive, negative))
    behind = [
        f"β_{{{window.boundary[1:]},{window.component}}}"
        for window in paper_rule.windows(robot())
        if _cosine(window) < 0
    ]
    at = sp.cos(0 - sp.atan(sp.Integer(0) / -1))  # a = -1, b = 0 at q = 0, where a cos q is -1
    return Outcome(
        judge(holds=right and left, under=right and corrected),
        "d cos(q - θ) equals a cos q + b sin q identically for a > 0. For a < 0 the arctangent"
        f" turns it round: a = -1, b = 0 at q = 0 gives {at} for -1. For a = 0 the quotient does"
        " not exist. With atan2(b, a) it is an identity in all quadrants. Of the robot's point"
        f" components, {' and '.join(behind)} have a < 0.",
    )


@computes("E-35")
def divided() -> Outcome:
    import sympy as sp

    c, d, x = sp.symbols("c d x", real=True)
    nonzero = sp.Symbol("d", positive=True)
    same = sp.solveset(nonzero * x - c, x) == sp.FiniteSet(c / nonzero)
    lost = (d * x - c).subs({c: 0, d: 0}) == 0
    count = int(circle_roots(0.0, 0.0, 0.0).count)
    return Outcome(
        judge(holds=not lost, under=same and count == ALL),
        "Equivalent for d > 0. For a = b = c = 0 every q is a solution and c / d does not exist.",
    )


@computes("E-36")
def condition_for_roots() -> Outcome:
    steps = theorem_2()
    exact = all(steps.values())
    cases = {"|c| > d": (3, 4, 6), "|c| = d": (3, 4, 5), "|c| < d": (3, 4, 2)}
    counts = {name: int(circle_roots(*map(float, abc)).count) for name, abc in cases.items()}
    everywhere = int(circle_roots(0.0, 0.0, 0.0).count) == ALL
    numbers = ", ".join(f"{count} for {name}" for name, count in counts.items())
    return Outcome(
        judge(holds=not everywhere, under=exact and list(counts.values()) == [0, 1, 2]),
        "d² - (a cos q + b sin q)² is the square (a sin q - b cos q)², so for d > 0 the condition"
        " is needed, and θ + arccos(c / d) shows that it suffices. Roots for a = 3, b = 4:"
        f" {numbers}. For a = b = c = 0 there are solutions and no c / d.",
    )


@computes("E-37")
def inverse_cosine() -> Outcome:
    import sympy as sp

    k = sp.Symbol("k", integer=True)
    q = -sp.pi / 2  # cos q = 0: a = 1, b = c = 0
    solves = sp.cos(q) == 0
    turns = sp.solve(sp.Eq(q, sp.acos(0) + 2 * sp.pi * k), k)
    printed = bool(turns)
    _require_theorem()
    fraction = sp.solve(sp.Eq(q, sp.acos(0) + 2 * sp.pi * sp.Symbol("x")), sp.Symbol("x"))[0]
    return Outcome(
        judge(holds=not solves or printed),
        f"cos q = 0 has the solution q = {plain(q)}, which would need k = {fraction}: it is not"
        " among the printed ones. The cosine is even, so both signs solve it, and it falls strictly"
        " on (0, π), so there are no others.",
    )


@computes("E-38")
def one_root() -> Outcome:
    turn = np.linspace(-np.pi, np.pi, 73)[:-1]
    a, b = np.cos(turn), np.sin(turn)
    c = np.linspace(-0.99, 0.99, 45)[:, None]
    with np.errstate(divide="ignore"):
        printed = np.arctan(b / a) + np.arccos(c)
    corrected = np.arctan2(b, a) + np.arccos(c)
    wrong, left = (np.abs(a * np.cos(q) + b * np.sin(q) - c) > 1e-12 for q in (printed, corrected))
    falls = (b * np.cos(corrected) - a * np.sin(corrected) < 0).all()
    share = 100 * wrong.mean()
    behind = np.array_equal(wrong, (a < 0) & (np.abs(c) > 1e-12))
    which = "those with a < 0 and c not 0" if behind else "others than those with a < 0 too"
    return Outcome(
        judge(holds=not wrong.any(), under=not left.any() and bool(falls)),
        f"A root, but not with every a: of {wrong.size} equations with d = 1 all round the circle"
        f" the arctangent misses {share:.1f} %, {which}; with atan2 all are solved, always at the"
        " root where a cos q + b sin q falls. The rising root θ - arccos(c / d) is not among them"
        " (E-37).",
    )


@computes("E-39")
def interval_between_roots() -> Outcome:
    theta, alpha = symbols()
    interval, at = interval_of_the_proof(), smallest()
    falling, rising = (interval.inside(theta + sign * alpha, at) for sign in (1, -1))
    return Outcome(
        judge(holds=interval.excludes, under=falling == 0),
        f"Its length is {plain(interval.length)}, so it excludes no angle modulo a turn. Its ends"
        f" are two copies of the falling root and {falling} lie between, so a motion that keeps off"
        f" that root stays inside; the rising root lies between, {rising} time, and there the sign"
        " of a cos q + b sin q - c changes.",
    )


@computes("TH-2")
def theorem_as_printed() -> Outcome:
    theta, alpha = symbols()
    intervals = {
        "eq. (31)": printed_interval(),
        "eq. (39)": interval_of_the_proof(),
        "the restated theorem": Interval(theta - alpha, theta + alpha),
    }
    degrees = {
        name: round(np.degrees(float(interval.length.subs(smallest()))))
        for name, interval in intervals.items()
    }
    positive = round(2 * np.degrees(float(circle_arc(1.0, 0.0, 0.0).half_width)))
    _require_theorem()
    lengths = ", ".join(f"{name} {x}°" for name, x in degrees.items())
    return Outcome(
        judge(holds=degrees["eq. (31)"] == positive),
        f"For cos q ≥ 0 the lengths are: {lengths}. The cosine is positive on {positive}°. Its"
        f" proof has {len(theorem_2())} steps, each an identity checked by computer algebra.",
    )


def _cosine(window: paper_rule.Window) -> float:
    """Return a, the factor of the cosine in the component of a window, cm."""
    pair = next(pair for pair in pairs() if pair.name == window.boundary)
    component = pair_vector(robot(), pair)[window.component - 1]
    return float(component.along(window.joint, robot().home)[1])


def _require_theorem() -> None:
    """Stop where a step of the restated theorem is not proved."""
    for name, holds in theorem_2().items():
        require(holds, name)
