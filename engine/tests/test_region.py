"""The region of two joints: random robots against grids and symmetries, and the paper's robot.

By hand, for many more robots than the suite takes: `python engine/tests/test_region.py 10000`.
"""

import re
import sys
import warnings
from dataclasses import replace
from fractions import Fraction
from math import pi, radians

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import load_robot
from cspace.boundary.functions import clearance
from cspace.model.robot import Robot
from cspace.region import (
    NoHomeError,
    Problem,
    Region,
    clearance_problem,
    find_region,
    solve,
    violated,
    window_problem,
)
from cspace.region.region import faults
from engine_support.forms import PP, PR, RR, TURN, forms
from engine_support.regions import (
    SMALL,
    check_arcs,
    check_grid,
    check_roles,
    problem_of,
    relative,
    same_pieces,
    summary,
)
from engine_support.robots import (
    as_long_as_turned,
    drawn_robot,
    in_centimetres,
    mirror,
    random_robot,
    turned,
)
from qbound import window_region
from qbound.forms import HarmonicForm

MINERVA = load_robot("minervabot-v2")

# --- what is checked of each ---------------------------------------------------------------------


def check(robot: Robot) -> None:
    """Everything that must hold of one robot."""
    region = find_region(robot)
    check_arcs(region)
    check_home(robot, region)
    check_grid(region)
    assert all((c.centroid is None) == any(c.wraps) for c in region.components)
    check_roles(region)
    check_symmetries(robot, region)


def check_home(robot: Robot, region: Region) -> None:
    """There is a home component exactly where nothing is violated at home."""
    margin = relative(region.problem, robot.home[None])[0]
    if np.abs(margin).min(initial=1) > 1e-6:
        assert (not region.has_home) == bool(violated(robot, robot.home))


def check_symmetries(robot: Robot, region: Region) -> None:
    turn = 0.7
    swapped = swap_joints(region.problem)
    same_pieces(summary(solve(swapped, robot.home[::-1]), swap=True), summary(region))
    sign = np.array([-1.0 if kind == "revolute" else 1.0 for kind in robot.kinds])
    compare(region, find_region(mirror(robot)), robot, sign, np.zeros(2))
    length = np.array([1.0 if kind == "revolute" else 100.0 for kind in robot.kinds])
    compare(region, find_region(in_centimetres(robot)), robot, length, np.zeros(2))
    for j in (j for j, kind in enumerate(robot.kinds) if kind == "revolute"):
        other, shift = find_region(turned(robot, j, turn)), -turn * np.eye(2)[j]
        compare(find_region(as_long_as_turned(robot, j, turn)), other, robot, np.ones(2), shift)


def compare(region: Region, other: Region, robot: Robot, factor, shift) -> None:
    """The other region is this one with every q replaced by factor q + shift."""
    scale = abs(factor.prod())
    ours = [c for c in region.components if c.area > SMALL]
    theirs = [c for c in other.components if c.area > SMALL * scale]
    rows = [[(c.area, c.wraps, len(c.loops)) for c in found] for found in (theirs, ours)]
    same_pieces(*(sorted(r, reverse=True) for r in rows), scale)
    round_joints = np.array([joint.limits is None for joint in robot.joints])
    for one in ours:
        (*rest,) = (c for c in theirs if abs(c.area - one.area * scale) < 1e-6 * scale)
        if len(rest) == 1 and one.centroid is not None:
            gap = rest[0].centroid - (one.centroid * factor + shift)
            gap = np.where(round_joints, (gap + pi) % TURN - pi, gap)
            assert_allclose(gap / np.abs(factor), 0, atol=1e-6)


def swap_joints(problem: Problem) -> Problem:
    table = np.swapaxes(problem.forms.coefficients, 1, 2)
    turned_round = HarmonicForm(table, problem.forms.kinds[::-1])
    return Problem(turned_round, problem.names, problem.ranges[::-1], problem.limits[::-1])


@pytest.mark.parametrize("seed", range(60))
def test_random_robots(seed):
    check(random_robot(seed))


@pytest.mark.parametrize("seed", range(60))
def test_robots_drawn_in_whole_numbers(seed):
    check(drawn_robot(seed))


# --- the paper's robot ---------------------------------------------------------------------------


def test_the_papers_home_component_has_six_named_vertices():
    home = find_region(MINERVA).home_component
    assert home is not None
    meeting = [{*vertex.boundaries} for vertex in home.vertices]
    assert len(meeting) == 6
    around = [{"B2", "B7"}, {"B7", "B4"}, {"B4", "B1"}, {"B1", "B7"}, {"B7", "B3"}, {"B3", "B2"}]
    start = meeting.index(around[0])
    assert meeting[start:] + meeting[:start] == around
    for vertex in home.vertices:
        for name in vertex.boundaries:
            assert abs(clearance(MINERVA, MINERVA.boundary(name))(vertex.q)) < 1e-10


def test_only_the_first_component_holds_home():
    region = find_region(MINERVA)
    assert [c.contains_home for c in region.components] == [True] + [False] * 4
    (loop,) = region.home_component.loops
    x, y = np.concatenate([arc.points for arc in loop]).T
    angles = np.unwrap(np.arctan2(y - MINERVA.home[1], x - MINERVA.home[0]))
    assert round((angles[-1] - angles[0]) / TURN) == 1  # unrolled around home, anticlockwise


def by_windows(robot):
    return solve(window_problem(window_region(robot)))


def test_the_papers_rule_comes_out_of_the_same_engine():
    (component,) = by_windows(MINERVA).components
    corners = window_region(MINERVA).polygon
    assert len(corners) == 6
    assert_allclose([v.q for v in component.vertices], corners, atol=1e-12, rtol=0)


# --- home at the edges ---------------------------------------------------------------------------


DIAMOND = problem_of(forms(RR, {"10": 1, "01": 1}), (None, None))


def test_home_outside_belongs_to_no_component():
    region = solve(DIAMOND, (pi, pi))
    assert not region.has_home
    assert len(region.components) == 1


def test_home_at_a_touching_point_belongs_to_both_components():
    saddle = problem_of(forms(PP, {"20": 1, "02": -1}), ((-1.0, 1.0), (-1.0, 1.0)))
    region = solve(saddle, (0, 0))
    assert [component.contains_home for component in region.components] == [True, True]
    assert region.home_component is region.components[0]


def with_limits(robot, low, high):
    one, other = robot.joints
    return replace(robot, joints=(one, replace(other, limits=(radians(low), radians(high)))))


@pytest.mark.parametrize(
    ("robot", "find", "says"),
    [
        (with_limits(MINERVA, 30, 120), find_region, "q2.lower is violated by 30°"),
        (with_limits(MINERVA, -150, -60), find_region, "q2.upper is violated by 60°"),
        (with_limits(MINERVA, 30, 120), by_windows, "q2.lower is violated by 30°"),
        (replace(MINERVA, home=np.array([1.5, 0.0])), find_region, "B7 is violated by 26.88 cm"),
        (replace(MINERVA, home=np.array([3.0, 0.0])), by_windows, "B7 is violated by 20.18 cm"),
    ],
    ids=[
        "below a limit",
        "above a limit",
        "below a limit, within windows",
        "under the floor",
        "under the floor, within windows",
    ],
)
def test_a_home_in_no_component_says_which_boundary_it_violates_and_by_how_much(robot, find, says):
    region = find(robot)
    assert not region.has_home
    with pytest.raises(NoHomeError, match=re.escape(f"the home pose is in no component: {says}")):
        _ = region.home_component


def test_a_home_that_touches_without_room_says_what_it_touches():
    """Two floors at one height, one for below and one for above: the tool may move along a line."""
    floor = MINERVA.boundary("B7")
    place = MINERVA.frames(MINERVA.home).position("0", "3", "0")[2]
    walls = [
        replace(floor, name=name, normal=sign * floor.normal, offset=sign * place)
        for name, sign in (("above", 1.0), ("below", -1.0))
    ]
    region = find_region(replace(MINERVA, boundaries=tuple(walls)))
    with pytest.raises(NoHomeError, match=r"it touches above.* and has no room there"):
        _ = region.home_component


@pytest.mark.parametrize("turns", [(1, 0), (0, -1), (2, 3)])
@pytest.mark.parametrize("base", [0, 1])
def test_limits_some_turns_away_shift_the_region(turns, base):
    """Ranges on one side of 0, longer than a half-turn, and whole turns away."""
    limits = np.array([(0.5, 5.0), (-4.0, 1.5)])
    terms = {"00": 0.4, "10": 1, "01": 1, "11": 0.5}
    by = TURN * np.array(turns)
    here, there = (
        solve(problem_of(forms(RR, terms), tuple(map(tuple, ends.tolist()))), home, base)
        for ends, home in ((limits, (1, 1)), (limits + by[:, None], 1 + by))
    )
    assert [c.area for c in here.components] == pytest.approx([c.area for c in there.components])
    assert_allclose(there.home_component.centroid - here.home_component.centroid, by, atol=1e-12)


@pytest.mark.parametrize("angles", [(0.0, 0.0), (0.7, 0.0), (0.7, -1.1)])
def test_a_touching_point_is_no_hole(angles):
    """2 - cos(q1 - a) - cos(q2 - b) vanishes at one point of the torus, which bounds nothing.

    Doubles count as exact numbers: where cos^2 + sin^2 is a rounding above 1 there is a hole.
    """
    a, b = angles
    one = {"00": 2, "01": -np.cos(b), "02": -np.sin(b), "10": -np.cos(a), "20": -np.sin(a)}
    (component,) = solve(problem_of(forms(RR, one), (None, None)), (2.0, 2.0)).components
    first, second = (Fraction(np.cos(x)) ** 2 + Fraction(np.sin(x)) ** 2 for x in angles)
    rest = (4 - first - second) / 2
    hole = first * second > rest * rest  # sqrt(first) + sqrt(second) > 2, without roots
    assert len(component.loops) == hole
    assert component.wraps == (True, True)
    assert_allclose(component.area, TURN**2, rtol=1e-12)


@pytest.mark.parametrize("radius", [1e-4, 1e-5])
def test_a_small_hole_is_one(radius):
    one = {"00": 2 - radius**2 / 2, "01": -1, "10": -1}
    (component,) = solve(problem_of(forms(RR, one), (None, None)), (2.0, 2.0)).components
    (loop,) = component.loops
    assert_allclose(np.ptp([x for arc in loop for x in arc.points], axis=0), 2 * radius, rtol=1e-3)


def main(kind: str, count: int) -> None:
    """Check that many robots of one kind, random or drawn; say the seeds and what failed."""
    make, failed = {"random": random_robot, "drawn": drawn_robot}[kind], []
    for seed in range(count):
        try:
            check(make(seed))
        except Exception as error:
            failed.append(seed)
            sys.stdout.write(f"{seed}: {type(error).__name__} {str(error).strip()[:300]}\n")
    sys.stdout.write(f"{kind}, seeds 0 to {count - 1}: {len(failed)} of {count} wrong {failed}\n")


if __name__ == "__main__":
    warnings.simplefilter("error", RuntimeWarning)
    main(sys.argv[1], int(sys.argv[2]))


# --- forms that share a root for every base value -------------------------------------------------

SHARED = {
    # q (q + 2 cos) and q (q + 1): besides q = 0 they meet where 2 cos = 1
    "slide": problem_of(forms(PR, {"20": 1, "11": 2}, {"20": 1, "10": 1}), ((-2.0, 2.0), None)),
    # cos q1 (1 + cos q2) + sin q1 sin q2 and 1 + cos q2 + sin q2 / 2: besides q2 = pi once a turn
    "turn": problem_of(
        forms(RR, {"10": 1, "11": 1, "22": 1}, {"00": 1, "01": 1, "02": 0.5}), (None, None)
    ),
    # y (y - x) and y (y - 1 + x)
    "plane": problem_of(
        forms(PP, {"02": 1, "11": -1}, {"02": 1, "01": -1, "11": 1}), ((-2.0, 2.0), (-2.0, 2.0))
    ),
}


@pytest.mark.parametrize("name", SHARED)
def test_a_root_shared_everywhere_hides_no_crossing(name):
    """The resultant of two such forms is identically zero; their other roots meet nevertheless."""
    one, other = (solve(SHARED[name], (0.3, 0.1), base) for base in (0, 1))
    found, expected = ([c.area for c in r.components] for r in (one, other))
    assert_allclose(sorted(found), sorted(expected), rtol=1e-9)
    assert sorted(c.wraps for c in one.components) == sorted(c.wraps for c in other.components)
    low, high = np.array([ends or (-pi, pi) for ends in SHARED[name].ranges]).T
    q = np.random.default_rng(5).uniform(low, high, (200_000, 2))
    drawn = one.contains(q).mean() * np.prod(high - low)
    assert_allclose(sum(found), drawn, rtol=0.02)


# --- what a reader sees --------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["minervabot-v2", "pr-gantry-arm"])
def test_what_a_region_is_made_of_prints_on_one_line(name):
    region = find_region(load_robot(name))
    arc = region.components[0].loops[0][0]
    vertex = region.components[0].vertices[0]
    for thing in (region, region.robot, region.problem, region.components[0], vertex, arc):
        assert "\n" not in repr(thing)
        assert len(repr(thing)) <= 120
    assert arc.boundary in repr(arc)
    assert f" {region.area_unit}, " in repr(region.components[0])


# --- what is no question -------------------------------------------------------------------------


def question(**changed):
    """Two forms of two joints that turn, with one thing changed."""
    table = np.zeros((2, 3, 3), dtype=changed.pop("dtype", float))
    table[:, 0, 0], table[0, 1, 0], table[1, 0, 2] = 0.5, 1.0, 1.0
    for place, value in changed.pop("numbers", {}).items():
        table[place] = value
    forms = HarmonicForm(table, changed.pop("kinds", ("revolute", "revolute")))
    rest = {
        "names": ("f0", "f1"),
        "ranges": (None, None),
        "limits": (("a", "b"), ("c", "d")),
    }
    return solve(Problem(forms, **(rest | changed)))


NO_QUESTION = {
    "a coefficient that is NaN": ({"numbers": {(0, 0, 0): np.nan}}, r"\[0, 0, 0\] is nan"),
    "an infinite one": ({"numbers": {(1, 1, 0): np.inf}}, r"\[1, 1, 0\] is inf"),
    "complex coefficients": ({"dtype": complex}, "complex"),
    "a kind that is none": ({"kinds": ("rev", "revolute")}, r"kinds\[0\]: 'rev' is none of"),
    "a name too few": ({"names": ("f0",)}, "names: 1 for 2 forms"),
    "an open slide": ({"kinds": ("revolute", "prismatic")}, r"ranges\[1\]: a joint that slides"),
    "a range that is swapped": ({"ranges": ((1, -1), None)}, r"ranges\[0\]: the low end 1 is"),
    "a range without end": ({"ranges": ((-np.inf, 1), None)}, r"ranges\[0\]: two finite"),
    "three ranges": ({"ranges": (None, None, None)}, "ranges: two are wanted"),
}


@pytest.mark.parametrize("name", NO_QUESTION)
def test_what_is_no_question_about_two_joints_is_refused_with_its_place(name) -> None:
    assert question().components
    changed, words = NO_QUESTION[name]
    with pytest.raises(ValueError, match=words):
        question(**changed)


def test_regions_of_one_problem_are_equal():
    """A robot read twice is one robot; windows, another joint or held value make another region."""
    one, again = (find_region(load_robot("minervabot-v2")) for _ in range(2))
    assert one == again
    assert len({one, again}) == 1
    assert one != by_windows(load_robot("minervabot-v2"))
    assert one != find_region(load_robot("minervabot-v2-corrected"))
    assert one != "a region"


def test_the_check_sees_a_region_of_other_numbers():
    """Its arcs lie off the boundaries of a robot with another clearance."""
    robot = load_robot("two-links-on-a-table")
    other = clearance_problem(replace(robot, clearance=robot.clearance + 0.01))
    assert faults(replace(find_region(robot), problem=other))
