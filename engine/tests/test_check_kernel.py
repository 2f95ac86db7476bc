"""The checker's arithmetic: what its numbers enclose, and its inequality against samples."""

import ast
import json
import random
import sys
from fractions import Fraction
from pathlib import Path

import mpmath
import numpy as np
import pytest
import shapely

from cspace import check
from engine_support import brute_force, planar, second_checker
from engine_support.certificates import Draft
from engine_support.claims import ARM, between, box
from engine_support.samples import Sample, in_floats

ONE = check.ONE

# --- numbers --------------------------------------------------------------------------------------


def as_mpf(x):
    return mpmath.mpf(x.numerator) / x.denominator


@pytest.mark.parametrize(
    "angle", ["0", "1e-60", "0.7", "-1.5707963267948966", "3.2", "-9.9", "31.4", "-64", "63.99"]
)
def test_cosine_and_sine_are_within_their_error(angle):
    units = check.in_units(Fraction(angle))
    with mpmath.workprec(500):
        x = mpmath.mpf(units) / ONE
        for found, true in zip(check.cos_sin(units), (mpmath.cos(x), mpmath.sin(x)), strict=True):
            assert abs(found - ONE * true) < 2**17


def test_pi_is_eighty_digits():
    with mpmath.workprec(400):
        assert abs(as_mpf(check.PI) - mpmath.pi) < mpmath.mpf(10) ** -80


@pytest.mark.parametrize("seed", range(20))
def test_a_unit_vector_is_off_by_less_than_two_units(seed):
    rng = random.Random(seed)
    v = [Fraction(rng.randint(-(10**9), 10**9), 10 ** rng.randint(0, 40)) for _ in range(3)]
    with mpmath.workprec(500):
        length = mpmath.sqrt(sum(as_mpf(x) ** 2 for x in v))
        for found, x in zip(check.unit(v), v, strict=True):
            assert abs(found - ONE * as_mpf(x) / length) < 2


def test_a_length_is_rounded_up():
    assert check.size((3, 4, 0)) >= 5
    assert check.size((0, 0, 0)) >= 0
    assert check.size((ONE, ONE, 0)) ** 2 > 2 * ONE**2


def test_the_checker_is_one_file_of_the_standard_library_without_floats():
    tree = ast.parse(Path(check.__file__).read_text(encoding="utf-8"))
    nodes = [*ast.walk(tree)]
    names = {a.name for node in nodes if isinstance(node, ast.Import) for a in node.names}
    names |= {node.module for node in nodes if isinstance(node, ast.ImportFrom)}
    assert {name.split(".")[0] for name in names} <= set(sys.stdlib_module_names)
    numbers = [node.value for node in nodes if isinstance(node, ast.Constant)]
    assert not [number for number in numbers if isinstance(number, float)]


# --- kinematics and the inequality, against samples -----------------------------------------------


@pytest.mark.parametrize("free_share", [0, 0.3])
def test_a_place_is_as_near_to_its_linear_motion_as_the_bound_says(free_share):
    tightest = 0.0
    for seed in range(80):
        s = Sample(seed, free_share)
        scale = float(s.draft.arm.largest)
        names, corner = brute_force.frames_of(s.table), s.corner()
        near = s.rng.randrange(len(names)) if s.rng.random() < 0.3 else 0
        far = s.rng.randrange(near, len(names))
        placed = s.draft.arm.scaled([Fraction(str(x)) for x in corner])
        found = s.leaf.motion(near, far, placed)
        linear = in_floats(found.place, scale)
        for k, slope in found.slopes.items():
            one = in_floats(slope, scale if s.draft.steps[k].turns else 1)
            linear = linear + np.outer(s.step_of(k), one)
        true = brute_force.place(s.table, {"frame": names[far], "at": corner}, s.q, near, s.middle)
        error = np.linalg.norm(true - linear, axis=1).max()
        bound = (found.bend + found.radius) / ONE * scale
        assert error <= bound + 1e-12 * scale, seed
        tightest = max(tightest, error / bound if bound > 1e-6 else 0)
    assert tightest > 0.9


def with_gap(keep, gap, scale):
    return keep._replace(gap=check.in_units(Fraction(gap / scale)))


@pytest.mark.parametrize("width", [0.01, 0.1, 1])
def test_what_is_kept_on_a_leaf_is_what_is_kept_at_all_its_places(width):
    """Along any direction, and with any distance: never more than samples keep, or much less."""
    lost = []
    for seed in range(80):
        s = Sample(seed, width=width)
        scale = float(s.draft.arm.largest)
        for keep in s.draft.arm.keeps:
            row = [s.rng.randint(-99, 99) for _ in "xyz"]
            u = keep.normal or check.unit(row)
            near, far = (in_floats(hull.corners[0], scale) for hull in (keep.near, keep.far))
            true = (s.seen(keep.far.frame, far, keep.near.frame) - near) @ in_floats(u, 1)
            below = [
                true.min() + 1e-9 * scale,
                *(true.min() - x * scale for x in np.geomspace(1e-9, 99, 40)),
            ]
            kept = [check.is_kept(s.leaf, with_gap(keep, x, scale), u) for x in below]
            assert kept == sorted(kept)
            assert not kept[0], (seed, keep.name)
            lost.append((true.min() - below[kept.index(True)]) / scale)
    assert np.median(lost) < 10 * width**2


@pytest.mark.parametrize("free_share", [0, 0.3])
def test_what_is_violated_on_a_leaf_is_what_is_violated_at_all_its_places(free_share):
    found = 0
    for seed in range(120):
        s = Sample(seed, free_share, width=(0.01, 0.1, 0.5)[seed % 3])
        scale = float(s.draft.arm.largest)
        for keep in s.draft.arm.keeps:
            near, far = (hull.corners[0] for hull in (keep.near, keep.far))
            spots = check.Spots(near, far, 0)
            step = s.seen(keep.far.frame, in_floats(far, scale), keep.near.frame) - in_floats(
                near, scale
            )
            true = (
                np.linalg.norm(step, axis=1)
                if keep.normal is None
                else step @ in_floats(keep.normal, 1)
            )
            for above, wanted in ((-1e-9, [False]), (10, [False, True])):
                other = with_gap(keep, true.max() + above * scale, scale)
                holds = check.is_violated(s.leaf, other, spots)
                assert holds in wanted, (seed, keep.name)
                found += holds
    assert found > 300


# --- what rounding may decide ---------------------------------------------------------------------

SHELF = (
    ARM.replace("origin = [0, 0, 2]", "origin = [0, 0, 8]")
    .replace("offset = -1.5", "offset = 8")
    .replace(", radius = 0.25", "")
    .replace("[3, 0, 0]", "[0, 0, 0]")
)
"""The tip stands on the shelf exactly, and 8 is the largest length, a power of two."""


@pytest.mark.parametrize("part", [32, 1, Fraction(1, 32)])
def test_what_is_less_than_the_slack_decides_nothing(part):
    excess = f"{float(8 * part * check.SLACK / ONE):.12e}"
    above = SHELF.replace("at = [2, 0, 0]", f"at = [0, 0, {excess}]")
    below = SHELF.replace("at = [2, 0, 0]", f"at = [0, 0, -{excess}]")
    place = {"at": ["0", "0"], "place": {"keep": 0, "near": [], "far": ["1"]}}
    proof = {"proof": {"directions": [[0, 0, 1]], "trees": [["."], ["0."]]}}
    for robot, evidence in ((above, proof), (below, {"witness": place})):
        for text in (above, below):
            data = json.dumps(Draft(text, box("0 0", "0 0")).file(**evidence))
            if text is robot and part > 1:
                assert check.check(data).refuted == (robot is below)
            elif text is not robot or part < 1:
                with pytest.raises(check.Refused, match=r"fails on a leaf|is not violated"):
                    check.check(data)


@pytest.mark.parametrize("unit", ["deg", "rad"])
def test_many_turns_of_all_joints_add_less_than_the_slack(unit):
    """A robot of seven parallelograms, whose frames stand where they stood, but for rounding."""
    rows = [
        f'[[joint]]\nname = "q{j}"\ntype = "parallelogram"\nparent = "{j}"\nframe = "{j + 1}"\n'
        f'bar = "b{j}"\norigin = [0.1, 0.3, 1]\ncrank = [0, 0, 0]\naxis = [1, {j}, 2]\n'
        for j in range(7)
    ]
    home = ", ".join(f"q{j} = 0" for j in range(7))
    head = ARM.split("joint = [")[0].replace("q1 = 0, q2 = 0", home).replace("deg", unit)
    point = '[[point]]\nname = "tip"\nframe = "7"\nat = [0.3, -0.1, 0.7]\n'
    arm = check.Arm(check.read_robot(head + "".join(rows) + point, {}), Fraction(0))
    ends = arm.placed([Fraction(29 - 7 * j) for j in range(7)]), (0,) * 7
    turned, still = (check.Leaf(arm.steps, check.Box((q, q))) for q in ends)
    tip = arm.scaled([Fraction(3, 10), Fraction(-1, 10), Fraction(7, 10)])
    off = check.size(check.minus(turned.place(14, tip), still.place(14, tip)))
    assert 0 < off < check.SLACK >> 16


# --- discs, parts and leaves ----------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(30))
def test_a_disc_lies_within_a_part_if_every_edge_is_that_far(seed):
    rng = random.Random(seed)
    hull = shapely.MultiPoint(
        [(rng.randint(-9, 9), rng.randint(-9, 9)) for _ in range(7)]
    ).convex_hull
    if hull.geom_type != "Polygon":
        return
    corners = [(Fraction(x), Fraction(0), Fraction(y)) for x, y in [*hull.exterior.coords][:-1]]
    corners = corners[:: rng.choice((1, -1))]
    shares = [Fraction(1, len(corners))] * len(corners)
    at = check.mean(shares, corners)
    depth = hull.exterior.distance(shapely.Point(float(at[0]), float(at[2])))
    for part, within in ((0.999999, True), (1.000001, False)):
        assert check._holds_disc(corners, 1, at, Fraction(depth * part)) == within
    outside = (at[0] + 30, at[1], at[2])
    assert not check._holds_disc(corners, 1, outside, Fraction(1, 10**9))


def test_leaves_that_nearly_touch_are_one_way_on():
    for gap, touch in ((check.TOUCH, True), (check.TOUCH + 2, False)):
        leaf = check.Node(check.Box(((0, 0), (ONE, ONE))), is_open=True)
        beyond = check.Box(((ONE + gap, ONE + gap), (2 * ONE, 2 * ONE)))  # at a corner
        assert [*leaf.touching(beyond, [(0, 0)])] == [leaf] * touch


EVERYWHERE = planar.planar("", "[-90, 90]", "", posts=planar.wall("wall", 0, 1, 99))
"""Violated at every configuration: so any leaf may be called so, and only touching counts."""


SEAMS, HALF = (True, False, True), (Fraction(180), Fraction(90), Fraction(180))
WHOLE = tuple(-h for h in HALF), HALF


def open_leaves(tree):
    """Return the open leaves of a tree by their corners, exactly."""
    cell = second_checker.Cell(WHOLE, is_box=True)
    return [leaf.corners for leaf, number in second_checker.leaves(cell, tree) if not number]


def are_joined(tree, start, goal):
    """Tell whether open leaves lead from start to goal, by comparing all with all."""
    found = open_leaves(tree)

    def touch(a, b):
        return all(
            any(x + k <= v and u <= y + k for k in ((-360, 0, 360) if seam else (0,)))
            for x, y, u, v, seam in zip(*a, *b, SEAMS, strict=True)
        )

    reached = {k for k, leaf in enumerate(found) if touch((start, start), leaf)}
    goals = {k for k, leaf in enumerate(found) if touch((goal, goal), leaf)}
    while (
        new := {k for k, b in enumerate(found) if any(touch(found[i], b) for i in reached)}
        - reached
    ):
        reached |= new
    return bool(reached & goals), bool(reached and goals)


def random_tree(rng, depth):
    if not depth or rng.random() < 0.1:
        return rng.choice(("0.", "0.", "0.", "0.", "."))
    return rng.choice("abc") + random_tree(rng, depth - 1) + random_tree(rng, depth - 1)


@pytest.mark.parametrize("first", range(0, 300, 50))
def test_open_leaves_touch_at_faces_corners_and_seams(first):
    draft = Draft(EVERYWHERE, {"set": "no path"} | between("0 0 0", "9 9 9", "moves moves moves"))
    place, answers = {"keep": 0, "near": [], "far": ["1"]}, set()
    for seed in range(first, first + 50):
        rng = random.Random(seed)
        tree = random_tree(rng, 6)
        corners = [q for leaf in open_leaves(tree) for q in leaf] + [(Fraction(20),) * 3]
        start, goal = rng.choice(corners), rng.choice(corners)
        data = draft.file(proof={"places": [place], "tree": tree})
        points = [[[*map(check.exactly, q)] for q in (start, goal)]]
        data["claim"] = data["claim"] | {"points": points}
        joined, both_open = are_joined(tree, start, goal)
        for verify in (check.check, second_checker.verify):
            try:
                verify(json.dumps(data))
                answer = "proved"
            except ValueError as refusal:
                answer = str(refusal)
            wanted = "proved" if both_open and not joined else "lead" if joined else "no open leaf"
            assert wanted in answer, seed
        answers.add((joined, both_open))
    assert len(answers) == 3
