"""Sections 2 and 3: labels, Theorem 1 and its proof, and the components of eq. (29)."""

import re
from functools import cache
from itertools import permutations
from typing import Any, Final

import numpy as np
import sympy as sp

from lizarraga2025 import printed as paper
from lizarraga2025.computations.registry import computes, computes_each
from lizarraga2025.evidence import proofs
from lizarraga2025.evidence.arms import pairs, robot, symbolic_robot, tool_form
from lizarraga2025.evidence.proofs import UNTURNED, general, is_identity, right_side, vanishes
from lizarraga2025.verdicts import Outcome, judge, of_readings, reading
from qbound.boundary import components, pair_vector
from qbound.circle import roots_along
from qbound.frames import Frame, Frames
from qbound.symbols import joint_symbols

# --- Section 2: labels ----------------------------------------------------------------------------


@computes("E-1")
def frame() -> Outcome:
    g = general()
    o_ab = g.chain.frame("a", "b")
    columns = vanishes(o_ab[:, :3] - g.R_ab) and vanishes(o_ab[:, 3] - g.r_ab)
    orthonormal = vanishes(g.R_ab.T @ g.R_ab - UNTURNED)
    return Outcome(
        judge(holds=columns and orthonormal and o_ab.shape == (3, 4)),
        "For every rotation and vector the frame of the library has the columns of R and r, and the"
        " transpose of R times R is the identity: no remainder.",
    )


@computes_each({"E-2": 0, "E-4": 1, "E-6": 2})
def seen_from_itself(case: int) -> Outcome:
    """Judge what a frame is from itself: its three columns and origin, its origin, its axes."""
    chain = general().chain
    remainders = (
        [chain.frame(name, name) - np.eye(3, 4, dtype=int) for name in "ab"],
        [chain.position(name, name, observer) for name in "ab" for observer in "0ab"],
        [chain.rotation(name, name) - UNTURNED for name in "0ab"],
    )[case]
    return Outcome(
        judge(holds=all(map(vanishes, remainders))),
        f"No remainder in {len(remainders)} cases, for general rotations and vectors.",
    )


@computes("E-3")
def vector_and_observer() -> Outcome:
    g = general()
    from_0, from_a = (g.chain.position(*ENDS, observer) for observer in "0a")
    turned = vanishes(from_0 - g.R_0a @ from_a)
    same_length = vanishes((g.R_0a @ g.r_ab) @ (g.R_0a @ g.r_ab) - g.r_ab @ g.r_ab)
    return Outcome(
        judge(holds=turned and same_length and not vanishes(from_0 - from_a)),
        "Another observer turns the components, r from 0 is R times r from a, and keeps the length:"
        " no remainder. The two triples differ, so all vectors have to share the observer that is"
        " left out.",
    )


@computes("E-5")
def precedence() -> Outcome:
    names = ["a", "b", "c"]
    links = [Frame(n, p, UNTURNED, np.zeros(3)) for p, n in zip(["0", *names], names, strict=False)]
    chain = Frames("0", links)
    order = {pair for pair in permutations(names, 2) if chain.precedes(*pair)}
    itself = any(chain.precedes(name, name) for name in names)
    return Outcome(
        judge(holds=order == {("a", "b"), ("b", "c"), ("a", "c")} and not itself),
        f"Of the ordered pairs of a chain of three {len(order)} stand in the relation: it passes on"
        " from a to c, has no converse, and no frame precedes itself.",
    )


@computes("E-7")
def directional_cosines() -> Outcome:
    chain = general().chain
    axes_a, axes_b = chain.rotation("0", "a").T, chain.rotation("0", "b").T
    products = axes_a @ axes_b.T  # row: an axis of a; column: an axis of b
    unit = all(vanishes(axes[i] @ axes[i] - 1) for axes in (axes_a, axes_b) for i in range(3))
    return Outcome(
        judge(holds=vanishes(chain.rotation("a", "b") - products) and unit),
        f"All {products.size} entries of R are products of a unit vector of a and one of b, for"
        " every rotation.",
    )


@computes("E-8")
def unit_vector() -> Outcome:
    x, y, z = sp.symbols("x y z", real=True)
    r = np.array([x, y, z])
    u = sp.Matrix(paper.work_out(paper.UNIT_VECTOR, {"r": r, "x": x, "y": y, "z": z}))
    unit = sp.simplify(u.dot(u)) == 1
    parallel = u.cross(sp.Matrix(r)).applyfunc(sp.simplify) == sp.zeros(3, 1)
    left, right = (sp.limit(u[0].subs({y: 0, z: 0}), x, 0, side) for side in "-+")
    return Outcome(
        judge(holds=unit and parallel),
        "Length 1 and the direction of r, identically, where r is not null. At r = 0, where points"
        f" collide, there is none: along x the limits are {left} and {right}.",
    )


@computes("S-11")
def orthonormal_directions() -> Outcome:
    frames = symbolic_robot()[0].frames(joint_symbols(robot()))
    axes = [sp.Matrix(frames.rotation("0", name)) for name in "12"]
    return Outcome(
        judge(holds=all(sp.simplify(R.T * R) == sp.eye(3) for R in axes)),
        "For both moving frames of the chain the nine dot products are those of the identity"
        " matrix, for all joint values.",
    )


@computes("E-3.1", "S-11.1")
def one_observer() -> Outcome:
    literally = {n: is_identity(n, ENDS, seen, seen) for n, seen in ((15, "a"), (19, "0"))}
    turned = is_identity(15, ENDS, "a") and is_identity(25, ENDS, "0")
    return Outcome(
        judge(holds=all(literally.values()), under=literally[19] and turned),
        "Where no matrix stands, as in eq. (19), it holds. With a vector behind a matrix seen from"
        " a as well, eq. (15) fails; seen from its own first index, eqs. (15) and (25) hold.",
    )


@computes("S-11.2")
def convention_is_applied_throughout() -> Outcome:
    later = [number for number in paper.OBSERVERS if number > SECTION_2]
    sides = sorted(set(paper.OBSERVERS.values()))
    labels = [name for text in paper.EQUATION_29.values() for name in re.findall(r"[xz]_\w+", text)]
    two = all(re.fullmatch(r"[xz]_(\d+|min)_\d+", name) for name in labels)
    return Outcome(
        judge(holds=bool(later) and len(sides) == 1, under=two),
        f"{sum('min' not in name for name in labels)} of the {len(labels)} lengths in eq. (29) have"
        " both indices of a vector, and the others are limits. The observer, the third part of a"
        f" label, is marked in eqs. {', '.join(f'({n})' for n in paper.OBSERVERS)}, on the"
        f" {' and on the '.join(sides)} of the symbol, and in {len(later) or 'no'} equation after"
        " Section 2.",
    )


SECTION_2: Final = 8
"""The last equation of Section 2."""


@computes("S-11.3")
def letters_as_subscripts() -> Outcome:
    names = {n for text in paper.THEOREM_1.values() for n in re.findall(r"[rR]_(\w+)", text)}
    letters = sum(any(c.isalpha() for c in name) for name in names)
    return Outcome(
        judge(holds=letters > 0), f"{letters} of {len(names)} labels of Theorem 1 have letters."
    )


@computes("S-11.4")
def components_of_a_vector() -> Outcome:
    lengths = [o for o in paper.OFFSETS if o.table in (3, 4)]
    same = 0
    for one in lengths:
        axis, _, point = re.findall(r"[xz]|\d+", one.label)
        same += bool(robot().point(point).at["xyz".index(axis)] == one.value)
    return Outcome(
        judge(holds=same == len(lengths)),
        f"{same} of the {len(lengths)} lengths of Tables 3 and 4 are the components, of those"
        " names, of the points' vectors.",
    )


# --- Theorem 1 ------------------------------------------------------------------------------------

ENDS: Final = ("a+n", "b+m")
"""The vector on the left of most equations: from one point to the other."""


def _between() -> Any:
    """Return the vector between the points, seen from the base."""
    return general().chain.position(*ENDS, "0")


def _null_together(number: int) -> bool:
    """Tell whether the vector between the points is R_{0,a} times a right side, and back."""
    R, B = general().R_0a, right_side(number)
    return vanishes(_between() - R @ B) and vanishes(R.T @ _between() - B)


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
    return Outcome(judge(holds=at_least and squared.subs(dict.fromkeys(parts, 0)) == 0))


@computes("E-15")
def relative_position() -> Outcome:
    small = proofs.quarter_turn()
    seen = [tuple(int(x) for x in small.position("a", "b", o)) for o in "a0"]
    return of_readings(
        "Seen from a it is an identity at every configuration, not under a collision only. Seen"
        " from the base the same arrow has other components: with frame a turned a quarter about y"
        f" the vector {seen[0]} from a is {seen[1]} from the base.",
        reading(
            "seen from a, each local vector from its own frame", holds=is_identity(15, ENDS, "a")
        ),
        reading("all vectors seen from the base", holds=is_identity(15, ENDS, "0", "0")),
    )


@computes_each({"E-16": 16, "E-27": 27})
def boundary_function(number: int) -> Outcome:
    joints = {len(pair_vector(robot(), pair).joints()) for pair in pairs()}
    return Outcome(judge(holds=is_identity(number, ENDS, "a") and joints == {1}))


@computes("E-17")
def collision_condition() -> Outcome:
    between, B = _between(), right_side(16)
    return Outcome(judge(holds=vanishes(between @ between - B @ B)))


def _one_step(vector: Any, rotation: Any, step: Any) -> Any:
    """Work out the right side of eq. (18)."""
    return paper.work_out(paper.THEOREM_1[18], {"r_1": vector, "R_1": rotation, "r_2": step})


@computes("E-18")
def chain_rule() -> Outcome:
    g, small = general(), proofs.quarter_turn()
    whole = g.chain.position("0", "b", "0")
    own, common = (
        vanishes(whole - _one_step(g.r_0a, g.R_0a, g.chain.position("a", "b", observer)))
        for observer in "a0"
    )
    seen = small.position("a", "b", "0")
    wrong, right = (tuple(map(int, x)) for x in (small.rotation("0", "a") @ seen, seen))
    return of_readings(
        "With r_{b-1,b} seen from b-1 it is an identity. With it seen from a as well it is not:"
        " with b-1 turned a quarter about y and b one unit along x of it the right side is"
        f" {wrong} for {right}.",
        reading("the last vector seen from b-1, as its matrix says", holds=own),
        reading("all vectors seen from one frame", holds=common),
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
    return Outcome(judge(holds=not any(map(sp.expand, vector - whole[:3, 3]))))


def _homogeneous(rotation: Any, origin: Any) -> Any:
    return np.vstack([np.column_stack([rotation, origin]), [0, 0, 0, 1]])


@computes_each({f"E-{number}": number for number in range(19, 25)})
def step_of_the_proof(number: int) -> Outcome:
    left = {20: ("0", "a+n"), 21: ("0", "b+m")}.get(number, ENDS)
    seen = [(observer, observer) for observer in "0ab"] if number == 19 else [("0", "")]
    return Outcome(judge(holds=all(is_identity(number, left, *of) for of in seen)))


@computes("E-24.1")
def rotations_in_a_row() -> Outcome:
    g = general()
    product = paper.work_out(paper.ROTATIONS_IN_A_ROW, {"R_0a": g.R_0a, "R_ab": g.R_ab})
    return Outcome(judge(holds=vanishes(g.chain.rotation("0", "b") - product)))


@computes("E-25")
def rotation_taken_out() -> Outcome:
    return of_readings(
        "An identity seen from the base. The left side has the label of eq. (15), which holds seen"
        " from a: one arrow, two observers.",
        reading("seen from the base, as eqs. (19) to (24)", holds=is_identity(25, ENDS, "0")),
        reading("seen from a, as eq. (15)", holds=is_identity(25, ENDS, "a")),
    )


@computes("E-26")
def bracket_null() -> Outcome:
    back = vanishes(general().R_0a.T @ _between() - right_side(26))
    flat, up = np.diag([1, 1, 0]), np.array([0, 0, 1])  # a projection is not invertible
    return Outcome(
        judge(holds=back and not (flat @ up).any()),
        "The transpose of R_{0,a} times the vector is B, identically. The step needs that R_{0,a}"
        f" is invertible, and does not say so: diag(1, 1, 0) sends {tuple(map(int, up))} to null.",
    )


@computes("E-28")
def collision_condition_again() -> Outcome:
    return Outcome(judge(holds=_null_together(27)))


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
    same_order = vanishes(printed.position(*ENDS, "a") - right_side(16))
    return Outcome(
        judge(holds=_null_together(16) and same_order),
        "Proved in two general rotations and four general vectors, both directions, whether b is"
        " chained to a or to the point a+n, as the printed order has it.",
    )


@computes("S-14")
def without_homogeneous_matrices() -> Outcome:
    turn = sp.Matrix(3, 3, sp.symbols("R:9"))
    step, point = (sp.Matrix(sp.symbols(f"{name}:3")) for name in "rp")
    block = sp.Matrix(sp.BlockMatrix([[turn, step], [sp.zeros(1, 3), sp.ones(1, 1)]]))
    same = sp.expand((block * sp.Matrix([*point, 1]))[:3, :] - (turn * point + step))
    joints = {b.name: len(components(robot(), b).joints()) for b in robot().boundaries}
    of_pairs = max(joints[pair.name] for pair in pairs())
    far = [name for name, number in joints.items() if number > 1]
    fewer = same == sp.zeros(3, 1) and len(turn) < len(block)
    vary = sum(not entry.is_number for entry in block[:3, :3])
    return of_readings(
        f"A pair of points depends on {of_pairs} of {len(robot().joints)} joints, and a point costs"
        f" {len(turn)} products instead of the {len(block)} of the 4 by 4 matrix, which needs"
        f" {vary} too if its constant row is skipped. {', '.join(far)} do not relate consecutive"
        " systems: they use r_{0,3}, from the base, over both joints.",
        reading(
            "against the full matrix from the base",
            holds=fewer and not far,
            under=fewer and of_pairs == 1,
        ),
        reading(
            "against a 4 by 4 matrix whose constant row is not computed", holds=len(turn) < vary
        ),
    )


@computes("S-15")
def two_rotations_about_y() -> Outcome:
    axes = [joint.axis.tolist() for joint in robot().joints]
    return Outcome(judge(holds=axes == [[0, 1, 0]] * 2 and not tool_form().coefficients[1].any()))


@computes("S-18")
def all_components_at_once() -> Outcome:
    alone: list[float] = []
    for pair in pairs():
        vector = pair_vector(robot(), pair)
        (joint,) = vector.joints()
        q = np.tile(np.array(robot().home), (4, 1))
        q[:, joint] = np.ravel([roots_along(vector[j], joint, robot().home) for j in (0, 2)])
        alone += np.linalg.norm(vector(q), axis=-1).tolist()  # NaN where there is no root
    apart = [distance for distance in alone if distance > 0.5]
    return Outcome(
        judge(holds=bool(apart)),
        f"At {len(apart)} of {np.isfinite(alone).sum()} roots of one component the two points are"
        f" more than 0.5 cm apart, up to {max(apart, default=0):.2f} cm.",
    )


# --- the components of eq. (29) -------------------------------------------------------------------


@computes("E-29")
def eleven_components() -> Outcome:
    equal = sum(differences()[name] == 0 for name in paper.EQUATION_29)
    rest = [left for name, left in differences().items() if name not in paper.EQUATION_29]
    return Outcome(
        judge(holds=not any(differences().values())),
        f"{equal} of {len(paper.EQUATION_29)} printed components equal the derived ones by"
        f" identity, symbol by symbol, and {rest.count(0)} of the {len(rest)} that are not printed"
        " are zero.",
    )


@cache
def differences() -> dict[str, Any]:
    """Return what each component derived from the chain has beyond the printed one.

    A component that is not printed is meant to be zero.
    """
    arm, _ = symbolic_robot()
    found = {}
    for boundary in arm.boundaries:
        derived = components(arm, boundary).symbolic(joint_symbols(robot()))
        for j, form in enumerate(derived, start=1):
            name = f"beta_{{{boundary.name[1:]},{j}}}"
            found[name] = sp.expand(form - paper.expression(paper.EQUATION_29.get(name, "0")))
    return found


@computes_each(
    {"E-29.{}.{}".format(*paper.indices(name)): name for name in paper.EQUATION_29}
    | {"T-3.4": "beta_{1,", "T-3.5": "beta_{2,", "T-3.6": "beta_{3,", "T-4.3": "beta_{4,"}
    | {"S-51": "beta"}
)
def components_are_derived(start: str) -> Outcome:
    """Judge the components whose label starts so: one, those of a pair, or all."""
    left = [one for name, one in differences().items() if name.startswith(start)]
    return Outcome(judge(holds=not any(left)))
