"""Equations (9) to (29): constraints, Theorem 1 and its proof, the eleven components."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from lizarraga2025 import printed as paper
from lizarraga2025.ledger.entries import Finding, entry, judge, require, undetermined
from lizarraga2025.ledger.facts import degrees, lettered, mended, pairs, robot, square, walls
from lizarraga2025.ledger.labels import quarter_turn
from lizarraga2025.ledger.proofs import General, general, vanishes
from lizarraga2025.ledger.rounding import contact, radii
from qbound import clearance, components, pair_vector
from qbound.boundary.functions import closest_approach, observer
from qbound.model.frames import Frame, Frames
from qbound.model.robot import joint_symbols
from qbound.region import find_region, paper_rule

PAGE = "03_theorem_1#equation-eq-"


# --- constraints: eqs. (9) to (12) ----------------------------------------------------------------


@entry(
    "E-9",
    "equation",
    "eq. (9), Section 3",
    "Each component of a boundary function is positive inside the feasible region, zero on its"
    " boundary and negative outside.",
    test="test_boundary.py::test_clearance_of_a_pair_is_positive_exactly_where_it_keeps_apart",
    chapter="03_theorem_1#the-sign-of-a-component-is-no-verdict",
    mended="β = |B|² - d_min² for a point pair and β = n · r - h for a wall: one function for each"
    " boundary, positive exactly inside.",
)
def sign_of_a_component() -> Finding:
    import sympy as sp

    q = np.array([-np.pi / 2, 0.0])  # cos and sin are 0 and -1: the values are exact
    cm = {name: sp.Rational(str(x)) for name, x in paper.offsets_in_cm().items()}
    exact = -cm["x_{0,6}"] - cm["z_{1,7}"]
    path = np.linspace(robot().home, q, 1001)
    free = all((clearance(robot(), b)(path) > 0).all() for b in robot().boundaries if b.used)
    inside = bool(paper_rule.feasible(robot(), q)) and free
    x = pair_vector(robot(), pairs()[0])(q)[0]
    allowed = square()[paper_rule.feasible(robot(), square())]
    vectors = np.stack([pair_vector(robot(), pair)(allowed) for pair in pairs()], axis=1)
    negative = (vectors < 0).mean(axis=0)
    share = 100 * (vectors < 0).any(axis=(1, 2)).mean()
    kinds = [
        f"β_{{{i + 1},{j + 1}}} ({100 * x:.0f} %)" for (i, j), x in np.ndenumerate(negative) if x
    ]
    B, d = sp.symbols("B d", nonnegative=True)
    require(sp.expand((B - d) * (B + d) - B**2 + d**2) == 0, "|B|² - d² = (|B| - d)(|B| + d)")
    return Finding(
        judge(holds=not (inside and x < 0 and share > 0)),
        f"At q = (-90°, 0°), which lies in the selected region and is reached freely from home,"
        f" β_{{1,1}} = -(x_{{0,6}} + z_{{1,7}}) = {float(exact):.2f} cm exactly. In {share:.1f} %"
        f" of the region some component is negative: {', '.join(kinds)}. The y components are zero"
        " everywhere.",
    )


@entry(
    "E-9.1",
    "equation",
    "eq. (9) for geometric boundary functions",
    "The one component of a wall that counts is positive inside the feasible region.",
    test="test_boundary.py::test_clearance_of_a_half_space_is_the_depth_inside_it",
    chapter="03_theorem_1#the-sign-of-a-component-is-no-verdict",
    mended="β_{7,3} ≥ 0 in the region; β_{5,1} and β_{6,1} do not bound it.",
)
def sign_of_a_wall() -> Finding:
    allowed = square()[paper_rule.feasible(robot(), square())]
    below = {w.name: 100 * (clearance(robot(), w)(allowed) < 0).mean() for w in walls()}
    used = [w.name for w in walls() if w.used]
    shares = ", ".join(f"{name} in {share:.1f} %" for name, share in below.items())
    return Finding(
        judge(holds=not any(below.values()), under=not any(below[name] for name in used)),
        f"Negative within the selected region: {shares}. So it holds for the wall that bounds it.",
    )


@entry(
    "E-10",
    "equation",
    "eq. (10), Section 3",
    "Each joint has a lower and an upper limit; no value is printed for this robot.",
    test="test_sampling.py::test_ranges_are_the_limits_or_a_full_turn",
    chapter="03_theorem_1#what-a-boundary-function-is",
)
def joint_limits() -> Finding:
    from dataclasses import replace

    printed = [o.label for o in paper.OFFSETS if o.label.startswith("q")]
    box = np.degrees([paper_rule.box(robot()).lower, paper_rule.box(robot()).upper])
    area = {}
    for name, limits in (("none", None), ("±180°", (-np.pi, np.pi)), ("±170°", (-2.967, 2.967))):
        joints = tuple(replace(joint, limits=limits) for joint in robot().joints)
        home = find_region(replace(robot(), joints=joints)).home
        area[name] = 0.0 if home is None else home.area
    same = {name: bool(np.isclose(a, area["none"])) for name, a in area.items()}
    verdict = undetermined({name: not printed and fits for name, fits in same.items()})
    return Finding(
        verdict,
        f"{len(printed)} limits are printed. The windows of Table 6 end at {box[0, 0]:.2f}° and"
        f" {box[1, 0]:.2f}° for the first joint and at {box[0, 1]:.2f}° and {box[1, 1]:.2f}° for"
        " the second, so"
        " wide limits change nothing: area around home "
        + ", ".join(f"{a:.6f} rad² with limits {name}" for name, a in area.items())
        + ".",
    )


@entry(
    "E-11",
    "equation",
    "eq. (11), Section 3",
    "Points of different bodies keep a distance of at least d_min; no value is printed.",
    test="test_robotfile.py::test_the_clearance_of_the_packaged_robot_makes_a_wall_of_every_pair",
    chapter="03_theorem_1#what-the-distance-condition-repairs",
)
def least_distance() -> Finding:
    from dataclasses import replace

    gaps = [closest_approach(robot(), pair)[1] for pair in pairs()]
    seen, fits = [], {}
    for d in (0.01, 0.1, 0.5):
        boundaries = tuple(
            replace(b, clearance=d) if b in pairs() else b for b in robot().boundaries
        )
        home = find_region(replace(robot(), boundaries=boundaries)).home
        walled = sum(gap < d for gap in gaps)
        area = 0.0 if home is None else home.area
        corners = 0 if home is None else len(home.vertices)
        fits[str(d)] = walled == len(gaps) and corners == 6
        seen.append(f"d_min = {d} cm: {walled} walls, {corners} corners, {area:.6f} rad²")
    return Finding(
        undetermined(fits),
        f"The pairs come as close as {min(gaps):.4f} to {max(gaps):.4f} cm, so d_min = 0 makes no"
        f" wall at all; every pair is a wall above {max(gaps):.4f} cm. {'; '.join(seen)}.",
    )


@entry(
    "E-12",
    "equation",
    "eq. (12), Section 3",
    "The position stays between limits along x, y and z.",
    test="test_boundary.py::test_clearance_of_a_half_space_is_the_depth_inside_it",
    chapter="07_joint_region#all-bounds-in-one-picture",
    mended="z ≥ z_{min,1} alone bounds the selected region.",
)
def limits_in_space() -> Finding:
    corners = [vertex.q for vertex in paper_rule.vertices(robot())]
    least = {w.name: float(np.min(clearance(robot(), w)(corners))) for w in walls()}
    inside = {name: x > -1e-9 for name, x in least.items()}
    depths = ", ".join(f"{name} {round(x, 9) + 0:.2f} cm" for name, x in least.items())
    upper = [o.label for o in paper.OFFSETS if "max" in o.label]
    return Finding(
        judge(holds=all(inside.values()), under=inside["B7"]),
        f"{len(upper)} upper limits and two lower ones for x are printed. Least margins at the six"
        f" points of the region: {depths}. Only the floor is kept.",
    )


# --- Theorem 1 ------------------------------------------------------------------------------------


@entry(
    "E-13",
    "equation",
    "eq. (13), Theorem 1",
    "Two points collide when the vector between them is null.",
    test="test_boundary.py::test_converse_of_theorem_1",
    chapter=PAGE + "13",
)
def null_between() -> Finding:
    chain = general().chain
    ends = [chain.position("0", name, "0") for name in ("a+n", "b+m")]
    holds = vanishes(chain.position("a+n", "b+m", "0") - (ends[1] - ends[0]))
    return Finding(
        judge(holds=holds),
        "The vector is the difference of the two places, identically, so it is null exactly where"
        " they are one. A collision here means that points coincide, not that bodies touch.",
    )


@entry(
    "E-14",
    "equation",
    "eq. (14), Theorem 1",
    "The vector is null exactly when its length is zero.",
    test="test_boundary.py::test_converse_of_theorem_1",
    chapter=PAGE + "14",
)
def null_length() -> Finding:
    import sympy as sp

    x, y, z = parts = sp.symbols("x y z", real=True)
    squared = x**2 + y**2 + z**2
    holds = all((squared - part**2).is_nonnegative for part in parts)
    return Finding(
        judge(holds=holds and squared.subs({x: 0, y: 0, z: 0}) == 0),
        "Of real components each square is at most the sum of all, so a zero sum leaves three"
        " zeros; the converse is immediate.",
    )


@entry(
    "E-15",
    "equation",
    "eq. (15), Theorem 1",
    "Under a collision the vector between the points is r_{a,b} + R_{a,b} r_{b,b+m} - r_{a,a+n}.",
    test="test_boundary.py::test_the_label_of_eqs_15_and_25_is_two_vectors_of_one_length",
    chapter="03_theorem_1#one-label-two-observers",
    mended="The same, seen from frame a, at every configuration; seen from the base it is turned"
    " by R_{0,a}.",
)
def relative_position() -> Finding:
    g, small = general(), quarter_turn()
    from_a, from_0 = (g.chain.position("a+n", "b+m", o) for o in ("a", "0"))
    seen = [tuple(int(x) for x in small.position("a", "b", o)) for o in ("a", "0")]
    return Finding(
        judge(holds=vanishes(from_0 - g.B), under=vanishes(from_a - g.B) and seen[0] != seen[1]),
        "Seen from a it is an identity at every configuration, not under a collision only. Seen"
        f" from the base it is false: with frame a turned a quarter about y the vector {seen[0]}"
        f" from a is {seen[1]} from the base.",
    )


@entry(
    "E-16",
    "equation",
    "eq. (16), Theorem 1",
    "This vector, as a function of the joints, is the boundary function B(q).",
    test="test_boundary.py::test_theorem_1_holds_for_any_chain_and_either_order",
    chapter=PAGE + "16",
)
def boundary_function() -> Finding:
    import sympy as sp

    symbolic, _ = lettered()
    q = np.array(joint_symbols(robot()))
    frames = symbolic.frames(q)
    left, joints = [], []
    for pair in pairs():
        derived = sp.Matrix(pair_vector(symbolic, pair).symbolic(tuple(q)))
        seen = sp.Matrix(frames.position(*pair.points, observer(symbolic, pair)))
        left.append(sp.simplify(derived - seen) == sp.zeros(3, 1))
        joints.append(len(derived.free_symbols & set(q)))
    return Finding(
        judge(holds=all(left) and set(joints) == {1}),
        f"For all {len(left)} pairs of the robot the form derived from the file is the vector of"
        " forward kinematics seen from frame a, identically; each depends on one joint.",
    )


@entry(
    "E-17",
    "equation",
    "eq. (17), Theorem 1",
    "A collision occurs if and only if B(q) = 0.",
    test="test_boundary.py::test_converse_of_theorem_1",
    chapter="03_theorem_1#do-the-points-ever-meet",
)
def collision_condition() -> Finding:
    g = general()
    between = g.chain.position("a+n", "b+m", "0")
    gaps = [closest_approach(robot(), pair)[1] for pair in pairs()]
    return Finding(
        judge(holds=vanishes(between @ between - g.B @ g.B)),
        "The vector between the points and B have the same length, identically, so both are null"
        " together. With the printed offsets no pair of the robot ever meets: the gaps that stay"
        f" run from {min(gaps):.4f} to {max(gaps):.4f} cm (E-17.1 to E-17.4).",
    )


def _pair_meets(number: int) -> Callable[[], Finding]:
    def meets() -> Finding:
        pair = pairs()[number - 1]
        q, gap = closest_approach(robot(), pair)
        a, b = radii(robot(), pair)
        limit = contact(pair)
        with_9_09 = closest_approach(mended(), pairs(mended())[number - 1])[1]
        verdict = judge(holds=gap == 0, under=gap <= limit, mended=with_9_09 <= limit)
        slip = f" With x_{{2,13}} = 9.09 the gap is {with_9_09:.4f} cm." if with_9_09 != gap else ""
        return Finding(
            verdict,
            f"They are {a:.4f} and {b:.4f} cm from the joint between them and come as close as"
            f" {gap:.4f} cm, at {degrees(q)}. Offsets rounded to hundredths allow {limit:.4f}"
            f" cm.{slip}",
        )

    return meets


for _number, _pair in enumerate(pairs(), start=1):
    entry(
        f"E-17.{_number}",
        "equation",
        f"eq. (17) for B_{_number}, Tables 3 and 4",
        f"Points {_pair.points[0]} and {_pair.points[1]} meet at some joint value.",
        test="test_boundary.py::test_printed_points_never_quite_meet",
        chapter="05_boundary_functions#where-the-points-come-closest",
        mended="x_{2,13} = 9.09 cm."
        if _number == 4
        else "They meet up to the rounding of the print.",
    )(_pair_meets(_number))


# --- the proof of Theorem 1 -----------------------------------------------------------------------


@entry(
    "E-18",
    "equation",
    "eq. (18), proof of Theorem 1",
    "A position along a chain is the one before plus the rotated next step.",
    test="test_frames.py::test_frame_is_the_relative_homogeneous_matrix",
    chapter="03_theorem_1#positions-along-the-chain",
    mended="The last vector is seen from b-1 (rule 1); rule 5, one observer, does not apply.",
)
def chain_rule() -> Finding:
    g = general()
    whole, first = (g.chain.position("0", name, "0") for name in ("b", "a"))
    own, common = (whole - first - g.R_0a @ g.chain.position("a", "b", o) for o in ("a", "0"))
    small = quarter_turn()
    R = small.rotation("0", "a")
    wrong = tuple(int(x) for x in R @ small.position("a", "b", "0"))
    right = tuple(int(x) for x in small.position("a", "b", "0"))
    return Finding(
        judge(holds=vanishes(own) and vanishes(common), under=vanishes(own)),
        "With each vector seen from its first index it is an identity. With one common observer,"
        f" as rule 5 has it, it is false: with a turned a quarter about y and b one unit along x"
        f" of a it gives {wrong} for {right}.",
    )


Step = Callable[[General], Any]

STEPS: tuple[tuple[int, str, str, Step], ...] = (
    (
        19,
        "The vector between the points is the difference of their places.",
        "for the observers 0, a and b",
        lambda g: [
            g.chain.position("a+n", "b+m", o)
            - (g.chain.position("0", "b+m", o) - g.chain.position("0", "a+n", o))
            for o in ("0", "a", "b")
        ],
    ),
    (
        20,
        "The place of a+n is that of a plus the rotated local vector.",
        "seen from the base, the local vector from a",
        lambda g: g.chain.position("0", "a+n", "0") - (g.r_0a + g.R_0a @ g.r_an),
    ),
    (
        21,
        "The place of b+m is that of b plus the rotated local vector.",
        "seen from the base, the local vector from b",
        lambda g: g.chain.position("0", "b+m", "0") - (_r_0b(g) + _R_0b(g) @ g.r_bm),
    ),
    (
        22,
        "Both places inserted into the difference.",
        "seen from the base",
        lambda g: _between(g) - ((_r_0b(g) + _R_0b(g) @ g.r_bm) - (g.r_0a + g.R_0a @ g.r_an)),
    ),
    (
        23,
        "The same, sorted.",
        "seen from the base",
        lambda g: _between(g) - ((_r_0b(g) - g.r_0a) + _R_0b(g) @ g.r_bm - g.R_0a @ g.r_an),
    ),
    (
        24,
        "R_{0,b} is replaced by R_{0,a} R_{a,b}.",
        "seen from the base; it also takes r_{0,b} - r_{0,a} = R_{0,a} r_{a,b}",
        lambda g: [
            _between(g) - (g.R_0a @ g.r_ab + g.R_0a @ g.R_ab @ g.r_bm - g.R_0a @ g.r_an),
            _r_0b(g) - g.r_0a - g.R_0a @ g.r_ab,
        ],
    ),
)


def _between(g: General) -> Any:
    return g.chain.position("a+n", "b+m", "0")


def _r_0b(g: General) -> Any:
    return g.chain.position("0", "b", "0")


def _R_0b(g: General) -> Any:
    return g.chain.rotation("0", "b")


def _step_of_the_proof(seen: str, difference: Step) -> Callable[[], Finding]:
    def step() -> Finding:
        left = np.ravel(np.asarray(difference(general())))
        return Finding(
            judge(holds=vanishes(left)),
            f"An identity {seen}: none of {left.size} components leaves a remainder in general"
            " rotations and vectors.",
        )

    return step


for _number, _says, _seen, _difference in STEPS:
    entry(
        f"E-{_number}",
        "equation",
        f"eq. ({_number}), proof of Theorem 1",
        _says,
        test="test_boundary.py::test_the_label_of_eqs_15_and_25_is_two_vectors_of_one_length",
        chapter=f"{PAGE}{_number}",
    )(_step_of_the_proof(_seen, _difference))


@entry(
    "E-25",
    "equation",
    "eq. (25), proof of Theorem 1",
    "Taken out, the factor R_{0,a} leaves the vector of eq. (15) in parentheses.",
    test="test_boundary.py::test_the_label_of_eqs_15_and_25_is_two_vectors_of_one_length",
    chapter=PAGE + "25",
    mended="The left side is seen from the base, that of eq. (15) from a.",
)
def rotation_taken_out() -> Finding:
    g = general()
    from_0, from_a = (g.chain.position("a+n", "b+m", o) for o in ("0", "a"))
    under = vanishes(from_0 - g.R_0a @ g.B)
    return Finding(
        judge(holds=under and vanishes(from_a - g.R_0a @ g.B), under=under),
        "An identity seen from the base. The left side has the label of eq. (15), which holds seen"
        " from a: one arrow, two observers, and two equal columns only where R_{0,a} leaves B as it"
        " is.",
    )


@entry(
    "E-26",
    "equation",
    "eq. (26), proof of Theorem 1",
    "If the vector is null, the term in parentheses is null.",
    test="test_boundary.py::test_converse_of_theorem_1",
    chapter="03_theorem_1#from-the-vector-to-its-null",
)
def bracket_null() -> Finding:
    g = general()
    back = vanishes(g.R_0a.T @ _between(g) - g.B)
    flat, up = np.diag([1, 1, 0]), np.array([0, 0, 1])
    needed = not (flat @ up).any() and bool(up.any())
    return Finding(
        judge(holds=back and needed),
        "The transpose of R_{0,a} times the vector is B, identically. This is the reason that the"
        " step needs and leaves out: R_{0,a} is invertible. With a projection, which is not,"
        f" diag(1, 1, 0) sends {tuple(int(x) for x in up)} to null.",
    )


@entry(
    "E-27",
    "equation",
    "eq. (27), proof of Theorem 1",
    "The term in parentheses defines B_i(q).",
    test="test_boundary.py::test_theorem_1_holds_for_any_chain_and_either_order",
    chapter=PAGE + "27",
)
def boundary_function_again() -> Finding:
    g = general()
    return Finding(
        judge(holds=vanishes(g.chain.position("a+n", "b+m", "a") - g.B)),
        "The same right side as eq. (16): the vector between the points seen from a, for every"
        " rotation and vector.",
    )


@entry(
    "E-28",
    "equation",
    "eq. (28), proof of Theorem 1",
    "A collision occurs if and only if B_i(q) = 0.",
    test="test_boundary.py::test_converse_of_theorem_1",
    chapter=PAGE + "28",
)
def collision_condition_again() -> Finding:
    g = general()
    there, back = vanishes(_between(g) - g.R_0a @ g.B), vanishes(g.R_0a.T @ _between(g) - g.B)
    return Finding(
        judge(holds=there and back),
        "Both directions: the vector is R_{0,a} B, and B is the transpose of R_{0,a} times the"
        " vector, identically. The first gives 'if', the second 'only if'.",
    )


@entry(
    "TH-1",
    "sentence",
    "Theorem 1",
    "In a chain 0, a, a+n, b, b+m two points collide exactly where B(q) = 0.",
    test="test_boundary.py::test_theorem_1_holds_for_any_chain_and_either_order",
    chapter="03_theorem_1#thm:1",
)
def theorem_1() -> Finding:
    g = general()
    printed = Frames(  # the labels in the printed order: b grows from the point a+n
        "0",
        [
            Frame("a", "0", g.R_0a, g.r_0a),
            Frame("a+n", "a", np.eye(3, dtype=int), g.r_an),
            Frame("b", "a+n", g.R_ab, g.r_ab - g.r_an),
            Frame("b+m", "b", np.eye(3, dtype=int), g.r_bm),
        ],
    )
    same_order = vanishes(printed.position("a+n", "b+m", "a") - g.B)
    both = vanishes(_between(g) - g.R_0a @ g.B) and vanishes(g.R_0a.T @ _between(g) - g.B)
    return Finding(
        judge(holds=both and same_order),
        "Proved in two general rotations and four general vectors, both directions. Whether b is"
        " chained to a or to the point a+n, as the printed order has it, makes no difference.",
    )


# --- the eleven components ------------------------------------------------------------------------


def _derived(name: str) -> Any:
    import sympy as sp

    symbolic, _ = lettered()
    i, j = int(name[6]), int(name[8])
    form = components(symbolic, symbolic.boundary(f"B{i}"))
    return sp.sympify(form.symbolic(joint_symbols(robot()))[j - 1])


def _component(name: str) -> Callable[[], Finding]:
    def component() -> Finding:
        import sympy as sp

        printed = paper.expression(paper.EQUATION_29[name])
        difference = sp.expand(_derived(name) - printed)
        return Finding(
            judge(holds=difference == 0),
            f"The component derived from the chain has {len(sp.Add.make_args(sp.expand(printed)))}"
            f" terms; printed minus derived is {difference}, symbol by symbol.",
        )

    return component


@entry(
    "E-29",
    "equation",
    "eq. (29), Section 4",
    "Eleven components of the seven boundary functions.",
    test="test_boundary.py::test_derived_component_is_the_printed_formula_by_identity",
    chapter="05_boundary_functions#the-eleven-components",
)
def eleven_components() -> Finding:
    import sympy as sp

    names = {f"beta_{{{b.name[1:]},{j}}}" for b in robot().boundaries for j in (1, 2, 3)}
    equal = [
        sp.expand(_derived(n) - paper.expression(text)) == 0
        for n, text in paper.EQUATION_29.items()
    ]
    rest = [_derived(name) == 0 for name in names - set(paper.EQUATION_29)]
    return Finding(
        judge(holds=all(equal) and all(rest)),
        f"{sum(equal)} of {len(equal)} printed components equal the derived ones by identity, and"
        f" the {len(rest)} that are not printed are zero.",
    )


for _name in paper.EQUATION_29:
    _i, _j = _name[6], _name[8]
    entry(
        f"E-29.{_i}.{_j}",
        "equation",
        f"eq. (29), β_{{{_i},{_j}}}",
        f"Component {'xyz'[int(_j) - 1]} of B_{_i} in the offsets and joint values.",
        test="test_boundary.py::test_derived_component_is_the_printed_formula_by_identity",
        chapter="05_boundary_functions#equation-eq-29",
    )(_component(_name))
