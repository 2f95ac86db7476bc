"""Equations (13) to (29): Theorem 1, its proof, the eleven components."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence.arms import corrected, pairs, robot, symbolic_robot
from lizarraga2025.evidence.proofs import (
    UNTURNED,
    General,
    general,
    is_identity,
    quarter_turn,
    right_side,
    vanishes,
)
from lizarraga2025.evidence.rounding import contact, degrees, other_slips, radii
from lizarraga2025.verdicts import Outcome, judge, of_readings
from qbound.boundary import closest_approach, components, pair_vector
from qbound.frames import Frame, Frames
from qbound.symbols import joint_symbols

ENDS: Final = ("a+n", "b+m")
"""The vector on the left of most equations: from one point to the other."""


@computes("E-13")
def null_between() -> Outcome:
    return Outcome(
        judge(holds=is_identity(19, ENDS, "0", "0")),
        "The vector is the difference of the two places, identically, so it is null exactly where"
        " they are one. A collision here means that points coincide, not that bodies touch.",
    )


@computes("E-14")
def null_length() -> Outcome:
    parts = sp.symbols("x y z", real=True)
    squared = sp.expand(paper.work_out(paper.THEOREM_1[14], dict(zip("xyz", parts, strict=True))))
    at_least = all((squared - part**2).is_nonnegative for part in parts)
    return Outcome(
        judge(holds=at_least and squared.subs(dict.fromkeys(parts, 0)) == 0),
        "Of real components each square is at most the sum of all, so a zero sum leaves three"
        " zeros; the converse is immediate.",
    )


@computes("E-15")
def relative_position() -> Outcome:
    small = quarter_turn()
    seen = [tuple(int(x) for x in small.position("a", "b", o)) for o in ("a", "0")]
    return of_readings(
        "seen from a, the local vectors each from its own frame",
        {
            "seen from a, the local vectors each from its own frame": judge(
                holds=is_identity(15, ENDS, "a")
            ),
            "all vectors seen from the base": judge(holds=is_identity(15, ENDS, "0", "0")),
        },
        "Seen from a it is an identity at every configuration, not under a collision only. Seen"
        f" from the base the same arrow has other components: with frame a turned a quarter about y"
        f" the vector {seen[0]} from a is {seen[1]} from the base.",
    )


@computes_each({"E-16": 16, "E-27": 27})
def boundary_function(number: int) -> Outcome:
    joints = [len(pair_vector(robot(), pair).joints()) for pair in pairs()]
    return Outcome(
        judge(holds=is_identity(number, ENDS, "a") and set(joints) == {1}),
        "It is the vector between the points seen from frame a, for every rotation and vector. For"
        f" each of the {len(joints)} pairs of the robot it depends on one joint.",
    )


@computes("E-17")
def collision_condition() -> Outcome:
    between, B = _between(general()), right_side(16)
    gaps = [closest_approach(robot(), pair).gap for pair in pairs()]
    return Outcome(
        judge(holds=vanishes(between @ between - B @ B)),
        "The vector between the points and B have the same length, identically, so both are null"
        " together. With offsets printed to hundredths of a cm the pairs of the robot come as close"
        f" as {min(gaps):.4f} to {max(gaps):.4f} cm (E-17.1 to E-17.4).",
    )


@computes_each({f"E-17.{number}": number for number in (1, 2, 3, 4)})
def pair_meets(number: int) -> Outcome:
    pair = pairs()[number - 1]
    nearest = closest_approach(robot(), pair)
    q, gap = nearest.q, nearest.gap
    a, b = radii(robot(), pair)
    limit = contact(pair)
    with_9_09 = closest_approach(corrected(), pairs(corrected())[number - 1]).gap
    slip = f" With x_{{2,13}} = 9.09 the gap is {with_9_09:.4f} cm: a single digit, of a converted"
    slip += f" text, decides. {other_slips()}"
    return Outcome(
        judge(holds=gap <= limit, corrected=with_9_09 <= limit),
        f"They are {a:.4f} and {b:.4f} cm from the joint between them and come as close as"
        f" {gap:.4f} cm, at {degrees(q)}. Offsets rounded to hundredths allow {limit:.4f}"
        f" cm.{slip if gap > limit else ''}",
    )


# --- the proof of Theorem 1 -----------------------------------------------------------------------


def _one_step(vector: Any, rotation: Any, step: Any) -> Any:
    """Work out the right side of eq. (18)."""
    return paper.work_out(paper.THEOREM_1[18], {"r_1": vector, "R_1": rotation, "r_2": step})


@computes("E-18")
def chain_rule() -> Outcome:
    g, small = general(), quarter_turn()
    whole = g.chain.position("0", "b", "0")
    own, common = (
        vanishes(whole - _one_step(g.r_0a, g.R_0a, g.chain.position("a", "b", observer)))
        for observer in ("a", "0")
    )
    R = small.rotation("0", "a")
    wrong = tuple(int(x) for x in R @ small.position("a", "b", "0"))
    right = tuple(int(x) for x in small.position("a", "b", "0"))
    return of_readings(
        "the last vector seen from b-1, as its matrix says",
        {
            "the last vector seen from b-1, as its matrix says": judge(holds=own),
            "all vectors seen from one frame": judge(holds=common),
        },
        "With r_{b-1,b} seen from b-1 it is an identity. With it seen from a as well it is not:"
        " with b-1 turned a quarter about y and b one unit along x of it the right side is"
        f" {wrong} for {right}.",
    )


@computes("E-18.1")
def longer_chains() -> Outcome:
    rotations = [np.array(sp.symbols(f"R{i}_0:9")).reshape(3, 3) for i in range(4)]
    steps = [np.array(sp.symbols(f"x{i} y{i} z{i}")) for i in range(4)]
    vector, rotation = steps[0], rotations[0]
    whole = _homogeneous(rotation, vector)
    for R, step in zip(rotations[1:], steps[1:], strict=True):
        vector, rotation = _one_step(vector, rotation, step), rotation @ R
        whole = whole @ _homogeneous(R, step)
    return Outcome(
        judge(holds=not any(map(sp.expand, vector - whole[:3, 3]))),
        f"Applied again and again, over {len(steps)} steps, it gives the last column of the product"
        " of their homogeneous matrices, for any entries.",
    )


def _homogeneous(rotation: Any, origin: Any) -> Any:
    return np.vstack([np.column_stack([rotation, origin]), [0, 0, 0, 1]])


Step = tuple[tuple[str, str], tuple[tuple[str, str], ...], str]

STEPS: Mapping[int, Step] = {
    19: (ENDS, (("0", "0"), ("a", "a"), ("b", "b")), "for the observers 0, a and b"),
    20: (("0", "a+n"), (("0", ""),), "seen from the base, the local vector from a"),
    21: (("0", "b+m"), (("0", ""),), "seen from the base, the local vector from b"),
    22: (ENDS, (("0", ""),), "seen from the base"),
    23: (ENDS, (("0", ""),), "seen from the base"),
    24: (
        ENDS,
        (("0", ""),),
        "seen from the base, by r_{0,b} - r_{0,a} = R_{0,a} r_{a,b} too",
    ),
}
"""Steps of the proof: the vector on the left, who sees the left and the right side, in words."""


@computes_each({f"E-{number}": number for number in STEPS})
def step_of_the_proof(number: int) -> Outcome:
    left, observers, words = STEPS[number]
    return Outcome(
        judge(holds=all(is_identity(number, left, *seen) for seen in observers)),
        f"An identity {words}, in general rotations and vectors.",
    )


@computes("E-24.1")
def rotations_in_a_row() -> Outcome:
    g = general()
    product = paper.work_out(paper.ROTATIONS_IN_A_ROW, {"R_0a": g.R_0a, "R_ab": g.R_ab})
    derived = g.chain.rotation("0", "b")
    commute = vanishes(derived - g.R_ab @ g.R_0a)
    return Outcome(
        judge(holds=vanishes(derived - product)),
        "An identity in two general rotations; the order matters, for with the factors exchanged it"
        f" is {'one too' if commute else 'none'}. It says nothing of the vectors: that"
        " r_{0,b} - r_{0,a} is R_{0,a} r_{a,b}, which the step uses too, is eq. (20) for b.",
    )


@computes("E-25")
def rotation_taken_out() -> Outcome:
    return of_readings(
        "seen from the base, as eqs. (19) to (24)",
        {
            "seen from the base, as eqs. (19) to (24)": judge(holds=is_identity(25, ENDS, "0")),
            "seen from a, as eq. (15)": judge(holds=is_identity(25, ENDS, "a")),
        },
        "An identity seen from the base. The left side has the label of eq. (15), which holds seen"
        " from a: one arrow, two observers, and two equal columns only where R_{0,a} leaves B as"
        " it is.",
    )


def _between(g: General) -> Any:
    return g.chain.position(*ENDS, "0")


@computes("E-26")
def bracket_null() -> Outcome:
    g = general()
    back = vanishes(g.R_0a.T @ _between(g) - right_side(26))
    flat, up = np.diag([1, 1, 0]), np.array([0, 0, 1])
    needed = not (flat @ up).any() and bool(up.any())
    return Outcome(
        judge(holds=back and needed),
        "The transpose of R_{0,a} times the vector is B, identically. This is the reason that"
        " the step needs and leaves out: R_{0,a} is invertible. With a projection, which is not,"
        f" diag(1, 1, 0) sends {tuple(int(x) for x in up)} to null.",
    )


@computes("E-28")
def collision_condition_again() -> Outcome:
    g, B = general(), right_side(27)
    there, back = vanishes(_between(g) - g.R_0a @ B), vanishes(g.R_0a.T @ _between(g) - B)
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
    B = right_side(16)
    same_order = vanishes(printed.position("a+n", "b+m", "a") - B)
    both = vanishes(_between(g) - g.R_0a @ B) and vanishes(g.R_0a.T @ _between(g) - B)
    return Outcome(
        judge(holds=both and same_order),
        "Proved in two general rotations and four general vectors, both directions. Whether b is"
        " chained to a or to the point a+n, as the printed order has it, makes no difference.",
    )


# --- the eleven components ------------------------------------------------------------------------


def _derived(name: str) -> Any:
    symbolic, _ = symbolic_robot()
    i, j = paper.indices(name)
    form = components(symbolic, symbolic.boundary(f"B{i}"))
    return sp.sympify(form.symbolic(joint_symbols(robot()))[j - 1])


def _differs(name: str) -> Any:
    """Return the derived component less the printed one."""
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
    printed = sp.expand(paper.expression(paper.EQUATION_29[name]))
    return Outcome(
        judge(holds=_differs(name) == 0),
        f"The component derived from the chain has {len(sp.Add.make_args(printed))} terms; printed"
        f" minus derived is {_differs(name)}, symbol by symbol.",
    )
