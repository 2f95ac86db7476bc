"""One meaning of equality: feasible is margin >= 0 up to rounding, a component is its closure."""

import json
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from cspace import find_region, load_robot, save_robot
from cspace.model.robot import HalfSpace, Pair, Point
from cspace.region import margins, solve, violated
from cspace.sampling import keeps_clear
from engine_support.arms import three_joints
from engine_support.commands import run
from engine_support.forms import PP, RR, SQUARE, forms
from engine_support.regions import problem_of
from engine_support.robots import random_robot

MINERVA = load_robot("minervabot-v2")


def with_limits(robot, *limits):
    joints = [replace(j, limits=ends) for j, ends in zip(robot.joints, limits, strict=True)]
    return replace(robot, joints=tuple(joints))


# --- on a limit -----------------------------------------------------------------------------------


@pytest.mark.parametrize("limits", [((0.0, 1.0), (-1.0, 1.0)), ((-1.0, 0.0), (0.0, 1.0))])
def test_home_on_a_joint_limit_is_in_its_component(limits):
    """The usual case on real robots."""
    robot = with_limits(MINERVA, *limits)
    region = find_region(robot)
    assert region.home_component is region.components[0]
    assert region.component_of(robot.home) == 0
    assert region.contains(robot.home)
    assert violated(robot, robot.home) == []
    assert keeps_clear(robot, robot.home[None]).all()


def test_commands_json_and_python_agree_on_a_limit(capsys, tmp_path):
    robot = with_limits(MINERVA, (0.0, 1.0), (-1.0, 1.0))
    file = tmp_path / "arm.toml"
    save_robot(robot, file)
    status, out, _ = run(capsys, "contains", str(file), "0deg", "0deg")
    assert status == 0
    assert out.startswith("feasible by points, in component 0 (of")
    status, out, _ = run(capsys, "region", str(file), "--json", "-")
    content = json.loads(out)
    assert status == 0
    assert content["home_component"] == 0
    assert content["home"] == {"q": [0.0, 0.0], "feasible": True, "violated": []}
    assert content["components"][0]["contains_home"]


# --- touching ------------------------------------------------------------------------------------


@pytest.mark.parametrize("gap", [0.0, 1e-16, -1e-16])
def test_touching_spheres_are_feasible(gap):
    """Nothing but rounding tells these gaps apart."""
    pair = MINERVA.boundary("B1")
    assert isinstance(pair, Pair)
    apart = float(MINERVA.required_distance(pair) + dict(margins(MINERVA, MINERVA.home))["B1"])
    touching = replace(pair, clearance=apart - gap)
    boundaries = tuple(touching if b is pair else b for b in MINERVA.boundaries)
    robot = replace(MINERVA, boundaries=boundaries)
    assert dict(margins(robot, robot.home))["B1"] == 0
    region = find_region(robot)
    assert region.contains(robot.home)
    assert region.has_home
    assert keeps_clear(robot, robot.home[None]).all()


def test_a_violation_beyond_rounding_is_one():
    pair = MINERVA.boundary("B1")
    assert isinstance(pair, Pair)
    apart = float(MINERVA.required_distance(pair) + dict(margins(MINERVA, MINERVA.home))["B1"])
    boundaries = tuple(
        replace(pair, clearance=apart + 1e-9) if b is pair else b for b in MINERVA.boundaries
    )
    robot = replace(MINERVA, boundaries=boundaries)
    ((name, margin),) = violated(robot, robot.home)
    assert name == "B1"
    assert_allclose(margin, -1e-9, rtol=1e-3)
    assert not find_region(robot).contains(robot.home)
    assert not find_region(robot).has_home


def test_the_common_boundary_of_two_components_belongs_to_both():
    separated = problem_of(forms(RR, {"00": 1, "10": -1}), SQUARE)  # 1 - cos q1
    region = solve(separated, (0.0, 0.0))
    assert region.components_of((0.0, 0.3)) == (0, 1)
    assert region.component_of((0.0, 0.3)) == 0
    assert [c.contains_home for c in region.components] == [True, True]
    assert region.home_component is region.components[0]
    beside = {region.components_of((x, 0.3)) for x in (-1e-3, 1e-3)}
    assert beside == {(0,), (1,)}


def test_touching_without_room_is_feasible_and_in_no_component():
    point = problem_of(forms(PP, {"20": -1, "02": -1}), SQUARE)
    region = solve(point, (0.0, 0.0))
    assert region.components == ()
    assert region.contains((0.0, 0.0))
    assert region.component_of((0.0, 0.0)) is None
    assert region.empty_because == ("f0",)


@pytest.mark.parametrize("seed", range(12))
def test_every_point_of_an_arc_belongs_to_its_component(seed):
    region, checked = find_region(random_robot(seed)), 0
    for k, component in enumerate(region.components):
        for loop in component.loops:
            for arc in loop:
                for q in arc.points[:: max(1, len(arc.points) // 8)]:
                    if region.contains(q):  # else it lies a rounding outside
                        assert k in region.components_of(q), (arc.boundary, q)
                        checked += 1
    assert checked or not any(component.loops for component in region.components)


# --- a boundary that depends on no joint ---------------------------------------------------------


def still(offset: float) -> HalfSpace:
    return HalfSpace("still", "base", np.array([0.0, 0.0, 1.0]), offset)


@pytest.mark.parametrize(("offset", "reason"), [(-1.0, ()), (0.0, ("still",)), (1.0, ("still",))])
def test_what_depends_on_no_joint_is_decided_by_name(offset, reason):
    """Kept with room everywhere, touching everywhere, violated everywhere."""
    base = Point("base", MINERVA.base, np.zeros(3))
    robot = replace(
        MINERVA,
        points=(*MINERVA.points, base),
        boundaries=(*MINERVA.boundaries, still(offset)),
    )
    region = find_region(robot)
    assert region.empty_because == reason
    assert bool(region.components) == (offset < 0)
    assert region.contains(robot.home) == (offset <= 0)
    if offset < 0:
        assert_allclose(region.area, find_region(MINERVA).area, rtol=1e-12)


def test_a_held_joint_beyond_its_limit_leaves_nothing():
    robot = three_joints()
    limited = replace(robot.joints[2], limits=(-1.0, 1.0))
    robot = replace(robot, joints=(*robot.joints[:2], limited))
    assert find_region(robot, {2: 1.0}).empty_because == ()
    assert find_region(robot, {2: 1.5}).empty_because == (f"{limited.name}.upper",)


def test_an_empty_region_names_boundaries_each_of_which_is_needed():
    # cos q1 > 1/2, cos q2 > 1/2, cos q1 < -1/2
    blocked = forms(RR, {"00": -0.5, "10": 1}, {"00": -0.5, "01": 1}, {"00": -0.5, "10": -1})
    assert solve(problem_of(blocked, (None, None)), (0.0, 0.0)).empty_because == ("f0", "f2")


# --- order ---------------------------------------------------------------------------------------


def test_vertices_have_one_order_in_python_json_and_commands(capsys):
    region = find_region(MINERVA)
    _, out, _ = run(capsys, "region", "minervabot-v2", "--json", "-")
    written = json.loads(out)["components"]
    for component, content in zip(region.components, written, strict=True):
        assert [v.q.tolist() for v in component.vertices] == [v["q"] for v in content["vertices"]]
        heights = [v.q[1] for v in component.vertices]
        assert heights[0] <= min(heights) + 1e-9  # as near as they are compared


def test_one_configuration_is_asked_for_where_one_is_meant():
    many = [[0.0, 0.0], [1.0, 1.0]]
    with pytest.raises(ValueError, match="one configuration"):
        find_region(MINERVA).components_of(many)
    with pytest.raises(ValueError, match=r"one configuration.*margins and is_feasible"):
        violated(MINERVA, many)


def test_a_fixed_pair_that_must_keep_nothing_blocks_nothing():
    fixed = [Point(name, MINERVA.base, np.zeros(3)) for name in ("here", "there")]
    pair = Pair("fixed", ("here", "there"), 0.0)
    robot = replace(
        MINERVA, points=(*MINERVA.points, *fixed), boundaries=(*MINERVA.boundaries, pair)
    )
    assert_allclose(find_region(robot).area, find_region(MINERVA).area, rtol=1e-12)


def test_of_several_boundaries_that_are_violated_everywhere_one_is_reason_enough():
    base = Point("base", MINERVA.base, np.zeros(3))
    walls = (replace(still(1.0), name="one"), replace(still(1.0), name="other"))
    robot = replace(MINERVA, points=(*MINERVA.points, base), boundaries=walls)
    assert find_region(robot).empty_because == ("one",)
