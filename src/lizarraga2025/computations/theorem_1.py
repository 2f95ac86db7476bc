"""Equations (13) to (29): Theorem 1, its proof, the eleven components."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import corrected, pairs, robot, symbolic_robot
from lizarraga2025.evidence.proofs import UNTURNED, General, general, quarter_turn, vanishes
from lizarraga2025.evidence.rounding import contact, degrees, radii
from lizarraga2025.verdicts import Outcome, judge
from qbound import components, pair_vector
from qbound.boundary.functions import closest_approach, observer
from qbound.model.frames import Frame, Frames
from qbound.symbols import joint_symbols


@computes("E-13")
def null_between() -> Outcome:
    chain = general().chain
    ends = [chain.position("0", name, "0") for name in ("a+n", "b+m")]
    holds = vanishes(chain.position("a+n", "b+m", "0") - (ends[1] - ends[0]))
    return Outcome(
        judge(holds=holds),
        "The vector is the difference of the two places, identically, so it is null exactly where"
        " they are one. A collision here means that points coincide, not that bodies touch.",
    )


@computes("E-14")
def null_length() -> Outcome:
    import sympy as sp

    x, y, z = parts = sp.symbols("x y z", real=True)
    squared = x**2 + y**2 + z**2
    holds = all((squared - part**2).is_nonnegative for part in parts)
    return Outcome(
        judge(holds=holds and squared.subs({x: 0, y: 0, z: 0}) == 0),
        "Of real components each square is at most the sum of all, so a zero sum leaves three"
        " zeros; the converse is immediate.",
    )


@computes("E-15")
def relative_position() -> Outcome:
    g, small = general(), quarter_turn()
    from_a, from_0 = (g.chain.position("a+n", "b+m", o) for o in ("a", "0"))
    seen = [tuple(int(x) for x in small.position("a", "b", o)) for o in ("a", "0")]
    return Outcome(
        judge(holds=vanishes(from_0 - g.B), under=vanishes(from_a - g.B) and seen[0] != seen[1]),
        "Seen from a it is an identity at every configuration, not under a collision only. Seen"
        f" from the base it is false: with frame a turned a quarter about y the vector {seen[0]}"
        f" from a is {seen[1]} from the base.",
    )


@computes("E-16")
def boundary_function() -> Outcome:
    import sympy as sp

    symbolic, _ = symbolic_robot()
    q = np.array(joint_symbols(robot()))
    frames = symbolic.frames(q)
    left, joints = [], []
    for pair in pairs():
        derived = sp.Matrix(pair_vector(symbolic, pair).symbolic(tuple(q)))
        seen = sp.Matrix(frames.position(*pair.points, observer(symbolic, pair)))
        left.append(sp.simplify(derived - seen) == sp.zeros(3, 1))
        joints.append(len(derived.free_symbols & set(q)))
    return Outcome(
        judge(holds=all(left) and set(joints) == {1}),
        f"For all {len(left)} pairs of the robot the form derived from the file is the vector of"
        " forward kinematics seen from frame a, identically; each depends on one joint.",
    )


@computes("E-17")
def collision_condition() -> Outcome:
    g = general()
    between = g.chain.position("a+n", "b+m", "0")
    gaps = [closest_approach(robot(), pair)[1] for pair in pairs()]
    return Outcome(
        judge(holds=vanishes(between @ between - g.B @ g.B)),
        "The vector between the points and B have the same length, identically, so both are null"
        " together. With the printed offsets no pair of the robot ever meets: the gaps that stay"
        f" run from {min(gaps):.4f} to {max(gaps):.4f} cm (E-17.1 to E-17.4).",
    )


@computes_each({f"E-17.{number}": number for number in (1, 2, 3, 4)})
def pair_meets(number: int) -> Outcome:
    pair = pairs()[number - 1]
    q, gap = closest_approach(robot(), pair)
    a, b = radii(robot(), pair)
    limit = contact(pair)
    with_9_09 = closest_approach(corrected(), pairs(corrected())[number - 1])[1]
    slip = f" With x_{{2,13}} = 9.09 the gap is {with_9_09:.4f} cm." if with_9_09 != gap else ""
    return Outcome(
        judge(holds=gap == 0, under=gap <= limit, corrected=with_9_09 <= limit),
        f"They are {a:.4f} and {b:.4f} cm from the joint between them and come as close as"
        f" {gap:.4f} cm, at {degrees(q)}. Offsets rounded to hundredths allow {limit:.4f}"
        f" cm.{slip}",
    )


# --- the proof of Theorem 1 -----------------------------------------------------------------------


@computes("E-18")
def chain_rule() -> Outcome:
    g = general()
    whole, first = (g.chain.position("0", name, "0") for name in ("b", "a"))
    own, common = (whole - first - g.R_0a @ g.chain.position("a", "b", o) for o in ("a", "0"))
    small = quarter_turn()
    R = small.rotation("0", "a")
    wrong = tuple(int(x) for x in R @ small.position("a", "b", "0"))
    right = tuple(int(x) for x in small.position("a", "b", "0"))
    return Outcome(
        judge(holds=vanishes(own) and vanishes(common), under=vanishes(own)),
        "With each vector seen from its first index it is an identity. With one common observer, as"
        " rule 5 has it, it is false: with a turned a quarter about y and b one unit along x of a"
        f" it gives {wrong} for {right}.",
    )


Step = Callable[[General], Any]

STEPS: Mapping[str, tuple[str, Step]] = {
    "E-19": (
        "for the observers 0, a and b",
        lambda g: [
            g.chain.position("a+n", "b+m", o)
            - (g.chain.position("0", "b+m", o) - g.chain.position("0", "a+n", o))
            for o in ("0", "a", "b")
        ],
    ),
    "E-20": (
        "seen from the base, the local vector from a",
        lambda g: g.chain.position("0", "a+n", "0") - (g.r_0a + g.R_0a @ g.r_an),
    ),
    "E-21": (
        "seen from the base, the local vector from b",
        lambda g: g.chain.position("0", "b+m", "0") - (_r_0b(g) + _R_0b(g) @ g.r_bm),
    ),
    "E-22": (
        "seen from the base",
        lambda g: _between(g) - ((_r_0b(g) + _R_0b(g) @ g.r_bm) - (g.r_0a + g.R_0a @ g.r_an)),
    ),
    "E-23": (
        "seen from the base",
        lambda g: _between(g) - ((_r_0b(g) - g.r_0a) + _R_0b(g) @ g.r_bm - g.R_0a @ g.r_an),
    ),
    "E-24": (
        "seen from the base; it also takes r_{0,b} - r_{0,a} = R_{0,a} r_{a,b}",
        lambda g: [
            _between(g) - (g.R_0a @ g.r_ab + g.R_0a @ g.R_ab @ g.r_bm - g.R_0a @ g.r_an),
            _r_0b(g) - g.r_0a - g.R_0a @ g.r_ab,
        ],
    ),
}
"""Steps of the proof: who observes, and left side less right side."""


@computes_each(STEPS)
def step_of_the_proof(step: tuple[str, Step]) -> Outcome:
    seen, difference = step
    left = np.ravel(np.asarray(difference(general())))
    return Outcome(
        judge(holds=vanishes(left)),
        f"An identity {seen}: none of {left.size} components leaves a remainder in general"
        " rotations and vectors.",
    )


def _between(g: General) -> Any:
    return g.chain.position("a+n", "b+m", "0")


def _r_0b(g: General) -> Any:
    return g.chain.position("0", "b", "0")


def _R_0b(g: General) -> Any:
    return g.chain.rotation("0", "b")


@computes("E-25")
def rotation_taken_out() -> Outcome:
    g = general()
    from_0, from_a = (g.chain.position("a+n", "b+m", o) for o in ("0", "a"))
    under = vanishes(from_0 - g.R_0a @ g.B)
    return Outcome(
        judge(holds=under and vanishes(from_a - g.R_0a @ g.B), under=under),
        "An identity seen from the base. The left side has the label of eq. (15), which holds seen"
        " from a: one arrow, two observers, and two equal columns only where R_{0,a} leaves B as"
        " it is.",
    )


@computes("E-26")
def bracket_null() -> Outcome:
    g = general()
    back = vanishes(g.R_0a.T @ _between(g) - g.B)
    flat, up = np.diag([1, 1, 0]), np.array([0, 0, 1])
    needed = not (flat @ up).any() and bool(up.any())
    return Outcome(
        judge(holds=back and needed),
        "The transpose of R_{0,a} times the vector is B, identically. This is the reason that"
        " the step needs and leaves out: R_{0,a} is invertible. With a projection, which is not,"
        f" diag(1, 1, 0) sends {tuple(int(x) for x in up)} to null.",
    )


@computes("E-27")
def boundary_function_again() -> Outcome:
    g = general()
    return Outcome(
        judge(holds=vanishes(g.chain.position("a+n", "b+m", "a") - g.B)),
        "The same right side as eq. (16): the vector between the points seen from a, for every"
        " rotation and vector.",
    )


@computes("E-28")
def collision_condition_again() -> Outcome:
    g = general()
    there, back = vanishes(_between(g) - g.R_0a @ g.B), vanishes(g.R_0a.T @ _between(g) - g.B)
    return Outcome(
        judge(holds=there and back),
        "Both directions: the vector is R_{0,a} B, and B is the transpose of R_{0,a} times the"
        " vector, identically. The first gives 'if', the second 'only if'.",
    )


@computes("TH-1")
def theorem_1() -> Outcome:
    g = general()
    printed = Frames(  # the labels in the printed order: b grows from the point a+n
        "0",
        [
            Frame("a", "0", g.R_0a, g.r_0a),
            Frame("a+n", "a", UNTURNED, g.r_an),
            Frame("b", "a+n", g.R_ab, g.r_ab - g.r_an),
            Frame("b+m", "b", UNTURNED, g.r_bm),
        ],
    )
    same_order = vanishes(printed.position("a+n", "b+m", "a") - g.B)
    both = vanishes(_between(g) - g.R_0a @ g.B) and vanishes(g.R_0a.T @ _between(g) - g.B)
    return Outcome(
        judge(holds=both and same_order),
        "Proved in two general rotations and four general vectors, both directions. Whether b is"
        " chained to a or to the point a+n, as the printed order has it, makes no difference.",
    )


# --- the eleven components ------------------------------------------------------------------------


def _derived(name: str) -> Any:
    import sympy as sp

    symbolic, _ = symbolic_robot()
    i, j = paper.indices(name)
    form = components(symbolic, symbolic.boundary(f"B{i}"))
    return sp.sympify(form.symbolic(joint_symbols(robot()))[j - 1])


def _differs(name: str) -> Any:
    """Return the derived component less the printed one."""
    import sympy as sp

    return sp.expand(_derived(name) - paper.expression(paper.EQUATION_29[name]))


@computes("E-29")
def eleven_components() -> Outcome:
    names = {f"beta_{{{b.name[1:]},{j}}}" for b in robot().boundaries for j in (1, 2, 3)}
    equal = [_differs(name) == 0 for name in paper.EQUATION_29]
    rest = [_derived(name) == 0 for name in names - set(paper.EQUATION_29)]
    return Outcome(
        judge(holds=all(equal) and all(rest)),
        f"{sum(equal)} of {len(equal)} printed components equal the derived ones by identity, and"
        f" the {len(rest)} that are not printed are zero.",
    )


@computes_each({"E-29.{}.{}".format(*paper.indices(name)): name for name in paper.EQUATION_29})
def component(name: str) -> Outcome:
    import sympy as sp

    printed = sp.expand(paper.expression(paper.EQUATION_29[name]))
    return Outcome(
        judge(holds=_differs(name) == 0),
        f"The component derived from the chain has {len(sp.Add.make_args(printed))} terms; printed"
        f" minus derived is {_differs(name)}, symbol by symbol.",
    )
