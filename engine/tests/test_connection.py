"""Connected or not: against the float engine's components, round the torus, through narrow gaps."""

from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.ndimage import label

from cspace import find_region, load_robot
from cspace.proofs.exact.problem import exact_problem, exact_robot
from cspace.proofs.subpaving.connection import connection, outer_groups, separated, separating_cells
from cspace.proofs.subpaving.paving import pave
from engine_support.exact import stated
from engine_support.forms import RR
from engine_support.robots import random_robot

PAPER = exact_problem(exact_robot("minervabot-v2"))
REGION = find_region(load_robot("minervabot-v2"))
CENTRES = [c.centroid for c in REGION.components]


def test_all_five_components_of_the_paper_robot_are_separated():
    paving = connection(PAPER, CENTRES[0], CENTRES[1]).paving
    groups = outer_groups(paving)
    held = [groups.containing(paving, q) for q in CENTRES]
    assert all(held)
    assert not any(one & other for one, other in combinations(held, 2))
    assert separated(paving, CENTRES[0], CENTRES[4])


def test_every_path_is_feasible_at_a_thousand_points_of_each_leg():
    found = connection(PAPER, [0, 0], [-2.2, -0.6])
    assert found.answer == "connected"
    assert np.allclose(found.path[0], [0, 0])
    assert np.allclose(found.path[-1], [-2.2, -0.6])
    s = np.linspace(0, 1, 1000)[:, None]
    for a, b in zip(found.path, found.path[1:], strict=False):
        assert (REGION.problem.forms(a + s * (b - a)) > 0).all()


@settings(max_examples=15)
@given(st.integers(0, 10**6))
def test_answers_never_contradict_the_float_engine(seed):
    robot = random_robot(seed)
    region, problem = find_region(robot), exact_problem(exact_robot(robot))
    rng = np.random.default_rng(seed)
    centres = [c.centroid for c in region.components if c.centroid is not None][:3]
    places = [*centres, rng.uniform(-1, 1, 2)]
    for one, other in combinations(places, 2):
        if not all(inside(problem, q) for q in (one, other)):
            continue
        answer = connection(problem, one, other, most=4000).answer
        same = region.component_of(one), region.component_of(other)
        if answer == "infeasible":
            assert None in same
        elif answer != "undecided" and None not in same:
            assert (answer == "connected") == (same[0] == same[1])


def inside(problem, q) -> bool:
    return all(
        r is None or r[0] < x < r[1] for x, r in zip(map(float, q), problem.ranges, strict=True)
    )


STRIP = {"00": 0.5, "10": -1}  # cos q1 < 1/2: forbids |q1| < 60 deg


def test_the_only_way_leads_round_the_joint():
    free = stated(RR, [STRIP])
    assert connection(free, [-1.5, 0], [1.5, 0]).answer == "connected"
    held = stated(RR, [STRIP], ((-3.1, 3.1), None))
    assert connection(held, [-1.5, 0], [1.5, 0]).answer == "separated"


def test_a_path_round_the_joint_is_unrolled():
    path = connection(stated(RR, [STRIP]), [-1.5, 0], [1.5, 0]).path
    assert np.abs(np.diff(path, axis=0)).max() < np.pi
    assert abs(abs(path[-1, 0] - path[0, 0]) - (2 * np.pi - 3)) < 1e-12


def test_regions_that_touch_in_a_point_are_undecided():
    saddle = stated(RR, [{"11": 1}])  # cos q1 cos q2 > 0
    assert connection(saddle, [0, 0], [3, 3], most=3000).answer == "undecided"


@pytest.mark.parametrize(("gap", "answer"), [(1e-3, "connected"), (-1e-3, "separated")])
def test_a_door_is_found_while_it_is_open_and_a_wall_when_it_is_shut(gap, answer):
    """cos q2 - cos q1 + gap > 0: at q1 = 0 only |q2| < sqrt(2 gap) is left."""
    door = stated(RR, [{"00": gap, "10": -1, "01": 1}], ((-3.1, 3.1), None))
    assert connection(door, [-1.5, 0], [1.5, 0]).answer == answer


def test_poses_outside_the_limits_are_refused():
    held = stated(RR, [STRIP], ((-3.1, 3.1), None))
    with pytest.raises(ValueError, match="limits"):
        connection(held, [-3.2, 0], [1.5, 0])


@pytest.mark.parametrize("pose", [[0.0, np.nan], [np.inf, 0.0], [0.0], [0.0, 0.0, 0.0]])
def test_what_is_no_configuration_is_refused(pose):
    with pytest.raises(ValueError, match="no configuration of 2 joints"):
        connection(PAPER, [0.0, 0.0], pose)


def test_an_angle_of_astronomical_size_is_never_decided_wrongly():
    assert connection(PAPER, [0.0, 0.0], [1e300, 0.0], most=500).answer == "undecided"
    turns = 2 * np.pi * 1000  # as a double: 1000 turns and a hair
    assert connection(PAPER, [0.0, 0.0], [turns, 0.0]).answer == "connected"


def test_the_wall_alone_separates_by_an_independent_flood_fill():
    found = connection(PAPER, CENTRES[0], CENTRES[1])
    n = 1024
    blocked = np.zeros((n, n), dtype=bool)
    for cells in separating_cells(found.paving, CENTRES[0]):
        low, high = (
            np.rint((p + np.pi) / (2 * np.pi) * n).astype(int)
            for p in found.paving.bounds.places(cells)
        )
        for (a, b), (c, d) in zip(low, high, strict=True):
            blocked[a:c, b:d] = True
    tiled, _ = label(~np.tile(blocked, (2, 2)))  # twice in each direction: the torus unrolled
    places = ((np.array(CENTRES[:2]) + np.pi) / (2 * np.pi) * n).astype(int)
    assert not blocked[tuple(places[0])]
    homes = {tiled[x + i, y + j] for x, y in places[:1] for i in (0, n) for j in (0, n)}
    others = {tiled[x + i, y + j] for x, y in places[1:] for i in (0, n) for j in (0, n)}
    assert not homes & others


def test_groups_close_round_the_torus():
    paving = pave(stated(RR, [STRIP]), 0.02)
    (labels,) = {frozenset(np.concatenate(outer_groups(paving).label).tolist())}
    assert len(labels) == 1
