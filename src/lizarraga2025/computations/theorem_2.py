"""Equations (30) to (39): Theorem 2, its proof, and the theorem restated."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes
from lizarraga2025.evidence.arms import pairs, robot
from lizarraga2025.evidence.proofs import theorem_2
from lizarraga2025.evidence.rounding import SMALL
from lizarraga2025.verdicts import Outcome, Verdict, judge, of_readings
from qbound import joint_windows, pair_vector
from qbound.circle import ALL, circle_arc, circle_roots
from qbound.symbols import joint_symbols
from qbound.windows import Window

ATAN2: Final = "θ = atan2(b, a)"


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
        _, alpha = symbols()
        shorter = sp.solveset(self.length < 2 * sp.pi, alpha, sp.Interval(0, sp.pi))
        return bool(shorter != sp.EmptySet)

    def reaches(self, root: sp.Expr) -> bool:
        """Tell whether a root, or a copy of it some full turns away, lies between the ends.

        Tried for α from 0 to π in steps of π/8, exactly; an interval of a full turn needs no trial.
        """
        _, alpha = symbols()
        return not self.excludes or all(
            self.copies(root, {alpha: sp.pi * sp.Rational(i, 8)}) for i in range(9)
        )

    def copies(self, root: sp.Expr, at: dict[sp.Symbol, sp.Expr], *, inside: bool = False) -> int:
        """Count the copies of a root, full turns away, between the ends or strictly inside."""
        low, high = ((x - root).subs(at) for x in (self.lower, self.upper))
        turns = (2 * sp.pi * turn for turn in range(-3, 4))
        return sum(bool(low < x < high if inside else low <= x <= high) for x in turns)


def symbols() -> tuple[sp.Symbol, sp.Symbol]:
    """Return θ and α."""
    theta, alpha = sp.symbols("theta alpha", real=True)
    return theta, alpha


def interval(equation: int) -> Interval:
    """Return the interval of eq. (31) or (39), k = 0, with θ for the printed inverse tangent."""
    theta, alpha = symbols()
    ends = (paper.expression(paper.THEOREM_2[f"{equation} {end}"]) for end in ("lower", "upper"))
    lower, upper = (
        end.replace(sp.atan, lambda _: theta).replace(sp.acos, lambda _: alpha) for end in ends
    )
    k = sp.Symbol("k", real=True)
    return Interval(lower.subs(k, 0), upper.subs(k, 0))


def plain(expression: sp.Expr) -> str:
    """Write an expression in θ, α and π without signs of multiplication."""
    text = str(sp.sstr(expression)).replace("*", "")
    return text.replace("alpha", "α").replace("theta", "θ").replace("pi", "π")


def smallest() -> dict[sp.Symbol, sp.Expr]:
    """Return θ and α of cos q = 0: a = 1, b = c = 0."""
    theta, alpha = symbols()
    return {theta: sp.atan2(0, 1), alpha: sp.acos(0)}


@computes("E-30")
@computes("E-32")
def form_of_the_components() -> Outcome:
    joints = joint_symbols(robot())
    components = [sp.expand(paper.expression(text)) for text in paper.EQUATION_29.values()]
    of_the_form = [
        form for form in components if all(_is_of_the_form(form, q) for q in joints if form.has(q))
    ]
    return Outcome(
        judge(holds=len(of_the_form) == len(components)),
        f"{len(of_the_form)} of {len(components)} components of eq. (29) are of this form in every"
        " joint they depend on, identically in the offsets, the other joint held.",
    )


def _is_of_the_form(form: sp.Expr, q: sp.Symbol) -> bool:
    """Tell whether a component is that of eq. (30) in a joint, with c the rest, less its sign."""
    a, b, x = (sp.Symbol(name, real=True) for name in "abq")
    printed = paper.expression(paper.THEOREM_2["30"]).subs(x, q)
    factors = {a: form.coeff(sp.cos(q)), b: form.coeff(sp.sin(q))}
    rest = sp.expand(form - printed.subs(factors))
    return not any(part.has(q) for part in (*factors.values(), rest))


@computes("E-31")
def bounds_as_printed() -> Outcome:
    theta, alpha = symbols()
    printed, arc = interval(31), Interval(theta - alpha, theta + alpha)
    low, high = (plain(end.subs(smallest())) for end in (printed.lower, printed.upper))
    return Outcome(
        _judge(printed),
        f"It is {plain(printed.length)} long, a full turn or more: with arctan or atan2, every"
        " solution has a copy in it, full turns away, for some k, and so has every other angle."
        f" With atan2 both of its ends are roots too, and {_between(printed)} more copies of these"
        " two roots lie strictly between, so for a fixed k it bounds nothing that they do not bound"
        " closer (E-39)."
        f" Smallest case: cos q = 0 has the interval from {low} to {high}. Without the -2π of the"
        f" second line, and with {ATAN2}, it is {plain(arc.length)} long and exactly the set where"
        f" a cos q + b sin q ≥ c{_proved()}. {_one_sign_off()}",
    )


def _between(printed: Interval) -> int:
    """Count the copies of the roots at the two ends that lie strictly between, for cos q = 0."""
    ends = (printed.lower, printed.upper)
    apart = {end: printed.copies(end, smallest(), inside=True) for end in ends}
    is_one_root = printed.copies(printed.upper, smallest()) - apart[printed.upper] == 2
    return apart[printed.upper] if is_one_root else sum(apart.values())


def _as_a_motion(printed: Interval) -> Verdict:
    """Judge that a joint stays between the ends, for a fixed k, while it keeps off their roots.

    The ends have to be roots, and no other copy of them lies between.
    """
    theta, alpha = symbols()

    def are_roots(turned: sp.Expr) -> bool:
        """Tell whether both ends solve the equation if θ is off by some angle."""
        ends = (end.subs(theta, turned) for end in (printed.lower, printed.upper))
        return all(sp.expand_trig(sp.cos(end) - sp.cos(alpha)) == 0 for end in ends)

    alone = _between(printed) == 0
    return judge(
        holds=alone and are_roots(sp.Integer(0)) and are_roots(sp.pi),
        amended=alone and are_roots(sp.Integer(0)),
    )


def _judge(printed: Interval) -> Verdict:
    """Judge that every solution has a copy between two bounds, whatever the arctangent."""
    theta, alpha = symbols()
    roots = [theta + turned + sign * alpha for turned in (0, sp.pi) for sign in (1, -1)]
    either = all(printed.reaches(root) for root in roots)
    return judge(
        holds=either,
        constrains=printed.excludes,
        under=all(printed.reaches(root) for root in roots[:2]),
    )


def _one_sign_off() -> str:
    """Tell that eqs. (31) and (39) differ by one sign, and what that changes: nothing."""
    _, alpha = symbols()
    stated, derived = interval(31), interval(39)
    same = derived.upper == stated.upper and derived.lower == stated.lower.subs(alpha, -alpha)
    if not same:
        return "It is not what the proof derives."
    return (
        "The proof ends with eq. (39), which has + before cos⁻¹ in both lines: the two differ by"
        " one sign, and with either every angle has a copy."
    )


def _proved() -> str:
    """Tell whether the steps of the restated theorem are identities."""
    return ", as Theorem 2 restated proves" if all(theorem_2().values()) else ""


@computes("S-21.2")
def range_of_values() -> Outcome:
    theta, alpha = symbols()
    printed, arc = interval(31), Interval(theta - alpha, theta + alpha)
    same = (printed.lower, printed.upper) == (arc.lower, arc.upper)
    return of_readings(
        "by eq. (31) as printed",
        {
            "by eq. (31) as printed": judge(holds=same),
            "by Theorem 2 restated (TH-2)": judge(holds=False, under=all(theorem_2().values())),
        },
        "While a constraint is satisfied, a cos q + b sin q ≥ c, which is an inequality. Its"
        f" solutions are an arc of {plain(arc.length)}{_proved()}; eq. (31) is"
        f" {'that arc' if same else f'{plain(printed.length)} long and holds every angle'}.",
    )


@computes("E-33")
def one_cosine() -> Outcome:
    a, b, q, d, theta = (sp.Symbol(name, real=True) for name in ("a", "b", "q", "d", "theta"))
    cosine = paper.expression(paper.THEOREM_2["33"])
    left = sp.expand_trig(cosine.subs({d: sp.sqrt(a**2 + b**2), theta: sp.atan2(b, a)}))
    return Outcome(
        judge(holds=sp.simplify(left - a * sp.cos(q) - b * sp.sin(q)) == 0),
        "There is such a d and θ for all real a and b, not both zero: with d the root of a² + b²"
        " and θ the direction of (a, b) it is an identity. Which θ is meant, eq. (34) says.",
    )


@computes("E-34")
def amplitude_and_phase() -> Outcome:
    b, q = sp.symbols("b q", real=True)

    def missing(a: sp.Symbol, reading: paper.Reading) -> sp.Expr:
        d, theta = (
            paper.expression(paper.THEOREM_2[f"34 {name}"], arctan=reading).subs(
                sp.Symbol("a", real=True), a
            )
            for name in ("d", "theta")
        )
        return sp.simplify(d * sp.cos(q - theta) - a * sp.cos(q) - b * sp.sin(q))

    positive, negative = sp.Symbol("a", positive=True), sp.Symbol("a", negative=True)
    right, left = (missing(a, "arctan") == 0 for a in (positive, negative))
    corrected = all(missing(a, "atan2") == 0 for a in (positive, negative))
    behind = [
        f"β_{{{window.boundary[1:]},{window.component}}}"
        for window in joint_windows(robot())
        if _cosine(window) < 0
    ]
    at = sp.cos(0 - sp.atan(sp.Integer(0) / -1))  # a = -1, b = 0 at q = 0, where a cos q is -1
    return Outcome(
        judge(holds=right and left, amended=right and corrected),
        "d cos(q - θ) equals a cos q + b sin q identically for a > 0. For a < 0 an arctangent of"
        f" the quotient alone turns it round: a = -1, b = 0 at q = 0 gives {at} for -1. For a = 0"
        " the quotient does not exist. With atan2(b, a), which is often meant, it is an identity in"
        f" all quadrants. Of the robot's point components, {' and '.join(behind)} have a < 0.",
    )


@computes("E-35")
def divided() -> Outcome:
    c, d, x = sp.symbols("c d x", real=True)
    nonzero = sp.Symbol("d", positive=True)
    quotient = paper.expression(paper.THEOREM_2["35"]).subs(d, nonzero)
    same = sp.solveset(nonzero * x - c, x) == sp.FiniteSet(quotient)
    lost = (d * x - c).subs({c: 0, d: 0}) == 0
    return Outcome(
        judge(holds=same),
        "Equivalent for d > 0, as dividing by d takes for granted and all components of the robot"
        f" have it. For a = b = c = 0 every q {'is' if lost else 'is not'} a solution, and c / d"
        " does not exist.",
    )


@computes("E-36")
def condition_for_roots() -> Outcome:
    ends = (paper.expression(paper.THEOREM_2[f"36 {end}"]) for end in ("lower", "upper"))
    values = sp.Interval(*ends)
    x = sp.Symbol("x", real=True)
    exact = sp.calculus.util.function_range(sp.cos(x), x, sp.Interval(0, 2 * sp.pi)) == values
    cases = {"|c| > d": (3, 4, 6), "|c| = d": (3, 4, 5), "|c| < d": (3, 4, 2)}
    counts = {name: int(circle_roots(*map(float, abc)).count) for name, abc in cases.items()}
    everywhere = int(circle_roots(0.0, 0.0, 0.0).count) == ALL
    numbers = ", ".join(f"{count} for {name}" for name, count in counts.items())
    return Outcome(
        judge(holds=exact and list(counts.values()) == [0, 1, 2]),
        "The values of a cosine are those from -1 to 1, so for d > 0 the condition is needed, and"
        f" it suffices. Roots for a = 3, b = 4: {numbers}. At d = 0 there is no c / d;"
        f" for c = 0 too {'every q solves' if everywhere else 'no q solves'} the equation.",
    )


@computes("E-37")
def inverse_cosine() -> Outcome:
    _, alpha = symbols()
    k, pm = (sp.Symbol(name, real=True) for name in ("k", "pm"))
    text = paper.expression(paper.THEOREM_2["37"]).replace(sp.acos, lambda _: alpha).subs(k, 0)
    families = {text.subs(pm, sign) for sign in (1, -1)}
    solve = all(sp.cos(x) == sp.cos(alpha) for x in families)
    q = -sp.pi / 2  # cos q = 0: a = 1, b = c = 0
    needed = (q - sp.acos(0)) / (2 * sp.pi)
    every = {text.subs(pm, 1), -text.subs(pm, 1)} == {alpha, -alpha}
    return of_readings(
        "every solution, with ± for +",
        {
            "the solutions at which it falls, with + as printed": judge(
                holds=solve and families == {alpha, -alpha}, under=solve
            ),
            "every solution, with ± for +": judge(
                holds=families == {alpha, -alpha}, corrected=every
            ),
        },
        "These are the solutions at which a cos q + b sin q falls. Those at which it rises have the"
        f" other sign, for the cosine is even: cos q = 0 has q = {plain(q)} too, which would need"
        f" k = {needed}. All hangs on one sign of a converted text. Eq. (38) and Table 6 have the"
        " same +. We therefore read it as a deliberate choice of one root.",
    )


@computes("E-38")
def one_root() -> Outcome:
    turn = np.linspace(-np.pi, np.pi, 73)[:-1] + 0.01  # no a is zero
    a, b, c = np.cos(turn), np.sin(turn), np.linspace(-0.99, 0.99, 45)[:, None]
    names = sp.symbols("a b c d k", real=True)
    solved, falls = {}, {}
    for reading in ("arctan", "atan2"):
        root = paper.expression(paper.THEOREM_2["38"], arctan=reading)
        q = sp.lambdify(names, root, "numpy")(a, b, c, 1, 0)
        solved[reading] = np.abs(a * np.cos(q) + b * np.sin(q) - c) < SMALL
        falls[reading] = bool((b * np.cos(q) - a * np.sin(q) < 0).all())
    missed = ~solved["arctan"]
    where = (
        "those with a < 0 and c not 0" if (missed == ((a < 0) & (c**2 > SMALL))).all() else "some"
    )
    return Outcome(
        judge(
            holds=bool(solved["arctan"].all()),
            amended=bool(solved["atan2"].all()) and falls["atan2"],
        ),
        f"Tried on {missed.size} equations with d = 1 all round the circle: with an arctangent of"
        f" the quotient alone {where} are not solved, with {ATAN2} all are, at the root where"
        " a cos q + b sin q falls. The root where it rises is not among them (E-37).",
    )


@computes("E-39")
def interval_between_roots() -> Outcome:
    theta, alpha = symbols()
    printed, at = interval(39), smallest()
    rising = printed.copies(theta - alpha, at, inside=True)
    return of_readings(
        "for every solution some k",
        {
            "k fixed: a joint that moves continuously and never reaches the roots at the ends": (
                _as_a_motion(printed)
            ),
            "for every solution some k": _judge(printed),
        },
        f"It is {plain(printed.length)} long. With {ATAN2} its ends are two copies of the falling"
        f" root, and {_between(printed) or 'no other'} copy of it lies between. A joint that moves"
        f" continuously and never reaches that root therefore stays inside. {rising} copy of the"
        " rising root lies between, and there the sign of a cos q + b sin q - c changes. With k"
        " free, every solution has a copy in it, full turns away, and so has every other angle.",
    )


@computes("E-39.2")
def proof_completed() -> Outcome:
    theta, alpha = symbols()
    pm = sp.Symbol("pm", real=True)
    stated, derived = interval(31), interval(39)
    step = paper.expression(paper.THEOREM_2["37"]).replace(sp.acos, lambda _: alpha)
    signs = {step.coeff(alpha).subs(pm, sign) for sign in (1, -1)}
    gaps = [derived.lower - stated.lower, stated.upper - derived.upper]
    inside = all(gap.subs(alpha, end) >= 0 for gap in gaps for end in (0, sp.pi))  # affine in α
    follows = inside and all(derived.reaches(theta + sign * alpha) for sign in signs)
    either = all(stated.reaches(theta + sign * alpha) for sign in (1, -1))
    return of_readings(
        "eq. (31) for every solution",
        {
            "eq. (31) for every solution": judge(
                holds=follows and signs == {1, -1}, under=follows and either
            ),
            "eq. (39) as the bound of the solutions in eq. (38)": judge(
                holds=follows, constrains=derived.excludes
            ),
        },
        "Eq. (31) follows from eq. (39), whose interval lies in it for every θ and every cos⁻¹ from"
        " 0 to π. Eq. (39) is derived for the solutions with + in eq. (37) alone; those with - have"
        " a copy in both intervals too, so with ± there the proof is complete, with"
        f" {ATAN2} (E-34).",
    )


@computes("TH-2")
def theorem_as_printed() -> Outcome:
    theta, alpha = symbols()
    intervals = {
        "eq. (31)": interval(31),
        "eq. (39)": interval(39),
        "the restated theorem": Interval(theta - alpha, theta + alpha),
    }
    lengths = ", ".join(f"{name} {_in_degrees(one)}°" for name, one in intervals.items())
    positive = round(2 * np.degrees(float(circle_arc(1.0, 0.0, 0.0).half_width)))
    return Outcome(
        _judge(intervals["eq. (31)"]),
        "True of every solution, and of every angle, for no interval of a full turn or more leaves"
        f" one out. For cos q ≥ 0 the lengths are: {lengths}; the cosine is positive on"
        f" {positive}°. The restated theorem has {len(theorem_2())} steps,"
        f" {sum(theorem_2().values())} of them identities checked by computer algebra."
        f" With atan2 both ends are roots (E-31). {_one_sign_off()}",
    )


def _in_degrees(one: Interval) -> int:
    """Return the length of an interval for cos q = 0."""
    return int(np.rint(np.degrees(float(one.length.subs(smallest())))))


def _cosine(window: Window) -> float:
    """Return a, the factor of the cosine in the component of a window, cm."""
    pair = next(pair for pair in pairs() if pair.name == window.boundary)
    component = pair_vector(robot(), pair)[window.component - 1]
    return float(component.along(window.joint, robot().home)[1])
